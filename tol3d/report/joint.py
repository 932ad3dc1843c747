"""Joint results of a run's measures: their common yield in a line, and a table of the largest correlations."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Annotated, Final

from tol3d.report.declared import declared_table
from tol3d.report.number import NOTHING, unsigned_zero
from tol3d.report.page import Line, PageItem, Row, Shown, Table, note, title
from tol3d.study.runs.summary.run import Correlations, Joint, RunSummary
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import Method

MOST_PAIRS: Final = 12  # correlations that are printed, the largest; all are in correlations.csv
NORMAL_95: Final = 1.959964  # sigma; a normal's 95 % lie within
FISHER_FREEDOM: Final = 3  # trials used up by Fisher's artanh r
YIELD_DECIMALS: Final = 2  # of a yield in %, more where less than a hundredth is lost
HEADINGS: Final[Mapping[Method, str]] = {"analytic": "analytic", "geometric": "3D simulation"}
Pair = tuple[int, int]


def joint_of(run: RunSummary) -> Joint | None:
    """Joint results to show; None if fewer than two measures have limits, or for an older run."""
    return run.joint if run.joint and len(run.joint.limited) > 1 else None


def yield_lines(run: RunSummary) -> list[PageItem]:
    """The share of all trials that are within every limit, by the best method, and by the other one beside it."""
    joint = joint_of(run)
    if joint is None or not joint.yields:
        return []
    own, analytic = joint.yields[run.best_method], joint.yields["analytic"]
    text = f"yield: {yield_text(own.yield_ppm)} of all trials are within all limits"
    if own.yield_ppm_95:
        low, high = map(yield_text, own.yield_ppm_95)
        text += f" ({low} to {high}, 95 % confidence)"
    text += f"; analytic {yield_text(analytic.yield_ppm)}" if run.best_method != "analytic" else ""
    others = {name: column.get("joint") for name, column in (run.published or {}).items()}
    known = {name: its["yields"].value("yield_ppm") for name, its in others.items() if its and "yields" in its}
    text += "".join(f"; {name} {yield_text(ppm)}" for name, ppm in known.items() if ppm is not None)
    return [Line(((text, "bold"),), note=True)]


def yield_text(ppm: float | None) -> str:
    """A yield in %, with at least two digits of the loss.

    >>> yield_text(983000.0), yield_text(999_971.0), yield_text(1e6), yield_text(0.0), yield_text(None)
    ('98.30 %', '99.9971 %', '100 %', '0 %', '–')
    """
    if ppm is None:
        return NOTHING
    lost = 100 - ppm / 1e4
    if not 0.0 < ppm < 1e6:
        return f"{100 - lost:.0f} %"
    return f"{100 - lost:.{max(YIELD_DECIMALS, 1 - math.floor(math.log10(lost)))}f} %"


def correlation_blocks(run: RunSummary) -> list[PageItem]:
    """The largest correlations of measures, of those that are more than noise; nothing where none is."""
    joint = joint_of(run)
    if joint is None or not joint.correlations:
        return []
    own = joint.correlations[run.best_method]
    beyond = sorted(_beyond_noise(own), key=lambda pair: -abs(own.r[pair[0]][pair[1]] or 0.0))
    if not beyond:
        return []
    shown = f" · the largest {MOST_PAIRS} of {len(beyond)}" if len(beyond) > MOST_PAIRS else ""
    if joint.correlated_of:
        shown = f" · the largest of {joint.correlated_of} measures"
    words = (
        "Pearson's r over the trials in which both have a value, where it is larger than 95 % of as many independent "
        "trials give without any correlation; all in correlations.csv"
    )
    return [title("correlation of measures", shown), _table(joint, run.best_method, beyond[:MOST_PAIRS]), note(words)]


def _beyond_noise(correlations: Correlations) -> Iterator[Pair]:
    """The pairs of measures whose correlation is more than noise."""
    for i, j in combinations(range(len(correlations.r)), 2):
        r, count = correlations.r[i][j], correlations.trials[i][j]
        if r is not None and abs(r) > _noise(count):
            yield i, j


def _noise(count: int) -> float:
    """|r| that 95 % of so many independent trials stay below without any correlation; 1 of three or less."""
    return math.tanh(NORMAL_95 / math.sqrt(count - FISHER_FREEDOM)) if count > FISHER_FREEDOM else 1.0


@dataclass(frozen=True)
class CorrelationRow:
    """Correlation of two measures: by the best method, its interval if known, and by the other method."""

    r: Annotated[Mapping[str, float | None], Shows("{key}", ".3f", decides=True)]
    interval: Annotated[str | None, Shows("95 % interval", seldom=True)]
    trials: Annotated[int, Shows("trials", "d")]
    other: Annotated[Mapping[str, float | None], Shows("{key}", ".3f")]


def _table(joint: Joint, best: Method, pairs: list[Pair]) -> Table:
    methods = joint.correlations or {}
    own = methods[best]
    low, high = own.r_low_95, own.r_high_95
    rows = []
    for i, j in pairs:
        interval = f"{_r_text(low[i][j])} to {_r_text(high[i][j])}" if low and high else None
        other = {} if best == "analytic" else {HEADINGS["analytic"]: methods["analytic"].r[i][j]}
        row = CorrelationRow({HEADINGS[best]: own.r[i][j]}, interval, own.trials[i][j], other)
        rows.append((f"{joint.correlated[i]} · {joint.correlated[j]}", row))
    return replace(declared_table("measures", rows), repeated=1)


def _r_text(r: float | None) -> str:
    return NOTHING if r is None else unsigned_zero(f"{r:.3f}")


@dataclass(frozen=True)
class YieldRow:
    """The share of trials within all limits by a method, and its 95 % interval [%]."""

    method: Annotated[str, Shows("method", "words")]
    trials: Annotated[int, Shows("trials", "d", plain=True)]
    share: Annotated[Shown, Shows("yield")]
    low: Annotated[Shown, Shows("from")]
    high: Annotated[Shown, Shows("to")]
    measures: Annotated[int, Shows("measures with limits", "d", plain=True)]


def joint_comparison(runs: Sequence[tuple[str, RunSummary]]) -> list[PageItem]:
    """The yields of several runs below each other, each with its label; nothing where no run has any to show."""
    rows = []
    for label, run in runs:
        joint = joint_of(run)
        for index, (method, own) in enumerate(((joint.yields if joint else None) or {}).items()):
            share, low, high = map(_yield_cell, (own.yield_ppm, *(own.yield_ppm_95 or (None, None))))
            row = YieldRow(HEADINGS[method], own.trials, share, low, high, len(joint.limited) if joint else 0)
            rows.append((Row("" if index else label, (), unit="%"), row))
    if not rows:
        return []
    words = "yield: share of all trials within the limits of all measures that have any; from, to: 95 % confidence"
    return [title("all limits together"), replace(declared_table("run", rows), repeated=1), note(words)]


def _yield_cell(ppm: float | None) -> Shown:
    return Shown(yield_text(ppm), None if ppm is None else ppm / 1e4)
