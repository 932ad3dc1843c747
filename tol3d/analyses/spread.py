"""The spread of a sample with its sign: what a table shows of it."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tol3d.distributions.base import HIGH_PROBABILITY, LOW_PROBABILITY
from tol3d.numerics.arrays import Array
from tol3d.statistics import Moments


@dataclass(frozen=True, eq=False)
class Spread:
    """A sample's values, (n,), in any unit; a number that it has none of is nan."""

    values: Array

    @cached_property
    def moments(self) -> Moments:
        """Count, mean, sigma, extremes and standard errors."""
        return Moments.of(self.values)

    @property
    def low(self) -> float:
        """Mean - 3 sigma."""
        return self.moments.mean - 3 * self.moments.sigma

    @property
    def high(self) -> float:
        """Mean + 3 sigma."""
        return self.moments.mean + 3 * self.moments.sigma

    @property
    def ends_se(self) -> float:
        """Standard error of low and of high, as of independent mean and sigma."""
        return math.hypot(self.moments.mean_se, 3 * self.moments.sigma_se)

    @cached_property
    def quantiles(self) -> tuple[float, float, float]:
        """The 0.135 %, 50 % and 99.865 % quantiles of the sample, between its neighbours."""
        if not len(self.values):
            return math.nan, math.nan, math.nan
        low, middle, high = np.quantile(self.values, (LOW_PROBABILITY, 0.5, HIGH_PROBABILITY))
        return float(low), float(middle), float(high)

    @property
    def largest_error(self) -> float:
        """The largest of the values without their sign."""
        return max(abs(self.moments.minimum), abs(self.moments.maximum)) if len(self.values) else math.nan
