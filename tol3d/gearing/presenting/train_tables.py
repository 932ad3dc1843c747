"""The trains of a run as tables: contribution of each stage to the lost motion, and the sum of the stages."""

from collections.abc import Iterator
from dataclasses import dataclass

from tol3d.gearing.presenting.shown_stage import (
    Range,
    ShownStage,
    distributions_of,
    ends_by_column,
    leading_method,
    sense_text,
    shafts_along,
    stages_of,
    sums_of,
    trains_of,
    whole_ratio_text,
)
from tol3d.gearing.summary.types import TrainSummary
from tol3d.report.column import heading_by
from tol3d.report.declared import declared_table
from tol3d.report.number import tip_mm, value_cell
from tol3d.report.page import BLANK, PageItem, Row, Shown, Table, line, note, title
from tol3d.report.presenter import FurtherRow
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.shows import Computed, Shows

METHOD_WORDS = {"analytic": "analytic (same trials)", "geometric": "3D simulation"}
SUMS_MEAN = (
    "a sum of the stages' highs has every stage at its mean + 3 sigma at once; it is no worst case: a build with every "
    "deviation at its limit may exceed it. Mean + 3 sigma of the sum is of its distribution"
)
STAGES_MEAN = "low, mean, high: a stage's own angular backlash at its driven shaft, mean ∓ 3 sigma; by the {method}"
OF_LAWS = "; of a data sheet's law its ends, where they are nearer than 3 sigma"


def train_report(summary: RunSummary) -> list[PageItem]:
    """Tables of every train of a run: its stages, then sums of their ends beside the distribution of the sum."""
    return [block for name in trains_of(summary) for block in _train_blocks(name, summary)]


def _train_blocks(name: str, summary: RunSummary) -> Iterator[PageItem]:
    train = trains_of(summary)[name]
    stages = stages_of(train)
    yield title(f"train {name}")
    yield line(train_words(train), "dim")
    if not stages:
        return
    yield from (BLANK, stages_table(train, stages))
    method = "3D simulation" if leading_method(train) == "geometric" else "analytic method"
    yield note(STAGES_MEAN.format(method=method) + (OF_LAWS if any(stage.within_its_law for stage in stages) else ""))
    yield from (BLANK, sums_table(train, summary), note(SUMS_MEAN))


def sum_rows(measure: MeasureSummary, summary: RunSummary) -> list[FurtherRow]:
    """Sums of the stages' ends, where a measure is the sum of a train's stages."""
    sums = {who: own.by_word for who, own in sums_of(measure, summary).items()}
    words = next(iter(sums.values()), {})
    return [FurtherRow(f"sum of the stages' {word}", {who: own[word] for who, own in sums.items()}) for word in words]


def train_words(train: TrainSummary) -> str:
    """The shafts from the held one to the one that is read, and the ratio of the whole train."""
    shafts = shafts_along(stages_of(train), train.held)
    turns = f" · i = {whole_ratio_text(train.ratio)}, {train.driven} and {train.output} turn "
    turns += "opposite" if train.ratio < 0 else "the same way"
    return f"{' → '.join(shafts)} · {train.held} held{turns}"


@dataclass(frozen=True)
class StageRow:
    """A stage of a train whose lost motion is read at a shaft; angles [arcmin]."""

    of: ShownStage
    shaft: str

    ratio = Computed(Shows("ratio", plain=True), lambda own: own.of.ratio_text)
    sense = Computed(Shows("sense"), lambda own: sense_text(own.of))
    low = Computed(Shows("low", "arcmin"), lambda own: own.of.own.low)
    mean = Computed(Shows("mean", "arcmin"), lambda own: own.of.own.mean)
    high = Computed(Shows("high", "arcmin"), lambda own: own.of.own.high)
    at_shaft = Computed(Shows("mean at {key}", "arcmin", decides=True), lambda own: {own.shaft: own.of.at_shaft.mean})
    share = Computed(Shows("share of variance [%]", ".1f", plain=True), lambda own: own.of.share)
    published = Computed(
        Shows("{key}: high", "arcmin", given=True),
        lambda own: {name: each.high for name, each in own.of.published.items()},
    )


def stages_table(train: TrainSummary, stages: list[ShownStage]) -> Table:
    """One row per stage, and the whole train below; angles in minutes and seconds of arc."""
    return declared_table(
        "stage", [(Row(stage.link, (), unit="arcmin"), StageRow(stage, train.shaft)) for stage in stages]
    )


def _angle(arcmin: float | None) -> Shown:
    return value_cell(arcmin, "arcmin")


def sums_table(train: TrainSummary, summary: RunSummary) -> Table:
    """Sums of the stages' ends against the distribution of the sum, one column per method and published source."""
    distributions = distributions_of(train, summary)
    columns = {name: Range.of(ends) for name, ends in ends_by_column(train).items()}
    columns = {name: columns[name] for name in (*METHOD_WORDS, *columns) if name in columns}
    rows = [
        Row(f"sum of the stages' {word}", [_angle(column.by_word[word]) for column in columns.values()], unit="arcmin")
        for word in Range(None, None, None).by_word
    ]
    highs = [distributions[name].high if name in METHOD_WORDS and name in distributions else None for name in columns]
    rows.append(Row("mean + 3 sigma of the sum", [_angle(high) for high in highs], unit="arcmin"))
    lever = train.lever_mm
    if lever is not None:
        worst = [tip_mm(column.high, lever) for column in columns.values()]
        rows.append(Row(f"{train.point}, sum of highs [mm]", [value_cell(value, "mm") for value in worst], unit="mm"))
        tips = [value_cell(tip_mm(high, lever), "mm") for high in highs]
        rows.append(Row(f"{train.point}, mean + 3 sigma [mm]", tips, unit="mm"))
    headings = [heading_by(name, METHOD_WORDS.get(name, name)) for name in columns]
    return Table(f"at {train.shaft}", headings, rows)
