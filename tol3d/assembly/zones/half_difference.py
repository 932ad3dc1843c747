"""Half the difference d of an axis' uniform ends: its length has a law of its own, whatever length is allowed.

For |d| = cos(angle) the middle of the axis lies in a lens, where two discs of radius 1 about ±d meet; `angle` is half
the arc of each that bounds it. The law of |d| is that of two ends in unit discs; an orientation zone only cuts it off.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tol3d.assembly.zones.inverse import NODES, WEIGHTS, Density, InverseTable, integral, inverse, table
from tol3d.assembly.zones.zone import Ratio
from tol3d.numerics.arrays import Array

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
