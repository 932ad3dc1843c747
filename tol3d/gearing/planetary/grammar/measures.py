"""Kinds of measure of planetary sets."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.planetary.grammar.moves import PlanetarySpec
from tol3d.gearing.reducers.grammar import Flank, FreeTurnSpec, HarmonicOrder, OverTurnSpec
from tol3d.scene.bases import AngleSpec, MoveSpec
from tol3d.scene.direction import RandomOrFixed
from tol3d.scene.name import Name


class PlanetaryMeasureSpec(AngleSpec):
    """An angle that is read on a planetary set."""

    applies_to: ClassVar[tuple[type[MoveSpec], ...]] = (PlanetarySpec,)

    of: Name = Field(description="the planetary set")


class PlanetaryFreeTurnSpec(PlanetaryMeasureSpec, FreeTurnSpec):
    """A free turn of a shaft at one position, or a part of it."""

    at: Literal["output", "input"] = Field(default="output", description="the shaft that turns: output or input")
    over: RandomOrFixed = Field(default="random", description="position of the output: random or {at: angle}")


class PlanetaryLostMotionSpec(PlanetaryFreeTurnSpec):
    """An angle: the free turn of the output while the input stands, or of the input while the output stands.

    Planets, and shafts that neither are held nor drive, turn with it as their meshes let them.
    """

    kind: Literal["planetary_lost_motion"]


class PlanetaryLowStiffnessSpec(PlanetaryFreeTurnSpec):
    """An angle: turn of a shaft against the springs of a flexible carrier alone, both ways together.

    From where springs hold the planets, beyond the breakaway torque, to where contacts stop them for good: the region
    in which the set is as stiff as its springs. The lost motion that springs leave is not in it.
    """

    kind: Literal["planetary_low_stiffness"]


class PlanetaryTransmissionErrorSpec(PlanetaryMeasureSpec, OverTurnSpec):
    """An angle: lead of the output over its nominal position while a load on it keeps the meshes on one side.

    Counted in the sense in which the output turns, 0 at the first position.
    """

    kind: Literal["planetary_transmission_error"]
    flank: Flank = "drive"
    over: Literal["turn", "long_period"] = Field(
        default="turn",
        description="positions of the output: turn (one of it) or long_period (until the same teeth meet again)",
    )
    take: Literal["min", "max", "range", "harmonic", "curve"] = Field(
        default="range",
        description="min, max, range (peak to peak), harmonic (one sine, peak to peak) or curve of these positions",
    )
    order: HarmonicOrder = None
    positions: int = Field(
        default=2000, ge=24, le=32_000, description="positions a turn of the output; many for each turn of the input"
    )
