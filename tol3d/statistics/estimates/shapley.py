"""Shapley effects of sums: shares of the variance of correlated summands, none negative, which add up to all of it.

Summands come to be known in some order; each has what the variance that is explained grows by when it comes, averaged
over all orders. Of regressions this is known as LMG.

Source: Lindeman, Merenda, Gold, Introduction to Bivariate and Multivariate Analysis (1980); Owen and Prieur, On Shapley
value for measuring importance of dependent inputs, SIAM/ASA J. Uncertain. Quantif. 5 (2017).
"""

from collections.abc import Iterator, Sequence
from itertools import permutations
from math import factorial
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array

ALL_ORDERS: Final = 5040
"""Largest number of orders for which all are taken, those of seven summands; beyond, as many random ones."""
RANK_RTOL: Final = 1e-10


def linear_shapley(slopes: Array, covariance: Array) -> Array:
    """Effects (n,) of a sum of slopes (n,) times variables of some covariance (n, n); they add up to its variance.

    >>> linear_shapley(np.array([1.0, 3.0]), np.array([[1.0, 0.8], [0.8, 1.0]])).round(4).tolist()
    [5.96, 8.84]
    """
    return grouped_shapley(slopes, covariance, [slice(k, k + 1) for k in range(len(slopes))])


def grouped_shapley(slopes: Array, covariance: Array, groups: Sequence[slice]) -> Array:
    """The same (groups,) of groups of variables that come to be known together."""
    across = covariance @ slopes
    known: dict[frozenset[int], float] = {frozenset(): 0.0}

    def explained(which: frozenset[int]) -> float:
        if which not in known:
            columns = np.concatenate([np.arange(len(slopes))[groups[k]] for k in sorted(which)])
            inverse = np.linalg.pinv(covariance[np.ix_(columns, columns)], rcond=RANK_RTOL, hermitian=True)
            known[which] = float(across[columns] @ inverse @ across[columns])
        return known[which]

    found, count = np.zeros(len(groups)), 0
    for order in _orders(len(groups)):
        count += 1
        before = frozenset[int]()
        for k in order:
            after = before | {k}
            found[k] += explained(after) - explained(before)
            before = after
    return found / max(count, 1)


def _orders(size: int) -> Iterator[Sequence[int]]:
    if size <= ALL_ORDERS and factorial(min(size, 20)) <= ALL_ORDERS:
        yield from permutations(range(size))
        return
    generator = np.random.default_rng(size)
    for _ in range(ALL_ORDERS):
        yield generator.permutation(size).tolist()
