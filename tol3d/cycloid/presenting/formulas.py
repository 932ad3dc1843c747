"""Cycloid stages by formula as tables: the published formula (reconstructed) and first principles."""

from collections.abc import Mapping, Sequence
from typing import Final

from tol3d.cycloid.summary_types import CycloidOfRun, CycloidStageSummary
from tol3d.gearing.summary.types import TrainsOfRun
from tol3d.report.page import Heading, PageItem, Row, Shown, Table, note, titled
from tol3d.runs.summary.run import RunSummary

PAPER: Final = "paper (reconstructed) [″]"
FIRST_PRINCIPLES: Final = "first principles [″]"
IN_A_TRAIN: Final = "rv_reducer"
TERM_HEADS: Final = ("tolerance [µm]", PAPER, FIRST_PRINCIPLES, "per µm [″]")
NEGATIVE: Final = (
    "negative where pins press on both sides of their lobes at once: of rigid parts the turn by which lobes and pins "
    "would have to give way, a preload and no play"
)
WHAT: Final = (
    "±3σ; first principles: a disc's turn while its best pin alone touches, through lobes times eccentricity; what "
    "the smallest of all working pins makes of it is in the simulation"
)


def link_sections(summary: RunSummary) -> Sequence[PageItem]:
    """Tables of each stage of a run, and a note to reducers of trains whose mean play is negative."""
    stages = (summary.cycloid_stages or {}) if isinstance(summary, CycloidOfRun) else {}
    trains = (summary.trains or {}).values() if isinstance(summary, TrainsOfRun) else ()
    tight = {
        stage.link
        for train in trains
        for stage in train.stages
        if stage.kind == IN_A_TRAIN
        for method in (stage.methods.analytic, stage.methods.geometric)
        if method is not None and method.mean is not None and method.mean < 0.0
    }
    notes = [note(f"{', '.join(sorted(tight))}: {NEGATIVE}; it is added to the play of other stages as it is")]
    return [*(notes if tight else ()), *stage_blocks(stages)]


def below_zero(summary: RunSummary) -> Sequence[PageItem]:
    """A note to lost motions whose mean is negative."""
    means = {
        name: [each.mean for each in (own.analytic, own.geometric) if each is not None and each.mean is not None]
        for name, own in summary.measures.items()
        if own.kind == "cycloid_lost_motion"
    }
    names = [name for name, own in means.items() if own and min(own) < 0.0]
    return [note(f"{', '.join(names)}: {NEGATIVE}")] if names else []


def stage_blocks(stages: Mapping[str, CycloidStageSummary]) -> Sequence[PageItem]:
    """The same of stages by their names: contributions, then totals."""
    return [block for name, own in stages.items() for block in _blocks(name, own)]


def _blocks(name: str, own: CycloidStageSummary) -> Sequence[PageItem]:
    rows = [
        Row(
            source,
            [
                Shown(f"{each.tolerance_um:.4g}", each.tolerance_um),
                _seconds(each.by_formula_arcsec, 2),
                _seconds(each.first_principles_arcsec, 2),
                _seconds(each.arcsec_per_um, 4),
            ],
        )
        for source, each in own.sources.items()
    ]
    terms = Table("source", [Heading(head) for head in TERM_HEADS], rows)
    totals = Table("output", [Heading(PAPER), Heading(FIRST_PRINCIPLES)], _totals(own))
    return [
        *titled(f"{name}: transmission error by formula", terms),
        note(WHAT),
        *titled(f"{name}: by formula, added up", totals),
        *map(note, _notes(own)),
    ]


def _totals(own: CycloidStageSummary) -> list[Row]:
    paper, ours = own.by_formula, own.first_principles
    lines: list[tuple[str, float | None, float]] = [
        ("cycloid stage, ±3σ", paper.cycloid_arcsec, ours.cycloid_arcsec),
        ("  99.73 % half-range of its law", paper.cycloid_half_range_arcsec, ours.cycloid_arcsec),
        ("carrier, ±3σ", paper.carrier_arcsec, ours.carrier_arcsec),
        ("both added, as published", paper.added_arcsec, ours.added_arcsec),
        ("both, root sum square", paper.root_sum_square_arcsec, ours.root_sum_square_arcsec),
    ]
    if own.sun_held is not None:
        lines.append((f"  times {own.sun_held:.5f}, sun held", None, own.sun_held * ours.root_sum_square_arcsec))
    return [Row(label, [_seconds(theirs, 3), _seconds(first, 3)]) for label, theirs, first in lines]


def _notes(own: CycloidStageSummary) -> list[str]:
    law = (
        "the paper's pin circle is a normal length times the sine of a random phase, which is not normal: ±3σ covers "
        f"{own.by_formula.cycloid_coverage_percent:.2f} % of the cycloid stage"
    )
    return [law, *([f"not in the formula: {', '.join(own.left_out)}"] if own.left_out else [])]


def _seconds(value: float | None, digits: int) -> str:
    return "" if value is None else Shown(f"{value:.{digits}f}", value)
