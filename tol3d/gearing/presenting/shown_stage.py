"""The stages of a train from a run's summary, with the contribution of each to the lost motion at a shaft."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Self

from tol3d.gearing.summary.types import Ends, StageSummary, TrainMeasureSummary, TrainsOfRun, TrainSummary
from tol3d.report.column import columns_of
from tol3d.report.number import NOTHING, tip_arcmin, tip_mm
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.values import Method, Section

MANY_TURNS = 1e6  # no decimals from there on
ROUNDING = 1e-6  # sigma
SUMMED_KINDS = frozenset(("lost_motion", "tip_displacement"))


@dataclass(frozen=True)
class Range:
    """An angular backlash or a lost motion [arcmin]: mean -+ 3 sigma and mean; None if unknown."""

    low: float | None
    mean: float | None
    high: float | None

    @classmethod
    def of(cls, values: Section | None) -> Self:
        """From a summary's low_3sigma, mean and high_3sigma."""
        if values is None:
            return cls(None, None, None)
        return cls(values.value("low_3sigma"), values.value("mean"), values.value("high_3sigma"))

    def times(self, factor: float) -> "Range":
        """The range downstream of a ratio."""
        return self.each(lambda value: value * factor)

    def each(self, of: Callable[[float], float | None]) -> "Range":
        """The range of another quantity, value by value."""
        return Range(*(None if v is None else of(v) for v in (self.low, self.mean, self.high)))

    @property
    def by_word(self) -> Mapping[str, float | None]:
        """Sums over stages, by word in the plural."""
        return {"lows": self.low, "means": self.mean, "highs": self.high}

    @property
    def known(self) -> bool:
        """True if there is any value."""
        return (self.low, self.mean, self.high) != (None, None, None)


@dataclass(frozen=True)
class ShownStage:
    """A stage of a train as shown: its link, and its contribution at the shaft that is read.

    Args:
        number: its place in the train, from 1 on.
        link: the move's name.
        kind: what it is.
        driver, driven: its shafts.
        teeth: of the driver and the driven; None where it is no mesh.
        ratio: turns of the driver per turn of the driven, negative where they turn opposite.
        working_flank: "left" or "right"; None where it is no mesh.
        factor: turn of the shaft that is read per turn of the driven shaft, without its sign.
        own: angular backlash at the driven shaft.
        at_shaft: contribution to the lost motion of the shaft that is read.
        share: of the variance there [%].
        published: published angular backlash at the driven shaft, by source.
        within_its_law: whether an end of `own` is that of a data sheet's law, nearer than 3 sigma.
    """

    number: int
    link: str
    kind: str
    driver: str
    driven: str
    teeth: tuple[int, int] | None
    ratio: float
    working_flank: str | None
    factor: float
    own: Range
    at_shaft: Range
    share: float | None
    published: Mapping[str, Range]
    within_its_law: bool = False

    @property
    def opposite(self) -> bool:
        """True if its shafts turn in opposite senses."""
        return self.ratio < 0

    @property
    def ratio_text(self) -> str:
        """Its ratio without its sign, by the teeth where there are any: `110/28 = 3.929`, `i = 152`."""
        value = f"{abs(self.ratio):.4g}"
        return f"{self.teeth[1]}/{self.teeth[0]} = {value}" if self.teeth else f"i = {value}"


def trains_of(summary: RunSummary) -> Mapping[str, TrainSummary]:
    """The trains of a run by name; older runs have none."""
    return (summary.trains or {}) if isinstance(summary, TrainsOfRun) else {}


def leading_method(train: TrainSummary) -> Method:
    """The method by which a train is shown: the 3D simulation where there is one."""
    return "geometric" if all(stage.methods.geometric is not None for stage in train.stages) else "analytic"


def leading_sums(train: TrainSummary) -> Range:
    """Sums of the stages' ends by that method."""
    return Range.of(train.sums.geometric if leading_method(train) == "geometric" else train.sums.analytic)


def stages_of(train: TrainSummary) -> list[ShownStage]:
    """The stages of a train's summary, from the held shaft on, by the leading method."""
    method = leading_method(train)
    return [_stage(number, stage, stage.methods.by(method)) for number, stage in enumerate(train.stages, 1)]


def _stage(number: int, stage: StageSummary, values: Ends) -> ShownStage:
    own, factor = Range.of(values), abs(stage.factor)
    return ShownStage(
        number=number,
        link=stage.link,
        kind=stage.kind,
        driver=stage.driver,
        driven=stage.driven,
        teeth=(stage.teeth[0], stage.teeth[1]) if stage.teeth else None,
        ratio=stage.ratio,
        working_flank=stage.working_flank,
        factor=factor,
        own=own,
        at_shaft=own.times(factor),
        share=values.share_percent,
        published={name: Range.of(ends) for name, ends in stage.published.items()},
        within_its_law=stage.gears is None and stage.ways is None and _nearer_than_3_sigma(own, values.sigma),
    )


def _nearer_than_3_sigma(own: Range, sigma: float | None) -> bool:
    """True if an end lies nearer to the mean than 3 sigma, by more than rounding.

    >>> _nearer_than_3_sigma(Range(2.0, 5.0, 9.0), 1.5), _nearer_than_3_sigma(Range(0.5, 5.0, 9.5), 1.5)
    (True, False)
    """
    if sigma is None or own.low is None or own.mean is None or own.high is None:
        return False
    return min(own.mean - own.low, own.high - own.mean) < (3 - ROUNDING) * sigma


def shafts_along(stages: Sequence[ShownStage], held: str) -> list[str]:
    """The shafts from the held one to the one that is read; a link may be gone through from its driven side."""
    shafts = [held]
    for stage in stages:
        shafts.append(stage.driver if shafts[-1] == stage.driven else stage.driven)
    return shafts


def sums_of(measure: MeasureSummary, summary: RunSummary) -> Mapping[str, Range]:
    """Sums of the stages' lows, means and highs in the unit of a measure, by method and by published source.

    Empty for a measure that is no such sum, or is read at another shaft, point or position than the train's stages are.
    """
    if not isinstance(measure, TrainMeasureSummary) or measure.kind not in SUMMED_KINDS or measure.take == "curve":
        return {}
    train = trains_of(summary).get(measure.of)
    if train is None or measure.over != "random" or (measure.shaft, measure.held) != (train.shaft, train.held):
        return {}
    sums = {name: Range.of(ends) for name, ends in ends_by_column(train).items()}
    if measure.kind == "lost_motion":
        return sums
    lever = _lever_of(measure, train)
    if lever is None:
        return {}
    return {name: own.each(lambda value: tip_mm(value, lever)) for name, own in sums.items()}


def ends_by_column(train: TrainSummary) -> dict[str, Ends]:
    """Sums of the stages' ends by method, and by published source."""
    own: dict[str, Ends] = {"analytic": train.sums.analytic}
    if train.sums.geometric is not None:
        own["geometric"] = train.sums.geometric
    return own | dict(train.sums.published)


def _lever_of(measure: TrainMeasureSummary, train: TrainSummary) -> float | None:
    """The lever of a measure's point [mm]: its own, or the train's where that is of the same point."""
    if measure.lever_mm is None and f"{measure.point} of {measure.arm}" == train.point:
        return train.lever_mm
    return measure.lever_mm


def distributions_of(train: TrainSummary, summary: RunSummary) -> dict[str, Range]:
    """The sum of the train's stages in lost motion, by method and by published source: ends and mean [arcmin].

    Of a train whose stages are those of a tip's displacement it is the turn that displaces the tip so far.
    """
    measure = summary.measures.get(train.measure)
    if not isinstance(measure, TrainMeasureSummary):
        return {}
    columns = {
        column.heading if column.method == "published" else column.method: Range.of(column.values)
        for column in columns_of(measure)
    }
    if measure.unit == "arcmin":
        return columns
    lever = _lever_of(measure, train)
    return {name: own.each(lambda value: tip_arcmin(value, lever)) for name, own in columns.items()}


def whole_ratio_text(ratio: float) -> str:
    """The ratio of a whole train without its sign.

    >>> whole_ratio_text(597.142857), whole_ratio_text(-35075712.4)
    ('597.143', '35075712')
    """
    return f"{abs(ratio):.6g}" if abs(ratio) < MANY_TURNS else f"{abs(ratio):.0f}"


def sense_text(stage: ShownStage) -> str:
    """Relative sense of rotation of a stage's shafts."""
    return "opposite" if stage.opposite else "same"


def share_text(share: float | None) -> str:
    """A share of the variance [%] in a sentence.

    >>> share_text(96.04), share_text(0.3), share_text(0.00002)
    ('96 %', '0.3 %', '0 %')
    """
    if share is None:
        return NOTHING
    return f"{share:.0f} %" if share >= 9.95 or share < 0.05 else f"{share:.1f} %"
