"""Nonlinear terms of a trial's deviations, evaluated trial by trial: a length, a maximum, a width."""

from dataclasses import dataclass
from itertools import combinations
from typing import Literal, Protocol

import numpy as np

from tol3d.assembly.torsors.torsor import ordered_product, squared_lengths
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

Form = Literal[
    "largest length",
    "least width",
    "least largest residual",
    "clipped amount",
    "largest inscribed circle",
    "least in a room",
    "one-sided contacts",
    "end",
    "place in a room",
]
"""Form of a term's dependence on its inputs: the largest length of vectors, the least width between parallel planes and
the least within a clearance are convex; a largest inscribed circle is concave; a pose of least largest residual or on
one-sided contacts and a clipped amount are neither, but piecewise linear; a place within a clearance is neither."""


class Term(Protocol):
    """A term evaluated trial by trial, as it is not linear in the columns before it."""

    @property
    def form(self) -> Form:
        """Form of its dependence on its inputs."""
        ...

    @property
    def forms(self) -> Array:
        """(lengths, columns): what it reads, linear in the columns before it [mm]."""
        ...

    @property
    def count(self) -> int:
        """Number of its columns."""
        ...

    def values(self, read: Array) -> Array:
        """Its columns (count, trials) from what it reads (lengths, trials)."""
        ...


@dataclass(frozen=True, eq=False)
class Largest:
    """The largest length among vectors; of vectors of one number, the largest amount.

    Args:
        forms: (vectors * size, columns).
        size: numbers of each vector.
    """

    forms: Array
    size: int
    form: Form = "largest length"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (vectors * size, trials)."""
        if self.size == 1:
            return np.asarray(np.abs(read).max(axis=0, keepdims=True))
        squares = squared_lengths(read.reshape(-1, self.size, read.shape[1]))
        return np.asarray(np.sqrt(squares.max(axis=0, keepdims=True)))


@dataclass(frozen=True, eq=False)
class Ends:
    """The larger or the smaller one of some amounts.

    Args:
        forms: (amounts, columns).
        is_largest: which.
    """

    forms: Array
    is_largest: bool
    form: Form = "end"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (amounts, trials)."""
        return np.asarray(read.max(axis=0, keepdims=True) if self.is_largest else read.min(axis=0, keepdims=True))


@dataclass(frozen=True, eq=False)
class Width:
    """The smallest distance of two parallel planes with points between them.

    Args:
        forms: heights of the points (points, columns).
        balances: (sets, points), whose products with the heights have the width as their largest amount.
    """

    forms: Array
    balances: Array
    form: Form = "least width"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (points, trials)."""
        widths = (np.abs(ordered_product(balance[None], read)[0]) for balance in self.balances)
        largest = np.zeros(read.shape[1])
        for width in widths:
            np.maximum(largest, width, out=largest)
        return largest[None]


@dataclass(frozen=True, eq=False)
class Clipped:
    """An amount clipped between 0 and a maximum.

    Args:
        forms: (1, columns).
        most: [mm].
    """

    forms: Array
    most: float
    form: Form = "clipped amount"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (1, trials)."""
        return np.clip(read, 0.0, self.most)


MOST_POINTS = 20
"""4845 sets of four."""
IN_LINE = 1e-6
"""Distance from a line over the points' extent, below which points are in line."""
IDLE = 1e-8
"""Weight below which a point is not in the set; smaller than a fourth point's beside three not in line."""


def balances(points: Array) -> Array:
    """Weights (sets, points) whose products with the heights of points have the flatness as their largest amount.

    By duality it is the largest of sum(w h) over weights with sum(w) = 0, sum(w p) = 0 and sum |w| = 2; the maximum is
    at one of the weights that are nonzero at as few points as possible: four, three in a line, or two at one place.

    Args:
        points: in the nominal plane (points, 2) [mm].

    Raises:
        InputError: more than 20 points.
    """
    if len(points) > MOST_POINTS:
        raise InputError(f"flatness of {len(points)} points; expected {MOST_POINTS} at most on the analytic method")
    size = max(float(np.ptp(points, axis=0).max()), 1e-300)
    sums = np.vstack([np.ones(len(points)), ((points - points.mean(axis=0)) / size).T])
    found = []
    for count in (2, 3, 4):
        for chosen in combinations(range(len(points)), count):
            _, strengths, right = np.linalg.svd(sums[:, chosen])
            weights = right[-1]
            if np.sum(strengths > IN_LINE) == count - 1 and np.abs(weights).min() > IDLE:
                row = np.zeros(len(points))
                row[list(chosen)] = 2.0 * weights / np.abs(weights).sum()
                found.append(row)
    return np.array(found).reshape(-1, len(points))
