"""Loops over whole arrays in kernels: each `to[:] = source` that is written takes numba half a second to compile."""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import nested

NO_PIVOT: Final = 1e-12
"""Pivot of equations with coefficients of about 1, below which they are singular."""


@nested
def fill(to: Any, number: Any) -> None:
    """Make all of a vector one number."""
    for i in range(to.shape[0]):
        to[i] = number


@nested
def fill_matrix(to: Any, number: Any) -> None:
    """Make all of a matrix one number."""
    for i in range(to.shape[0]):
        for j in range(to.shape[1]):
            to[i, j] = number


@nested
def copy(to: Any, source: Any) -> None:
    """Make a vector another one."""
    for i in range(to.shape[0]):
        to[i] = source[i]


@nested
def copy_matrix(to: Any, source: Any) -> None:
    """Make a matrix another one."""
    for i in range(to.shape[0]):
        for j in range(to.shape[1]):
            to[i, j] = source[i, j]


@nested
def eliminated(matrix: Any, right: Any, count: int) -> Any:
    """Solve count equations in place by elimination with pivots: their determinant's sign, and the least pivot.

    The sign is 0 if they are singular, or their solution is not finite.
    """
    sign, least = 1.0, np.inf
    for k in range(count):
        best = k
        for i in range(k + 1, count):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if best != k:
            sign = -sign
            for j in range(k, count):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            right[k], right[best] = right[best], right[k]
        pivot = matrix[k, k]
        if not abs(pivot) > NO_PIVOT:
            return 0.0, 0.0
        sign, least = -sign if pivot < 0.0 else sign, min(least, abs(pivot))
        for i in range(k + 1, count):
            factor = matrix[i, k] / pivot
            if factor != 0.0:
                for j in range(k + 1, count):
                    matrix[i, j] -= factor * matrix[k, j]
                right[i] -= factor * right[k]
    for k in range(count - 1, -1, -1):
        total = right[k]
        for j in range(k + 1, count):
            total -= matrix[k, j] * right[j]
        right[k] = total / matrix[k, k]
    if count > 0 and not np.isfinite(right[0]):  # a loop of its input alone has no unknown
        return 0.0, 0.0
    return sign, least
