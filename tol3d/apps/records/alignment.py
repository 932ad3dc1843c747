"""Place of each measured pass in the long period.

A driver's angle is known up to whole turns where an encoder counts within one turn, or was counted from another start.
Both encoders together know more: a driver that is n turns further on leaves phi2 - phi1 z1/z2 larger by n z1/z2 turns,
of which whole turns of the driven gear cannot be seen: n is known up to the long period, by steps of gcd(z1, z2)
pitches of the driven gear. Transmission errors and backlash are far smaller than half such a step.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tol3d.apps.records.bins import Bins, BinSums, Ends
from tol3d.apps.records.pair import TURN, RigPair, Side
from tol3d.apps.records.reading import Pass
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Aligned:
    """A pass in its place.

    Args:
        path, repeat: whose it is.
        turns: of the driver, by which its own count was shifted.
        ends: see Pass, shifted by these turns; errors off a constant.
        torques: see Pass.
    """

    path: Path
    repeat: int
    turns: int
    ends: Ends | None
    torques: tuple[float, float] | None


class Alignment:
    """Places of passes in one long period: that of the first pass of the drive side.

    Args:
        pair: nominal numbers.
        j0: backlash [rad] where the encoders were set to zero between the sides: the back side then lies where its
            own angles say, at any offset.
    """

    def __init__(self, pair: RigPair, j0: float | None) -> None:
        self._pair, self._j0 = pair, j0
        self._reference: float | None = None
        self._back: float | None = None  # by which errors of the back side are shifted

    def placed(self, side: Side, own: Pass) -> tuple[Aligned, Bins]:
        """A pass in its place, and its rows."""
        bins, mean = own.bins, mean_error(own.bins)
        if self._reference is None:
            self._reference = mean
        if side == "back" and self._j0 is not None:
            self._back = self._reference + self._j0 - mean if self._back is None else self._back
            bins = bins.shifted(self._pair, 0, self._back)
        pair, step = self._pair, TURN * self._pair.common_factor / self._pair.driven_teeth
        steps = round((mean_error(bins) - self._reference) / step)
        turns = steps * _inverse(pair) % pair.long_period_turns
        ends = None if own.ends is None else own.ends.shifted(pair, turns, 0.0)
        placed = Aligned(own.path, own.repeat, turns, ends, own.torques)
        return placed, bins.shifted(pair, turns, -steps * step)


def mean_error(bins: Bins) -> float:
    """Mean of phi2 - phi1 z1/z2 over the rows [rad]."""
    return float(np.average(bins.error, weights=bins.rows))


def _inverse(pair: RigPair) -> int:
    """Turns of the driver that leave one step, whole turns of the driven gear apart."""
    if pair.long_period_turns == 1:
        return 0
    return pow(pair.driver_teeth // pair.common_factor, -1, pair.long_period_turns)


@dataclass(frozen=True)
class HiddenShift:
    """The encoders' once-per-turn part if the back side lay elsewhere in the long period.

    Args:
        own: the part of the driven gear's turn as measured [rad].
        turns: of the driver by which the back side would have to be shifted for the smallest such part.
        least: that part [rad].
        moved: largest change of the backlash [rad].
    """

    own: float
    turns: int
    least: float
    moved: float


def hidden_shift(pair: RigPair, drive: complex, back: complex) -> HiddenShift:
    """The shift that both encoders would not show, for they were counted from another start.

    With the back side n turns off, its part of the driven gear's turn is turned by 2 pi n z1/z2; read as it stands,
    that is an encoder's error on the driven shaft, and a large one.

    Args:
        pair: nominal numbers.
        drive, back: of each side the part a in Im(a exp(i phi2)) [rad].
    """
    alpha = pair.working_angle

    def parts(turns: int) -> tuple[complex, complex]:
        there = back * np.exp(-1j * TURN * pair.rate * turns)
        eccentric = (there - drive) / (2j * math.sin(alpha))
        return eccentric, drive - eccentric * np.exp(-1j * alpha)

    encoders = [abs(parts(turns)[1]) for turns in range(pair.long_period_turns)]
    turns = int(np.argmin(encoders))
    moved = 2 * math.sin(alpha) * abs(parts(turns)[0] - parts(0)[0])
    return HiddenShift(encoders[0], turns, encoders[turns], moved)


class SidePool:
    """The rows of one side, by torque: the kept data does not grow with the number of passes.

    Passes of one torque are gathered in the same bins, with travel counted from the middle of each, so that a fit,
    which is linear in travel and torque, finds the same of them as of all passes one by one.
    """

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
