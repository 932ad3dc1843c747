"""Histograms from a summary, ready to be drawn: fewer bars for few trials, densities in % a unit."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEWEST_BARS = 8


@dataclass(frozen=True)
class Bars:
    """Bars of a histogram.

    Args:
        edges: (bars + 1,) in the measure's unit.
        density: (bars,) % of the trials a unit, so that runs with other bars and the normal curve compare.
    """

    edges: Array
    density: Array

    @property
    def middles(self) -> Array:
        """Middle of each bar."""
        return (self.edges[:-1] + self.edges[1:]) / 2


def bars_of(measure: Any) -> dict[str, Bars]:
    """Bars of each road of a measure's summary; none when nothing was counted.

    Densities are of all trials: what failed is missing, and does not make the others seem more.
    """
    histogram = measure["histogram"]
    if not histogram:
        return {}
    total = max(sum(counts) for counts in histogram["counts"].values())
    merged = _neighbours_in_one(len(next(iter(histogram["counts"].values()))), total)
    return {
        road: _bars(
            _seated(measure.get(road) or {}) * np.asarray(counts, dtype=np.float64) / (sum(counts) or 1),
            merged,
            histogram["lower_edge"],
            histogram["bin_width"],
        )
        for road, counts in histogram["counts"].items()
    }


def _seated(sample: Any) -> float:
    """The share of a road's trials that seated."""
    count, trials = sample.get("count"), sample.get("trials")
    return count / trials if count and trials else 1.0


def _neighbours_in_one(bars: int, total: int) -> int:
    """How many bars make one, for about 2 n^(1/3) of them (the Rice rule)."""
    wanted: float = max(FEWEST_BARS, 2 * total ** (1 / 3))
    return max(1, round(bars / wanted))


def _bars(shares: Array, merged: int, lower: float, width: float) -> Bars:
    bars = -(-len(shares) // merged)
    padded = np.zeros(bars * merged)
    padded[: len(shares)] = shares
    edges: Array = lower + merged * width * np.arange(bars + 1, dtype=np.float64)
    return Bars(edges, 100 * padded.reshape(bars, merged).sum(axis=1) / (merged * width))
