"""Parts that stay where they are nominally, and placed parts that become one body."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.moves.assembly_move import AssemblyMoveSpec, PlacingSpec
from tol3d.assembly.model.move import Acts
from tol3d.assembly.model.moves import STATED_BY, Fix, Weld
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath


class FixSpec(PlacingSpec):
    """A part stays where it is nominally: the first of an assembly, or a fixture."""

    words: ClassVar[str] = "a fixed part"
    acts: ClassVar[Acts] = Fix.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.moves:fixed"

    kind: Literal["fix"]

    @property
    def fixed(self) -> Sequence[str]:
        return (self.part,)


class WeldSpec(AssemblyMoveSpec):
    """Placed parts become one body, which may be moved again by the name of its first part."""

    words: ClassVar[str] = "a weld"
    acts: ClassVar[Acts] = Weld.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.moves:welded"

    kind: Literal["weld"]
    part: Name = Field(description="by whose name the body is moved again")
    to: Annotated[tuple[Name, ...], listed("parts")] = Field(description="what it is welded to")

    @property
    def joined(self) -> Sequence[tuple[KeyPath, str]]:
        return [(("part",), self.part), *((("to", k), name) for k, name in enumerate(self.to))]
