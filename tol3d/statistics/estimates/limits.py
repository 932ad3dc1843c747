"""Fraction outside the limits of a measure, in parts per million, and the performance indices."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array

Mask = NDArray[np.bool_]

CONFIDENCE = 0.95  # of the interval beside a ppm; what engineers expect when nothing is said

MOST_PPK = 10.0  # that may be asked for; a share beyond 30 sigma is no number of builds

HALF_A_TRIAL = 0.5  # trials; what is less than one of all that were run cannot be distinguished from none


@dataclass(frozen=True)
class Proportion:
    """`count` of `total` trials.

    >>> Proportion(3, 2000).ppm
    1500.0
    """

    count: int
    total: int

    def merge(self, other: Self) -> Self:
        """The counts of both."""
        return type(self)(self.count + other.count, self.total + other.total)

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
    """Numbers of trials that gave a value, failed, and lie out of the limits.

    A fraction out of limits is one of ALL trials: a build that cannot be assembled is not a good one.

    Args:
        good: trials that gave a value.
        failed: the others.
        below: trials below the lower limit, with the failed ones whose status is "lacking".
        above: trials above the upper limit.
        out: trials that are not good within both limits, each once; without limits those that failed.
    """

    good: int = 0
    failed: int = 0
    below: int = 0
    above: int = 0
    out: int = 0

    @classmethod
    def of(cls, values: Array, lower: float | None, upper: float | None, lacking: Mask | None = None) -> Self:
        """Counts of one block of values (trials,), NaN where the trial failed; None is no limit.

        A value at a limit is within it.

        Args:
            values, lower, upper: as described.
            lacking: (trials,), failed trials that count as below any lower limit; None for none.
        """
        return cls.of_spans(values, values, lower, upper, lacking)

    @classmethod
    def of_spans(
        cls, lowest: Array, highest: Array, lower: float | None, upper: float | None, lacking: Mask | None = None
    ) -> Self:
        """The same of trials that have several values, from the lowest to the highest of each (trials,)."""
        failed = int(np.count_nonzero(np.isnan(lowest)))
        below = np.zeros(len(lowest), dtype=bool) if lower is None else lowest < lower
        above = np.zeros(len(lowest), dtype=bool) if upper is None else highest > upper
        short = 0 if lower is None or lacking is None else int(np.count_nonzero(lacking & np.isnan(lowest)))
        return cls(
            good=len(lowest) - failed,
            failed=failed,
            below=int(np.count_nonzero(below)) + short,
            above=int(np.count_nonzero(above)),
            out=int(np.count_nonzero(below | above)) + failed,
        )

    def merge(self, other: Self) -> Self:
        """The counts of both."""
        return type(self)(
            self.good + other.good,
            self.failed + other.failed,
            self.below + other.below,
            self.above + other.above,
            self.out + other.out,
        )

    @property
    def total(self) -> int:
        """All trials."""
        return self.good + self.failed

    @property
    def below_limit(self) -> Proportion:
        """Fraction of all trials below the lower limit."""
        return Proportion(self.below, self.total)

    @property
    def above_limit(self) -> Proportion:
        """Fraction of all trials above the upper limit."""
        return Proportion(self.above, self.total)

    @property
    def failures(self) -> Proportion:
        """Fraction of all trials that gave no value."""
        return Proportion(self.failed, self.total)

    @property
    def out_of_limits(self) -> Proportion:
        """Fraction of all trials that are not good within the limits: 1 less the yield."""
        return Proportion(self.out, self.total)


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


def equivalent_ppk(out: Proportion) -> float | None:
    """The Ppk of a normal measure with one limit that has this share out: PHI^-1(1 - p)/3. None of no trials.

    For measures of which a part failed, whose mean and sigma are those of the others only. No share is nearer to 0
    or 1 than half a trial, so that it stays finite.

    >>> round(equivalent_ppk(Proportion(1350, 1_000_000)), 3), round(equivalent_ppk(Proportion(1, 2)), 3)
    (1.0, 0.0)
    """
    if not out.total:
        return None
    half = HALF_A_TRIAL / out.total
    return ppk_beyond(min(max(out.count / out.total, half), 1 - half))


def ppk_beyond(share: float) -> float:
    """The Ppk of a normal measure that has a share beyond one limit: PHI^-1(1 - p)/3; infinite of 0 and 1.

    >>> round(ppk_beyond(0.00135), 3), round(ppk_beyond(0.0027), 3)
    (1.0, 0.927)
    """
    return 0.0 - float(scipy.special.ndtri(share)) / 3


def quantile_pp(lower: float | None, upper: float | None, low: float | None, high: float | None) -> float | None:
    """Pp by quantiles, (upper - lower) / (x99.865 - x0.135), ISO 22514-2; None without both limits or without spread.

    Args:
        lower, upper: the limits.
        low, high: the 0.135 % and 99.865 % quantiles; None where one is not known.
    """
    if lower is None or upper is None or low is None or high is None or not high > low:
        return None
    return (upper - lower) / (high - low)


def quantile_ppk(
    lower: float | None, upper: float | None, below: tuple[float, float] | None, above: tuple[float, float] | None
) -> float | None:
    """Ppk by quantiles, the smaller of (x50 - L) / (x50 - x0.135) and (U - x50) / (x99.865 - x50), ISO 22514-2.

    Of any law: at 1 a share of 0.135 % lies beyond the limit. None without limits, where a quantile that a limit needs
    is not known, and where the quantiles of a side are the same and a limit lies inside or on them.

    >>> quantile_ppk(0.0, 3.0, (0.5, 1.0), (1.0, 5.0))
    0.5

    Args:
        lower, upper: the limits.
        below: x0.135 and x50 of the values that the lower limit judges.
        above: x50 and x99.865 of the values that the upper limit judges.
    """
    sides = []
    if lower is not None:
        sides.append(None if below is None else (below[1] - lower, below[1] - below[0]))
    if upper is not None:
        sides.append(None if above is None else (upper - above[0], above[1] - above[0]))
    known = [side for side in sides if side is not None]
    spread = [margin / reach for margin, reach in known if reach > 0.0]
    if not spread or len(known) < len(sides) or any(reach <= 0.0 >= margin for margin, reach in known):
        return None
    return min(spread)


def normal_share(margin: float, sigma: float) -> float:
    """Share of a normal measure beyond a limit that lies a margin from its mean.

    >>> round(1e6 * normal_share(3.0, 1.0))
    1350
    """
    return float(scipy.special.ndtr(-margin / sigma))


def _difference(larger: float | None, smaller: float | None) -> float | None:
    return None if larger is None or smaller is None else larger - smaller


@dataclass(frozen=True)
class Agreement:
    """Differences of two columns over the same trials, in their unit.

    Args:
        count: trials in which both methods gave a number.
        skipped: trials in which one or both gave NaN.
        max_abs: largest |difference|, 0 when there are none.
        total, total_squares: sums of the differences and of their squares.
    """

    count: int = 0
    skipped: int = 0
    max_abs: float = 0.0
    total: float = 0.0
    total_squares: float = 0.0

    @classmethod
    def of(cls, values: Array, reference: Array) -> Self:
        """The differences values - reference of one block, both (trials,)."""
        difference = values - reference
        known = difference[~np.isnan(difference)]
        return cls(
            count=len(known),
            skipped=len(difference) - len(known),
            max_abs=float(np.max(np.abs(known), initial=0.0)),
            total=float(np.sum(known)),
            total_squares=float(np.sum(known * known)),
        )

    def merge(self, other: Self) -> Self:
        """The differences of both blocks together."""
        return type(self)(
            self.count + other.count,
            self.skipped + other.skipped,
            max(self.max_abs, other.max_abs),
            self.total + other.total,
            self.total_squares + other.total_squares,
        )

    @property
    def mean(self) -> float:
        """Mean difference (values - reference); NaN without trials."""
        return self.total / self.count if self.count else math.nan

    @property
    def rms(self) -> float:
        """Root of the mean square difference; NaN without trials."""
        return math.sqrt(self.total_squares / self.count) if self.count else math.nan
