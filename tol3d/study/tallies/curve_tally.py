"""Statistics of a curve measure, folded block by block."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import Grid, LimitCounts, Moments
from tol3d.study.runs.summary.sample import SpectrumSample
from tol3d.study.runs.summary.values import made
from tol3d.study.system.measure import Measure
from tol3d.study.system.outcome import (
    ANALYTIC,
    GEOMETRIC,
    METHODS,
    Columns,
    Outcome,
    Statuses,
    outcome_of,
    reason_column,
    status_column,
    value_column,
)
from tol3d.study.system.spectrum import Spectrum
from tol3d.study.tallies.performance import Judged, Performance, Side
from tol3d.study.tallies.replicated import Rows, interval_of_replicates, limits_by_replicate, merged_by_replicate
from tol3d.study.tallies.sample import QUANTILES, Sample, finite, in_unit, lacking_of, quantile
from tol3d.study.trials.study import PpkBy

BINS = 2**12  # 32 KB of counts; there may be some hundred orders, and of 24 sigma one bin is 0.006 sigma


def grid_name(measure: str, index: int) -> str:
    """Name of the grid of an order of a measure, by the order's place."""
    return f"{measure}:order {index}"


def amplitudes_of(measure: Measure, spectrum: Spectrum, curves: Array) -> Array:
    """Amplitudes (trials that were assembled, orders) of curves (trials, positions), both in the measure's unit."""
    return spectrum.amplitudes(measure.positions, curves[~np.isnan(curves).any(axis=1)])


@dataclass(frozen=True)
class OrderTally:
    """One method's amplitudes of one order."""

    moments: Moments
    grid: Grid

    def merge(self, other: "OrderTally") -> "OrderTally":
        """Both as one."""
        return OrderTally(self.moments.merge(other.moments), self.grid.merge(other.grid))

    def quantile(self, p: float) -> float | None:
        """Amplitude below which a share p of the trials lies."""
        return finite(quantile(self.moments, self.grid, p))


def spectrum_tally(measure: Measure, curves: Array, grids: Mapping[str, Grid]) -> tuple[OrderTally, ...]:
    """A block's amplitudes of each order that a measure asks for; none if it asks for none."""
    if measure.spectrum is None:
        return ()
    found = amplitudes_of(measure, measure.spectrum, curves)
    return tuple(
        OrderTally(Moments.of(own), grids[grid_name(measure.name, k)].add(own))
        for k, own in enumerate(np.ascontiguousarray(found.T))
    )


def spectrum_sample(measure: Measure, tallies: tuple[OrderTally, ...]) -> SpectrumSample | None:
    """Spectrum in the form of summary.json, in the measure's unit; None if the measure asks for none."""
    if measure.spectrum is None:
        return None
    low, middle, high = ([tally.quantile(p) for tally in tallies] for p in QUANTILES)
    return made(
        SpectrumSample,
        order=[float(order) for order in measure.spectrum.orders],
        mean=[tally.moments.mean if tally.moments.count else None for tally in tallies],
        sigma=[finite(tally.moments.sigma) for tally in tallies],
        p0_135=low,
        p50=middle,
        p99_865=high,
        max=[finite(tally.moments.maximum) for tally in tallies],
    )


Counts = Mapping[str, int]


def status_counts(statuses: Statuses, columns: Columns, measure: Measure) -> dict[str, int]:
    """Trials of a block by status, for one measure; those of the analytic method all seat."""
    trials = len(columns[value_column(ANALYTIC, measure.name)])
    return counted(statuses, columns.get(status_column(measure.name)), trials)


def counted(statuses: Statuses, status: NDArray[np.generic] | None, trials: int) -> dict[str, int]:
    """Number of trials of each status; `status` is (trials,), None where all of them seat."""
    seated = trials if status is None else int(np.count_nonzero(status == statuses.seated))
    if seated == trials:
        return {statuses.seated: trials, **dict.fromkeys(statuses.failed, 0)}
    return {statuses.seated: seated, **{text: int(np.count_nonzero(status == text)) for text in statuses.failed}}


def reason_counts(columns: Columns, measure: Measure) -> dict[str, int]:
    """Trials of a block that failed, by the deciding cause; none if the method does not give it."""
    reasons = columns.get(reason_column(measure.name))
    if reasons is None or not (said := reasons != "").any():
        return {}
    words, counts = np.unique(np.asarray(reasons[said], dtype=np.str_), return_counts=True)
    return dict(zip(words.tolist(), counts.tolist(), strict=True))


def gathered(mine: Counts, counts: Counts) -> dict[str, int]:
    """Both counts as one, of any names."""
    return {name: mine.get(name, 0) + counts.get(name, 0) for name in sorted(mine.keys() | counts.keys())}


def added(mine: Counts, counts: Counts) -> dict[str, int]:
    """Both counts as one."""
    return {name: count + counts[name] for name, count in mine.items()}


LOWEST: Final = "lowest"
HIGHEST: Final = "highest"
ENDS: Final[Mapping[str, Callable[[Array], Array]]] = {
    LOWEST: lambda curves: np.asarray(curves.min(axis=1)),
    HIGHEST: lambda curves: np.asarray(curves.max(axis=1)),
}
"""The value of a trial's curve (trials, positions) that a lower and that an upper limit judges."""


def judged_ends(measure: Measure) -> tuple[str, ...]:
    """The ends of a curve that its limits judge."""
    limits = {LOWEST: measure.lower_limit, HIGHEST: measure.upper_limit}
    return tuple(end for end, limit in limits.items() if limit is not None)


def end_name(measure: str, end: str) -> str:
    """Name of the grid of an end of a measure's curves."""
    return f"{measure}:{end}"


@dataclass(frozen=True)
class CurveTally:
    """A curve measure: moments at each position, for both methods, the trials with any position out of limits, spectra.

    A trial counts at every position, or where one of them failed at none. `ends` are the samples of the ends that
    limits judge, `replicates` what is out of limits by replicate, empty for independent trials; both by method.
    """

    status: Mapping[str, int]
    analytic: tuple[Moments, ...]
    geometric: tuple[Moments, ...] | None
    limits: Mapping[str, LimitCounts]
    replicates: Mapping[str, Mapping[int, LimitCounts]]
    ends: Mapping[str, Mapping[str, Sample]]
    deepest: float
    spectra: Mapping[str, tuple[OrderTally, ...]]

    @classmethod
    def of(
        cls, statuses: Statuses, measure: Measure, columns: Columns, grids: Mapping[str, Grid], rows: Rows
    ) -> "CurveTally":
        """Tally of one block of columns; `grids` as grids_of gives them, `rows` those of each replicate."""
        curves = {
            method: outcome_of(columns, method, measure.name, statuses.lacking)
            for method in METHODS
            if value_column(method, measure.name) in columns
        }
        moments = {
            method: tuple(Moments.of(column[~np.isnan(column)]) for column in own.values.T)
            for method, own in curves.items()
        }
        lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
        lowest, highest = (
            {method: Outcome(end(own.values), own.lacking) for method, own in curves.items()} for end in ENDS.values()
        )
        limits = {
            method: LimitCounts.of_spans(
                lowest[method].values, highest[method].values, lower, upper, lacking_of(measure, own)
            )
            for method, own in curves.items()
        }
        replicates = {
            method: limits_by_replicate(
                lowest[method].values, highest[method].values, rows, lower, upper, lacking_of(measure, own)
            )
            for method, own in curves.items()
        }
        ends = {LOWEST: lowest, HIGHEST: highest}
        return cls(
            status_counts(statuses, columns, measure),
            moments[ANALYTIC],
            moments.get(GEOMETRIC),
            limits,
            replicates,
            {
                method: {
                    end: Sample.of(measure, ends[end][method], grids[end_name(measure.name, end)], rows)
                    for end in judged_ends(measure)
                }
                for method in curves
            },
            min(curve.deepest for curve in curves.values()),
            {method: spectrum_tally(measure, own.values, grids) for method, own in curves.items()},
        )

    def merge(self, other: "CurveTally") -> "CurveTally":
        """Both tallies as one."""

        def merged(mine: tuple[Moments, ...], its: tuple[Moments, ...]) -> tuple[Moments, ...]:
            return tuple(a.merge(b) for a, b in zip(mine, its, strict=True))

        return CurveTally(
            added(self.status, other.status),
            merged(self.analytic, other.analytic),
            merged(self.geometric, other.geometric) if self.geometric and other.geometric else None,
            {method: counts.merge(other.limits[method]) for method, counts in self.limits.items()},
            {method: merged_by_replicate(own, other.replicates[method]) for method, own in self.replicates.items()},
            {
                method: {end: sample.merge(other.ends[method][end]) for end, sample in own.items()}
                for method, own in self.ends.items()
            },
            min(self.deepest, other.deepest),
            {
                method: tuple(a.merge(b) for a, b in zip(own, other.spectra[method], strict=True))
                for method, own in self.spectra.items()
            },
        )

    def interval_ppm(self, method: str) -> tuple[float, float] | None:
        """Bounds [ppm] of the true share of trials with any position out of limits; None of no trials."""
        limits, replicates = self.limits[method], self.replicates[method]
        if replicates:
            return interval_of_replicates([counts.out_of_limits for counts in replicates.values()])
        return limits.out_of_limits.interval_ppm() if limits.total else None

    def performance(self, measure: Measure, method: str, asked: PpkBy | None) -> Performance:
        """Ppk by the lowest value of each trial against the lower limit, and by the highest against the upper one."""
        lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
        sides = {end: sample.side for end, sample in self.ends[method].items()}
        nothing = Side(Moments(), (), lambda p: None)
        low, high = (sides.get(end, nothing) for end in ENDS)
        return Judged(lower, upper, low, high, self.limits[method], self.interval_ppm(method)).performance(asked)
