"""Region of low stiffness of a planetary set on a flexible carrier."""

from typing import Literal

from pydantic import Field

from tol3d.planetary.grammar.measures.planetary_measure import PlanetaryMeasureSpec
from tol3d.scene.direction import RandomOrFixed


class PlanetaryLowStiffnessSpec(PlanetaryMeasureSpec):
    """An angle: how far a shaft turns against the springs of a flexible carrier alone, both ways together.

    From where springs hold the planets, beyond the breakaway torque, to where contacts stop them for good: the region
    in which the set is as stiff as its springs. The lost motion that springs leave is not in it.
    """

    kind: Literal["planetary_low_stiffness"]
    at: Literal["output", "input"] = Field(default="output", description="the shaft that turns: output or input")
    over: RandomOrFixed = Field(default="random", description="position of the output: random or {at: angle}")

    @property
    def gives_curve(self) -> bool:
        """A number a trial."""
        return False

    @property
    def several_positions(self) -> bool:
        """At one."""
        return False
