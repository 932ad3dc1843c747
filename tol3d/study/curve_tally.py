"""Statistics of a curve measure, folded block by block."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tol3d.statistics import Grid, LimitCounts, Moments
from tol3d.study.sample import in_unit, lacking_of
from tol3d.study.spectrum_tally import OrderTally, spectrum_tally
from tol3d.study.status_counts import added, status_counts
from tol3d.system.measure import Measure
from tol3d.system.outcome import ANALYTIC, GEOMETRIC, ROADS, Columns, outcome_of, value_column
from tol3d.system.statuses import Statuses


@dataclass(frozen=True)
class CurveTally:
    """A curve measure: moments at each position, for both roads, the trials with any position out of limits, spectra.

    A trial counts at every position, or where one of them did not seat at none.
    """

    status: Mapping[str, int]
    analytic: tuple[Moments, ...]
    geometric: tuple[Moments, ...] | None
    limits: Mapping[str, LimitCounts]
    deepest: float
    spectra: Mapping[str, tuple[OrderTally, ...]]

    @classmethod
    def of(cls, statuses: Statuses, measure: Measure, columns: Columns, grids: Mapping[str, Grid]) -> "CurveTally":
        """Tally of one block of columns; `grids` as grids_of gives them."""
        curves = {
            road: outcome_of(columns, road, measure.name, statuses.lacking)
            for road in ROADS
            if value_column(road, measure.name) in columns
        }
        moments = {
            road: tuple(Moments.of(column[~np.isnan(column)]) for column in own.values.T)
            for road, own in curves.items()
        }
        lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
        limits = {
            road: LimitCounts.of_spans(
                own.values.min(axis=1), own.values.max(axis=1), lower, upper, lacking_of(measure, own)
            )
            for road, own in curves.items()
        }
        return cls(
            status_counts(statuses, columns, measure),
            moments[ANALYTIC],
            moments.get(GEOMETRIC),
            limits,
            min(own.deepest for own in curves.values()),
            {road: spectrum_tally(measure, own.values, grids) for road, own in curves.items()},
        )

    def merge(self, other: "CurveTally") -> "CurveTally":
        """Both tallies as one."""

        def merged(mine: tuple[Moments, ...], its: tuple[Moments, ...]) -> tuple[Moments, ...]:
            return tuple(a.merge(b) for a, b in zip(mine, its, strict=True))

        return CurveTally(
            added(self.status, other.status),
            merged(self.analytic, other.analytic),
            merged(self.geometric, other.geometric) if self.geometric and other.geometric else None,
            {road: counts.merge(other.limits[road]) for road, counts in self.limits.items()},
            min(self.deepest, other.deepest),
            {
                road: tuple(a.merge(b) for a, b in zip(own, other.spectra[road], strict=True))
                for road, own in self.spectra.items()
            },
        )
