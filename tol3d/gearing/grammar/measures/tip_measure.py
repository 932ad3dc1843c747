"""What every measure of a point on a train's arm has in common."""

from collections.abc import Iterator, Mapping
from typing import ClassVar

from pydantic import Field

from tol3d.gearing.grammar.measures.train_measure import TrainMeasureSpec
from tol3d.gearing.grammar.moves import MoveSpec
from tol3d.gearing.grammar.parts import ArmSpec, PartSpec
from tol3d.scene.measure import LengthLimit
from tol3d.scene.name import Name
from tol3d.scene.reference import Contradiction, Reference
from tol3d.units import Dimension


class TipMeasureSpec(TrainMeasureSpec):
    """A length at a point of an arm."""

    dimension: ClassVar[Dimension] = "length"

    arm: Name = Field(description="the arm")
    point: Name = Field(description="one of the arm's points")
    lower_limit: LengthLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """The train and the arm."""
        return (*super().references(), Reference(("arm",), self.arm, (ArmSpec,)))

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The arm has the point."""
        arm = parts[self.arm]
        if isinstance(arm, ArmSpec) and self.point not in arm.points:
            yield Contradiction(("point",), f"a point of the arm {self.arm!r}", repr(self.point), tuple(arm.points))
