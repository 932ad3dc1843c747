"""Lost motion of an RV reducer."""

from typing import Literal

from pydantic import Field

from tol3d.cycloid.grammar.measures.cycloid_measure import CycloidMeasureSpec
from tol3d.scene.direction import RandomOrFixed


class CycloidLostMotionSpec(CycloidMeasureSpec):
    """An angle: the free turn of the output while the input stands; below 0 where pins press on both sides."""

    kind: Literal["cycloid_lost_motion"]
    over: RandomOrFixed = Field(default="random", description="position of the output: random or {at: angle}")

    @property
    def gives_curve(self) -> bool:
        """A number a trial."""
        return False

    @property
    def several_positions(self) -> bool:
        """At one."""
        return False
