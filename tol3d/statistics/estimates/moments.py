"""Count, mean and higher moments of a sample, gathered block by block."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class Moments:
    """A sample's count, mean, central sums and extremes; no values are kept.

    Blocks merged in a fixed order give the same bits, whoever computed them. Values must be
    numbers: a trial that failed is left out (and counted) by the caller, a NaN makes all NaN.

    Args:
        count: number of values n.
        mean: their mean, 0 when there are none.
        m2, m3, m4: sums over the values of (value - mean)^2, ^3, ^4.
        minimum, maximum: the extremes, inf and -inf when there are none.
    """

    count: int = 0
    mean: float = 0.0
    m2: float = 0.0
    m3: float = 0.0
    m4: float = 0.0
    minimum: float = math.inf
    maximum: float = -math.inf

    @classmethod
    def of(cls, values: Array) -> Self:
        """The moments of one block of values (n,)."""
        if len(values) == 0:
            return cls()
        # from the first value, so that a constant sample has no spread at all, not a rounding error's
        shifted = values - values[0]
        mean = float(np.mean(shifted))
        deviation = shifted - mean
        square = deviation * deviation
        return cls(
            count=len(values),
            mean=float(values[0]) + mean,
            m2=float(np.sum(square)),
            m3=float(np.sum(square * deviation)),
            m4=float(np.sum(square * square)),
            minimum=float(np.min(values)),
            maximum=float(np.max(values)),
        )

    def merge(self, other: Self) -> Self:
        """The moments of both samples together, exact but for rounding.

        Source: Pebay, Formulas for robust, one-pass parallel computation of covariances and
        arbitrary-order statistical moments, SAND2008-6212, 2008.
        """
        if self.count == 0 or other.count == 0:
            return other if self.count == 0 else self
        a, b = self.count, other.count
        n = a + b
        delta = other.mean - self.mean
        m2 = self.m2 + other.m2 + delta**2 * a * b / n
        m3 = self.m3 + other.m3 + delta**3 * a * b * (a - b) / n**2 + 3 * delta * (a * other.m2 - b * self.m2) / n
        m4 = (
            self.m4
            + other.m4
            + delta**4 * a * b * (a**2 - a * b + b**2) / n**3
            + 6 * delta**2 * (a**2 * other.m2 + b**2 * self.m2) / n**2
            + 4 * delta * (a * other.m3 - b * self.m3) / n
        )
        mean = self.mean + delta * b / n
        minimum, maximum = min(self.minimum, other.minimum), max(self.maximum, other.maximum)
        return type(self)(n, mean, m2, m3, m4, minimum, maximum)

    @property
    def variance(self) -> float:
        """m2 / (n - 1); NaN for fewer than two values."""
        return self.m2 / (self.count - 1) if self.count > 1 else math.nan

    @property
    def sigma(self) -> float:
        """The sample standard deviation, of n - 1; NaN for fewer than two values."""
        return math.sqrt(self.variance)

    @property
    def skewness(self) -> float:
        """g1 = (m3 / n) / (m2 / n)^1.5; NaN if nothing varies."""
        return math.sqrt(self.count / self.m2) * (self.m3 / self.m2) if self.m2 > 0 else math.nan

    @property
    def excess_kurtosis(self) -> float:
        """g2 = (m4 / n) / (m2 / n)^2 - 3, 0 for a normal; NaN if nothing varies."""
        return (self.count / self.m2) * (self.m4 / self.m2) - 3 if self.m2 > 0 else math.nan

    @property
    def mean_se(self) -> float:
        """Standard error of the mean, sigma / sqrt(n); NaN for fewer than two values."""
        return self.sigma / math.sqrt(self.count) if self.count else math.nan

    @property
    def sigma_se(self) -> float:
        """Standard error of sigma, for any distribution; NaN if nothing varies.

        var(s^2) = (mu4 - mu2^2 (n - 3) / (n - 1)) / n (Mood, Graybill, Boes, Introduction to the
        Theory of Statistics, 3rd ed., 1974, ch. VI), with the sample's own mu4 and s^2
        for mu2, through d sigma = d(s^2) / (2 s). For a normal it tends to sigma / sqrt(2 n).
        """
        if not self.m2 > 0:
            return math.nan
        n = self.count
        variance_of_variance = (self.m4 / n - self.variance**2 * (n - 3) / (n - 1)) / n
        return math.sqrt(max(variance_of_variance, 0.0)) / (2 * self.sigma)


def skewness_se(count: int) -> float:
    """Standard deviation of the skewness g1 of independent values of a normal law; inf for fewer than three.

    var(g1) = 6 (n - 2) / ((n + 1) (n + 3)), exact. Source: Fisher, The moments of the distribution for normal samples
    of measures of departure from normality, Proc. R. Soc. A 130, 1930; it tends to 6 / n.
    """
    n = count
    return math.sqrt(6 * (n - 2) / ((n + 1) * (n + 3))) if n > 2 else math.inf


def kurtosis_se(count: int) -> float:
    """Standard deviation of the excess kurtosis g2 of a number of values of a normal law; inf for fewer than four.

    var(g2) = 24 n (n - 2) (n - 3) / ((n + 1)^2 (n + 3) (n + 5)), exact; it tends to 24 / n. Source: as skewness_se.
    """
    n = count
    return math.sqrt(24 * n * (n - 2) * (n - 3) / ((n + 1) ** 2 * (n + 3) * (n + 5))) if n > 3 else math.inf
