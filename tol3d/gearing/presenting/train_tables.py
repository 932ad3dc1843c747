"""The trains of a run as tables: what each stage brings to the lost motion, and the worst case beside the sum."""

from collections.abc import Iterator
from typing import Any

from tol3d.gearing.presenting.stage import (
    SUM_KEYS,
    Stage,
    distributions_of,
    leading_road,
    sense_text,
    shafts_along,
    stages_of,
    sums_of,
    whole_ratio_text,
)
from tol3d.gearing.summary_types import TrainMeasureSummary
from tol3d.report.number import percent_text, tip_mm, value_text
from tol3d.report.page import BLANK, Block, Heading, Row, Table, line, note, title
from tol3d.report.presenter import FurtherRow
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.run import RunSummary

Summary = Any  # typed, read by text

ROAD_WORDS = {"analytic": "analytic (same trials)", "geometric": "3D simulation"}
WORST_CASE_MEANS = "a sum of the stages' highs is a worst case; mean + 3 sigma of the sum is of its distribution"
STAGES_MEAN = "low, mean, high: a stage's own angular backlash at its driven shaft, mean ∓ 3 sigma; by the {road}"
OF_LAWS = "; of a data sheet's law its ends, where they are nearer than 3 sigma"


def train_report(summary: Summary) -> list[Block]:
    """Tables of every train of a run: its stages, then sums of their ends beside the distribution of the sum."""
    return [block for name in summary.get("trains", {}) for block in _train_blocks(name, summary)]


def _train_blocks(name: str, summary: Summary) -> Iterator[Block]:
    train = summary["trains"][name]
    stages = stages_of(train)
    yield title(f"train {name}")
    yield line(train_words(train), "dim")
    if not stages:
        return
    yield from (BLANK, stages_table(train, stages))
    road = "3D simulation" if leading_road(train) == "geometric" else "analytic road"
    yield note(STAGES_MEAN.format(road=road) + (OF_LAWS if any(stage.within_its_law for stage in stages) else ""))
    yield from (BLANK, sums_table(train, summary), note(WORST_CASE_MEANS))


def sum_rows(measure: MeasureSummary, summary: RunSummary) -> list[FurtherRow]:
    """Sums of the stages' ends, where a measure is the sum of a train's stages."""
    sums = sums_of(measure, summary) if isinstance(measure, TrainMeasureSummary) else {}
    return [
        FurtherRow(f"sum of the stages' {word}", {who: values.get(key) for who, values in sums.items()})
        for key, word in SUM_KEYS.items()
        if sums
    ]


def train_words(train: Summary) -> str:
    """The shafts from the held one to the one that is read, and the ratio of the whole train."""
    shafts = shafts_along(stages_of(train), train["held"])
    ratio = train["ratio"]
    turns = "" if ratio is None else f" · i = {whole_ratio_text(ratio)}, {train['driven']} and {train['output']} turn "
    turns += "" if ratio is None else ("opposite" if ratio < 0 else "the same way")
    return f"{' → '.join(shafts)} · {train['held']} held{turns}"


def stages_table(train: Summary, stages: list[Stage]) -> Table:
    """A row a stage, and the whole train below; angles in minutes and seconds of arc."""
    published = list(dict.fromkeys(name for stage in stages for name in stage.published))
    headings = [
        *(Heading(word) for word in ("ratio", "sense", "low", "mean", "high")),
        Heading(f"mean at {train['shaft']}", "bold"),
        Heading("share of variance [%]"),
        *(Heading(f"{name}: high", "green") for name in published),
    ]
    return Table("stage", headings, [Row(stage.link, _cells(stage, published)) for stage in stages])


def _cells(stage: Stage, published: list[str]) -> list[str]:
    highs = [stage.published[name].high if name in stage.published else None for name in published]
    return [
        stage.ratio_text,
        sense_text(stage),
        *(_angle(value) for value in (stage.own.low, stage.own.mean, stage.own.high, stage.at_shaft.mean)),
        percent_text(stage.share),
        *map(_angle, highs),
    ]


def _angle(arcmin: float | None) -> str:
    return value_text(arcmin, "arcmin")


def sums_table(train: Summary, summary: Summary) -> Table:
    """Sums of the stages' ends against the distribution of the sum, a column a road and who published."""
    distributions = distributions_of(train, summary)
    own = {road: train["sums"][road] for road in ROAD_WORDS if road in train["sums"]}
    columns = [*own.items(), *train["sums"].get("published", {}).items()]
    rows = [
        Row(f"sum of the stages' {word}", [_angle(values.get(key)) for _, values in columns])
        for key, word in SUM_KEYS.items()
    ]
    highs = [distributions.get(road, {}).get("high_3sigma") if road in own else None for road, _ in columns]
    rows.append(Row("mean + 3 sigma of the sum", [_angle(high) for high in highs]))
    lever = train["lever_mm"]
    if lever is not None:
        worst = [tip_mm(values.get("high_3sigma"), lever) for _, values in columns]
        rows.append(Row(f"{train['point']}, sum of highs [mm]", [value_text(value, "mm") for value in worst]))
        tips = [value_text(tip_mm(high, lever), "mm") for high in highs]
        rows.append(Row(f"{train['point']}, mean + 3 sigma [mm]", tips))
    styles = {"geometric": "bold", "analytic": ""}
    headings = [Heading(ROAD_WORDS.get(road, road), styles.get(road, "green")) for road, _ in columns]
    return Table(f"at {train['shaft']}", headings, rows)
