"""Types of arrays, arrays that belong together, and products whose bits do not depend on the number of trials."""

from collections.abc import Callable
from dataclasses import fields
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Places = NDArray[np.int64]


def times(rows: Array, columns: Array) -> Array:
    """Product (…, n) of rows (…, f) and columns (f, n) of trials, the addends in the order of f.

    numpy's own products and `einsum` add one trial alone in another order than many, and leave other last bits.
    """
    found = np.zeros((*rows.shape[:-1], columns.shape[1]))
    for k, column in enumerate(columns):
        found += rows[..., k, None] * column
    return found


class TrialArrays:
    """A frozen dataclass of arrays, or of others such, with the trials on axis 0: trials are taken and put in all."""

    def __getitem__(self, trials: Any) -> Self:
        """Values of some trials."""
        return type(self)(*(getattr(self, field.name)[trials] for field in fields(self)))  # type: ignore[arg-type]

    def __setitem__(self, trials: Any, part: Self) -> None:
        """Write those of some trials."""
        for field in fields(self):  # type: ignore[arg-type]
            getattr(self, field.name)[trials] = getattr(part, field.name)

    def plus(self, other: Self, factor: float = 1.0) -> Self:
        """Both added up, the other one times a factor."""
        return self._each(lambda one, two: one + factor * two, other)

    def summed(self, rows: Places, weights: Array, trials: int) -> Self:
        """Sums of values times weights (values,) by the trial (values,) that each is of, in rising order."""
        found, first = np.unique(rows, return_index=True)

        def sums(own: Array) -> Array:
            into = np.zeros((trials, *own.shape[1:]))
            if len(found):
                weighted = weights.reshape(-1, *(1,) * (own.ndim - 1)) * own
                into[found] = np.add.reduceat(weighted, first, axis=0)
            return into

        return self._each(sums)

    def _each(self, made: Callable[..., Array], *others: Self) -> Self:
        """The same of every array, and of those at the same place of others."""
        found = []
        for field in fields(self):  # type: ignore[arg-type]
            values = [getattr(each, field.name) for each in (self, *others)]
            nested = isinstance(values[0], TrialArrays)
            found.append(values[0]._each(made, *values[1:]) if nested else made(*values))
        return type(self)(*found)
