"""Sums of products over many trials, compiled."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.compiled import FULL, kernel

Array = NDArray[np.float64]

TILE = 512  # trials; forty rows of them stay in the nearest cache


def quick_products(rows: Array) -> Array:
    """As variance_shares.plain_products, to rounding."""
    sums = np.zeros((len(rows), len(rows)))
    _add_products(np.ascontiguousarray(rows), sums)
    return sums


@kernel(arrays="float64[:, ::1], float64[:, ::1]", reassociated=True, level=FULL)
def _add_products(rows: Any, sums: Any) -> None:
    """Add the products of all pairs of rows, tile by tile; within one the order is the compiler's, always the same."""
    count, trials = rows.shape
    for first in range(0, trials, TILE):
        last = min(first + TILE, trials)
        for i in range(count):
            row = rows[i, first:last]
            for j in range(i, count):
                other = rows[j, first:last]
                part = 0.0
                for k in range(len(row)):
                    part += row[k] * other[k]
                sums[i, j] += part
    for i in range(count):
        for j in range(i):
            sums[i, j] = sums[j, i]
