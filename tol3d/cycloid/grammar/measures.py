"""Kinds of measure of RV reducers."""

from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from tol3d.cycloid.grammar.moves import RVReducerSpec
from tol3d.scene.direction import FixedAngle, RandomOrFixed, known_word, shape
from tol3d.scene.listed import listed
from tol3d.scene.measure import AngleSpec, CountLimit, MeasureSpec
from tol3d.scene.name import Name
from tol3d.scene.part import Length
from tol3d.scene.reference import Reference
from tol3d.strict import refused
from tol3d.units import Dimension

Over = Annotated[
    Annotated[Literal["random", "turn"], Tag("word")] | FixedAngle, Discriminator(shape), known_word("random", "turn")
]


Reducer = Annotated[Name, Field(description="the RV reducer")]


class CycloidMeasureSpec(MeasureSpec):
    """A measure of an RV reducer."""

    of: Reducer

    def references(self) -> tuple[Reference, ...]:
        """The reducer."""
        return (Reference(("of",), self.of, (RVReducerSpec,)),)


class OutputAngleSpec(AngleSpec, CycloidMeasureSpec):
    """An angle of the output."""

    of: Reducer


class CycloidLostMotionSpec(OutputAngleSpec):
    """An angle: the free turn of the output while the input stands; below 0 where pins press on both sides."""

    gives_curve: ClassVar[bool] = False
    several_positions: ClassVar[bool] = False

    kind: Literal["cycloid_lost_motion"]
    over: RandomOrFixed = Field(default="random", description="position of the output: random or {at: angle}")


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
        default=None, description="value at one position; of a turn min (default), max, range or curve"
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
        """Value taken over the positions."""
        return self.take or ("min" if self.over == "turn" else "value")

    @property
    def gives_curve(self) -> bool:
        """True if a trial gives a count at every position instead of one."""
        return self.taken == "curve"

    @property
    def several_positions(self) -> bool:
        """True: it is read over a turn."""
        return self.over == "turn"


MOST_ORDER: Final = 16_000  # of 32 000 positions
ONE_POSITION: Final = "value"
Order = Annotated[int, Field(ge=1, le=MOST_ORDER)]


class CycloidTransmissionErrorSpec(OutputAngleSpec):
    """An angle: lead of the output over its nominal position while a load on it keeps pins and flanks in touch.

    The output turns counter-clockwise. At one position it is counted from the nominal one; over a turn it is 0 at the
    first position.
    """

    kind: Literal["cycloid_transmission_error"]
    flank: Literal["drive", "back"] = Field(
        default="drive", description="drive: the load resists the output; back: it drives it on"
    )
    over: Over = Field(default="random", description="position of the output: random, {at: angle}, or turn (one of it)")
    take: Literal["value", "min", "max", "range", "harmonic", "curve"] | None = Field(
        default=None,
        description="value at one position; of a turn min, max, range (peak to peak; default), harmonic or curve",
    )
    order: int | None = Field(
        default=None, ge=1, description="of the harmonic: cycles a turn of the output; default: 1"
    )
    orders: Annotated[tuple[Order, ...], listed("orders")] | None = Field(
        default=None, description="of a curve: orders whose amplitudes are pooled, cycles a turn of the output"
    )
    positions: int = Field(
        default=2000, ge=24, le=32_000, description="positions a turn of the output; many for each turn of the cranks"
    )

    @model_validator(mode="after")
    def _refuse_unfit(self) -> Self:
        if self.take is not None and (self.take == ONE_POSITION) == (self.over == "turn"):
            fitting = (
                "min, max, range, harmonic or curve over a turn" if self.over == "turn" else "value at one position"
            )
            raise refused("take", fitting, self.take)
        self._refuse_orders()
        return self

    def _refuse_orders(self) -> None:
        """Refuse orders of a measure without any, and those that the positions do not resolve."""
        if self.order is not None and self.take != "harmonic":
            raise refused("order", f"none beside take: {self.taken}; only a harmonic has an order", self.order)
        if self.orders is not None and self.take != "curve":
            raise refused("orders", f"none beside take: {self.taken}; only a curve has orders", list(self.orders))
        for field, given in (("order", (self.order or 1,)), ("orders", self.orders or ())):
            if given and max(given) > (highest := (self.positions - 1) // 2):
                raise refused(field, f"at most {highest}, which {self.positions} positions resolve", max(given))

    @property
    def taken(self) -> Literal["value", "min", "max", "range", "harmonic", "curve"]:
        """Value taken over the positions."""
        return self.take or ("range" if self.over == "turn" else "value")

    @property
    def gives_curve(self) -> bool:
        """True if a trial gives a value at every position instead of one."""
        return self.taken == "curve"

    @property
    def several_positions(self) -> bool:
        """True: it is read over a turn."""
        return self.over == "turn"
