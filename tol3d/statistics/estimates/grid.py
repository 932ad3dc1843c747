"""Integer counts on a fine grid: quantiles and pictures of a sample without its values."""

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array

Counts = NDArray[np.integer[Any]]

BINS = 2**17  # 1 MB of counts; over 40 sigma one bin is 0.0003 sigma, far under the sampling error of a percentile
MOST_OF_32_BITS = 2**31 - 1
FEW = 8  # of so many bins at most one is occupied where the occupied ones alone are kept


@dataclass(frozen=True)
class Histogram:
    """Counts between edges, for a picture.

    Args:
        edges: (bins + 1,) in the unit of the values, evenly spaced.
        counts: (bins,) values at or above one edge and below the next.
    """

    edges: Array
    counts: Counts


@dataclass(frozen=True, eq=False)
class Grid:
    """Counts of values in `bins` equal bins from `lower` on; bin k holds lower + [k, k + 1) width.

    The grid is fixed beforehand (by the model, not by the sample), so that counts of blocks add
    up to the same integers in any order. What falls outside is counted too.

    Args:
        lower: lower edge of the first bin.
        width: of a bin, in the unit of the values.
        bins: their number.
        held: values in each bin (bins,), or in those of `places` alone; of 32 bits while they need no more.
        places: bins that are occupied (occupied,), in order; None if all are held.
        inside: values in all bins.
        underflow, overflow: values below the first and above the last bin, infinite ones included.
    """

    lower: float
    width: float
    bins: int
    held: Counts
    places: Counts | None
    inside: int = 0
    underflow: int = 0
    overflow: int = 0

    @classmethod
    def empty(cls, lower: float, width: float, bins: int = BINS) -> Self:
        """A grid without values.

        Raises:
            ValueError: the bins have no width, or too little for floats to distinguish their edges.
        """
        upper = lower + bins * width
        if not (math.isfinite(upper) and lower + width > lower and upper - width < upper):
            raise ValueError(f"a grid of {bins} bins from {lower} to {upper} has no width")
        return cls(lower, width, bins, np.zeros(0, dtype=np.int32), np.zeros(0, dtype=np.int32))

    @property
    def counts(self) -> Counts:
        """Values in each bin (bins,)."""
        if self.places is None:
            return self.held
        counts = np.zeros(self.bins, dtype=self.held.dtype)
        counts[self.places] = self.held
        return counts

    def add(self, values: Array) -> Self:
        """This grid with the values (n,) counted.

        Raises:
            ValueError: a value is NaN; failed trials are left out, and counted, by the caller.
        """
        if np.any(np.isnan(values)):
            raise ValueError("NaN has no place on a grid")
        position = np.floor((values - self.lower) / self.width)
        below, above = position < 0, position >= self.bins
        index = position[~(below | above)].astype(np.int32)
        if len(index) * FEW < self.bins:
            places, held = np.unique(index, return_counts=True)
        else:
            places, held = None, np.bincount(index, minlength=self.bins)
        kind = np.int32 if len(index) <= MOST_OF_32_BITS else np.int64
        outside = int(np.count_nonzero(below)), int(np.count_nonzero(above))
        return self._plus(places, held.astype(kind), len(index), *outside)

    def merge(self, other: "Grid") -> Self:
        """The counts of both.

        Raises:
            ValueError: they are not the same grid.
        """
        if (self.lower, self.width, self.bins) != (other.lower, other.width, other.bins):
            raise ValueError("only counts on the same grid can be merged")
        return self._plus(other.places, other.held, other.inside, other.underflow, other.overflow)

    def _plus(self, places: Counts | None, held: Counts, inside: int, underflow: int, overflow: int) -> Self:
        """Grid with more counted: in the bins of `places`, or in all."""
        kind = np.int32 if self.inside + inside <= MOST_OF_32_BITS else np.int64
        mine: Counts | None = None
        its: Counts
        if self.places is None:
            its = self.held.astype(kind)
            its[slice(None) if places is None else places] += held
        elif places is None:
            its = held.astype(kind)
            its[self.places] += self.held
        elif (len(self.places) + len(places)) * FEW < self.bins:
            mine, which = np.unique(np.concatenate([self.places, places]), return_inverse=True)
            its = np.zeros(len(mine), dtype=kind)
            its[which[: len(self.places)]] += self.held
            its[which[len(self.places) :]] += held
        else:
            its = self.counts.astype(kind)
            its[places] += held
        return type(self)(
            self.lower,
            self.width,
            self.bins,
            its,
            mine,
            self.inside + inside,
            self.underflow + underflow,
            self.overflow + overflow,
        )

    @property
    def total(self) -> int:
        """Values counted, wherever they fell."""
        return self.inside + self.underflow + self.overflow

    def quantile(self, p: float) -> float | None:
        """The value below which a share p of the sample lies, 0 < p < 1; linear inside its bin.

        It lies in the same bin as the ceil(p n)-th smallest value, so it is off by one `width` at
        most. None where that value fell outside the grid (only the extremes bound it then) or
        nothing was counted.
        """
        rank = p * self.total - self.underflow
        below = np.cumsum(self.held)
        if not len(below) or not 0 < rank <= below[-1]:
            return None
        at = int(np.searchsorted(below, rank))
        inside = 1 - (below[at] - rank) / self.held[at]
        index = at if self.places is None else int(self.places[at])
        return float(self.lower + (index + inside) * self.width)

    @property
    def quantile_error(self) -> float:
        """Largest error of a quantile."""
        return self.width

    def histogram(self, bins: int, span: tuple[float, float] | None = None) -> Histogram:
        """At most `bins` coarse bins, each of equally many fine ones, over a span of values.

        The span grows to whole fine bins and is cut at the grid's ends; None takes the occupied range.
        The same grid, bins and span always give the same edges, so that pictures can be laid over
        each other. Values outside the span, under- and overflow are left out.
        """
        first, last = self._occupied() if span is None else self._bins_over(span)
        factor = -(-(last - first) // bins)
        coarse = -(-(last - first) // factor)
        fine = np.zeros(coarse * factor, dtype=np.int64)
        inside = self.counts[first:last]
        fine[: len(inside)] = inside
        edges = self.lower + self.width * np.arange(first, first + factor * coarse + 1, factor, dtype=np.float64)
        return Histogram(edges, fine.reshape(coarse, factor).sum(axis=1))

    def _occupied(self) -> tuple[int, int]:
        occupied = np.flatnonzero(self.held) if self.places is None else self.places
        return (int(occupied[0]), int(occupied[-1]) + 1) if len(occupied) else (0, self.bins)

    def _bins_over(self, span: tuple[float, float]) -> tuple[int, int]:
        """The first bin of a span and the one after its last, at least one bin."""
        bins = self.bins
        first = math.floor(min(max((span[0] - self.lower) / self.width, 0), bins - 1))
        last = math.ceil(min(max((span[1] - self.lower) / self.width, 0), bins))
        return first, max(last, first + 1)


@dataclass(frozen=True, eq=False)
class CountGrid(Grid):
    """A grid of whole numbers, each in the middle of its bin."""

    @classmethod
    def up_to(cls, most: int) -> Self:
        """A grid without values, for 0 to `most`."""
        return cls.empty(-0.5, 1.0, most + 1)

    def quantile(self, p: float) -> float | None:
        """The whole number below or at which a share p of the sample lies, 0 < p < 1; see Grid."""
        value = super().quantile(p)
        return None if value is None else float(math.ceil(value - 0.5))

    @property
    def quantile_error(self) -> float:
        """None."""
        return 0.0
