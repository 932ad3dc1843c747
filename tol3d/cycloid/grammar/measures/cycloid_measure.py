"""What every measure of an RV reducer has in common."""

from typing import ClassVar

from pydantic import Field

from tol3d.cycloid.grammar.moves.rv_reducer import RVReducerSpec
from tol3d.scene.measure import AngleLimit, MeasureSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.units import Dimension


class CycloidMeasureSpec(MeasureSpec):
    """An angle of the output."""

    dimension: ClassVar[Dimension] = "angle"

    of: Name = Field(description="the RV reducer")
    lower_limit: AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: AngleLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """The reducer."""
        return (Reference(("of",), self.of, (RVReducerSpec,)),)
