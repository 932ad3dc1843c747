"""Sums in a stated order, so that a trial has the same bits alone as among others; BLAS promises no order."""

from collections.abc import Iterable
from functools import reduce
from operator import add

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def ordered_sum(addends: Iterable[Array]) -> Array:
    """Their sum, the first two first."""
    return reduce(add, addends)


def ordered_product(matrix: Array, columns: Array) -> Array:
    """(rows, trials) from a matrix (rows, columns) and columns (columns, trials); what is times 0 does not count."""
    product = np.zeros((len(matrix), columns.shape[1]))
    for row, weights in zip(product, matrix, strict=True):
        for k in np.flatnonzero(weights):
            row += weights[k] * columns[k]
    return product


def squared_lengths(vectors: Array) -> Array:
    """Squared lengths (vectors, trials) of (vectors, size, trials)."""
    return ordered_sum(vectors[:, k] ** 2 for k in range(vectors.shape[1]))
