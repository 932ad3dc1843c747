"""Passes as they come, laid in one long period and pooled: what is kept does not grow with their number.

Passes of one torque are gathered in the same bins, with travel counted from the middle of each, so that a fit, which is
linear in travel and torque, finds the same of them as of all passes one by one.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.records.alignment import Aligned, Alignment
from tol3d.records.bins import Bins, BinSums
from tol3d.records.exact_play import Side
from tol3d.records.pair import RigPair
from tol3d.records.reading import Pass


class SidePool:
    """The rows of one side, by torque."""

    def __init__(self, pair: RigPair) -> None:
        self._pair = pair
        self._single: dict[str, Bins] = {}
        self._several: dict[str, tuple[BinSums, float]] = {}

    def add(self, bins: Bins, torques: tuple[float, float] | None) -> None:
        """Add a pass in its place, with its smallest and largest torque [N m]."""
        level = "" if torques is None else f"{(torques[0] + torques[1]) / 2:.1e}"
        own = replace(bins, travel=_centred(bins.travel))
        if level in self._several:
            sums, error = self._several[level]
            sums.add_bins(own, error)
        elif level in self._single:
            first = self._single.pop(level)
            sums, error = BinSums(self._pair), float(first.error[0])
            sums.add_bins(first, error)
            sums.add_bins(own, error)
            self._several[level] = sums, error
        else:
            self._single[level] = own

    @property
    def bins(self) -> tuple[Bins, ...]:
        """One for each torque."""
        return (*self._single.values(), *(sums.bins(error) for sums, error in self._several.values()))


class Pool:
    """Both sides: passes without their rows as they were read and as they were aligned, and the rows."""

    def __init__(self, pair: RigPair, j0: float | None) -> None:
        self._alignment = Alignment(pair, j0)
        self._rows: Mapping[Side, SidePool] = {"drive": SidePool(pair), "back": SidePool(pair)}
        self._read: Mapping[Side, list[Pass]] = {"drive": [], "back": []}
        self._aligned: Mapping[Side, list[Aligned]] = {"drive": [], "back": []}

    def add(self, side: Side, passes: Iterable[Pass]) -> None:
        """Add passes of a side, those of the drive side first."""
        for own in passes:
            placed, bins = self._alignment.placed(side, own)
            self._rows[side].add(bins, own.torques)
            self._aligned[side].append(placed)
            self._read[side].append(own.without_rows())

    @property
    def read(self) -> Mapping[Side, tuple[Pass, ...]]:
        """Passes as they were read."""
        return {side: tuple(passes) for side, passes in self._read.items()}

    @property
    def aligned(self) -> Mapping[Side, tuple[Aligned, ...]]:
        """The same as they were aligned."""
        return {side: tuple(passes) for side, passes in self._aligned.items()}

    @property
    def bins(self) -> Mapping[Side, tuple[Bins, ...]]:
        """Their rows."""
        return {side: pool.bins for side, pool in self._rows.items()}


def _centred(travel: Array) -> Array:
    middle = (travel.min() + travel.max()) / 2
    return np.asarray(travel - middle)
