"""Histograms ready to be drawn: fewer bars for few trials, densities in % per unit."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.values import Method

FEWEST_BARS = 8
Limits = tuple[float | None, float | None]


@dataclass(frozen=True, eq=False)
class Pieces:
    """Bars cut at limits.

    Args:
        edges: (pieces + 1,) rising.
        bars: (pieces,) index of the bar that each is of.
        beyond: (pieces,) True for those that lie beyond a limit.
    """

    edges: Array
    bars: NDArray[np.intp]
    beyond: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Bars:
    """Bars of a histogram.

    Args:
        edges: (bars + 1,) in the unit of the values.
        counts: (bars,) values in each bar.
        trials: how many trials there were in all; those that failed are in no bar.
    """

    edges: Array
    counts: Array
    trials: float

    @classmethod
    def of(cls, values: Array, edges: Array) -> "Bars":
        """Bars of values, all of which are counted."""
        return cls(edges, np.histogram(values, edges)[0].astype(np.float64), len(values))

    @property
    def density(self) -> Array:
        """(bars,) % of the trials a unit, so that samples with other bars and the normal curve compare."""
        return 100 * self.counts / (max(self.trials, 1.0) * np.diff(self.edges))

    @property
    def middles(self) -> Array:
        """Middle of each bar."""
        return (self.edges[:-1] + self.edges[1:]) / 2

    def cut(self, limits: Limits) -> Pieces:
        """Its bars, those that a limit runs through in two pieces."""
        within = [limit for limit in limits if limit is not None and self.edges[0] < limit < self.edges[-1]]
        edges = np.unique(np.concatenate([self.edges, within]))
        middles = (edges[:-1] + edges[1:]) / 2
        lower, upper = limits
        below, above = -math.inf if lower is None else lower, math.inf if upper is None else upper
        bars = np.clip(np.searchsorted(self.edges, middles) - 1, 0, len(self.counts) - 1)
        return Pieces(edges, bars, np.asarray((middles < below) | (middles > above)))

    def times(self, factor: float) -> "Bars":
        """The same values in another unit, so many to one of this one."""
        return Bars(factor * self.edges, self.counts, self.trials)


def bars_of(measure: MeasureSummary) -> dict[Method, Bars]:
    """Bars of each method of a measure; none where nothing was counted.

    Densities refer to all trials: failed ones are missing in the bars and do not raise the others.
    """
    histogram = measure.histogram
    if histogram is None or histogram.counts is None or histogram.lower_edge is None or histogram.bin_width is None:
        return {}
    total = max(sum(counts) for counts in histogram.counts.values())
    merged = _neighbours_in_one(len(next(iter(histogram.counts.values()))), total)
    width = merged * histogram.bin_width
    found: dict[Method, Bars] = {}
    for method, counts in histogram.counts.items():
        joined = _joined(np.asarray(counts, dtype=np.float64), merged)
        edges = histogram.lower_edge + width * np.arange(len(joined) + 1, dtype=np.float64)
        found[method] = Bars(edges, joined, sum(counts) / _seated(measure, method))
    return found


def _seated(measure: MeasureSummary, method: Method) -> float:
    """The share of a method's trials that were assembled."""
    sample = measure.sample(method)
    return sample.count / sample.trials if sample and sample.count and sample.trials else 1.0


def _neighbours_in_one(bars: int, total: int) -> int:
    """Number of bars to merge into one, for about 2 n^(1/3) bars (the Rice rule)."""
    wanted: float = max(FEWEST_BARS, 2 * total ** (1 / 3))
    return max(1, round(bars / wanted))


def _joined(counts: Array, merged: int) -> Array:
    """Counts of bars that are so many neighbours each."""
    padded = np.pad(counts, (0, -len(counts) % merged))
    return np.asarray(padded.reshape(-1, merged).sum(axis=1))
