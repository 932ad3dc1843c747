"""Half the difference of an axis' ends, d: its length has a law of its own, whatever length is allowed.

For |d| = cos(angle) the middle of the axis lies in a lens, where two discs of radius 1 about ±d meet; `angle` is half
the arc of each that bounds it. The law of |d| is that of two ends in unit discs; an orientation zone only cuts it off.
"""

import math
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from scipy.special import erf

from tol3d.assembly.zones.cross_section import SIGMAS
from tol3d.assembly.zones.domain import Array, Ratio
from tol3d.assembly.zones.inverse import NODES, WEIGHTS, Density, InverseTable, integral, inverse, table

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
        complement = HALF_RANGE * inverse(self.small, 2, 1.0)(np.sqrt(np.minimum(share / parting, 1.0)))
        angle = QUARTER_TURN - complement
        if not isinstance(ratio, float) or ratio > math.sin(HALF_RANGE):
            rest = np.minimum((1.0 - share) / (1.0 - parting), 1.0)
            angle = np.where(share < parting, angle, HALF_RANGE * inverse(self.large, 5, 1.0)(rest**0.2))
        return np.maximum(angle, np.arccos(ratio))

    def quadrature(self, ratio: float) -> tuple[Array, Array]:
        """Angles and their probabilities, for means of smooth functions where |d| <= ratio."""
        complement = math.asin(ratio) * NODES
        mass = WEIGHTS * self.small(complement / HALF_RANGE, np.asarray(1.0))
        return QUARTER_TURN - complement, mass / mass.sum()

    def _share(self, ratio: float) -> float:
        """The probability that |d| <= ratio."""
        one = np.asarray(1.0)
        within = integral(self.small, np.asarray(math.asin(ratio) / HALF_RANGE), one)
        return float(within / integral(self.small, np.asarray(2.0), one))

    def _shares(self, ratio: Array) -> Array:
        place = np.arcsin(ratio) / QUARTER_TURN
        return np.asarray(place * place * self._table(place))

    @cached_property
    def _parting(self) -> float:
        return self._share(math.sin(HALF_RANGE))

    @cached_property
    def _table(self) -> InverseTable:
        whole = integral(self.small, np.asarray(2.0), np.asarray(1.0))
        return table(lambda place: integral(self.small, 2.0 * place, np.asarray(1.0)) / (whole * place * place))


def uniform_lens(z: Array, size: Array) -> Array:
    """Density of inner / angle, see `normal_lens`, of a middle uniform in the lens."""
    return np.asarray(np.sin(QUARTER_TURN * size * z) ** 2)


def normal_lens(z: Array, size: Array) -> Array:
    """Density of inner / angle, angle = size pi/2, of a normal middle within the lens.

    The middle's distance along d is cos(inner) - cos(angle), and the lens there reaches ±sin(inner) across.
    """
    angle = QUARTER_TURN * size
    along, across = np.cos(angle * z) - np.cos(angle), np.sin(angle * z)
    return np.asarray(np.exp(-((SIGMAS * along) ** 2)) * erf(SIGMAS * across) * across)


def uniform_small(z: Array, unused: Array) -> Array:
    """Density of the complement for uniform ends: |d| d|d| times the area of the lens."""
    return _uniform_large(QUARTER_TURN - HALF_RANGE * z)


def uniform_large(z: Array, unused: Array) -> Array:
    """Density of the angle for uniform ends."""
    return _uniform_large(HALF_RANGE * z)


def normal_small(z: Array, unused: Array) -> Array:
    """Density of the complement for normal ends: |d| d|d| times both normals' mass."""
    return _normal_large(QUARTER_TURN - HALF_RANGE * z)


def normal_large(z: Array, unused: Array) -> Array:
    """Density of the angle for normal ends."""
    return _normal_large(HALF_RANGE * z)


def _uniform_large(angle: Array) -> Array:
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.asarray(sine * cosine * (angle - sine * cosine))


def _normal_large(angle: Array) -> Array:
    sine, cosine, size = np.sin(angle), np.cos(angle), angle / QUARTER_TURN
    lens = size**3 * _normal_lens_mass()(size)
    return np.asarray(sine * cosine * np.exp(-((SIGMAS * cosine) ** 2)) * lens)


@cache
def _normal_lens_mass() -> InverseTable:
    """Mass of the normal in a lens, over the cube of its angle's size."""
    return table(lambda size: integral(normal_lens, np.ones_like(size), size) / size**2)


UNIFORM_DIFFERENCE = HalfDifference(uniform_small, uniform_large)
NORMAL_DIFFERENCE = HalfDifference(normal_small, normal_large)
