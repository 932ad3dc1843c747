"""How many pins of an RV reducer are near contact."""

from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.cycloid.grammar.measures.cycloid_measure import CycloidMeasureSpec, Over
from tol3d.scene.measure import CountLimit
from tol3d.scene.part import Length
from tol3d.strict import refused
from tol3d.units import Dimension


class CycloidPinsNearContactSpec(CycloidMeasureSpec):
    """A count: working pins of all discs whose gap is within the deflection where the first one touches, that too."""

    dimension: ClassVar[Dimension] = "count"

    kind: Literal["cycloid_pins_near_contact"]
    deflection: Length = Field(description="the largest gap of a pin that is counted, along the normal")
    flank: Literal["drive", "back"] = Field(
        default="drive", description="drive: the load resists the output; back: it drives it on"
    )
    over: Over = Field(default="random", description="position of the output: random, {at: angle}, or turn (one of it)")
    take: Literal["value", "min", "max", "range", "curve"] | None = Field(
        default=None, description="value at one position; of a turn min (if not given), max, range or curve"
    )
    positions: int = Field(
        default=2000, ge=24, le=32_000, description="positions a turn of the output; many for each turn of the cranks"
    )
    lower_limit: CountLimit | None = Field(default=None, description="fewer than this are out of limits")
    upper_limit: CountLimit | None = Field(default=None, description="more than this are out of limits")

    @model_validator(mode="after")
    def _refuse_unfit(self) -> Self:
        if self.take is not None and (self.take == "value") == (self.over == "turn"):
            fitting = "min, max, range or curve over a turn" if self.over == "turn" else "value at one position"
            raise refused("take", fitting, self.take)
        return self

    @property
    def taken(self) -> Literal["value", "min", "max", "range", "curve"]:
        """What is taken."""
        return self.take or ("min" if self.over == "turn" else "value")

    @property
    def gives_curve(self) -> bool:
        """Whether a trial gives a count at every position instead of one."""
        return self.taken == "curve"

    @property
    def several_positions(self) -> bool:
        """Over a turn."""
        return self.over == "turn"
