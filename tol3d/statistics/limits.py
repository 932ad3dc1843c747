"""What falls outside the limits of a measure, in parts per million, and the performance indices."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONFIDENCE = 0.95  # of the interval beside a ppm; what engineers expect when nothing is said


@dataclass(frozen=True)
class Proportion:
    """`count` of `total` trials.

    >>> Proportion(3, 2000).ppm
    1500.0
    """

    count: int
    total: int

    @property
    def ppm(self) -> float | None:
        """Parts per million; None of no trials."""
        return 1e6 * self.count / self.total if self.total else None

    def interval_ppm(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """Bounds [ppm] that hold the true proportion with at least this confidence.

        Clopper and Pearson 1934, by quantiles of the beta distribution; none of n trials still
        leaves up to 1 - (alpha / 2)^(1 / n).
        """
        k, n, alpha = self.count, self.total, 1 - confidence
        low = float(scipy.special.betaincinv(k, n - k + 1, alpha / 2)) if k > 0 else 0.0
        high = float(scipy.special.betaincinv(k + 1, n - k, 1 - alpha / 2)) if k < n else 1.0
        return 1e6 * low, 1e6 * high


@dataclass(frozen=True)
class LimitCounts:
    """How many trials are good, failed, and of the good ones below and above the limits."""

    good: int = 0
    failed: int = 0
    below: int = 0
    above: int = 0

    @classmethod
    def of(cls, values: Array, lower: float | None, upper: float | None) -> Self:
        """Counts of one block of values (trials,), NaN where the trial failed; None is no limit.

        A value at a limit is within it.
        """
        failed = int(np.count_nonzero(np.isnan(values)))
        below = 0 if lower is None else int(np.count_nonzero(values < lower))
        above = 0 if upper is None else int(np.count_nonzero(values > upper))
        return cls(len(values) - failed, failed, below, above)

    def merge(self, other: Self) -> Self:
        """The counts of both."""
        return type(self)(
            self.good + other.good, self.failed + other.failed, self.below + other.below, self.above + other.above
        )

    @property
    def below_limit(self) -> Proportion:
        """Of the good trials, those below the lower limit."""
        return Proportion(self.below, self.good)

    @property
    def above_limit(self) -> Proportion:
        """Of the good trials, those above the upper limit."""
        return Proportion(self.above, self.good)

    @property
    def failures(self) -> Proportion:
        """Of all trials, those that gave no value."""
        return Proportion(self.failed, self.good + self.failed)


def pp(lower: float | None, upper: float | None, sigma: float) -> float | None:
    """Performance index (upper - lower) / (6 sigma), ISO 22514-2; neglects where the mean lies.

    Assumes a normal measure. None without both limits or without spread.
    """
    if lower is None or upper is None or not sigma > 0:
        return None
    return (upper - lower) / (6 * sigma)


def ppk(lower: float | None, upper: float | None, mean: float, sigma: float) -> float | None:
    """Smallest distance from the mean to a limit over 3 sigma, ISO 22514-2; negative if the mean is outside.

    Assumes a normal measure. One limit is enough; None without any or without spread.
    """
    margins = [margin for margin in (_difference(mean, lower), _difference(upper, mean)) if margin is not None]
    return min(margins) / (3 * sigma) if margins and sigma > 0 else None


def _difference(larger: float | None, smaller: float | None) -> float | None:
    return None if larger is None or smaller is None else larger - smaller
