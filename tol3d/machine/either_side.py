"""One of two sides, each as often: the end of its play at which a joint lies that nothing loads."""

from dataclasses import dataclass

import numpy as np

from tol3d.distributions.base import Distribution
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class EitherSide(Distribution):
    """-1 or 1."""

    def ppf(self, u: Array) -> Array:
        """-1 below one half, 1 from it on."""
        return np.where(u < 0.5, -1.0, 1.0)

    def cdf(self, x: Array) -> Array:
        """0, one half from -1 on, 1 from 1 on."""
        return np.where(x >= 1.0, 1.0, np.where(x >= -1.0, 0.5, 0.0))

    @property
    def mean(self) -> float:
        """0."""
        return 0.0

    @property
    def variance(self) -> float:
        """1."""
        return 1.0

    @property
    def limits(self) -> tuple[float, float]:
        """-1 and 1."""
        return -1.0, 1.0
