"""A sample whose trials are not independent, by its replicates, which are: their spread gives the errors."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import LimitCounts, Moments, Proportion
from tol3d.statistics.estimates.limits import CONFIDENCE
from tol3d.statistics.samplers.replicates import pieces
from tol3d.study.trials.study import Study

Rows = Mapping[int, slice]
Mask = NDArray[np.bool_]

LEAST_COUNT = 5.0  # a replicate, in the mean, inside and outside a limit: fewer are nearer to Poisson's law


def rows_of_replicates(study: Study, first: int, count: int) -> Rows:
    """Rows of trials first ... first + count - 1 that belong to each replicate; none for independent trials."""
    if study.sampler == "monte_carlo":
        return {}
    rows, start = {}, 0
    for piece in pieces(study.replicate_trials, first, count):
        rows[piece.replicate] = slice(start, start + piece.count)
        start += piece.count
    return rows


@dataclass(frozen=True)
class Replicated:
    """One method's sample of one measure by replicate, in the measure's unit."""

    moments: Mapping[int, Moments]
    limits: Mapping[int, LimitCounts]

    @classmethod
    def of(
        cls, values: Array, rows: Rows, lower: float | None, upper: float | None, lacking: Mask | None = None
    ) -> "Replicated":
        """Statistics of a block of values (trials,), nan for failed trials; limits, `lacking` as in LimitCounts.of."""
        own = {replicate: values[part] for replicate, part in rows.items()}
        return cls(
            {replicate: Moments.of(part[~np.isnan(part)]) for replicate, part in own.items()},
            limits_by_replicate(values, values, rows, lower, upper, lacking),
        )

    def merge(self, other: "Replicated") -> "Replicated":
        """Both samples as one; a replicate may have begun in one and end in the other."""
        moments = dict(self.moments)
        for replicate, found in other.moments.items():
            moments[replicate] = moments[replicate].merge(found) if replicate in moments else found
        return Replicated(moments, merged_by_replicate(self.limits, other.limits))

    @property
    def mean_se(self) -> float:
        """Standard error of the mean: the standard deviation of the replicates' means over sqrt(replicates)."""
        return standard_error([moment.mean if moment.count else math.nan for moment in self.moments.values()])

    @property
    def sigma_se(self) -> float:
        """Standard error of sigma: the standard deviation of the replicates' sigmas over sqrt(replicates)."""
        return standard_error([moment.sigma for moment in self.moments.values()])

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the standard errors."""
        return len(self.moments) - 1

    @property
    def below_interval_ppm(self) -> tuple[float, float] | None:
        """Bounds [ppm] of the true share below the lower limit, as interval_of_replicates makes them."""
        return self._interval_ppm(lambda counts: counts.below_limit)

    @property
    def above_interval_ppm(self) -> tuple[float, float] | None:
        """Bounds [ppm] of the true share above the upper limit, as interval_of_replicates makes them."""
        return self._interval_ppm(lambda counts: counts.above_limit)

    @property
    def out_interval_ppm(self) -> tuple[float, float] | None:
        """Bounds [ppm] of the true share that is out of limits or failed, as interval_of_replicates makes them."""
        return self._interval_ppm(lambda counts: counts.out_of_limits)

    def _interval_ppm(self, share_of: Callable[[LimitCounts], Proportion]) -> tuple[float, float] | None:
        return interval_of_replicates([share_of(counts) for counts in self.limits.values()])


def limits_by_replicate(
    lowest: Array, highest: Array, rows: Rows, lower: float | None, upper: float | None, lacking: Mask | None = None
) -> dict[int, LimitCounts]:
    """Trials out of limits by replicate; arguments as LimitCounts.of_spans has them."""
    return {
        replicate: LimitCounts.of_spans(
            lowest[part], highest[part], lower, upper, None if lacking is None else lacking[part]
        )
        for replicate, part in rows.items()
    }


def merged_by_replicate(mine: Mapping[int, LimitCounts], its: Mapping[int, LimitCounts]) -> dict[int, LimitCounts]:
    """Both; a replicate may have begun in one and end in the other."""
    both = {key: own.merge(its[key]) if key in its else own for key, own in mine.items()}
    return both | {key: own for key, own in its.items() if key not in mine}


def interval_of_replicates(shares: Sequence[Proportion]) -> tuple[float, float] | None:
    """Bounds [ppm] of the true share, 95 % confidence, of the shares of replicates; None for fewer than two.

    Student's t, for replicates are independent of each other. Of counts too small to be near a normal the wider of
    that and of Clopper and Pearson's for as many independent trials; and never less than a share of which all
    replicates may have missed every trial (`missed_share`).
    """
    if len(shares) < 2 or not all(share.total for share in shares):
        return None
    outside, total = sum(share.count for share in shares), sum(share.total for share in shares)
    parts = [1e6 * share.count / share.total for share in shares]
    half, middle = students_half(standard_error(parts), len(parts) - 1), float(np.mean(parts))
    low, high = max(middle - half, 0.0), min(middle + half, 1e6)
    if min(outside, total - outside) >= LEAST_COUNT * len(shares):
        return low, high
    independent = Proportion(outside, total).interval_ppm()
    low, high = min(low, independent[0]), max(high, independent[1])
    missed = 1e6 * missed_share(min(share.total for share in shares), len(shares))
    return (low, max(high, missed)) if 2 * outside <= total else (min(low, 1e6 - missed), high)


def missed_share(points: int, replicates: int) -> float:
    """The largest share of which no replicate of a number of points may have any, with a chance of 2.5 %.

    A net's count k of a share p has the mean n p. Of a Latin hypercube it has a variance of at most n/(n - 1) times
    n p (1 - p), that of independent trials (Owen, Monte Carlo variance of scrambled net quadrature, SIAM J. Numer.
    Anal. 34, 1997); of Sobol' points it may have more for sets that no measure is made of, and that is not covered.
    By Cantelli's inequality a replicate has none with at most 1/(1 + (n - 1) p/(1 - p)). With many replicates it
    tends to Clopper and Pearson's 3.69 of all trials, with few it is wider.

    >>> [round(replicates * 1000 * missed_share(1000, replicates), 2) for replicates in (2, 4, 16, 256)]
    [10.6, 6.06, 4.15, 3.72]
    """
    odds = ((1 - CONFIDENCE) / 2) ** (-1 / replicates) - 1
    return odds / (points - 1 + odds) if points > 1 else 1.0


def students_half(error: float, freedom: int) -> float:
    """Half of the 95 % interval of an estimate by Student's t, of its standard error and the freedom of that."""
    return error * float(scipy.special.stdtrit(freedom, (1 + CONFIDENCE) / 2)) if freedom > 0 else math.nan


def standard_error(parts: Sequence[float]) -> float:
    """Standard error of the mean of independent parts; nan for fewer than two, or where one says nothing."""
    return float(np.std(parts, ddof=1)) / math.sqrt(len(parts)) if len(parts) > 1 else math.nan
