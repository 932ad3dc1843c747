"""What every tolerance of a gear, or of what carries it, has in common."""

from typing import ClassVar

from pydantic import Field

from tol3d.gearing.grammar.parts import GEARS
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference, Sort
from tol3d.scene.tolerance import ToleranceSpec


class GearToleranceSpec(ToleranceSpec):
    """A tolerance of one gear, or of what carries it."""

    sorts: ClassVar[tuple[Sort, ...]] = GEARS

    of: Name = Field(description="the gear")

    def references(self) -> tuple[Reference, ...]:
        """The gear, or what carries it."""
        return (Reference(("of",), self.of, self.sorts),)
