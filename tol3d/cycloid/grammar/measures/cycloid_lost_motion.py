"""Lost motion of an RV reducer."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.cycloid.grammar.measures.cycloid_measure import OutputAngleSpec
from tol3d.scene.direction import RandomOrFixed


class CycloidLostMotionSpec(OutputAngleSpec):
    """An angle: the free turn of the output while the input stands; below 0 where pins press on both sides."""

    gives_curve: ClassVar[bool] = False
    several_positions: ClassVar[bool] = False

    kind: Literal["cycloid_lost_motion"]
    over: RandomOrFixed = Field(default="random", description="position of the output: random or {at: angle}")
