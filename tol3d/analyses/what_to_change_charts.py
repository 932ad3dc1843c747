"""Charts of what to change: each measure in its limits as it is, and after each change."""

from typing import Final

import numpy as np

from tol3d.analyses.what_to_change import Changes, MeasureChanges, Spread
from tol3d.analyses.what_to_change_table import proposal_text
from tol3d.report.chart import Axis, Chart, Charts, Mark, Names, Panel, Range, Role
from tol3d.report.measure_charts import spanned
from tol3d.report.number import limit_text, share_text

WIDTH: Final = 10.0  # inch
MOST: Final = 6
"""Measures that are drawn."""
NOTHING: Final = "no limit is left more often than is accepted"


def changes_charts(name: str, found: Changes) -> Charts:
    """Mean ± 3 sigma of each change."""
    charts = [changes_chart(measure, own) for measure, own in list(found.measures.items())[:MOST]]
    rows = [[own] for own in charts] or [[Chart(NOTHING, Axis("", 0.0, 1.0), (), instead=NOTHING)]]
    return Charts(rows, f"{name} · what to change", WIDTH)


def changes_chart(name: str, own: MeasureChanges) -> Chart:
    """A row for each change of a measure with mean ± 3 sigma and the fraction out of limits."""
    changes = changes_of_one(own)
    rows = [
        Range(row, mean - 3 * sigma, mean + 3 * sigma, mean, role, words, share_text(after.out_ppm))
        for row, (words, after, role) in enumerate(changes)
        if (mean := after.mean) is not None and (sigma := after.sigma) is not None
    ]
    limits = [(word, end) for word, end in (("LSL", own.lower_limit), ("USL", own.upper_limit)) if end is not None]
    marks = [Mark(limit, "limit", label=f"{word} {limit_text(limit, own.unit)}") for word, limit in limits]
    ends = [end for row in rows for end in (row.low, row.high) if end is not None]
    across = spanned(name, np.array([*ends, *(limit for _, limit in limits)]), own.unit)
    panel = Panel(Names([words for words, _, _ in changes]), rows, marks)
    table = [(words, f"{share_text(after.out_ppm)} out of limits") for words, after, _ in changes]
    return Chart(f"{name} after each change", across, [panel], name, "mean ± 3 sigma; out of limits", table)


def changes_of_one(own: MeasureChanges) -> list[tuple[str, Spread, Role]]:
    """Every change of a measure in words, what it makes of it, and its role."""
    found: list[tuple[str, Spread, Role]] = [("as it is", own.now, "plain")]
    for each in own.proposals:
        moves = any(step.change is not None for step in each.steps)
        role: Role = "series-0" if len(each.steps) > 1 else "series-2" if moves else "series-1"
        found.append((proposal_text(each), each.after, role))
    return found
