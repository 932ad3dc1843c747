"""Charts of what other tolerances do: each measure before and after, with its limits."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from tol3d.analyses.before_after import MeasureWhatIf, WhatIf
from tol3d.analyses.what_if_table import bounded_text
from tol3d.report.chart import Axis, Chart, Charts, Mark, Outline, Panel, Role
from tol3d.report.measure_charts import spanned
from tol3d.report.number import limit_text

MOST: Final = 8
"""Measures that are drawn."""


def what_if_charts(name: str, found: WhatIf) -> Charts:
    """The distributions before and after."""
    words = "; ".join(f"{own.contributor}: {own.before} → {own.after}" for own in found.changes)
    shown = list(found.measures.items())[:MOST]
    rows = [[what_if_chart(measure, own, found.trials)] for measure, own in shown]
    return Charts(rows, f"{name} · what if {words}")


def what_if_chart(name: str, own: MeasureWhatIf, trials: int) -> Chart:
    """Outlines of a measure's histograms before and after."""
    edges, series, table = np.array(own.edges, dtype=np.float64), [], []
    roles: dict[str, Role] = {"before": "series-0", "after": "series-1"}
    for (word, role), state in zip(roles.items(), (own.before, own.after), strict=True):
        ppm = ", ".join(f"{bounded_text(limit)} {side}" for side, limit in state.limits.items())
        percent = 100.0 * np.array(state.counts) / max(trials, 1)
        series.append(Outline(edges, percent, role, f"{word}{': ' if ppm else ''}{ppm}"))
        table.append((word, ppm))
    y = Axis("% of trials", 0.0, 1.05 * max(float(each.heights.max()) for each in series) or 1.0)
    marks = [*_limits(own)]
    across = spanned(name, np.array([edges[0], edges[-1], *(mark.value for mark in marks)]), own.unit)
    return Chart(f"{name} before and after", across, [Panel(y, series, marks, 0.7)], name, table=table)


def _limits(own: MeasureWhatIf) -> Iterator[Mark]:
    for word, limit in (("LSL", own.lower_limit), ("USL", own.upper_limit)):
        if limit is not None:
            yield Mark(limit, "limit", (f"{word} {limit_text(limit, own.unit)}",), upper=word == "USL")
