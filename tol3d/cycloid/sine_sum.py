"""The law of a sum of normals and of one normal length times the sine of a phase anywhere on the circle."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import erf

PHASES: Final = 2048  # of a quarter circle; the half-range then is within 1e-4 of itself, 1e-12 where normals are in it
QUANTILE_XTOL: Final = 1e-12  # of the standard deviation
SIX_SIGMA_SHARE: Final = 0.9973  # that +-3 sigma of a normal covers


@dataclass(frozen=True)
class SineSum:
    """G + L sin(phase), phase uniform: not normal, though a Rayleigh length times that sine is.

    Given the phase the sum is normal with variance G^2 + L^2 sin^2(phase): its law is a mean of normals over a quarter
    of the circle, where the midpoint rule converges beyond all powers.

    Args:
        normal: standard deviation of what is normal.
        length: standard deviation of the normal length that the sine multiplies.

    >>> round(SineSum(0.0, 1.0).sigma, 6)
    0.707107
    """

    normal: float
    length: float

    @property
    def sigma(self) -> float:
        """Standard deviation."""
        return float(np.hypot(self.normal, self.length / np.sqrt(2.0)))

    def coverage(self, half_range: float) -> float:
        """Probability of -half_range to half_range."""
        return float(np.mean(erf(half_range / (np.sqrt(2.0) * self._spreads))))

    def half_range(self, share: float = SIX_SIGMA_SHARE) -> float:
        """Half-range, even about 0, that covers a share of all.

        Raises:
            ValueError: the share is not between 0 and 1.
        """
        if not 0.0 < share < 1.0:
            raise ValueError(f"share: expected a number between 0 and 1, got {share:g}")
        if self.sigma == 0.0:
            return 0.0
        unit = SineSum(self.normal / self.sigma, self.length / self.sigma)
        reach = 1.0
        while unit.coverage(reach) < share:
            reach *= 2.0
        return self.sigma * float(brentq(lambda x: unit.coverage(x) - share, 0.0, reach, xtol=QUANTILE_XTOL))

    @property
    def _spreads(self) -> NDArray[np.float64]:
        phases = (np.arange(PHASES) + 0.5) * (np.pi / 2 / PHASES)
        return np.asarray(np.hypot(self.normal, self.length * np.sin(phases)))
