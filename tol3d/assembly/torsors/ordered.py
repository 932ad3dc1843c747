"""Sums in a stated order, so that a trial has the same bits alone as among others; BLAS promises no order."""

from collections.abc import Iterable
from functools import reduce
from operator import add

import numpy as np
import scipy.sparse

from tol3d.numerics.arrays import Array

MANY = 64
"""Numbers of a matrix that is not 0, from which its sparse form, which adds in the same order, is quicker."""
UNDECIDED = 1e-13
"""Part of a pivot of positive definite equations that is left of it, below which it is rounding."""


def ordered_sum(addends: Iterable[Array]) -> Array:
    """Their sum, the first two first."""
    return reduce(add, addends)


def ordered_product(matrix: Array, columns: Array) -> Array:
    """(rows, trials) from a matrix (rows, columns) and columns (columns, trials); what is times 0 does not count.

    Each row's addends in the order of the columns.
    """
    if np.count_nonzero(matrix) > MANY:
        return np.asarray(scipy.sparse.csr_array(matrix) @ columns)
    product = np.zeros((len(matrix), columns.shape[1]))
    for row, weights in zip(product, matrix, strict=True):
        for k in np.flatnonzero(weights):
            row += weights[k] * columns[k]
    return product


def squared_lengths(vectors: Array) -> Array:
    """Squared lengths (vectors, trials) of (vectors, size, trials)."""
    return ordered_sum(vectors[:, k] ** 2 for k in range(vectors.shape[1]))


def ordered_solution(matrix: Array, right: Array) -> Array:
    """Solutions (unknowns, trials) of positive definite equations (unknowns, unknowns, trials), by L D L^T.

    What the equations do not decide beyond rounding stays 0.
    """
    count = len(right)
    matrix, solution = matrix.copy(), right.copy()
    pivots = np.empty(right.shape)
    sizes = [matrix[k, k].copy() for k in range(count)]
    for k in range(count):
        pivots[k] = np.where(matrix[k, k] > UNDECIDED * sizes[k], matrix[k, k], np.inf)
        column = matrix[:, k].copy()
        matrix[k + 1 :, k] /= pivots[k]
        for i in range(k + 1, count):
            for j in range(k + 1, i + 1):
                matrix[i, j] -= matrix[i, k] * column[j]
            solution[i] -= matrix[i, k] * solution[k]
    solution /= pivots
    for k in range(count - 1, -1, -1):
        for i in range(k + 1, count):
            solution[k] -= matrix[i, k] * solution[i]
    return solution
