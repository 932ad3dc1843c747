"""Lost motion of a train."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.measures.train_measure import TrainMeasureSpec
from tol3d.gearing.grammar.parts.shaft_reference import ShaftReference
from tol3d.scene.direction import RandomOrFixed
from tol3d.scene.measure import AngleLimit
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.units import Dimension


class LostMotionSpec(TrainMeasureSpec):
    """An angle: the free turn of a shaft while the train's held shaft stands.

    The angular backlashes of the links between the two, each at its driven shaft, over the ratios behind it.
    """

    dimension: ClassVar[Dimension] = "angle"

    kind: Literal["lost_motion"]
    shaft: Name | None = Field(default=None, description="the shaft that turns; the train's output if not given")
    over: RandomOrFixed = Field(
        default="random", description="position of the train's driven shaft: random or {at: angle}"
    )
    lower_limit: AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: AngleLimit | None = Field(default=None, description="more than this is out of limits")

    def references(self) -> tuple[Reference, ...]:
        """The train, and the shaft if it is given."""
        train = super().references()
        return train if self.shaft is None else (*train, ShaftReference(("shaft",), self.shaft))
