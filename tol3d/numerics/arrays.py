"""Types of arrays, sets of arrays over trials, and products whose bits do not depend on the number of trials."""

from collections.abc import Callable
from dataclasses import fields
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Places = NDArray[np.int64]


def times(rows: Array, columns: Array) -> Array:
    """Product (…, n) of rows (…, f) and columns (f, n) of trials, summed in the order of f.

    numpy's products and `einsum` sum a single trial in another order than many, which changes the last bits.
    """
    product = np.zeros((*rows.shape[:-1], columns.shape[1]))
    for k, column in enumerate(columns):
        product += rows[..., k, None] * column
    return product


class TrialArrays:
    """A dataclass of arrays, or further TrialArrays, with the trials on axis 0; an index is applied to all of them."""

    def __getitem__(self, trials: Any) -> Self:
        """The same arrays of some trials."""
        return type(self)(*(getattr(self, field.name)[trials] for field in fields(self)))  # type: ignore[arg-type]

    def __setitem__(self, trials: Any, part: Self) -> None:
        """Write the arrays of some trials."""
        for field in fields(self):  # type: ignore[arg-type]
            getattr(self, field.name)[trials] = getattr(part, field.name)

    def plus(self, other: Self, factor: float = 1.0) -> Self:
        """Sum of these arrays and a factor times those of another."""
        return self._each(lambda array, added: array + factor * added, other)

    def summed(self, rows: Places, weights: Array, trials: int) -> Self:
        """Weighted sums of values by trial, each array then (trials, ...).

        Args:
            rows: trial of each value (values,), in rising order.
            weights: of each value (values,).
            trials: number of trials; those without values have 0.
        """
        present, first = np.unique(rows, return_index=True)

        def sums(values: Array) -> Array:
            into = np.zeros((trials, *values.shape[1:]))
            if len(present):
                weighted = weights.reshape(-1, *(1,) * (values.ndim - 1)) * values
                into[present] = np.add.reduceat(weighted, first, axis=0)
            return into

        return self._each(sums)

    def _each(self, made: Callable[..., Array], *others: Self) -> Self:
        """A function of every array, and of the array of the same name of others."""
        results = []
        for field in fields(self):  # type: ignore[arg-type]
            values = [getattr(each, field.name) for each in (self, *others)]
            nested = isinstance(values[0], TrialArrays)
            results.append(values[0]._each(made, *values[1:]) if nested else made(*values))
        return type(self)(*results)
