"""The largest circle in several discs, as terms: the smallest of those in any three of them."""

from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from tol3d.assembly.torsors.terms import Form
from tol3d.numerics.arrays import Array

Disc = tuple[Array, ...]
"""x, y, radius (trials,) or (discs, trials) [mm]."""

AT_ONCE: Final = 1 << 13
"""Rows of three discs and a trial that are worked out together: few enough for a processor's cache."""

GOLDEN: Final = (5**0.5 - 1) / 2
SECTIONS: Final = 44
"""Sections of a bracket of milliradians; 6e-10 of it are left, at arms of 50 mm 1e-10 mm."""

HALVINGS: Final = 48
"""Halvings of tenths of a millimetre: down to rounding."""
TINY: Final = 1e-300
"""Smaller than any length; if a divisor is zero, the quotient is not used."""


@dataclass(frozen=True, eq=False)
class CommonOpening:
    """The diameter of the largest circle that lies in all discs.

    The distance of a point outside a disc is convex in it, so that the minimum of the largest distance in the plane is
    that of some three discs (Helly's theorem).

    Args:
        forms: (discs * 3, columns): x, y and radius of each disc.
    """

    forms: Array
    form: Form = "largest inscribed circle"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (discs * 3, trials)."""
        discs, trials = read.reshape(-1, 3, read.shape[1]), read.shape[1]
        if len(discs) == 2:
            least, _, _ = _of_two(*(tuple(disc) for disc in discs))
            return -2.0 * least[None]
        least = np.full(trials, -np.inf)
        threes, step = np.array([*combinations(range(len(discs)), 3)]), max(AT_ONCE // max(trials, 1), 1)
        for begin in range(0, len(threes), step):
            first, second, third = (tuple(disc) for disc in discs[threes[begin : begin + step]].transpose(1, 2, 0, 3))
            np.maximum(least, _of_three(first, second, third).max(axis=0), out=least)
        return -2.0 * least[None]


def _of_two(first: Disc, second: Disc) -> Disc:
    """Smallest distance outside both of two discs, and its point."""
    (x, y, radius), (its_x, its_y, its_radius) = first, second
    apart = np.sqrt((its_x - x) ** 2 + (its_y - y) ** 2)
    along = np.clip(0.5 * (apart + radius - its_radius), 0.0, apart)  # one within the other: the smaller one decides
    share = along / np.maximum(apart, TINY)
    outside = np.maximum(along - radius, apart - along - its_radius)
    return outside, x + share * (its_x - x), y + share * (its_y - y)


def _of_three(first: Disc, second: Disc, third: Disc) -> Array:
    """Smallest distance outside all of three discs (trials,)."""
    pairs = ((first, second, third), (second, third, first), (third, first, second))
    at_pairs = [_of_two(one, other) for one, other, _ in pairs]
    least = np.maximum.reduce([outside for outside, _, _ in at_pairs])
    # where the pair that lies furthest outside leaves the third disc inside, it decides
    left = [_outside(disc, x, y) for (_, _, disc), (_, x, y) in zip(pairs, at_pairs, strict=True)]
    most = np.select([outside == least for outside, _, _ in at_pairs], [np.maximum(own, least) for own in left])
    together = _alike(first, second, third, least)
    return np.where(most <= least, least, np.fmin(np.fmax(together, least), most))


def _outside(disc: Disc, x: Array, y: Array) -> Array:
    return np.sqrt((disc[0] - x) ** 2 + (disc[1] - y) ** 2) - disc[2]


def _alike(first: Disc, second: Disc, third: Disc, least: Array) -> Array:
    """The least amount, from `least` on, by which one point lies outside of three discs alike; NaN where none does.

    By Cramer's rule from the differences of |c_k - p|^2 = (amount + r_k)^2, in which the amount over minus the first
    radius is a root of a quadratic equation.
    """
    rows = [(disc[0] - first[0], disc[1] - first[1], disc[2] - first[2]) for disc in (second, third)]
    (a, b, s), (c, d, t) = rows
    area = _divisor(a * d - b * c)  # nil where the centres lie in one line
    e, f = 0.5 * (a * a + b * b - s * s), 0.5 * (c * c + d * d - t * t)
    p, q = (e * d - b * f) / area, (a * f - c * e) / area
    u, v = (b * t - d * s) / area, (c * s - a * t) / area
    square, half, rest = _divisor(u * u + v * v - 1.0), p * u + q * v, p * p + q * q
    root = np.sqrt(np.where(half * half >= square * rest, half * half - square * rest, np.nan))
    middle = -(half + np.copysign(root, half))
    amounts = np.stack([middle / square, rest / _divisor(middle)])
    allowed = np.isfinite(amounts) & (amounts >= 0.0) & (amounts - first[2] >= least)
    found = np.where(allowed, amounts, np.inf).min(axis=0) - first[2]
    return np.where(np.isfinite(found), found, np.nan)


def _divisor(read: Array) -> Array:
    """The divisor, NaN if it is zero: the quotient is no solution."""
    return np.where(read == 0.0, np.nan, read)


@dataclass(frozen=True, eq=False)
class TurnedOpening:
    """The diameter of the largest circle in all discs, with the best common turn of their centres.

    It is concave in the turn: golden sections of a bracket that holds the best.

    Args:
        forms: as of CommonOpening.
        arms: how the centres move with the turn (discs, 2) [mm].
    """

    forms: Array
    arms: Array
    form: Form = "largest inscribed circle"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (discs * 3, trials)."""
        widest = self._widest(read)
        low, high = -widest, widest
        places = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)]
        openings = [self._at(read, place) for place in places]
        best = np.maximum(*openings)
        for _ in range(SECTIONS):
            left = openings[0] >= openings[1]
            low, high = np.where(left, low, places[0]), np.where(left, places[1], high)
            place = np.where(left, high - GOLDEN * (high - low), low + GOLDEN * (high - low))
            opening = self._at(read, place)
            np.maximum(best, opening, out=best)
            places = [np.where(left, place, places[1]), np.where(left, places[0], place)]
            openings = [np.where(left, opening, openings[1]), np.where(left, openings[0], opening)]
        return best[None]

    def _at(self, read: Array, turn: Array) -> Array:
        moved = read.reshape(-1, 3, read.shape[1]).copy()
        moved[:, :2] -= self.arms[:, :, None] * turn
        found: Array = CommonOpening(self.forms).values(moved.reshape(read.shape))[0]
        return found

    def _widest(self, read: Array) -> Array:
        """No better turn is larger: two centres apart would be further off than all are without one."""
        apart = np.linalg.norm(self.arms[:, None] - self.arms[None], axis=2)
        first, second = divmod(int(apart.argmax()), len(apart))
        discs = read.reshape(-1, 3, read.shape[1])
        off = np.sqrt(((discs[first, :2] - discs[second, :2]) ** 2).sum(axis=0))
        room = discs[first, 2] + discs[second, 2] - self._at(read, np.zeros(read.shape[1]))
        return np.asarray((off + np.maximum(room, 0.0)) / apart[first, second])


@dataclass(frozen=True, eq=False)
class LeastInRoom:
    """Twice the least by which discs about places grow until all discs have a point in common.

    By halving, from what the places ask alone to what they need in the middle of the room.

    Args:
        forms: (discs * 3, columns): x, y and radius, of the places, then of the room.
        places: how many of them are places.
    """

    forms: Array
    places: int
    form: Form = "least in a room"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (discs * 3, trials)."""
        discs = read.reshape(-1, 3, read.shape[1])
        own, room = discs[: self.places], discs[self.places :]
        low = -0.5 * _opening(own)
        middle = room[:, :2].mean(axis=0)
        far = np.sqrt(((own[:, :2] - middle) ** 2).sum(axis=1)) - own[:, 2]
        high = np.maximum(far.max(axis=0), low)
        for _ in range(HALVINGS):
            grown = discs.copy()
            between = 0.5 * (low + high)
            grown[: self.places, 2] += between
            enough = _opening(grown) >= 0.0
            low, high = np.where(enough, low, between), np.where(enough, between, high)
        return np.asarray(2.0 * high[None])


def _opening(discs: Array) -> Array:
    """As CommonOpening, of one disc too (trials,), from (discs, 3, trials)."""
    if len(discs) == 1:
        return np.asarray(2.0 * discs[0, 2], dtype=np.float64)
    found: Array = CommonOpening(np.zeros((0, 0))).values(discs.reshape(-1, discs.shape[2]))[0]
    return found
