"""The common opening of holes along one direction: the largest circle within all of their discs.

With discs of centres c and radii r, the least of max(|x - c| - r) over all points x of a plane is minus its radius.
That is a convex programme of two unknowns, decided by one, two or three discs: each step takes the disc that is
violated most to those that decided before, and finds exactly what these four at most leave (an LP-type problem after
Sharir and Welzl): of all points that one, two or three of them may decide, the one that violates the worst of them
least. The programme of contact/programme.py would do the same, by a kernel that takes nine times as long to compile.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import Any, Final

import numpy as np

from tol3d.numerics.arrays import Array, Places
from tol3d.numerics.compiled import kernel, nested

MET: Final = 1e-13
"""mm; largest violation of a disc at the end."""
STEPS: Final = 200
"""Steps at most, each decided by other discs than all before; in practice 2 to 6."""
TIGHT: Final = 1e-12
"""mm; largest gap below the tangents of both ends of the bracket at the end, and of circles without a common point."""
BEYOND: Final = 1e-3
"""Share of a bracket by which a turn goes beyond the one that is hoped for, so that its nearer end moves as well."""
LEAST: Final = 1e-16
"""Width of a bracket at the end [rad]."""
WIDEST: Final = 0.5
"""Limit of the search for a bracket [rad]."""
TURNS: Final = 200
"""In practice 10 to 30, of the trial that takes the most."""
GROWTHS: Final = 100
"""In practice 1 to 6."""
FREE: Final = 1e-12
"""Weight of places below which the clearance alone decides: it is empty."""


@nested
def violated(discs: Any, k: int, i: int, point: Any) -> Any:
    """Distance of a point outside a disc [mm]; negative inside."""
    x, y, radii = discs
    a, b = point[0] - x[k, i], point[1] - y[k, i]
    return sqrt(a * a + b * b) - radii[k, i]


@nested
def worst_of(discs: Any, chosen: Any, count: int, i: int, point: Any) -> Any:
    """Largest distance of a point outside several discs [mm]."""
    worst = -np.inf
    for c in range(count):
        worst = max(worst, violated(discs, chosen[c], i, point))
    return worst


@nested
def between(discs: Any, j: int, k: int, i: int, point: Any) -> bool:
    """Find the deciding point (2,) of two discs; False if one lies within the other."""
    x, y, radii = discs
    a, b = x[k, i] - x[j, i], y[k, i] - y[j, i]
    distance = sqrt(a * a + b * b)
    if not distance > abs(radii[k, i] - radii[j, i]):
        return False
    share = 0.5 * (distance + radii[j, i] - radii[k, i]) / distance
    point[0], point[1] = x[j, i] + share * a, y[j, i] + share * b
    return True


@nested
def touching(discs: Any, j: int, k: int, m: int, i: int, points: Any) -> int:
    """Points (2, 2) that three discs violate alike (Apollonius), and how many.

    About the first centre, w = |x| is how much more than minus its radius each violates: |x - c| = w + s, with s by how
    much the other radius is larger, so that c . x = (c^2 - s^2) / 2 - w s.
    """
    x, y, radii = discs
    a, b, s = x[k, i] - x[j, i], y[k, i] - y[j, i], radii[k, i] - radii[j, i]
    c, d, t = x[m, i] - x[j, i], y[m, i] - y[j, i], radii[m, i] - radii[j, i]
    area = a * d - b * c
    if area == 0.0:
        return 0
    e, f = 0.5 * (a * a + b * b - s * s), 0.5 * (c * c + d * d - t * t)
    p, q = (e * d - f * b) / area, (f * a - e * c) / area  # x = (p, q) + w (u, v)
    u, v = (t * b - s * d) / area, (s * c - t * a) / area
    square, half, rest = u * u + v * v - 1.0, p * u + q * v, p * p + q * q
    root = half * half - square * rest
    if root < 0.0:
        return 0
    middle = -(half + sqrt(root)) if half > 0.0 else -half + sqrt(root)
    count = 0
    for n in range(2):
        if (square if n == 0 else middle) == 0.0:
            continue
        w = middle / square if n == 0 else rest / middle
        if w >= 0.0:
            points[count, 0], points[count, 1] = x[j, i] + p + w * u, y[j, i] + q + w * v
            count += 1
    return count


@nested
def better(discs: Any, chosen: Any, count: int, i: int, point: Any, best: Any, found: Any) -> Any:
    """The least violation so far (of `found` (2,), or of a further point, which is then kept)."""
    own = worst_of(discs, chosen, count, i, point)
    if own < best:
        found[0], found[1] = point[0], point[1]
        return own
    return best


@nested
def decided(discs: Any, chosen: Any, count: int, i: int, found: Any, deciding: Any, rooms: Any) -> Any:
    """The least violation of up to four discs, its point, and which of them decide; -1 for none."""
    point, points = rooms
    best = np.inf
    for a in range(count):
        j = chosen[a]
        point[0], point[1] = discs[0][j, i], discs[1][j, i]
        own = better(discs, chosen, count, i, point, best, found)
        if own < best:
            best, deciding[0], deciding[1], deciding[2] = own, j, -1, -1
        for b in range(a + 1, count):
            k = chosen[b]
            if between(discs, j, k, i, point):
                own = better(discs, chosen, count, i, point, best, found)
                if own < best:
                    best, deciding[0], deciding[1], deciding[2] = own, j, k, -1
            for c in range(b + 1, count):
                m = chosen[c]
                for n in range(touching(discs, j, k, m, i, points)):
                    own = better(discs, chosen, count, i, points[n], best, found)
                    if own < best:
                        best, deciding[0], deciding[1], deciding[2] = own, j, k, m
    return best


@nested
def opened(discs: Any, i: int, found: Any, deciding: Any, rooms: Any) -> Any:
    """The least violation of all discs: its point (2,) in `found`, and in `deciding` (3,) which decide; -1 for none."""
    radii = discs[2]
    chosen, own_rooms = rooms
    smallest = 0
    for k in range(1, radii.shape[0]):
        if radii[k, i] < radii[smallest, i]:
            smallest = k
    found[0], found[1] = discs[0][smallest, i], discs[1][smallest, i]
    deciding[0], deciding[1], deciding[2] = smallest, -1, -1
    least, largest = -radii[smallest, i], 0.0
    for _ in range(STEPS):
        worst, largest = 0, -np.inf
        for k in range(radii.shape[0]):
            own = violated(discs, k, i, found)
            if own > largest:
                worst, largest = k, own
        if not largest > least + MET:
            break
        count = 0
        for c in range(3):
            if deciding[c] >= 0:
                chosen[count] = deciding[c]
                count += 1
        chosen[count] = worst
        own = decided(discs, chosen, count + 1, i, found, deciding, own_rooms)
        if not own > least:
            largest = own  # by rounding: no further gain
            break
        least = own
    return largest


@kernel(arrays="float64[:,::1], float64[:,::1], float64[:,::1], float64[::1], float64[:,::1], int64[:,::1]")
def common_openings(x: Any, y: Any, radii: Any, outside: Any, centres: Any, deciding: Any) -> None:
    """Largest circles in discs; see `Opening`."""
    discs, rooms = (x, y, radii), (np.empty(4, dtype=np.int64), (np.empty(2), np.empty((2, 2))))
    found, decided = np.empty(2), np.empty(3, dtype=np.int64)
    for i in range(outside.shape[0]):
        outside[i] = opened(discs, i, found, decided, rooms)
        centres[0, i], centres[1, i] = found[0], found[1]
        for c in range(3):
            deciding[c, i] = decided[c]


@dataclass(frozen=True, eq=False)
class Opening:
    """Largest circles that lie in all discs of a trial.

    Args:
        outside: how far their centres lie outside of the discs (n,) [mm]: minus the radius, above 0 where discs have no
            point in common.
        centres: (2, n) [mm].
        weights: of the discs that decide, with which their pulls on a centre balance; they sum to 1 (3, n).
        deciding: which these are (3, n).
        pulls: directions from them to the centre (2, 3, n); 0 of one that decides alone.
    """

    outside: Array
    centres: Array
    weights: Array
    deciding: Places
    pulls: Array

    def slope(self, x: Array, y: Array) -> Array:
        """Change of `outside` (n,) as the discs' centres move by x, y (discs, n): it grows as they go away."""
        x, y = (np.take_along_axis(own, self.deciding, axis=0) for own in (x, y))
        slopes = self.weights * (self.pulls[0] * x + self.pulls[1] * y)
        return np.asarray(-(slopes[0] + slopes[1] + slopes[2]))


def opening(x: Array, y: Array, radii: Array) -> Opening:
    """The largest circles in discs of centres x, y and radii (discs, n) [mm]."""
    x, y, radii = (np.ascontiguousarray(own) for own in (x, y, radii))
    outside, centres, deciding = np.empty(x.shape[1]), np.empty((2, x.shape[1])), np.empty((3, x.shape[1]), np.int64)
    common_openings(x, y, radii, outside, centres, deciding)
    decides, deciding = deciding >= 0, np.maximum(deciding, 0)
    off = np.where(decides, centres[:, None] - [np.take_along_axis(own, deciding, axis=0) for own in (x, y)], 0.0)
    length = np.sqrt(off[0] ** 2 + off[1] ** 2)
    pulls = off / np.where(length > 0.0, length, 1.0)
    (a, b, c), (d, e, f) = pulls
    areas = np.array([b * f - c * e, c * d - a * f, a * e - b * d])
    total = areas[0] + areas[1] + areas[2]
    even = decides / (1.0 + decides[1] + decides[2])
    weights = np.where(decides[2] & (total != 0.0), areas / np.where(total != 0.0, total, 1.0), even)
    return Opening(outside, centres, weights, deciding, pulls)


def least_in_rooms(x: Array, y: Array, radii: Array, places: int) -> Array:
    """The least growth of circles about places at which all circles have a common point (n,) [mm]; NaN if none has.

    Args:
        x, y: centres, of the places, then of the clearances (circles, n) [mm].
        radii: of the places without growth, of either sign, then of the clearances (circles, n) [mm].
        places: number of places among them.
    """
    least, going = opening(x[:places], y[:places], radii[:places]).outside, np.arange(x.shape[1])
    for _ in range(GROWTHS):
        wider = radii[:, going]
        wider[:places] += least[going]
        found = opening(x[:, going], y[:, going], wider)
        weight = np.where(found.deciding < places, found.weights, 0.0).sum(axis=0)
        missing, grows = found.outside > TIGHT, weight > FREE
        least[going[missing]] += np.where(grows, found.outside / np.where(grows, weight, 1.0), np.nan)[missing]
        going = going[missing & grows]
        if not len(going):
            return least
    least[going] = np.nan
    return least


def least_over_turns(turned: Callable[[Places, Array], Array], step: Array) -> Array:
    """The least violation over all turns (n,) [mm].

    It is taken to be convex: turns are bracketed by the signs of slopes, and the next one is in alternation where the
    slope would vanish if it were linear, and where the tangents at both ends meet.

    Args:
        turned: of some trials and a turn in each: that turn, the least violation there, and its slope (3, trials).
        step: turn to begin with (n,) [rad].
    """
    first = turned(np.arange(len(step)), 0.0 * step)
    least, going = first[1], np.flatnonzero(first[2])
    near = first[:, going]
    far = turned(going, -np.sign(near[2]) * step[going])
    while (ahead := (far[2] * near[2] > 0.0) & (np.abs(far[0]) < WIDEST)).any():
        near[:, ahead] = far[:, ahead]
        far[:, ahead] = turned(going[ahead], 2.0 * far[0, ahead])
    least[going] = np.minimum(least[going], np.minimum(near[1], far[1]))
    for k in range(TURNS):
        width, bend = far[0] - near[0], near[2] - far[2]
        meet = (far[1] - near[1] - far[2] * width) / np.where(bend != 0.0, bend, 1.0)  # from `near`
        on = (far[2] * near[2] < 0.0) & (np.abs(width) > LEAST) & (near[1] + near[2] * meet < least[going] - TIGHT)
        going, near, far = going[on], near[:, on], far[:, on]
        if not len(going):
            break
        share = meet[on] / width[on] if k % 2 else near[2] / bend[on]
        share = np.where((share > 0.0) & (share < 1.0), share, 0.5)
        share += np.where(share < 0.5, BEYOND, -BEYOND)
        middle = turned(going, near[0] + share * width[on])
        least[going] = np.minimum(least[going], middle[1])
        follows = middle[2] * near[2] > 0.0
        near, far = np.where(follows, middle, near), np.where(follows, far, middle)
    return np.asarray(least)
