"""Columns in which a trial's torsors are linear: deviations, a constant, and nonlinear terms, in order."""

import numpy as np

from tol3d.assembly.torsors.terms import Largest, Term
from tol3d.numerics.arrays import Array

ROUNDING = 1e-12
"""Coefficients of lengths below this are rounding: of a length [mm] that does not vary, and of one that does."""
NOWHERE = 1e-9
"""Nominal lengths below this are 0 [mm]."""


class Columns:
    """The growing columns of an assembly: deviations, 1, and one or more for each term.

    Args:
        width: of the deviations.
        room: largest number of columns of terms.
    """

    def __init__(self, width: int, room: int) -> None:
        self.constant = width
        self.count = width + 1 + room
        self.terms: list[tuple[int, Term]] = []
        """Each with the first of its columns."""
        self._next = width + 1

    def zeros(self, rows: int) -> Array:
        """Rows that do not vary and are 0."""
        return np.zeros((rows, self.count))

    def constants(self, values: Array) -> Array:
        """Rows that do not vary (rows, columns)."""
        rows = self.zeros(len(values))
        rows[:, self.constant] = np.where(np.abs(values) < NOWHERE, 0.0, values)
        return rows

    def largest(self, vectors: Array) -> Array:
        """The largest length of vectors (vectors, size, columns) as a row (columns,); 0 where none varies."""
        forms = without_rounding(vectors).reshape(-1, self.count)
        if not forms.any():
            return np.zeros(self.count)
        row: Array = self.made_by(Largest(forms, vectors.shape[1]))[0]
        return row

    def made_by(self, term: Term) -> Array:
        """Rows (count, columns) that are those of a new term."""
        start, self._next = self._next, self._next + term.count
        if self._next > self.count:
            raise ValueError(f"{self.count} columns have no room for another term")
        self.terms.append((start, term))
        return np.eye(self.count)[start : self._next]


def without_rounding(rows: Array) -> Array:
    """Rows over columns, coefficients that are rounding made 0."""
    return np.where(np.abs(rows) < ROUNDING, 0.0, rows)
