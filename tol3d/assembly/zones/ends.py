"""The domain of an axis in a round zone: both ends within discs of radius 1, half their difference within ratio.

With m the middle and d half the difference of the ends, start = m - d and end = m + d. See half_difference.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from typing_extensions import override

from tol3d.assembly.zones.balls import NormalLine
from tol3d.assembly.zones.cross_section import (
    QUARTER_TURN,
    SIGMAS,
    UNIFORM_DIFFERENCE,
    Disc,
    cut_normal,
    cut_rayleigh,
    cut_variance,
    uniform_lens,
)
from tol3d.assembly.zones.face import left_by_a_normal
from tol3d.assembly.zones.inverse import NODES, WEIGHTS, inverse
from tol3d.assembly.zones.zone import Domain, Ratio, UnitLaw
from tol3d.numerics.arrays import Array
from tol3d.study.system.normals import Group, scalars

ROUNDING = 1e-12


@dataclass(frozen=True)
class Ends(Domain):
    """Coordinates: start x, start y, end x, end y."""

    coordinates = 4

    @property
    def uniform(self) -> UnitLaw:
        return UniformEnds()

    @property
    def normal(self) -> UnitLaw:
        return NormalEnds()

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: the best, of equals the first, of the few points at which a linear function may be largest."""
        start, end = complex(*gradient[:2]), complex(*gradient[2:])
        ratio = orientation_half / half
        edge = _unit(start + end)
        found = [
            (_facing(start, end, ratio), _facing(end, start, ratio)),
            (edge + 2.0 * ratio * _unit(start), edge),
            (edge, edge + 2.0 * ratio * _unit(end)),
            (ratio * _unit(start), -ratio * _unit(start)),  # of a couple
        ]
        side = complex(math.sqrt(max(1.0 - ratio * ratio, 0.0)), ratio)  # both on the edge, as far apart as may be
        for turn in (side, side.conjugate()):
            along = _unit(start * turn + end * turn.conjugate())
            found.append((along * turn.conjugate(), along * turn))
        points = [np.array([s.real, s.imag, e.real, e.imag]) for s, e in found if _is_allowed(s, e, ratio)]
        reached = np.array([float(point @ gradient) for point in points])
        furthest = float(reached.max())
        return half * points[int(np.argmax(reached >= furthest - ROUNDING * abs(furthest)))]

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        start, end = coordinates[:, :2], coordinates[:, 2:]
        lengths = [np.hypot(own[:, 0], own[:, 1]) for own in (start, end, 0.5 * (end - start))]
        return np.maximum(np.maximum(lengths[0], lengths[1]) - half, lengths[2] - orientation_half)


@dataclass(frozen=True)
class UniformEnds(UnitLaw):
    """Uniform: two independent discs, or half the difference by its marginal and the middle uniform in the lens."""

    uniforms = 4

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        if isinstance(ratio, float) and ratio >= 1.0:
            return Group("plane", (0, 1)), Group("plane", (2, 3))
        return Group("plane", (0, 3)), *scalars(2, 1)

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: the radius and angle of each end; refined: length of d, m along and across d, angle of d."""
        u, v, p, q = uniforms
        if isinstance(ratio, float) and ratio >= 1.0:
            return *Disc().uniform(_ONE, u, v), *Disc().uniform(_ONE, p, q)
        angle = UNIFORM_DIFFERENCE.angle(ratio, u)
        tail = 2.0 * np.minimum(v, 1.0 - v)
        segment = np.cbrt((angle - np.sin(angle) * np.cos(angle)) * tail / QUARTER_TURN)  # of a half disc
        inner = np.minimum(QUARTER_TURN * inverse(uniform_lens, 3)(segment), angle)
        return _ends(angle, np.copysign(inner, v - 0.5), np.sin(inner) * (2.0 * p - 1.0), q)

    def covariance(self, ratio: float) -> Array:
        if ratio >= 1.0:
            return 0.25 * np.eye(4)
        return _uniform_covariance(ratio)


@dataclass(frozen=True)
class NormalEnds(UnitLaw):
    """Normal: the middle m as of a point in the disc; d in a uniform direction, as far as m leaves, sigma ratio / 3."""

    uniforms = 4

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return Group("plane", (0, 1)), Group("plane", (2, 3))

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: the radius and angle of m, the length of d and its angle against m."""
        u, v, p, q = uniforms
        length, angle, turn = cut_rayleigh(_ONE, u), (2.0 * math.pi) * v, (2.0 * math.pi) * q
        left = np.minimum(room(length, np.cos(turn), np.sin(turn)) / ratio, 1.0)
        apart, direction = ratio * cut_rayleigh(left, p), angle + turn
        x, y = length * np.cos(angle), length * np.sin(angle)
        a, b = apart * np.cos(direction), apart * np.sin(direction)
        return x - a, y - b, x + a, y + b

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: middle and half difference do not correlate, for d and -d are as likely."""
        middle, apart = float(Disc().normal_variance(_ONE)), _normal_difference(ratio)
        return np.kron(np.array([[middle + apart, middle - apart], [middle - apart, middle + apart]]), np.eye(2))


def room(length: Array, along: Array, across: Array) -> Array:
    """Longest half difference in a direction (along, across) to both sides of a middle of a length, in a disc of 1."""
    chord = np.sqrt(np.maximum(1.0 - (length * across) ** 2, 0.0)) + length * np.abs(along)
    return np.asarray((1.0 - length) * (1.0 + length) / np.maximum(chord, np.finfo(float).tiny))


@lru_cache(maxsize=4096)
def _normal_difference(ratio: float) -> float:
    """Variance of each coordinate of a normal half difference, by Gauss-Legendre over the middle's length and angle.

    A middle up to `near` leaves all of the ratio; beyond it sine substitutes the length, for the room's root.
    """
    turn = 0.5 * math.pi * NODES[:, None]
    along, across = np.cos(turn), np.sin(turn)
    near = np.sqrt(np.maximum(1.0 - (ratio * across) ** 2, 0.0)) - ratio * along
    start = np.arcsin(np.clip(near, 0.0, 1.0))
    place = start + (0.5 * math.pi - start) * NODES
    length = np.sin(place)
    rayleigh = SIGMAS**2 * length * np.exp(-0.5 * (SIGMAS * length) ** 2)
    mass = WEIGHTS * (0.5 * math.pi - start) * np.cos(place) * rayleigh
    variance = Disc().normal_variance(np.minimum(room(length, along, across) / ratio, 1.0))
    whole = -np.expm1(-0.5 * (SIGMAS * near) ** 2) * float(Disc().normal_variance(_ONE))
    total = float((WEIGHTS * (whole[:, 0] + (mass * variance).sum(axis=1))).sum())
    return ratio**2 * total / -math.expm1(-0.5 * SIGMAS**2)


def _ends(angle: Array, inner: Array, across: Array, turn: Array) -> tuple[Array, ...]:
    """Both ends of an axis whose middle lies at ±inner along d and `across` it; d in direction 2 pi turn."""
    half = np.cos(angle)
    along = np.copysign(np.cos(inner) - half, inner)
    direction = (2.0 * math.pi) * turn
    cosine, sine = np.cos(direction), np.sin(direction)
    x, y = -sine * across, cosine * across
    before, after = along - half, along + half
    return x + cosine * before, y + sine * before, x + cosine * after, y + sine * after


def _uniform_covariance(ratio: float) -> Array:
    """By Gauss-Legendre over the half difference and the lens in which the middle lies."""
    angle, mass = UNIFORM_DIFFERENCE.quadrature(ratio)
    angle, mass = angle[:, None], mass[:, None]
    shares = WEIGHTS * uniform_lens(NODES, angle / QUARTER_TURN)
    shares = mass * shares / shares.sum(axis=1, keepdims=True)
    along = np.cos(angle * NODES) - np.cos(angle)
    of_middle = 0.5 * float((shares * (along**2 + np.sin(angle * NODES) ** 2 / 3.0)).sum())
    of_difference = 0.5 * float((mass * np.cos(angle) ** 2).sum())
    own, shared = of_middle + of_difference, of_middle - of_difference
    return np.kron(np.array([[own, shared], [shared, own]]), np.eye(2))


def _unit(value: complex) -> complex:
    return value / abs(value) if value else 1.0 + 0.0j


def _facing(own: complex, other: complex, ratio: float) -> complex:
    """Where an end with this gradient goes by itself; one without gradient no further than the other takes it."""
    return _unit(own) if own or not other else max(0.0, 1.0 - 2.0 * ratio) * _unit(other)


def _is_allowed(start: complex, end: complex, ratio: float) -> bool:
    return max(abs(start), abs(end), abs(end - start) / (2.0 * ratio)) <= 1.0 + ROUNDING


_ONE = np.asarray(1.0)


@dataclass(frozen=True)
class FlatEnds(Domain):
    """Coordinates: start and end along the direction of the zone; with middle and half difference |m| + |d| <= 1."""

    coordinates = 2

    @property
    def uniform(self) -> UnitLaw:
        return UniformFlatEnds()

    @property
    def normal(self) -> UnitLaw:
        return NormalFlatEnds()

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: a corner of the hexagon."""
        both, apart = gradient[1] + gradient[0], gradient[1] - gradient[0]
        difference = math.copysign(orientation_half, apart) if abs(apart) > abs(both) else 0.0
        middle = math.copysign(half - abs(difference), both)
        return np.array([middle - difference, middle + difference])

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        start, end = coordinates.T
        outside = np.maximum(np.abs(start), np.abs(end)) - half
        return np.asarray(np.maximum(outside, 0.5 * np.abs(end - start) - orientation_half))


@dataclass(frozen=True)
class UniformFlatEnds(UnitLaw):
    """Uniform: |d| by its marginal, proportional to 1 - |d|, then the middle."""

    uniforms = 2

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: closed, for the distribution function of |d| is a square."""
        u, v = uniforms
        if isinstance(ratio, float) and ratio >= 1.0:
            return 2.0 * u - 1.0, 2.0 * v - 1.0
        square = np.abs(2.0 * u - 1.0) * (ratio * (2.0 - ratio))
        difference = np.copysign(np.minimum(square / (1.0 + np.sqrt(1.0 - square)), ratio), u - 0.5)
        middle = (1.0 - np.abs(difference)) * (2.0 * v - 1.0)
        return middle - difference, middle + difference

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: integrals of d^2 (1 - d) and (1 - d)^3 / 3."""
        mass = ratio - 0.5 * ratio**2
        apart = (ratio**3 / 3.0 - ratio**4 / 4.0) / mass
        middle = (1.0 - (1.0 - ratio) ** 4) / (12.0 * mass)
        return np.array([[middle + apart, middle - apart], [middle - apart, middle + apart]])


@dataclass(frozen=True)
class NormalFlatEnds(UnitLaw):
    """Normal: the middle as of a point, then half the difference, of sigma ratio / 3, in what the middle leaves."""

    uniforms = 2

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        u, v = uniforms
        (middle,) = NormalLine().coordinates(ratio, u)
        difference = ratio * cut_normal(np.minimum((1.0 - np.abs(middle)) / ratio, 1.0), v)
        return middle - difference, middle + difference

    def covariance(self, ratio: float) -> Array:
        middle, apart = NormalLine().covariance(ratio)[0, 0], ratio**2 * left_by_a_normal(cut_variance, ratio)
        return np.array([[middle + apart, middle - apart], [middle - apart, middle + apart]])
