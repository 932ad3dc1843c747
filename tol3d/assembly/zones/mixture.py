"""A law that is one of several, each as likely as any other."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.assembly.zones.domain import Array
from tol3d.distributions import Distribution

HALVINGS: Final = 60  # down to the last bits of a double


@dataclass(frozen=True, eq=False)
class Mixture(Distribution):
    """Of laws with limits.

    Args:
        laws: each of the same probability.
        of_all: the variance, where it is known better than from these laws; from them if not given.
    """

    laws: Sequence[Distribution]
    of_all: float | None = None

    def ppf(self, u: Array) -> Array:
        """See Distribution: by bisection of the distribution function."""
        bottom, top = self.limits
        low, high = np.full(np.shape(u), bottom), np.full(np.shape(u), top)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            is_below = self.cdf(middle) < u
            low, high = np.where(is_below, middle, low), np.where(is_below, high, middle)
        return np.asarray(0.5 * (low + high))

    def cdf(self, x: Array) -> Array:
        """See Distribution."""
        return np.asarray(sum(law.cdf(x) for law in self.laws) / len(self.laws))

    @property
    def mean(self) -> float:
        """See Distribution."""
        return sum(law.mean for law in self.laws) / len(self.laws)

    @cached_property
    def variance(self) -> float:
        """See Distribution."""
        if self.of_all is not None:
            return self.of_all
        return sum(law.variance + (law.mean - self.mean) ** 2 for law in self.laws) / len(self.laws)

    @cached_property
    def limits(self) -> tuple[float, float]:
        """The ends of the widest."""
        return min(law.low for law in self.laws), max(law.high for law in self.laws)
