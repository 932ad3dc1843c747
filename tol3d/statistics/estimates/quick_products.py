"""Sums of products over many trials, compiled."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import FULL, kernel

Places = NDArray[np.intp]

TILE = 512  # trials; forty rows of them stay in the nearest cache


def quick_products(rows: Array) -> Array:
    """Same products as variance_shares.plain_products, to rounding."""
    sums = np.zeros((len(rows), len(rows)))
    _add_products(np.ascontiguousarray(rows), sums)
    return sums


def cross_products(features: Array, targets: Array) -> Array:
    """Sums over the trials of each feature (features, trials) times each target (targets, trials).

    Returns:
        (features, targets); a pair's sum depends on its own rows alone, to the last bit.
    """
    sums = np.zeros((len(features) + len(features) % 2, len(targets) + -len(targets) % 4))
    _add_cross_products(_padded(features, len(sums)), _padded(targets, sums.shape[1]), sums)
    return sums[: len(features), : len(targets)]


def pair_products(rows: Array, first: Places, second: Places) -> Array:
    """Sums over the trials of the products of pairs of rows (rows, trials): (pairs,)."""
    sums = np.zeros(len(first))
    _add_pair_products(np.ascontiguousarray(rows), first, second, sums)
    return sums


def _padded(rows: Array, count: int) -> Array:
    """Rows in one piece of memory: those given and zeros."""
    if len(rows) == count:
        return np.ascontiguousarray(rows)
    return np.concatenate([rows, np.zeros((count - len(rows), rows.shape[1]))])


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


@kernel(arrays="float64[:, ::1], float64[:, ::1], float64[:, ::1]", reassociated=True, level=FULL)
def _add_cross_products(features: Any, targets: Any, sums: Any) -> None:
    """Add the products of each feature and target, two features by four targets at a time: each row read is used more.

    The number of features is even, that of targets a multiple of four.
    """
    count, trials = features.shape
    for first in range(0, trials, TILE):
        last = min(first + TILE, trials)
        for i in range(0, count, 2):
            one, two = features[i, first:last], features[i + 1, first:last]
            for j in range(0, len(targets), 4):
                a, b = targets[j, first:last], targets[j + 1, first:last]
                c, d = targets[j + 2, first:last], targets[j + 3, first:last]
                one_a = one_b = one_c = one_d = two_a = two_b = two_c = two_d = 0.0
                for k in range(len(one)):
                    one_a += one[k] * a[k]
                    one_b += one[k] * b[k]
                    one_c += one[k] * c[k]
                    one_d += one[k] * d[k]
                    two_a += two[k] * a[k]
                    two_b += two[k] * b[k]
                    two_c += two[k] * c[k]
                    two_d += two[k] * d[k]
                sums[i, j] += one_a
                sums[i, j + 1] += one_b
                sums[i, j + 2] += one_c
                sums[i, j + 3] += one_d
                sums[i + 1, j] += two_a
                sums[i + 1, j + 1] += two_b
                sums[i + 1, j + 2] += two_c
                sums[i + 1, j + 3] += two_d


@kernel(arrays="float64[:, ::1], intp[::1], intp[::1], float64[::1]", reassociated=True, level=FULL)
def _add_pair_products(rows: Any, first: Any, second: Any, sums: Any) -> None:
    """Add the products of some pairs of rows."""
    for pair in range(len(first)):
        one, other = rows[first[pair]], rows[second[pair]]
        part = 0.0
        for k in range(len(one)):
            part += one[k] * other[k]
        sums[pair] += part
