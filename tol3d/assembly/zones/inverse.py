"""Tabulated inverses of distribution functions that have no closed one: piecewise polynomials, good to 1e-9.

A law on [0, 1] whose density vanishes as z^(order - 1) at 0 has F(z) = w^order with a smooth z(w)/w, which is what is
tabulated: the tip of a domain keeps its relative accuracy.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array

Density = Callable[[Array], Array]
"""Density at z in [0, 1], up to a factor. A function of a module, which tables are kept by."""

CELLS = 384
DEGREE = 7
KNOTS = 32
NEWTON_STEPS = 4  # from 1e-3 of [0, 1] Newton's method doubles the digits at each step
EACH_STEPS = 6  # likewise from w itself, 0.2 off at most
NODE_COUNT = 32
NODES, WEIGHTS = (
    0.5 * (x + shift) for x, shift in zip(np.polynomial.legendre.leggauss(NODE_COUNT), (1.0, 0.0), strict=True)
)


def integral(density: Density, z: Array) -> Array:
    """Integral of the density from 0 to z, by Gauss-Legendre."""
    parts = density(z[..., None] * NODES) * WEIGHTS
    total: Array = parts.sum(axis=-1) * z
    return total


def solved(density: Density, order: int, w: Array) -> Array:
    """The z in (0, 1) with F(z) = w^order F(1), of w (any shape).

    By Newton's method from straight lines between knots: the order-th root of F is nearly straight in z, F is not.
    """
    knots = np.linspace(0.0, 1.0, KNOTS + 1)
    whole = integral(density, np.asarray(1.0))
    z = np.interp(w, (integral(density, knots) / whole) ** (1 / order), knots)
    for _ in range(NEWTON_STEPS):
        share = integral(density, z) / whole
        root = share ** (1 / order)
        rise = density(z) / whole * root / (order * share)
        z = np.clip(z - (root - w) / rise, 0.5 * z, 0.5 * (1.0 + z))
    return z


def solved_each(density: Callable[[Array, Array], Array], order: int, w: Array, parameter: Array) -> Array:
    """The z (trials,) in (0, 1) with F(z) = w^order F(1); each trial's density has its own parameter (trials,)."""
    own = parameter[..., None]
    whole = (density(NODES, own) * WEIGHTS).sum(axis=-1)
    z = np.array(w)
    for _ in range(EACH_STEPS):
        share = (density(z[..., None] * NODES, own) * WEIGHTS).sum(axis=-1) * z / whole
        root = share ** (1 / order)
        rise = density(z, parameter) / whole * root / (order * share)
        z = np.clip(z - (root - w) / rise, 0.5 * z, 0.5 * (1.0 + z))
    return z


@dataclass(frozen=True, eq=False)
class InverseTable:
    """A smooth function on [0, 1]: polynomials in the place within each cell, (degree + 1, cells)."""

    coefficients: Array

    def __call__(self, w: Array) -> Array:
        """Values (trials,) of w (trials,) in [0, 1]."""
        cell, place = _placed(w, CELLS)
        value: Array = self.coefficients[DEGREE].take(cell)
        for coefficient in self.coefficients[DEGREE - 1 :: -1]:
            value *= place
            value += coefficient.take(cell)
        return value


@dataclass(frozen=True, eq=False)
class Inverse:
    """z(w) of one law."""

    ratio: InverseTable

    def __call__(self, w: Array) -> Array:
        """Z (trials,) of w (trials,) in [0, 1]."""
        z = self.ratio(w)
        z *= w
        return np.minimum(z, 1.0, out=z)


def table(function: Callable[[Array], Array]) -> InverseTable:
    """Inverse table of a smooth function on [0, 1] that takes arrays of any shape."""
    places, w = _nodes(CELLS, DEGREE)
    return InverseTable(_coefficients(places, function(w)))


@cache
def inverse(density: Density, order: int) -> Inverse:
    """z(w), tabulated."""
    return Inverse(table(lambda w: solved(density, order, w) / w))


def _coefficients(places: Array, values: Array) -> Array:
    """Coefficients of polynomials (degree + 1, n) through values (nodes, n) at places (nodes,).

    Sums in a fixed order: in large products a BLAS changes the last bits with its threads.
    """
    weights = np.linalg.inv(np.vander(places, increasing=True))
    return np.stack([sum((w * own for w, own in zip(row, values, strict=True)), np.zeros(1)) for row in weights])


def _placed(w: Array, cells: int) -> tuple[NDArray[np.intp], Array]:
    """The cell of each w in [0, 1], and the place in it in [-1, 1]."""
    scaled = w * cells
    cell = np.minimum(scaled.astype(np.intp), cells - 1)
    scaled -= cell
    scaled *= 2.0
    scaled -= 1.0
    return cell, scaled


def _nodes(cells: int, degree: int) -> tuple[Array, Array]:
    """Chebyshev nodes: places in [-1, 1], and w (nodes, cells)."""
    places = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    return places, (np.arange(cells) + 0.5 * (1.0 + places[:, None])) / cells
