"""Rows gathered by position in the long period: all that a fit needs of them, however many there are."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.apps.records.pair import TURN, RigPair
from tol3d.numerics.arrays import Array

BINS_A_TOOTH = 32  # of the driver; a tooth's own harmonic is averaged by 0.2 % then
FEWEST_BINS_A_TOOTH = 8
MOST_BINS = 2**19  # 30 MB a file or repeat


def bins_a_turn(pair: RigPair) -> int:
    """Bins per turn of the driver: whole ones a tooth, fewer for pairs of a very long period."""
    teeth = pair.driver_teeth * pair.long_period_turns
    return pair.driver_teeth * max(FEWEST_BINS_A_TOOTH, min(BINS_A_TOOTH, MOST_BINS // teeth))


@dataclass(frozen=True, eq=False)
class Bins:
    """Means of the rows of one pass in each bin that has any; arrays (bins,).

    Args:
        rows: their number, as floats.
        phi1: driver's angle in the long period [rad].
        travel: driver's angle as it was counted on [rad].
        error: phi2 - phi1 z1/z2 [rad].
        torque: [N m]; zeros if none was measured.
        spread_phi1, spread_both, spread_error: sums of products of the deviations of phi1 and error from their means.
    """

    rows: Array
    phi1: Array
    travel: Array
    error: Array
    torque: Array
    spread_phi1: Array
    spread_both: Array
    spread_error: Array

    def shifted(self, pair: RigPair, turns: int, error: float) -> "Bins":
        """The same rows shifted by turns of the driver in the long period, their errors shifted [rad]."""
        return replace(self, phi1=np.mod(self.phi1 + TURN * turns, pair.long_period), error=self.error + error)

    def where(self, kept: NDArray[np.bool_]) -> "Bins":
        """Some of the bins."""
        return Bins(**{name: values[kept] for name, values in vars(self).items()})


class BinSums:
    """Sums over rows, bin by bin, while they are read."""

    def __init__(self, pair: RigPair) -> None:
        self._per_turn = bins_a_turn(pair)
        self._count = self._per_turn * pair.long_period_turns
        self._period = pair.long_period
        self._sums = np.zeros((8, self._count))

    def add(self, phi1: Array, error: Array, torque: Array | None) -> None:
        """Add rows: phi1 as it was counted on [rad], its error off a fixed value [rad]."""
        within = np.mod(phi1, self._period)
        index = np.minimum((within * (self._count / self._period)).astype(np.int64), self._count - 1)
        off = within - (index + 0.5) * (self._period / self._count)
        low = int(index.min())
        index = index - low
        high = int(index.max()) + 1
        view = self._sums[:, low : low + high]
        view[0] += np.bincount(index, minlength=high)
        for k, weights in enumerate((off, phi1, error, off * off, off * error, error * error), 1):
            view[k] += np.bincount(index, weights, minlength=high)
        if torque is not None:
            view[7] += np.bincount(index, torque, minlength=high)

    def add_bins(self, bins: Bins, error: float) -> None:
        """Add rows that are gathered already; `error` [rad] is the value that errors here are counted from."""
        index = np.minimum((bins.phi1 * (self._count / self._period)).astype(np.int64), self._count - 1)
        off = bins.phi1 - (index + 0.5) * (self._period / self._count)
        rows, own = bins.rows, bins.error - error
        parts = (
            rows,
            rows * off,
            rows * bins.travel,
            rows * own,
            bins.spread_phi1 + rows * off * off,
            bins.spread_both + rows * off * own,
            bins.spread_error + rows * own * own,
            rows * bins.torque,
        )
        for sums, part in zip(self._sums, parts, strict=True):
            np.add.at(sums, index, part)

    def bins(self, error: float) -> Bins:
        """Means of the bins that have rows; `error` [rad] is the value that errors were counted from."""
        used = np.flatnonzero(self._sums[0])
        rows, off, travel, own, off2, both, own2, torque = self._sums[:, used]
        centre = (used + 0.5) * (self._period / self._count)
        return Bins(
            rows=rows,
            phi1=centre + off / rows,
            travel=travel / rows,
            error=own / rows + error,
            torque=torque / rows,
            spread_phi1=np.maximum(off2 - off * off / rows, 0.0),
            spread_both=both - off * own / rows,
            spread_error=np.maximum(own2 - own * own / rows, 0.0),
        )


WINDOW: Final = TURN / 4  # of the driver: some teeth, so that single ones matter little, and little of any drift
SHORT: Final = WINDOW / 2  # by which a pass may fall short of the long period; from which over it places are compared


@dataclass(frozen=True, eq=False)
class Ends:
    """Rows of a quarter turn each, or of less.

    Args:
        start: of the first one.
        end: of the one a long period later, or of the last one before that.
        same_places: whether both lie at the same places of the long period.
    """

    start: Bins
    end: Bins
    same_places: bool

    def shifted(self, pair: RigPair, turns: int, error: float) -> "Ends":
        """See Bins."""
        return Ends(self.start.shifted(pair, turns, error), self.end.shifted(pair, turns, error), self.same_places)


class EndSums:
    """Rows of the first quarter turn, and of those about the end of the long period."""

    def __init__(self, pair: RigPair) -> None:
        self._period = pair.long_period
        self._start, self._end = BinSums(pair), BinSums(pair)

    def add(self, travel: Array, phi1: Array, error: Array, torque: Array | None) -> None:
        """Add rows; travel since the first row of the pass [rad], the others as BinSums.add has them."""
        for sums, low, high in (
            (self._start, 0.0, WINDOW),
            (self._end, self._period - SHORT - WINDOW, self._period + WINDOW),
        ):
            if float(travel[-1]) < low or float(travel[0]) > high + WINDOW:
                continue
            own = (travel >= low) & (travel <= high)
            if own.any():
                sums.add(phi1[own], error[own], None if torque is None else torque[own])

    def ends(self, start: float, travel: float, error: float) -> Ends | None:
        """Ends of all rows; windows are shorter if the pass ends within a quarter turn after the long period.

        Args:
            start: driver's angle at the first row [rad].
            travel: of the whole pass [rad].
            error: that errors were counted from [rad].

        Returns:
            None where the pass is shorter than the long period.
        """
        if travel < self._period - SHORT:
            return None
        first, last = self._start.bins(error), self._end.bins(error)
        at_start, at_end, over = (*(np.abs(own.travel - start) for own in (first, last)), travel - self._period)
        if over >= SHORT:
            after = at_end - self._period
            return Ends(first.where(at_start <= over), last.where((after >= 0.0) & (after <= over)), True)
        until = min(travel, self._period)
        return Ends(first, last.where((at_end > until - WINDOW) & (at_end <= until)), False)
