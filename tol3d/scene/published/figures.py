"""Kinds of published number, and the quantities that are somewhere among them."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Final, Self

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, model_validator

from tol3d.scene.place import KeyPath
from tol3d.strict import Strict, refused
from tol3d.units import Quantity

LARGEST: Final = 1e15  # as in summaries: of any unit
MOST_TRIALS: Final = 10**10  # as in studies
MOST_FIGURES: Final = 10_000  # of one list; a scene has room for twice as many values

Figure = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST)]
Percent = Annotated[float, Field(ge=0.0, le=100.0)]
Ppm = Annotated[float, Field(ge=0.0, le=1e6)]
R = Annotated[float, Field(ge=-1.0, le=1.0)]
Count = Annotated[int, Field(ge=0, le=MOST_TRIALS)]
Counts = Annotated[list[Count], Field(min_length=1, max_length=MOST_FIGURES)]
Figures = Annotated[list[Figure], Field(min_length=1, max_length=MOST_FIGURES)]
Quantities = Annotated[list[Quantity], Field(min_length=1, max_length=MOST_FIGURES)]

Range = Annotated[list[Quantity], Field(min_length=2, max_length=2)]


def _rising(bounds: list[float]) -> list[float]:
    if not bounds[0] <= bounds[1]:
        raise refused("", f"the lower bound first, at most {bounds[1]:g}", f"{bounds[0]:g}")
    return bounds


FigureRange = Annotated[list[Figure], Field(min_length=2, max_length=2), AfterValidator(_rising)]
PpmRange = Annotated[list[Ppm], Field(min_length=2, max_length=2), AfterValidator(_rising)]


def _shape(value: Any) -> str:
    """The tag of a number or of keys with values, for pydantic's Discriminator."""
    return "keys" if isinstance(value, dict | Strict) else "number"


def _number_or_keys(value: Any) -> Any:
    if isinstance(value, str | list) or value is None:
        raise refused("", "a number, or keys with values", repr(value) if isinstance(value, str) else "another value")
    return value


class PublishedShare(Strict):
    """Published figures of a contributor: shares of the measure's variance [%]."""

    percent: Percent | None = Field(default=None, description="share of the variance [%]")
    percent_se: Percent | None = Field(default=None, description="standard error of the share")
    high_low_mean_percent: Percent | None = Field(
        default=None, description="share of the squares of high-low-mean ranges"
    )


class PublishedCorrelation(Strict):
    """Published figures of two measures together."""

    r: R | None = Field(default=None, description="Pearson's")
    r_low_95: R | None = Field(default=None, description="lower bound of the true r, 95 % confidence")
    r_high_95: R | None = Field(default=None, description="upper bound of the true r, 95 % confidence")
    trials: Count | None = Field(default=None, description="trials that have both values")


Share = Annotated[
    Annotated[Percent, Tag("number")] | Annotated[PublishedShare, Tag("keys")],
    Discriminator(_shape),
    BeforeValidator(_number_or_keys),
]
Correlation = Annotated[
    Annotated[R, Tag("number")] | Annotated[PublishedCorrelation, Tag("keys")],
    Discriminator(_shape),
    BeforeValidator(_number_or_keys),
]


def quantities_in(value: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, Quantity]]:
    """Every dimensioned number in published figures, with its place below them."""
    if isinstance(value, Quantity):
        yield path, value
        return
    items: Iterator[tuple[str | int, Any]] = iter(())
    if isinstance(value, Strict):
        items = ((field.alias or name, getattr(value, name)) for name, field in type(value).model_fields.items())
    elif isinstance(value, Mapping):
        items = iter(value.items())
    elif isinstance(value, list):
        items = iter(enumerate(value))
    for key, own in items:
        yield from quantities_in(own, (*path, key))


def refuse_uneven(figures: Strict, of: str, count: int, place: str = "") -> None:
    """Refuse lists that are not of some length.

    Args:
        figures: whose lists.
        of: the key that has as many values.
        count: the length.
        place: dotted name of the figures below the validated value, with a dot at its end.

    Raises:
        PydanticCustomError: one of them is not.
    """
    for name in type(figures).model_fields:
        values = getattr(figures, name)
        if isinstance(values, list) and not name.endswith("_95") and len(values) != count:
            raise refused(f"{place}{name}", f"{count} values, as {of}", len(values))


class PublishedSpectrum(Strict):
    """Amplitudes of harmonics, half of peak to peak: a list each, as `order`."""

    order: Figures = Field(description="cycles per turn")
    mean: Quantities | None = Field(default=None, description="means")
    sigma: Quantities | None = Field(default=None, description="standard deviations")
    p0_135: Quantities | None = Field(default=None, alias="p0.135", description="0.135 % quantiles")
    p50: Quantities | None = Field(default=None, description="medians")
    p99_865: Quantities | None = Field(default=None, alias="p99.865", description="99.865 % quantiles")
    max: Quantities | None = Field(default=None, description="largest values of the trials")

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        refuse_uneven(self, "order", len(self.order))
        return self


class PublishedCurve(Strict):
    """A curve: a list of each statistic, as the measure's `position_deg`."""

    mean: Quantities | None = Field(default=None, description="means")
    sigma: Quantities | None = Field(default=None, description="standard deviations")
    min: Quantities | None = Field(default=None, description="smallest values of the trials")
    max: Quantities | None = Field(default=None, description="largest values of the trials")
    trials: Count | None = Field(default=None, description="all of them, failed ones too")
    below_limit_ppm: Ppm | None = Field(default=None, description="share below the lower limit at any position [ppm]")
    above_limit_ppm: Ppm | None = Field(default=None, description="share above the upper limit at any position [ppm]")
    failed_ppm: Ppm | None = Field(default=None, description="share that could not be assembled [ppm]")
    out_ppm: Ppm | None = Field(default=None, description="share that failed or is out of limits [ppm]")
    out_ppm_95: PpmRange | None = Field(default=None, description="bounds of the true share, 95 % confidence [ppm]")
    ppk: Figure | None = Field(default=None, description="Ppk")
    ppk_95: FigureRange | None = Field(default=None, description="bounds of the true Ppk, 95 % confidence")
    spectrum: PublishedSpectrum | None = Field(default=None, description="its harmonics")

    @property
    def is_listed(self) -> bool:
        """True if it has a statistic at positions."""
        return any(isinstance(getattr(self, name), list) for name in ("mean", "sigma", "min", "max"))


class PublishedHistogram(Strict):
    """Counts over bars of one width."""

    lower_edge: Quantity = Field(description="of the first bar")
    bin_width: Quantity = Field(description="of each bar")
    counts: Counts = Field(description="trials in each bar")

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if not self.bin_width.number > 0.0:
            raise refused("bin_width", "more than 0", self.bin_width)
        return self


class PublishedAgreement(Strict):
    """Published difference of two methods, trial by trial: simulation less theory."""

    max_abs_difference: Quantity | None = Field(default=None, description="largest difference, without its sign")
    rms_difference: Quantity | None = Field(default=None, description="root mean square of the differences")
    mean_difference: Quantity | None = Field(default=None, description="mean of the differences")
    compared: Count | None = Field(default=None, description="trials that both have a value of")
