"""Transmission error of a planetary set."""

from typing import Literal

from pydantic import Field

from tol3d.planetary.grammar.measures.planetary_measure import PlanetaryMeasureSpec


class PlanetaryTransmissionErrorSpec(PlanetaryMeasureSpec):
    """An angle: how far the output leads its nominal position while a load on it keeps the meshes on one side.

    Counted in the sense in which the output turns, 0 at the first position.
    """

    kind: Literal["planetary_transmission_error"]
    flank: Literal["drive", "back"] = Field(
        default="drive", description="drive: the load resists the output; back: it drives it on"
    )
    over: Literal["turn", "long_period"] = Field(
        default="turn",
        description="positions of the output: turn (one of it) or long_period (until the same teeth meet again)",
    )
    take: Literal["min", "max", "range", "curve"] = Field(
        default="range", description="min, max, range (peak to peak) or curve of these positions"
    )
    positions: int = Field(
        default=2000, ge=24, le=32_000, description="positions a turn of the output; many for each turn of the input"
    )

    @property
    def gives_curve(self) -> bool:
        """Whether a trial gives a value at every position instead of one."""
        return self.take == "curve"

    @property
    def several_positions(self) -> bool:
        """Always."""
        return True
