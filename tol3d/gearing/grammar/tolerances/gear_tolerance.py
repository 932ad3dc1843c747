"""What every tolerance of a gear, or of what carries it, has in common."""

from typing import ClassVar

from pydantic import Field

from tol3d.gearing.grammar.parts import GearSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import GearingToleranceSpec
from tol3d.scene.entry import Entry
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference


class GearToleranceSpec(GearingToleranceSpec):
    """A tolerance of one gear, or of what carries it."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (GearSpec,)

    of: Name = Field(description="the gear")

    def references(self) -> tuple[Reference, ...]:
        """The gear, or what carries it."""
        return (Reference(("of",), self.of, self.applies_to),)
