"""A part that rests on one-sided contacts under a force, such as its weight."""

from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.moves.locating import ContactSpec, LocatingSpec
from tol3d.assembly.grammar.moves.mate import RelationSpec
from tol3d.assembly.grammar.moves.placing_move import PairSpec
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction, Vector
from tol3d.strict import Strict


class ForceSpec(Strict):
    """A force on the part; how large it is does not matter."""

    direction: Direction = Field(description="in the world; gravity is [0, 0, -1] where z points up")
    at: Vector = Field(description="a point on its line, in the frame of the part; of its weight the centre of gravity")


class RestSpec(LocatingSpec):
    """One-sided contacts, of which a force chooses those that carry; without friction."""

    words: ClassVar[str] = "a rest"

    kind: Literal["rest"]
    contacts: Annotated[tuple[ContactSpec, ...], listed("contacts", 1)]
    force: ForceSpec
    relations: Annotated[tuple[RelationSpec, ...], listed("relations", 1, 6)] = Field(
        default=(), description="as of a mate, kept while the force moves what they leave free"
    )

    @property
    def pairs_by_name(self) -> Mapping[str, tuple[KeyPath, ContactSpec]]:
        """See LocatingSpec."""
        return {str(k + 1): (("contacts", k), pair) for k, pair in enumerate(self.contacts)}

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """Contacts, then relations."""
        return chain(super().paired(), ((("relations", k), pair) for k, pair in enumerate(self.relations)))
