"""Methods side by side as charts: the intervals by method over each measure's limits."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from tol3d.analyses.methods_section import MeasureMethods, Methods
from tol3d.analyses.methods_table import intervals_of
from tol3d.report.chart import Chart, Charts, Mark, Names, Panel, Range, Role
from tol3d.report.measure_charts import spanned
from tol3d.report.number import limit_text, short_text

MOST: Final = 12
"""Measures in one picture."""
COLUMNS: Final = 2
WIDTH: Final = 7.2  # inch, of a chart
ROLES: Final[Mapping[str, Role]] = {
    "worst found": "plain",
    "worst by slopes": "soft",
    "modified RSS": "series-1",
    "RSS": "series-4",
    "simulation, ±3 sigma": "series-0",
    "simulation, 0.135 % and 99.865 %": "series-2",
    "least and largest trial": "soft",
}


def methods_charts(found: Methods) -> Charts:
    """The measures that use most of their limits, MOST at most."""
    most = sorted(found.measures, key=lambda name: -_used(found.measures[name]))[:MOST]
    charts = [methods_chart(name, own) for name, own in found.measures.items() if name in most]
    rows = [charts[k : k + COLUMNS] for k in range(0, len(charts), COLUMNS)]
    return Charts(rows, found.scene, WIDTH * len(rows[0]))


def methods_chart(name: str, own: MeasureMethods) -> Chart:
    """A row for each method with its interval; dotted the mean build."""
    intervals = [*intervals_of(own)]
    rows = [
        Range(row, low, high, None, ROLES.get(words, "series-3"), words)
        for row, (words, low, high) in enumerate(intervals)
    ]
    limits = [(word, end) for word, end in (("LSL", own.lower_limit), ("USL", own.upper_limit)) if end is not None]
    marks = [Mark(limit, "limit", label=f"{word} {limit_text(limit, own.unit)}") for word, limit in limits]
    marks += [Mark(own.mean, "guide", label="mean build")] if own.mean is not None else []
    ends = [end for _, low, high in intervals for end in (low, high) if end is not None]
    across = spanned(name, np.array([*ends, *(mark.value for mark in marks)]), own.unit)
    table = [
        (words, f"{short_text(low, own.unit)} to {short_text(high, own.unit)}")
        for words, low, high in intervals
        if low is not None and high is not None
    ]
    panel = Panel(Names([words for words, _, _ in intervals]), rows, marks)
    said = "" if limits else "no limits"
    return Chart(f"{name} by methods", across, [panel], name, said, table)


def _used(own: MeasureMethods) -> float:
    """3 sigma of the simulation over the distance to the nearest limit; 0 without limits."""
    low, high, mean = own.simulation.low_3sigma, own.simulation.high_3sigma, own.simulation.mean
    if low is None or high is None or mean is None:
        return 0.0
    half = (high - low) / 2
    margins = [] if own.lower_limit is None else [mean - own.lower_limit]
    margins += [] if own.upper_limit is None else [own.upper_limit - mean]
    return max((half / margin if margin > 0.0 else float("inf") for margin in margins), default=0.0)
