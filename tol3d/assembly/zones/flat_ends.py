"""The domain of an axis between two lines: both ends within ±1, half their difference within ratio."""

import math
from dataclasses import dataclass

import numpy as np

from tol3d.assembly.zones.balls import NormalLine
from tol3d.assembly.zones.cross_section import cut_normal, cut_variance
from tol3d.assembly.zones.domain import Array, Domain, Ratio, UnitLaw
from tol3d.assembly.zones.face import left_by_a_normal


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


@dataclass(frozen=True)
class NormalFlatEnds(UnitLaw):
    """Normal: the middle as of a point, then half the difference, of sigma ratio / 3, in what the middle leaves."""

    uniforms = 2

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw."""
        u, v = uniforms
        (middle,) = NormalLine().coordinates(ratio, u)
        difference = ratio * cut_normal(np.minimum((1.0 - np.abs(middle)) / ratio, 1.0), v)
        return middle - difference, middle + difference

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw."""
        middle, apart = NormalLine().covariance(ratio)[0, 0], ratio**2 * left_by_a_normal(cut_variance, ratio)
        return np.array([[middle + apart, middle - apart], [middle - apart, middle + apart]])
