"""Lost motion of a planetary set."""

from typing import Literal

from pydantic import Field

from tol3d.planetary.grammar.measures.planetary_measure import PlanetaryMeasureSpec
from tol3d.scene.direction import RandomOrFixed


class PlanetaryLostMotionSpec(PlanetaryMeasureSpec):
    """An angle: the free turn of the output while the input stands, or of the input while the output stands.

    Planets, and shafts that neither are held nor drive, turn with it as their meshes let them.
    """

    kind: Literal["planetary_lost_motion"]
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
