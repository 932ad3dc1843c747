"""A sample whose trials are not independent, by its replicates, which are: their spread gives the errors."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from tol3d.samplers.replicates import pieces
from tol3d.statistics import LimitCounts, Moments, Proportion
from tol3d.statistics.limits import CONFIDENCE
from tol3d.study.study import Study

Array = NDArray[np.float64]
Rows = Mapping[int, slice]
Mask = NDArray[np.bool_]

LEAST_COUNT = 5.0  # a replicate, in the mean, inside and outside a limit: fewer are not near a normal


def rows_of_replicates(study: Study, first: int, count: int) -> Rows:
    """Which rows of trials first ... first + count - 1 belong to each replicate; none for independent trials."""
    if study.sampler == "monte_carlo":
        return {}
    rows, start = {}, 0
    for piece in pieces(study.replicate_trials, first, count):
        rows[piece.replicate] = slice(start, start + piece.count)
        start += piece.count
    return rows


@dataclass(frozen=True)
class Replicated:
    """One road's sample of one measure by replicate, in the measure's unit."""

    moments: Mapping[int, Moments]
    limits: Mapping[int, LimitCounts]

    @classmethod
    def of(
        cls, values: Array, rows: Rows, lower: float | None, upper: float | None, lacking: Mask | None = None
    ) -> "Replicated":
        """Of a block of values (trials,), nan where a trial failed; limits and `lacking` as in LimitCounts.of."""
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
        return _standard_error([own.mean if own.count else math.nan for own in self.moments.values()])

    @property
    def sigma_se(self) -> float:
        """Standard error of sigma: the standard deviation of the replicates' sigmas over sqrt(replicates)."""
        return _standard_error([own.sigma for own in self.moments.values()])

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
    """Student's interval [ppm] of the replicates' shares, which are independent of each other.

    None where the counts are too few for the shares to be near a normal: no interval is better than one of length
    zero. Clopper and Pearson's is for independent trials, which these are not.
    """
    outside, total = sum(share.count for share in shares), sum(share.total for share in shares)
    if len(shares) < 2 or min(outside, total - outside) < LEAST_COUNT * len(shares):
        return None
    parts = [1e6 * share.count / share.total if share.total else math.nan for share in shares]
    half = _standard_error(parts) * float(scipy.special.stdtrit(len(parts) - 1, (1 + CONFIDENCE) / 2))
    middle = float(np.mean(parts))
    return (max(middle - half, 0.0), min(middle + half, 1e6)) if math.isfinite(half) else None


def _standard_error(parts: list[float]) -> float:
    """Of the mean of independent parts; nan for fewer than two, or where one says nothing."""
    return float(np.std(parts, ddof=1)) / math.sqrt(len(parts)) if len(parts) > 1 else math.nan
