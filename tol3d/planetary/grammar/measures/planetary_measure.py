"""What every measure of a planetary set has in common."""

from typing import ClassVar

from pydantic import Field

from tol3d.planetary.grammar.moves.planetary import PlanetarySpec
from tol3d.scene.measure import AngleLimit, MeasureSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.units import Dimension


class PlanetaryMeasureSpec(MeasureSpec):
    """An angle that is read on a planetary set."""

    dimension: ClassVar[Dimension] = "angle"

    of: Name = Field(description="the planetary set")
    lower_limit: AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: AngleLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """The set."""
        return (Reference(("of",), self.of, (PlanetarySpec,)),)
