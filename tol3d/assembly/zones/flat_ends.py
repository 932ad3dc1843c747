"""The domain of an axis between two lines: both ends within ±1, half their difference within ratio."""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.special import erf, ndtr, ndtri

from tol3d.assembly.zones.balls import NormalLine
from tol3d.assembly.zones.cross_section import SIGMAS
from tol3d.assembly.zones.domain import Array, Domain, Ratio, UnitLaw
from tol3d.assembly.zones.ends import CUT_SIGMAS, cut_variance
from tol3d.assembly.zones.inverse import NODES, WEIGHTS, InverseTable, integral, inverse, table


@dataclass(frozen=True)
class FlatEnds(Domain):
    """Coordinates: start and end along the direction of the zone; with middle and half difference |m| + |d| <= 1."""

    coordinates = 2

    @property
    def uniform(self) -> UnitLaw:
        """See Domain."""
        return UniformFlatEnds()

    @property
    def normal(self) -> UnitLaw:
        """See Domain."""
        return NormalFlatEnds()

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: a corner of the hexagon."""
        both, apart = gradient[1] + gradient[0], gradient[1] - gradient[0]
        difference = math.copysign(orientation_half, apart) if abs(apart) > abs(both) else 0.0
        middle = math.copysign(half - abs(difference), both)
        return np.array([middle - difference, middle + difference])

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        """See Domain."""
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

    def density(self, ratio: float, first: Array) -> Array:
        """See UnitLaw: how far the other end may move."""
        return np.minimum(first + 2.0 * ratio, 1.0) - np.maximum(first - 2.0 * ratio, -1.0)


@dataclass(frozen=True)
class NormalFlatEnds(UnitLaw):
    """Normal: ends of sigma 1/3, so that middle and half the difference are independent but for the limits."""

    uniforms = 2

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: |d| by a table of 1 - |d|, which an orientation zone only cuts off."""
        u, v = uniforms
        if isinstance(ratio, float) and ratio >= 1.0:
            return *NormalLine().coordinates(1.0, u), *NormalLine().coordinates(1.0, v)
        share = np.abs(2.0 * u - 1.0) * (_share(ratio) if isinstance(ratio, float) else _shares()(ratio))
        difference = np.minimum(1.0 - inverse(room, 2, 1.0)(np.sqrt(1.0 - share)), ratio)
        reach = 1.0 - difference
        middle = ndtri(0.5 + (v - 0.5) * erf(SIGMAS * reach)) / CUT_SIGMAS
        middle = np.minimum(np.maximum(middle, -reach), reach)
        difference = np.copysign(difference, u - 0.5)
        return middle - difference, middle + difference

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: by Gauss-Legendre."""
        mass = WEIGHTS * room(1.0 - ratio * NODES, _ONE)
        mass = mass / mass.sum()
        apart = float(mass @ (ratio * NODES) ** 2)
        middle = float(mass @ cut_variance(1.0 - ratio * NODES))
        return np.array([[middle + apart, middle - apart], [middle - apart, middle + apart]])

    def density(self, ratio: float, first: Array) -> Array:
        """See UnitLaw."""
        high, low = np.minimum(first + 2.0 * ratio, 1.0), np.maximum(first - 2.0 * ratio, -1.0)
        return np.asarray(np.exp(-0.5 * (SIGMAS * first) ** 2) * (ndtr(SIGMAS * high) - ndtr(SIGMAS * low)))


def room(reach: Array, unused: Array) -> Array:
    """Density of 1 - |d| for normal ends: the middle lies within ±that."""
    return np.asarray(np.exp(-((SIGMAS * (1.0 - reach)) ** 2)) * erf(SIGMAS * reach))


def _apart(difference: Array, unused: Array) -> Array:
    """Density of |d| for normal ends."""
    return room(1.0 - difference, unused)


def _share(ratio: float) -> float:
    """The probability that |d| <= ratio."""
    return float(integral(_apart, np.asarray(ratio), _ONE) / integral(_apart, _ONE, _ONE))


@cache
def _shares() -> InverseTable:
    return table(lambda ratio: integral(_apart, ratio, _ONE) / integral(_apart, _ONE, _ONE))


_ONE = np.asarray(1.0)
