"""Kinds of measure of RV reducers."""

from typing import Annotated, ClassVar, Final, Literal

from pydantic import Discriminator, Field, Tag

from tol3d.gearing.cycloid.grammar.moves import RVReducerSpec
from tol3d.gearing.reducers.grammar import Flank, FreeTurnSpec, HarmonicOrder, OverTurnSpec
from tol3d.scene.bases import AngleSpec, CountLimit, Length, MeasureSpec, MoveSpec, Take
from tol3d.scene.direction import FixedAngle, RandomOrFixed, known_word, shape
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.units import Dimension

Over = Annotated[
    Annotated[Literal["random", "turn"], Tag("word")] | FixedAngle, Discriminator(shape), known_word("random", "turn")
]


Reducer = Annotated[Name, Field(description="the RV reducer")]


class CycloidMeasureSpec(MeasureSpec):
    """A measure of an RV reducer."""

    applies_to: ClassVar[tuple[type[MoveSpec], ...]] = (RVReducerSpec,)

    of: Reducer


class OutputAngleSpec(AngleSpec, CycloidMeasureSpec):
    """An angle of the output."""

    of: Reducer


class CycloidLostMotionSpec(OutputAngleSpec, FreeTurnSpec):
    """An angle: the free turn of the output while the input stands; below 0 where pins press on both sides."""

    kind: Literal["cycloid_lost_motion"]
    over: RandomOrFixed = Field(default="random", description="position of the output: random or {at: angle}")


class CycloidPinsNearContactSpec(CycloidMeasureSpec, OverTurnSpec):
    """A count: working pins of all discs whose gap is within the deflection where the first one touches, that too."""

    dimension: ClassVar[Dimension] = "count"
    takes: ClassVar[str] = "min, max, range or curve"
    usual: ClassVar[Take] = "min"

    kind: Literal["cycloid_pins_near_contact"]
    deflection: Length = Field(description="the largest gap of a pin that is counted, along the normal")
    flank: Flank = "drive"
    over: Over = Field(default="random", description="position of the output: random, {at: angle}, or turn (one of it)")
    take: Literal["value", "min", "max", "range", "curve"] | None = Field(
        default=None, description="value at one position; of a turn min (default), max, range or curve"
    )
    positions: int = Field(
        default=2000, ge=24, le=32_000, description="positions a turn of the output; many for each turn of the cranks"
    )
    lower_limit: CountLimit | None = Field(default=None, description="fewer than this are out of limits")
    upper_limit: CountLimit | None = Field(default=None, description="more than this are out of limits")


MOST_ORDER: Final = 16_000  # of 32 000 positions
Order = Annotated[int, Field(ge=1, le=MOST_ORDER)]


class CycloidTransmissionErrorSpec(OutputAngleSpec, OverTurnSpec):
    """An angle: lead of the output over its nominal position while a load on it keeps pins and flanks in touch.

    The output turns counter-clockwise. At one position it is counted from the nominal one; over a turn it is 0 at the
    first position.
    """

    kind: Literal["cycloid_transmission_error"]
    flank: Flank = "drive"
    over: Over = Field(default="random", description="position of the output: random, {at: angle}, or turn (one of it)")
    take: Literal["value", "min", "max", "range", "harmonic", "curve"] | None = Field(
        default=None,
        description="value at one position; of a turn min, max, range (peak to peak; default), harmonic or curve",
    )
    order: HarmonicOrder = None
    orders: Annotated[tuple[Order, ...], listed("orders")] | None = Field(
        default=None, description="of a curve: orders whose amplitudes are pooled, cycles a turn of the output"
    )
    positions: int = Field(
        default=2000, ge=24, le=32_000, description="positions a turn of the output; many for each turn of the cranks"
    )
