"""Histograms ready to be drawn: fewer bars for few trials, densities in % a unit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.values import Road

Array = NDArray[np.float64]

FEWEST_BARS = 8


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
        """Of values, of which none is lost."""
        return cls(edges, np.histogram(values, edges)[0].astype(np.float64), len(values))

    @property
    def density(self) -> Array:
        """(bars,) % of the trials a unit, so that samples with other bars and the normal curve compare."""
        return 100 * self.counts / (max(self.trials, 1.0) * np.diff(self.edges))

    @property
    def middles(self) -> Array:
        """Middle of each bar."""
        return (self.edges[:-1] + self.edges[1:]) / 2

    def times(self, factor: float) -> "Bars":
        """The same values in another unit, so many to one of this one."""
        return Bars(factor * self.edges, self.counts, self.trials)


def bars_of(measure: MeasureSummary) -> dict[Road, Bars]:
    """Bars of each road of a measure; none where nothing was counted.

    Trials are all: what failed is missing in the bars, and does not make the others seem more.
    """
    histogram = measure.histogram
    if histogram is None or histogram.counts is None or histogram.lower_edge is None or histogram.bin_width is None:
        return {}
    total = max(sum(counts) for counts in histogram.counts.values())
    merged = _neighbours_in_one(len(next(iter(histogram.counts.values()))), total)
    width = merged * histogram.bin_width
    found: dict[Road, Bars] = {}
    for road, counts in histogram.counts.items():
        joined = _joined(np.asarray(counts, dtype=np.float64), merged)
        edges = histogram.lower_edge + width * np.arange(len(joined) + 1, dtype=np.float64)
        found[road] = Bars(edges, joined, sum(counts) / _seated(measure, road))
    return found


def _seated(measure: MeasureSummary, road: Road) -> float:
    """The share of a road's trials that seated."""
    sample = measure.sample(road)
    return sample.count / sample.trials if sample and sample.count and sample.trials else 1.0


def _neighbours_in_one(bars: int, total: int) -> int:
    """How many bars make one, for about 2 n^(1/3) of them (the Rice rule)."""
    wanted: float = max(FEWEST_BARS, 2 * total ** (1 / 3))
    return max(1, round(bars / wanted))


def _joined(counts: Array, merged: int) -> Array:
    """Counts of bars that are so many neighbours each."""
    padded = np.pad(counts, (0, -len(counts) % merged))
    return np.asarray(padded.reshape(-1, merged).sum(axis=1))
