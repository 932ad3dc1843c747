"""The domain of an axis in a round zone: both ends within discs of radius 1, half their difference within ratio.

With m the middle and d half the difference of the ends, start = m - d and end = m + d. See half_difference.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import erf, ndtri

from tol3d.assembly.zones.cross_section import SIGMAS, Disc
from tol3d.assembly.zones.domain import Array, Domain, Ratio, UnitLaw
from tol3d.assembly.zones.end_density import normal_end, start_density, uniform_end
from tol3d.assembly.zones.half_difference import (
    NORMAL_DIFFERENCE,
    QUARTER_TURN,
    UNIFORM_DIFFERENCE,
    HalfDifference,
    normal_lens,
    uniform_lens,
)
from tol3d.assembly.zones.inverse import NODES, WEIGHTS, Density, inverse, inverse_family

CUT_SIGMAS = math.sqrt(2.0) * SIGMAS  # in a half width: of the middle and of half the difference of two normal ends
ROUNDING = 1e-12


@dataclass(frozen=True)
class Ends(Domain):
    """Coordinates: start x, start y, end x, end y."""

    coordinates = 4

    @property
    def uniform(self) -> UnitLaw:
        """See Domain."""
        return UniformEnds()

    @property
    def normal(self) -> UnitLaw:
        """See Domain."""
        return NormalEnds()

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: the best of the few points at which a linear function may have its maximum."""
        start, end = complex(*gradient[:2]), complex(*gradient[2:])
        ratio = orientation_half / half
        edge = _unit(start + end)
        found = [
            (_unit(start), _unit(end)),
            (edge + 2.0 * ratio * _unit(start), edge),
            (edge, edge + 2.0 * ratio * _unit(end)),
            (ratio * _unit(start), -ratio * _unit(start)),  # of a couple
        ]
        side = complex(math.sqrt(max(1.0 - ratio * ratio, 0.0)), ratio)  # both on the edge, as far apart as may be
        for turn in (side, side.conjugate()):
            along = _unit(start * turn + end * turn.conjugate())
            found.append((along * turn.conjugate(), along * turn))
        points = [np.array([s.real, s.imag, e.real, e.imag]) for s, e in found if _is_allowed(s, e, ratio)]
        return half * max(points, key=lambda point: float(point @ gradient))

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        """See Domain."""
        start, end = coordinates[:, :2], coordinates[:, 2:]
        lengths = [np.hypot(own[:, 0], own[:, 1]) for own in (start, end, 0.5 * (end - start))]
        return np.maximum(np.maximum(lengths[0], lengths[1]) - half, lengths[2] - orientation_half)


@dataclass(frozen=True)
class UniformEnds(UnitLaw):
    """Uniform: two independent discs, or half the difference by its marginal and the middle uniform in the lens."""

    uniforms = 4

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: the radius and angle of each end; refined: length of d, m along and across d, angle of d."""
        u, v, p, q = uniforms
        if isinstance(ratio, float) and ratio >= 1.0:
            return *Disc().uniform(_ONE, u, v), *Disc().uniform(_ONE, p, q)
        angle = UNIFORM_DIFFERENCE.angle(ratio, u)
        tail = 2.0 * np.minimum(v, 1.0 - v)
        segment = np.cbrt((angle - np.sin(angle) * np.cos(angle)) * tail / QUARTER_TURN)  # of a half disc
        inner = np.minimum(QUARTER_TURN * inverse(uniform_lens, 3, 1.0)(segment), angle)
        return _ends(angle, np.copysign(inner, v - 0.5), np.sin(inner) * (2.0 * p - 1.0), q)

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw."""
        if ratio >= 1.0:
            return 0.25 * np.eye(4)
        return _covariance(UNIFORM_DIFFERENCE, uniform_lens, lambda reach: reach**2 / 3.0, ratio)

    def density(self, ratio: float, first: Array) -> Array:
        """See UnitLaw."""
        return start_density(uniform_end, ratio, first)


@dataclass(frozen=True)
class NormalEnds(UnitLaw):
    """Normal: ends of sigma 1/3, so that middle and half the difference are independent but for the limits."""

    uniforms = 4

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: the radius and angle of each end; refined: length of d, m along and across d, angle of d."""
        u, v, p, q = uniforms
        if isinstance(ratio, float) and ratio >= 1.0:
            return *Disc().normal(_ONE, u, v), *Disc().normal(_ONE, p, q)
        angle = NORMAL_DIFFERENCE.angle(ratio, u)
        tail = 2.0 * np.minimum(v, 1.0 - v)
        inner = angle * inverse_family(normal_lens, 3)(np.cbrt(tail), angle / QUARTER_TURN)
        reach = np.sin(inner)
        across = ndtri(0.5 + (p - 0.5) * erf(SIGMAS * reach)) / CUT_SIGMAS
        across = np.minimum(np.maximum(across, -reach), reach)
        return _ends(angle, np.copysign(inner, v - 0.5), across, q)

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw."""
        if ratio >= 1.0:
            return float(Disc().normal_variance(_ONE)) * np.eye(4)
        return _covariance(NORMAL_DIFFERENCE, normal_lens, cut_variance, ratio)

    def density(self, ratio: float, first: Array) -> Array:
        """See UnitLaw."""
        return start_density(normal_end, ratio, first)


def cut_variance(reach: Array) -> Array:
    """Of a normal middle [squared half widths], truncated at ±reach."""
    limit = CUT_SIGMAS * reach
    cut = limit * math.sqrt(2.0 / math.pi) * np.exp(-0.5 * limit * limit) / erf(SIGMAS * reach)
    return np.asarray((1.0 - cut) / CUT_SIGMAS**2)


def _ends(angle: Array, inner: Array, across: Array, turn: Array) -> tuple[Array, ...]:
    """Both ends of an axis whose middle lies at ±inner along d and `across` it; d in direction 2 pi turn."""
    half = np.cos(angle)
    along = np.copysign(np.cos(inner) - half, inner)
    direction = (2.0 * math.pi) * turn
    cosine, sine = np.cos(direction), np.sin(direction)
    x, y = -sine * across, cosine * across
    before, after = along - half, along + half
    return x + cosine * before, y + sine * before, x + cosine * after, y + sine * after


def _covariance(law: HalfDifference, lens: Density, variance: Callable[[Array], Array], ratio: float) -> Array:
    """By Gauss-Legendre; `variance` is that of the middle across d, where the lens reaches so far."""
    angle, mass = law.quadrature(ratio)
    angle, mass = angle[:, None], mass[:, None]
    shares = WEIGHTS * lens(NODES, angle / QUARTER_TURN)
    shares = mass * shares / shares.sum(axis=1, keepdims=True)
    along = np.cos(angle * NODES) - np.cos(angle)
    of_middle = 0.5 * float((shares * (along**2 + variance(np.sin(angle * NODES)))).sum())
    of_difference = 0.5 * float((mass * np.cos(angle) ** 2).sum())
    own, shared = of_middle + of_difference, of_middle - of_difference
    return np.kron(np.array([[own, shared], [shared, own]]), np.eye(2))


def _unit(value: complex) -> complex:
    return value / abs(value) if value else 1.0 + 0.0j


def _is_allowed(start: complex, end: complex, ratio: float) -> bool:
    return max(abs(start), abs(end), abs(end - start) / (2.0 * ratio)) <= 1.0 + ROUNDING


_ONE = np.asarray(1.0)
