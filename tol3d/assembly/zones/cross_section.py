"""Cross-sections of a plane's domain at one height: a diamond of both rises for a rectangle, else a disc."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import erf, ndtri

from tol3d.assembly.zones.inverse import NODES, WEIGHTS, Density, InverseTable, integral, inverse, table
from tol3d.assembly.zones.zone import Ratio
from tol3d.numerics.arrays import Array
from tol3d.study.system.normals import Group, scalars

SIGMAS = 3.0  # of a normal coordinate within its largest value


class CrossSection(ABC):
    """The set of both rises, of a radius r: its largest rise.

    The normal law has sigma 1/3 where the largest radius is 1, and is conditioned on the section.
    """

    @abstractmethod
    def uniform(self, radius: Array, u: Array, v: Array) -> tuple[Array, Array]:
        """Both rises (trials,), uniform in sections of radii (trials,)."""

    @abstractmethod
    def normal(self, radius: Array, u: Array, v: Array) -> tuple[Array, Array]:
        """Both rises (trials,), normal and within sections of radii (trials,) up to 1."""

    @property
    def groups(self) -> tuple[Group, ...]:
        """Groups of the two uniforms, see Smooth: each by itself."""
        return scalars(2)

    @property
    @abstractmethod
    def uniform_variance(self) -> float:
        """Variance of each rise, uniform in the section of radius 1."""

    @abstractmethod
    def normal_variance(self, radius: Array) -> Array:
        """Variance of each rise, normal and within the section."""

    @abstractmethod
    def length(self, rises: Array) -> Array:
        """The smallest radius that holds rises (..., 2): a norm."""

    @abstractmethod
    def furthest(self, gradient: Array) -> Array:
        """The point (2,) of the section of radius 1 that lies furthest along a gradient (2,)."""


@dataclass(frozen=True)
class Diamond(CrossSection):
    """|x| + |y| <= r: (x + y, x - y) lie each within ±r and are independent under both laws."""

    def uniform(self, radius: Array, u: Array, v: Array) -> tuple[Array, Array]:
        return radius * (u + v - 1.0), radius * (u - v)

    def normal(self, radius: Array, u: Array, v: Array) -> tuple[Array, Array]:
        """See CrossSection: both diagonals are truncated normals of the rises' own sigma."""
        kept = erf((0.5 * SIGMAS) * radius)
        limit = math.sqrt(0.5) * radius
        first, second = (_cut(ndtri(0.5 + (own - 0.5) * kept) / SIGMAS, limit) for own in (u, v))
        return math.sqrt(0.5) * (first + second), math.sqrt(0.5) * (first - second)

    @property
    def uniform_variance(self) -> float:
        return 1.0 / 6.0

    def normal_variance(self, radius: Array) -> Array:
        """See CrossSection: that of a truncated normal."""
        return cut_variance(math.sqrt(0.5) * radius)

    def length(self, rises: Array) -> Array:
        return np.asarray(np.abs(rises).sum(axis=-1))

    def furthest(self, gradient: Array) -> Array:
        """See CrossSection: a corner."""
        x, y = gradient
        return np.array([_sign(x), 0.0]) if abs(x) >= abs(y) else np.array([0.0, _sign(y)])


@dataclass(frozen=True)
class Disc(CrossSection):
    """hypot(x, y) <= r: by radius and angle."""

    groups = (Group("plane", (0, 1)),)

    def uniform(self, radius: Array, u: Array, v: Array) -> tuple[Array, Array]:
        """See CrossSection: the square of the radius is uniform."""
        return _turned(radius * np.sqrt(u), v)

    def normal(self, radius: Array, u: Array, v: Array) -> tuple[Array, Array]:
        return _turned(cut_rayleigh(radius, u), v)

    @property
    def uniform_variance(self) -> float:
        return 0.25

    def normal_variance(self, radius: Array) -> Array:
        """See CrossSection: half that of the radius' square, a truncated exponential."""
        square = np.maximum(0.5 * (SIGMAS * radius) ** 2, np.finfo(float).tiny)
        return np.asarray((1.0 - square / np.expm1(square)) / SIGMAS**2)

    def length(self, rises: Array) -> Array:
        return np.asarray(np.hypot(rises[..., 0], rises[..., 1]))

    def furthest(self, gradient: Array) -> Array:
        size = math.hypot(*gradient)
        return gradient / size if size > 0.0 else np.array([1.0, 0.0])


def cut_rayleigh(limit: Array, u: Array) -> Array:
    """Length (trials,) of two normals of sigma 1/3, truncated at limits (trials,), of uniforms (trials,)."""
    kept = -np.expm1(-0.5 * (SIGMAS * limit) ** 2)
    return np.minimum(np.sqrt(-2.0 * np.log1p(-u * kept)) / SIGMAS, limit)


def cut_normal(limit: Array, u: Array) -> Array:
    """Normal of sigma 1/3, truncated at ±limits (trials,), of uniforms (trials,)."""
    return _cut(ndtri(0.5 + (u - 0.5) * erf(math.sqrt(0.5) * SIGMAS * limit)) / SIGMAS, limit)


def cut_variance(limit: Array) -> Array:
    """Variance of a normal of sigma 1/3, truncated at ±limits."""
    z = np.maximum(SIGMAS * limit, np.finfo(float).tiny)
    cut = z * math.sqrt(2.0 / math.pi) * np.exp(-0.5 * z * z) / erf(math.sqrt(0.5) * z)
    return np.asarray((1.0 - cut) / SIGMAS**2)


def _cut(value: Array, limit: Array) -> Array:
    """Within ±limit; rounding alone left it."""
    return np.minimum(np.maximum(value, -limit), limit)


def _turned(length: Array, v: Array) -> tuple[Array, Array]:
    """Components of a length at an angle of 2 pi v."""
    angle = 2.0 * math.pi * v
    return length * np.cos(angle), length * np.sin(angle)


def _sign(value: float) -> float:
    return -1.0 if value < 0.0 else 1.0


QUARTER_TURN = 0.5 * math.pi
HALF_RANGE = 0.25 * math.pi  # rad; where the tables of small and of large differences meet


@dataclass(frozen=True)
class HalfDifference:
    """Law of |d|, by the complement of the angle: |d| = sin(complement).

    Args:
        small: density of complement / HALF_RANGE, from 0 to 2.
        large: the same of angle / HALF_RANGE.
    """

    small: Density
    large: Density

    def angle(self, ratio: Ratio, u: Array) -> Array:
        """Angles (trials,) of the lens, of uniforms (trials,), where |d| <= ratio."""
        share = u * (self._share(ratio) if isinstance(ratio, float) else self._shares(ratio))
        parting = self._parting
        complement = HALF_RANGE * inverse(self.small, 2)(np.sqrt(np.minimum(share / parting, 1.0)))
        angle = QUARTER_TURN - complement
        if not isinstance(ratio, float) or ratio > math.sin(HALF_RANGE):
            rest = np.minimum((1.0 - share) / (1.0 - parting), 1.0)
            angle = np.where(share < parting, angle, HALF_RANGE * inverse(self.large, 5)(rest**0.2))
        return np.maximum(angle, np.arccos(ratio))

    def quadrature(self, ratio: float) -> tuple[Array, Array]:
        """Angles and their probabilities, for means of smooth functions where |d| <= ratio."""
        complement = math.asin(ratio) * NODES
        mass = WEIGHTS * self.small(complement / HALF_RANGE)
        return QUARTER_TURN - complement, mass / mass.sum()

    def _share(self, ratio: float) -> float:
        """The probability that |d| <= ratio."""
        within = integral(self.small, np.asarray(math.asin(ratio) / HALF_RANGE))
        return float(within / integral(self.small, np.asarray(2.0)))

    def _shares(self, ratio: Array) -> Array:
        place = np.arcsin(ratio) / QUARTER_TURN
        return np.asarray(place * place * self._table(place))

    @cached_property
    def _parting(self) -> float:
        return self._share(math.sin(HALF_RANGE))

    @cached_property
    def _table(self) -> InverseTable:
        whole = integral(self.small, np.asarray(2.0))
        return table(lambda place: integral(self.small, 2.0 * place) / (whole * place * place))


def uniform_lens(z: Array, size: Ratio = 1.0) -> Array:
    """Density of inner / angle, angle = size pi/2, of a middle uniform in the lens.

    The middle's distance along d is cos(inner) - cos(angle), and the lens there reaches ±sin(inner) across.
    """
    return np.asarray(np.sin(QUARTER_TURN * size * z) ** 2)


def uniform_small(z: Array) -> Array:
    """Density of the complement for uniform ends: |d| d|d| times the area of the lens."""
    return _uniform_large(QUARTER_TURN - HALF_RANGE * z)


def uniform_large(z: Array) -> Array:
    """Density of the angle for uniform ends."""
    return _uniform_large(HALF_RANGE * z)


def _uniform_large(angle: Array) -> Array:
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.asarray(sine * cosine * (angle - sine * cosine))


UNIFORM_DIFFERENCE = HalfDifference(uniform_small, uniform_large)
