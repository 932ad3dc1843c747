"""Bounds of Ppk and of quantiles: by mean and sigma, by order statistics, by replicates, by a share out of limits."""

import math
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
import scipy

from tol3d.statistics.estimates.limits import CONFIDENCE
from tol3d.statistics.estimates.moments import Moments

Bounds = tuple[float, float]
"""Lower and upper bound; infinite where there is none."""

CHANCE: Final = (1 - CONFIDENCE) / 2  # that a true value lies beyond one of its bounds
OF_THE_MEDIAN: Final = 0.1  # part of the chance that the median has of a Ppk by quantiles; it is known 7 times as well


def least_of(sides: Callable[[float], Sequence[Bounds]]) -> Bounds:
    """Bounds of the least of several values, by bounds of each at a chance of error per bound.

    Values whose bounds overlap share the chance of the upper bound, below which any of them may lie.
    """
    found = sides(CHANCE)
    low = min(own[0] for own in found)
    rivals = sum(own[0] <= min(own[1] for own in found) for own in found)
    return low, min(own[1] for own in (found if rivals < 2 else sides(CHANCE / rivals)))


def index_bounds(moments: Moments, margin: float, sign: float, chance: float) -> Bounds:
    """Bounds of margin/(3 sigma), by the standard error of the ratio of a mean's margin and sigma.

    The error is that of a normal law, 1/n + r^2 / (2 (n - 1)) of r = margin/sigma (Bissell, How reliable is your
    capability index?, Applied Statistics 39, 1990; within 2 % of the noncentral t from n = 20 on), or that by the
    sample's own skewness and kurtosis, if that is larger.

    Args:
        moments: of the sample.
        margin: of its mean from the limit, in the same unit.
        sign: +1 of a lower limit, -1 of an upper one.
        chance: that the true index lies beyond one of both bounds.
    """
    n, ratio = moments.count, margin / moments.sigma
    normal = 1 / n + ratio**2 / (2 * (n - 1))
    own = (1 - sign * ratio * moments.skewness + ratio**2 * (moments.excess_kurtosis + 2) / 4) / n
    half = float(scipy.special.ndtri(1 - chance)) * math.sqrt(max(normal, own))
    return (ratio - half) / 3, (ratio + half) / 3


def replicates_bounds(value: float, parts: Sequence[float], chance: float) -> Bounds:
    """Bounds of a value by those of independent replicates, by Student's t; infinite of fewer than two."""
    if len(parts) < 2 or not np.isfinite(parts).all():
        return -math.inf, math.inf
    error = float(np.std(parts, ddof=1)) / math.sqrt(len(parts))
    half = error * float(scipy.special.stdtrit(len(parts) - 1, 1 - chance))
    return value - half, value + half


def rank_below(count: int, share: float, chance: float) -> int:
    """Rank, from 1, of the largest order statistic that lies above a quantile with at most a chance; 0 for none.

    The number of values below the quantile is binomial: with P(number < rank) <= chance (David and Nagaraja, Order
    Statistics, 3rd ed., 7.1), of independent trials of any law.

    >>> [rank_below(n, 0.00135, 0.025) for n in (2000, 2730, 2731, 20_000)]
    [0, 0, 1, 17]
    """
    low, high = 0, math.ceil(count * share) + 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if scipy.special.bdtr(middle - 1, count, share) <= chance else (low, middle)
    return low


def quantile_index_bounds(median: Bounds, outer: Bounds, limit: float) -> Bounds:
    """Bounds of (median - limit)/(median - outer) by bounds of both quantiles; of an upper limit the same."""
    corners: list[float] = []
    for middle in median:
        for end in outer:
            margin, reach = middle - limit, middle - end
            if not math.isfinite(middle):
                return -math.inf, math.inf
            if math.isinf(end):
                corners.append(0.0)
            else:
                corners.append(margin / reach if reach else math.copysign(math.inf, margin))
    signs = {math.copysign(1.0, middle - end) for middle in median for end in outer}
    return (min(corners), max(corners)) if len(signs) == 1 else (-math.inf, math.inf)
