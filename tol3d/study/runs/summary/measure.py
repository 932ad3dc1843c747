"""One measure of a run: its properties, the findings of each method, and published figures.

A measure of where the output of a reducer or a planetary set stands, as summary.json has it.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator

from tol3d.scene.published import PublishedMeasure
from tol3d.strict import refused
from tol3d.study.runs.summary.agreement import Agreement
from tol3d.study.runs.summary.published import in_summary
from tol3d.study.runs.summary.sample import CurveMethods, CurveSample, Histogram, Methods, Normal, Sample
from tol3d.study.runs.summary.values import (
    LEFT_OUT,
    Count,
    Known,
    Label,
    Maybe,
    Method,
    NotNegative,
    Numbers,
    Section,
    Sentence,
    Unit,
)
from tol3d.study.system.outcome import SEATED

Worse = Literal["low", "high"]


SharesBy = Literal["regression", "total effects", "high-low-mean"]
"""Means by which shares of the variance are found."""


class ContributorShare(Section):
    """Shares of the variance of a measure [%]."""

    name: Label
    analytic_percent: Known
    geometric_percent: Known
    geometric_percent_se: Known = Field(description="one standard error")
    high_low_mean_percent: Known


class Unexplained(Section):
    """Shares of a measure that a regression on its contributors does not explain."""

    by: SharesBy = Field(
        description="total effects, or squared ranges as parts of their sum, in place of the regression's shares"
    )
    explained_percent: Known = Field(description="of the variance, by the regression, less what chance explains")


class Published(Section):
    """Published figures of a measure, in its unit, shares in %: any number that there is of ours."""

    description: Maybe[Sentence] = LEFT_OUT

    @property
    def percents(self) -> dict[str, float]:
        """Shares of the variance [%], by contributor."""
        return self._shares("percent")

    @property
    def high_low_mean_percents(self) -> dict[str, float]:
        """Shares of the squares of high-low-mean ranges [%], by contributor."""
        return self._shares("high_low_mean_percent")

    def _shares(self, key: str) -> dict[str, float]:
        found = {
            name: own.value(key) if isinstance(own, Section) else own if key == "percent" else None
            for name, own in (self.get("contributors") or {}).items()
        }
        return {name: share for name, share in found.items() if share is not None}


if TYPE_CHECKING:
    PublishedColumn = Published
else:
    PublishedColumn = in_summary(PublishedMeasure, Published)


@dataclass(frozen=True)
class Conversion:
    """A measure's values in other words: `words`, subject, `unit`, number per unit of the measure."""

    words: str
    of: str
    unit: Unit
    per_unit: float
    meaning: str


class MeasureSummary(Section):
    """One measure; every value is in `unit`. Mechanisms declare classes of it, with keys of their own."""

    presenter: ClassVar[str] = ""
    """Import path of its system's presenter, see `tol3d.report.presenter`."""
    long_in_mm: ClassVar[bool] = False
    """True of lengths that reports show in mm where they are nominally over 1 mm; the file has um."""

    kind: Label
    over: Label
    take: Literal["value", "min", "max", "range", "harmonic", "curve"]
    unit: Unit
    worse: Worse = Field(description="worse end without limits")
    lower_limit: Known
    upper_limit: Known
    status: Mapping[Label, Count] = Field(description="number of trials by status")
    reasons: Maybe[Mapping[Label, Count]] = Field(
        default=LEFT_OUT, description="number of failed trials by cause, in words of the system; the most first"
    )
    laws: Maybe[Mapping[Label, Label]] = Field(
        default=LEFT_OUT, description="laws of the zones that act on it, by tolerance"
    )
    law_sigmas_um: Maybe[Mapping[Label, NotNegative]] = Field(
        default=LEFT_OUT,
        description="standard deviation of the middle of each of these zones' features along one axis; of an "
        "orientation alone, of a rise at the edge or an end of the axis",
    )
    nominal: Methods
    mean_build: Methods
    analytic: Maybe[Sample] = LEFT_OUT
    analytic_closed_form: Maybe[Normal] = LEFT_OUT
    histogram: Maybe[Histogram] = LEFT_OUT
    geometric: Maybe[Sample] = LEFT_OUT
    agreement: Maybe[Agreement] = LEFT_OUT
    position_deg: Maybe[Numbers] = LEFT_OUT
    curve: Maybe[CurveMethods] = LEFT_OUT
    contributors: list[ContributorShare]
    shares_by: Maybe[Mapping[Method, Unexplained]] = Field(
        default=LEFT_OUT, description="methods whose regression explains less than 90 % of the variance"
    )
    published: Mapping[Label, PublishedColumn]

    # how it describes itself; a mechanism's class does so in its own words --------------------------------

    @property
    def words(self) -> str:
        """Quantity, subject and positions, in a line."""
        return self.kind.replace("_", " ")

    @property
    def position_word(self) -> str:
        """Whose positions those of a curve are: `driver`."""
        return ""

    @property
    def position_column(self) -> str | None:
        """The column with the position of each trial [deg]; None if there is none."""
        return None

    @property
    def jumps(self) -> bool:
        """True if it jumps between positions, so that its mean over them says nothing."""
        return False

    @property
    def jumps_deg(self) -> Sequence[float]:
        """Positions [deg] at which it jumps."""
        return ()

    @property
    def jump_words(self) -> str:
        """Reason why it jumps there."""
        return "jumps"

    @property
    def identity(self) -> tuple[str | None, ...]:
        """Properties that comparable measures of one name share, beside unit, positions and the value taken."""
        return (self.kind,)

    @property
    def conversions(self) -> Sequence[Conversion]:
        """Its values in other words, shown below them."""
        return ()

    def chord_words(self, chord_error_um: float) -> str:
        """Explanation of a difference by chord errors of measuring strips, in words; empty without strips."""
        return ""

    # ------------------------------------------------------------------------------------------------------

    @property
    def best_method(self) -> Method:
        """The method by which it is shown: the 3D simulation if there is one."""
        return "geometric" if self.geometric or (self.curve and self.curve.geometric) else "analytic"

    @property
    def limits(self) -> tuple[float | None, float | None]:
        """Lower and upper limit, None for none."""
        return self.lower_limit, self.upper_limit

    @property
    def has_limits(self) -> bool:
        """True if it has any limit."""
        return self.limits != (None, None)

    @property
    def seated(self) -> int:
        """Number of trials that were assembled."""
        return self.status.get(SEATED, self.trials)

    def ended_in(self, statuses: Collection[str]) -> int:
        """Number of trials that ended in one of some statuses."""
        return sum(self.status.get(text, 0) for text in statuses)

    @property
    def trials(self) -> int:
        """Number of trials."""
        return sum(self.status.values())

    def sample(self, method: Method) -> Sample | None:
        """Sample of a measure with one value per trial, by one method."""
        return self.geometric if method == "geometric" else self.analytic

    def curve_sample(self, method: Method) -> CurveSample | None:
        """Sample of a curve, by one method."""
        return getattr(self.curve, method, None)

    @property
    def shares(self) -> Sample | CurveSample:
        """Sample for the fractions out of limits, that of the best method."""
        found = self.curve_sample(self.best_method) if self.take == "curve" else self.sample(self.best_method)
        assert found is not None, "a summary that was read has one"
        return found

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        said = self.model_fields_set
        needed = {"curve", "position_deg"} if self.take == "curve" else {"analytic", "histogram"}
        if not needed <= said:
            raise refused("take", f"{' and '.join(sorted(needed))} beside it", self.take)
        if self.curve is not None and self.take == "curve":
            self._refuse_uneven_curves(self.curve)
        elif self.histogram is not None:
            self._refuse_uneven_histogram(self.histogram)
        if (self.agreement is None) != (self.geometric is None):
            raise refused("agreement", "one where there is a 3D simulation", "one of the two")
        return self

    def _refuse_uneven_curves(self, curve: CurveMethods) -> None:
        count = len(self.position_deg or ())
        for method in (curve.analytic, curve.geometric):
            lists = (method.mean, method.sigma, method.min, method.max) if method is not None else ()
            if any(len(values) != count for values in lists):
                raise refused("curve", f"{count} values each, as positions", "another number")
            if method is not None and method.spectrum is not None:
                method.spectrum.refuse_uneven()
        for build in (self.nominal, self.mean_build):
            for value in (build.analytic, build.geometric):
                if value is not None and not (isinstance(value, list) and len(value) == count):
                    raise refused("nominal", f"{count} values each, as positions, or null", "something else")

    def _refuse_uneven_histogram(self, histogram: Histogram) -> None:
        lower, width, counts = histogram.lower_edge, histogram.bin_width, histogram.counts
        if len(histogram) and (lower is None or width is None or counts is None):
            raise refused("histogram", "lower_edge, bin_width and counts", ", ".join(sorted(histogram.keys())))
        if counts is not None and width is not None:
            if len({len(count) for count in counts.values()}) != 1 or not width > 0.0:
                raise refused("histogram", "as many bars of both methods, wider than 0", "something else")
            if not any(counts.values()):
                raise refused("histogram.counts", "at least one bar", "none")
        for build in (self.nominal, self.mean_build):
            if isinstance(build.analytic, list) or isinstance(build.geometric, list):
                raise refused("nominal", "a number of each method, or null", "a list")


MOST_ORDER: Final = 16_000


class OutputMeasureSummary(MeasureSummary):
    """A measure of an output; its kind is the mechanism's word, then the quantity's."""

    of: Label
    order: Maybe[Annotated[int, Field(ge=1, le=MOST_ORDER)]] = Field(
        default=LEFT_OUT, description="of a harmonic: cycles a turn of the output"
    )

    @property
    def quantity(self) -> str:
        """Quantity in words: `largest transmission error`."""
        taken = {
            "min": "least ",
            "max": "largest ",
            "range": "range of the ",
            "harmonic": f"order {self.order}, peak to peak, of the ",
        }
        return taken.get(self.take, "") + self.kind.partition("_")[2].replace("_", " ")

    @property
    def position_word(self) -> str:
        return "output"

    @property
    def identity(self) -> tuple[str | None, ...]:
        return self.kind, self.of, None if self.order is None else str(self.order)
