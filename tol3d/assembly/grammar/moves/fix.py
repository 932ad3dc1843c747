"""Parts that stay where they are nominally, and placed parts that become one body."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.moves.placing_move import PairSpec, PlacingSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.scene.listed import listed
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Reference


class FixSpec(PlacingSpec):
    """A part stays where it is nominally: the first of an assembly, or a fixture."""

    words: ClassVar[str] = "a fixed part"

    kind: Literal["fix"]

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """None."""
        return iter(())


class WeldSpec(MoveSpec):
    """Placed parts become one body, which may be moved again by the name of its first part."""

    words: ClassVar[str] = "a weld"

    kind: Literal["weld"]
    part: Name = Field(description="by whose name the body is moved again")
    to: Annotated[tuple[Name, ...], listed("parts")] = Field(description="what it is welded to")

    def references(self) -> tuple[Reference, ...]:
        """The parts."""
        others = (Reference(("to", k), name, (SolidSpec,)) for k, name in enumerate(self.to))
        return (Reference(("part",), self.part, (SolidSpec,)), *others)
