"""What is not linear in a trial's deviations, evaluated trial by trial: a length, a largest amount, a width."""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.torsors.ordered import ordered_product, squared_lengths

Array = NDArray[np.float64]

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
"""How a term depends on what it reads: the largest length of vectors and the least width between parallel planes are
convex, as is the least in a room of its places; a largest inscribed circle is concave; a pose of least largest residual
or on one-sided contacts and a clipped amount are neither, but linear in pieces; a place in a room is neither."""


class Term(Protocol):
    """Something that is evaluated trial by trial, for it is not linear in the columns before it."""

    @property
    def form(self) -> Form:
        """How it depends on what it reads."""
        ...

    @property
    def forms(self) -> Array:
        """(lengths, columns): what it reads, linear in the columns before it [mm]."""
        ...

    @property
    def count(self) -> int:
        """How many columns it makes."""
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
    """An amount that is held between 0 and a most.

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
