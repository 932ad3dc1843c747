"""Transmission error of a planetary set."""

from typing import Literal, Self

from pydantic import Field, model_validator

from tol3d.planetary.grammar.measures.planetary_measure import PlanetaryMeasureSpec
from tol3d.strict import refused


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
    take: Literal["min", "max", "range", "harmonic", "curve"] = Field(
        default="range",
        description="min, max, range (peak to peak), harmonic (one sine, peak to peak) or curve of these positions",
    )
    order: int | None = Field(
        default=None, ge=1, description="of the harmonic: cycles a turn of the output; 1 if not given"
    )
    positions: int = Field(
        default=2000, ge=24, le=32_000, description="positions a turn of the output; many for each turn of the input"
    )

    @model_validator(mode="after")
    def _refuse_orders(self) -> Self:
        if self.order is None:
            return self
        if self.take != "harmonic":
            raise refused("order", f"none beside take: {self.take}; only a harmonic has an order", self.order)
        if self.order > (highest := (self.positions - 1) // 2):
            raise refused("order", f"at most {highest}, which {self.positions} positions resolve", self.order)
        return self

    @property
    def gives_curve(self) -> bool:
        """Whether a trial gives a value at every position instead of one."""
        return self.take == "curve"

    @property
    def several_positions(self) -> bool:
        """Always."""
        return True
