"""A part that is laid against others by contacts of round features."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.feature_name import Use
from tol3d.assembly.grammar.moves.placing_move import PairSpec, PlacingSpec
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction

SURFACES = ("plane", "cylinder", "sphere", "point")


class TouchSpec(PlacingSpec):
    """Contacts of round features, all at once: surfaces touch by the sizes of the trial."""

    words: ClassVar[str] = "a touch"

    kind: Literal["touch"]
    contacts: Annotated[tuple[PairSpec, ...], listed("contacts", 1, 6)]
    pressed: Direction | None = Field(
        default=None,
        description="where the part is pressed to, in the frame of the part of the first `to`; contacts do not pull",
    )

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """See PlacingSpec."""
        return ((("contacts", k), pair) for k, pair in enumerate(self.contacts))

    def uses(self) -> Iterator[Use]:
        """The features of the contacts."""
        for path, pair in self.paired():
            yield Use((*path, "from"), pair.from_, SURFACES)
            yield Use((*path, "to"), pair.to, SURFACES)
