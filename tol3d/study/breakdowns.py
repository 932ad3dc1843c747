"""The terms of measures that are sums, pooled block by block."""

from collections.abc import Mapping, Sequence

from tol3d.system.breakdown import Breakdown
from tol3d.system.outcome import METHODS, Columns, outcome_of, value_column
from tol3d.system.pooled import PooledTerms
from tol3d.system.statuses import Statuses

Pooled = Mapping[str, Mapping[str, PooledTerms]]
"""Pooled terms by measure and method."""


def pooled_terms(breakdowns: Sequence[Breakdown], statuses: Statuses, columns: Columns) -> Pooled:
    """The terms of every breakdown, of one block."""
    found: dict[str, dict[str, PooledTerms]] = {}
    for breakdown in breakdowns:
        methods = found.setdefault(breakdown.measure, {})
        for method in METHODS:
            if value_column(method, breakdown.measure) in columns:
                whole = outcome_of(columns, method, breakdown.measure, statuses.lacking)
                if pooled := PooledTerms.of(breakdown, method, columns, whole):
                    methods[method] = pooled
    return found


def merged_terms(mine: Pooled, its: Pooled) -> Pooled:
    """Both blocks as one."""
    return {name: {key: own.merge(its[name][key]) for key, own in methods.items()} for name, methods in mine.items()}
