"""A least-squares fit of a target on feature columns, with the errors of its coefficients."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from tol3d.statistics.variance_shares import RegressorSums, column_sigmas, factorised

Array = NDArray[np.float64]

LEAST_FREEDOM = 30  # rows beyond the fit's unknowns; Student's 5 sigma there is as rare as a normal's 4.2


@dataclass(frozen=True, eq=False)
class LinearFit:
    """Coefficients of y = b0 + b x by least squares; features that say the same share theirs, constant ones have 0.

    Args:
        count: rows.
        coefficients: (features,), in the unit of y per unit of x.
        covariance: (features, features) of the coefficients, for errors that do not depend on the features.
        spread: (features, features), covariance of the features themselves.
        intercept: of the features' zero [unit of y].
        residual: standard deviation of what is left [unit of y].
    """

    count: int
    coefficients: Array
    covariance: Array
    spread: Array
    intercept: float
    residual: float

    @classmethod
    def of(cls, sums: RegressorSums) -> Self | None:
        """The fit of the sums' target; None where there are too few rows to distinguish coefficients from chance."""
        width, sigma = len(sums.means) - 1, column_sigmas(sums)
        used = np.flatnonzero(sigma[:-1] > 0.0)
        freedom = sums.count - len(used) - 1
        if freedom < LEAST_FREEDOM:
            return None
        scale = sigma[used]
        correlation = sums.comoments[np.ix_(used, used)] / sums.count / scale / scale[:, None]
        inverse = factorised(correlation).inverse / scale / scale[:, None] / sums.count
        coefficients, covariance = np.zeros(width), np.zeros((width, width))
        coefficients[used] = inverse @ sums.comoments[used, -1]
        left = max(float(sums.comoments[-1, -1] - coefficients @ sums.comoments[:-1, -1]), 0.0)
        covariance[np.ix_(used, used)] = inverse * left / freedom
        return cls(
            sums.count,
            coefficients,
            covariance,
            sums.comoments[:-1, :-1] / sums.count,
            float(sums.means[-1] - coefficients @ sums.means[:-1]),
            math.sqrt(left / freedom),
        )

    def effect(self, group: slice) -> float:
        """Standard deviation of a group's part of the fit [unit of y]."""
        return effect_of(self.coefficients[group], self.spread[group, group])


def effect_of(coefficients: Array, spread: Array) -> float:
    """Standard deviation of a weighted sum of features with a covariance (features, features)."""
    return math.sqrt(max(float(coefficients @ spread @ coefficients), 0.0))


def standard_errors(coefficients: Array, covariance: Array) -> float:
    """How many standard errors a group of coefficients is from 0: the root of Wald's statistic; inf without error."""
    if not coefficients.any():
        return 0.0
    if not covariance.any():
        return math.inf
    return math.sqrt(max(float(coefficients @ np.linalg.pinv(covariance, hermitian=True) @ coefficients), 0.0))
