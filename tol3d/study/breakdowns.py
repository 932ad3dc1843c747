"""The terms of measures that are sums, pooled block by block."""

from collections.abc import Mapping, Sequence

from tol3d.system.breakdown import Breakdown
from tol3d.system.outcome import ROADS, Columns, outcome_of, value_column
from tol3d.system.pooled import PooledTerms
from tol3d.system.statuses import Statuses

Pooled = Mapping[str, Mapping[str, PooledTerms]]
"""By measure and road."""


def pooled_terms(breakdowns: Sequence[Breakdown], statuses: Statuses, columns: Columns) -> Pooled:
    """The terms of every breakdown, of one block."""
    found: dict[str, dict[str, PooledTerms]] = {}
    for breakdown in breakdowns:
        roads = found.setdefault(breakdown.measure, {})
        for road in ROADS:
            if value_column(road, breakdown.measure) in columns:
                whole = outcome_of(columns, road, breakdown.measure, statuses.lacking)
                if pooled := PooledTerms.of(breakdown, road, columns, whole):
                    roads[road] = pooled
    return found


def merged_terms(mine: Pooled, its: Pooled) -> Pooled:
    """Both blocks as one."""
    return {name: {road: own.merge(its[name][road]) for road, own in roads.items()} for name, roads in mine.items()}
