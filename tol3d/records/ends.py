"""Rows at the start of a pass and a long period later, kept apart while it is read: what its closure is read from."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.records.bins import Bins, BinSums
from tol3d.records.pair import TURN, RigPair

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
        """Of all rows; windows are shorter where the pass ends within a quarter turn after the long period.

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
