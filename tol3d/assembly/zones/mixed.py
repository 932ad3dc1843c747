"""The domains of an axis whose orientation zone has another shape than its location zone.

With m the middle and d half the difference of the ends, start = m - d and end = m + d, in half widths of the location
zone. One of both zones is round and the other flat, or both are flat in different directions.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from typing_extensions import override

from tol3d.assembly.zones.balls import Line, NormalLine
from tol3d.assembly.zones.cross_section import QUARTER_TURN, Disc, cut_rayleigh
from tol3d.assembly.zones.ends import FlatEnds, room
from tol3d.assembly.zones.face import left_by_a_normal
from tol3d.assembly.zones.inverse import NODES, WEIGHTS, integral, inverse, solved_each
from tol3d.assembly.zones.zone import Domain, Ratio, UnitLaw
from tol3d.numerics.arrays import Array
from tol3d.study.system.normals import Group, scalars, shifted

HALVINGS = 64  # of an interval, to the last digit
TINY = np.finfo(float).tiny
TURNS = QUARTER_TURN * NODES  # rad; of integrals over a quarter turn


@dataclass(frozen=True)
class EndsAlong(Domain):
    """A round zone, refined by a flat one: both ends in discs of radius 1, half their difference along x within ratio.

    Coordinates: start x, start y, end x, end y; x is the direction of the flat zone.
    """

    coordinates = 4

    @property
    def uniform(self) -> UnitLaw:
        return UniformEndsAlong()

    @property
    def normal(self) -> UnitLaw:
        return NormalEndsAlong()

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: each end on its own disc, or where their difference is at its limit, by halving over the middle.

        With the difference at its limit the value is concave in the middle along x, and both ends lie on their discs.
        """
        (a, b, c, d), ratio = gradient, orientation_half / half
        free = [own / (math.hypot(*own) or 1.0) for own in (gradient[:2], gradient[2:])]
        if abs(free[1][0] - free[0][0]) <= 2.0 * ratio:
            return np.asarray(half * np.concatenate(free))
        apart = math.copysign(min(ratio, 1.0), free[1][0] - free[0][0])
        low, high = abs(apart) - 1.0, 1.0 - abs(apart)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            ends = ((b, middle - apart), (d, middle + apart))
            if a + c > sum(abs(side) * x / math.sqrt(max(1.0 - x * x, TINY)) for side, x in ends):
                low = middle
            else:
                high = middle
        start, end = (math.copysign(min(abs(x), 1.0), x) for x in (low - apart, low + apart))
        sides = [math.copysign(math.sqrt(1.0 - x * x), side) for side, x in ((b, start), (d, end))]
        return half * np.array([start, sides[0], end, sides[1]])

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        start, end = coordinates[:, :2], coordinates[:, 2:]
        outside = np.maximum(np.hypot(*start.T), np.hypot(*end.T)) - half
        return np.asarray(np.maximum(outside, 0.5 * np.abs(end[:, 0] - start[:, 0]) - orientation_half))


@dataclass(frozen=True)
class UniformEndsAlong(UnitLaw):
    """Uniform: d along x by its marginal, m along x in what it leaves, then each end across in its disc."""

    uniforms = 4

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        u, v, p, q = uniforms
        most = np.minimum(np.asarray(ratio, dtype=np.float64), 1.0)
        apart = np.copysign(np.minimum(_apart(np.abs(2.0 * u - 1.0) * _share(most)), most), u - 0.5)
        size = np.abs(apart)
        tail = 2.0 * np.minimum(v, 1.0 - v)
        cosine = np.cos(QUARTER_TURN * solved_each(middles, 3, np.cbrt(tail), size))
        middle = np.copysign((1.0 - size) * cosine, v - 0.5)
        start, end = middle - apart, middle + apart
        across = [np.sqrt(np.maximum((1.0 - x) * (1.0 + x), 0.0)) for x in (start, end)]
        return start, across[0] * (2.0 * p - 1.0), end, across[1] * (2.0 * q - 1.0)

    def covariance(self, ratio: float) -> Array:
        return _uniform_covariance(min(ratio, 1.0))


def middles(z: Array, apart: Array) -> Array:
    """Density of z = angle / (pi/2), cos(angle) = m / (1 - d) along x, of ends uniform in their discs with d along x.

    Both discs' chords at m ± d are as long as sqrt(((1 - d)^2 - m^2) ((1 + d)^2 - m^2)) together.
    """
    sine = np.sin(QUARTER_TURN * z)
    square = sine * sine
    left = 4.0 * apart / (1.0 + apart) ** 2  # 1 - ((1 - d) / (1 + d))^2
    return np.asarray(square * np.sqrt(square + left * (1.0 - square)))


def differences(apart: Array) -> Array:
    """Density of d along x, 0 to 1, of ends uniform in their discs, up to a factor."""
    chords = (middles(NODES, apart[..., None]) * WEIGHTS).sum(axis=-1)
    return np.asarray((1.0 - apart) ** 2 * (1.0 + apart) * chords)


def small_differences(z: Array) -> Array:
    """The same of z = 2 d."""
    return differences(0.5 * z)


def large_differences(z: Array) -> Array:
    """The same of z = 2 (1 - d)."""
    return differences(1.0 - 0.5 * z)


@lru_cache(maxsize=1)
def _parting() -> float:
    """Share of differences below a half."""
    small, large = (float(integral(own, np.asarray(1.0))) for own in (small_differences, large_differences))
    return small / (small + large)


def _share(most: Array) -> Array:
    """Share of differences up to a largest one."""
    found = np.empty(np.shape(most))
    small, parting = np.asarray(most <= 0.5), _parting()
    whole = integral(small_differences, np.asarray(1.0)), integral(large_differences, np.asarray(1.0))
    found[small] = parting * integral(small_differences, 2.0 * most[small]) / whole[0]
    found[~small] = 1.0 - (1.0 - parting) * integral(large_differences, 2.0 * (1.0 - most[~small])) / whole[1]
    return found


def _apart(share: Array) -> Array:
    """Differences (trials,) of the shares (trials,) below them, by tables of both halves."""
    parting = _parting()
    small = 0.5 * inverse(small_differences, 1)(np.minimum(share / parting, 1.0))
    rest = np.clip((1.0 - share) / (1.0 - parting), 0.0, 1.0)
    return np.where(share < parting, small, 1.0 - 0.5 * inverse(large_differences, 3)(np.cbrt(rest)))


@lru_cache(maxsize=4096)
def _uniform_covariance(ratio: float) -> Array:
    """By Gauss-Legendre over d along x and the angle of the middle."""
    apart = ratio * NODES
    mass = WEIGHTS * differences(apart)
    of_angle = WEIGHTS * middles(NODES, apart[:, None])
    square = (of_angle * np.cos(TURNS) ** 2).sum(axis=1) / of_angle.sum(axis=1)
    middle, difference = (float(mass @ own / mass.sum()) for own in ((1.0 - apart) ** 2 * square, apart**2))
    across = (1.0 - middle - difference) / 3.0
    found = np.diag([middle + difference, across, middle + difference, across])
    found[0, 2] = found[2, 0] = middle - difference
    return found


@dataclass(frozen=True)
class NormalEndsAlong(UnitLaw):
    """Normal: the middle m as of a point; then d, of sigma ratio / 3 along x and 1/3 across, in what m leaves.

    In units of these sigmas d has a uniform direction, as in a round zone, which this is for a ratio of 1.
    """

    uniforms = 4

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return Group("plane", (0, 1)), Group("plane", (2, 3))

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: the radius and angle of m, the length of d and its angle."""
        u, v, p, q = uniforms
        length, angle, turn = cut_rayleigh(np.ones_like(u), u), 2.0 * math.pi * v, 2.0 * math.pi * q
        along, across = ratio * np.cos(turn), np.sin(turn)
        x, y = np.cos(angle), np.sin(angle)
        left = _left(length, along, across, x * along + y * across, x * across - y * along, np.abs(np.cos(turn)))
        apart = cut_rayleigh(left, p)
        x, y, along, across = length * x, length * y, apart * along, apart * across
        return x - along, y - across, x + along, y + across

    def covariance(self, ratio: float) -> Array:
        return _normal_covariance(ratio)


def _left(length: Array, x: Array, y: Array, along: Array, across: Array, limited: Array) -> Array:
    """Longest half difference in units of a direction (x, y), whose parts along and across the middle are given."""
    size = np.maximum(np.hypot(x, y), TINY)
    return np.minimum(room(length, along / size, across / size) / size, 1.0 / np.maximum(limited, TINY))


@lru_cache(maxsize=4096)
def _normal_covariance(ratio: float) -> Array:
    """By Gauss-Legendre over the middle's length, its angle to the half difference, and the direction of this one."""
    length, beside, turn = np.meshgrid(NODES, TURNS, TURNS, indexing="ij")
    mass = WEIGHTS * NODES * np.exp(-4.5 * NODES**2)
    x, y = ratio * np.cos(turn), np.sin(turn)
    size = np.hypot(x, y)
    left = _left(length, x, y, size * np.cos(beside), size * np.sin(beside), np.cos(turn))
    square = np.einsum("i,j,ijk->k", mass / mass.sum(), WEIGHTS, 2.0 * Disc().normal_variance(left))
    along, across = (float(WEIGHTS @ (square * own)) for own in (ratio**2 * np.cos(TURNS) ** 2, np.sin(TURNS) ** 2))
    middle = float(Disc().normal_variance(np.asarray(1.0)))
    found = np.diag([middle + along, middle + across] * 2)
    found[0, 2] = found[2, 0] = middle - along
    found[1, 3] = found[3, 1] = middle - across
    return found


@dataclass(frozen=True)
class FlatEndsRound(Domain):
    """A flat zone, refined by a round one: both ends within ±1 along it, half their difference in a disc of ratio.

    Coordinates: start and end along the direction of the zone, half the difference across it.
    """

    coordinates = 3

    @property
    def uniform(self) -> UnitLaw:
        return UniformFlatEndsRound()

    @property
    def normal(self) -> UnitLaw:
        return NormalFlatEndsRound()

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: on the disc, where a longer half difference takes as much of the middle as it gives."""
        both, apart, across = gradient[1] + gradient[0], gradient[1] - gradient[0], gradient[2]
        gain = max(abs(apart) - abs(both), 0.0)
        size = math.hypot(gain, across)
        difference = math.copysign(orientation_half * gain / size, apart) if gain > 0.0 else 0.0
        middle = math.copysign(half - abs(difference), both)
        left = math.sqrt(max((orientation_half - difference) * (orientation_half + difference), 0.0))
        return np.array([middle - difference, middle + difference, math.copysign(left, across)])

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        start, end, across = coordinates.T
        outside = np.maximum(np.abs(start), np.abs(end)) - half
        return np.asarray(np.maximum(outside, np.hypot(0.5 * (end - start), across) - orientation_half))


@dataclass(frozen=True)
class UniformFlatEndsRound(UnitLaw):
    """Uniform: d along the zone by its marginal, then m and d across in what it leaves."""

    uniforms = 3

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        u, v, p = uniforms
        tail = 2.0 * np.minimum(u, 1.0 - u)
        most = np.broadcast_to(np.asarray(ratio, dtype=np.float64), np.shape(u))
        angle = QUARTER_TURN * solved_each(leans, 3, np.cbrt(tail), most)
        apart = np.copysign(ratio * np.cos(angle), u - 0.5)
        middle = (1.0 - np.abs(apart)) * (2.0 * v - 1.0)
        return middle - apart, middle + apart, ratio * np.sin(angle) * (2.0 * p - 1.0)

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: by Gauss-Legendre over the angle."""
        mass = WEIGHTS * leans(NODES, np.asarray(ratio))
        apart = ratio * np.cos(TURNS)
        squares = apart**2, (1.0 - apart) ** 2 / 3.0, (ratio * np.sin(TURNS)) ** 2 / 3.0
        return _flat_covariance(*(float(mass @ square / mass.sum()) for square in squares))


def leans(z: Array, ratio: Array) -> Array:
    """Density of z = angle / (pi/2), cos(angle) = d / ratio along the zone, of m and d uniform in theirs."""
    angle = QUARTER_TURN * z
    return np.asarray(np.sin(angle) ** 2 * (1.0 - ratio + 2.0 * ratio * np.sin(0.5 * angle) ** 2))


@dataclass(frozen=True)
class NormalFlatEndsRound(UnitLaw):
    """Normal: the middle as of a point; d in a uniform direction, of sigma ratio / 3, in what the middle leaves."""

    uniforms = 3

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return (*scalars(1), *shifted((Group("plane", (0, 1)),), 1))

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: m, the length of d and its angle."""
        u, p, q = uniforms
        (middle,) = NormalLine().coordinates(ratio, u)
        x, y = np.cos(2.0 * math.pi * q), np.sin(2.0 * math.pi * q)
        left = np.minimum((1.0 - np.abs(middle)) / np.maximum(ratio * np.abs(x), TINY), 1.0)
        apart = ratio * cut_rayleigh(left, p)
        return middle - apart * x, middle + apart * x, apart * y

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: by Gauss-Legendre over the angle of d."""
        square = 2.0 * ratio**2 * np.array([left_by_a_normal(Disc().normal_variance, ratio * x) for x in np.cos(TURNS)])
        along, across = (float((WEIGHTS * square) @ own) for own in (np.cos(TURNS) ** 2, np.sin(TURNS) ** 2))
        return _flat_covariance(along, float(NormalLine().covariance(ratio)[0, 0]), across)


def _flat_covariance(apart: float, middle: float, across: float) -> Array:
    found = np.diag([middle + apart, middle + apart, across])
    found[0, 1] = found[1, 0] = middle - apart
    return found


@dataclass(frozen=True)
class FlatEndsAlong(Domain):
    """Two flat zones: both ends within ±1 along one direction, half their difference within ratio along another.

    Coordinates: start and end along the location zone, half the difference along the orientation zone; these are
    independent.
    """

    coordinates = 3

    @property
    def uniform(self) -> UnitLaw:
        return Beside(FlatEnds().uniform, Line().uniform)

    @property
    def normal(self) -> UnitLaw:
        return Beside(FlatEnds().normal, Line().normal)

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        ends = FlatEnds().furthest(gradient[:2], half, half)
        return np.append(ends, math.copysign(orientation_half, gradient[2]))

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        ends = FlatEnds().excess(coordinates[:, :2], half, half)
        return np.asarray(np.maximum(ends, np.abs(coordinates[:, 2]) - orientation_half))


@dataclass(frozen=True)
class Beside(UnitLaw):
    """Two independent laws: of the location zone, unrefined, and of the orientation zone."""

    location: UnitLaw
    orientation: UnitLaw

    @property
    def uniforms(self) -> int:
        """Those of both."""
        return self.location.uniforms + self.orientation.uniforms

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        own = self.location.groups(1.0)
        return (*own, *shifted(self.orientation.groups(1.0), self.location.uniforms))

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        count = self.location.uniforms
        turned = self.orientation.coordinates(1.0, *uniforms[count:])
        return (*self.location.coordinates(1.0, *uniforms[:count]), *(ratio * own for own in turned))

    def covariance(self, ratio: float) -> Array:
        own, turned = self.location.covariance(1.0), ratio**2 * self.orientation.covariance(1.0)
        found = np.zeros((len(own) + len(turned),) * 2)
        found[: len(own), : len(own)], found[len(own) :, len(own) :] = own, turned
        return found
