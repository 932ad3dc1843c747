"""What every tolerance of a mesh has in common."""

from typing import ClassVar

from pydantic import Field

from tol3d.gearing.grammar.moves import MeshSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearingToleranceSpec
from tol3d.scene.entry import Entry
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference


class MeshToleranceSpec(GearingToleranceSpec):
    """A tolerance of how two axes lie to each other."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (MeshSpec,)

    of: Name = Field(description="the mesh move")

    def references(self) -> tuple[Reference, ...]:
        """The mesh."""
        return (Reference(("of",), self.of, self.applies_to),)
