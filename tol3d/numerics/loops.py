"""Loops over whole arrays in kernels: each `to[:] = source` that is written takes numba half a second to compile."""

from typing import Any

from tol3d.numerics.compiled import nested


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
