"""An estimated probability, with its confidence interval and warnings."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import beta as beta_law
from scipy.stats import t as student

from tol3d.numerics.arrays import Array

CONFIDENCE: Final = 0.95
MOST_FACTOR: Final = 1e6
"""Factor of an interval of which next to nothing is known."""


@dataclass(frozen=True)
class Estimate:
    """A probability by one method.

    Args:
        probability: of the failure.
        error: one standard error of it; None where it is not known.
        interval: that holds it with 95 % confidence; None where it is not known.
        unseated: share of the failing builds that cannot be assembled.
        draws: builds that were drawn for it.
        warnings: sentences.
    """

    probability: float | None
    error: float | None
    interval: tuple[float, float] | None
    unseated: float = 0.0
    draws: int = 0
    warnings: tuple[str, ...] = ()


def weighted_interval(probability: float, error: float, freedoms: float, unseen: float) -> tuple[float, float]:
    """By Student's law for the logarithm, on the rarer side.

    Args:
        probability, error: estimated.
        freedoms: of the error.
        unseen: upper bound if nothing was found.
    """
    if probability > 0.5:
        low, high = weighted_interval(1.0 - probability, error, freedoms, unseen)
        return 1.0 - high, 1.0 - low
    if not probability > 0.0:
        return 0.0, unseen
    quantile = float(student.ppf((1 + CONFIDENCE) / 2, max(freedoms, 1.0)))
    factor = min(math.exp(min(quantile * error / probability, 700.0)), MOST_FACTOR)
    return probability / factor, min(1.0, probability * factor)


def counted_interval(failed: int, draws: int) -> tuple[float, float]:
    """Clopper and Pearson's interval for a count of independent draws."""
    half = (1 - CONFIDENCE) / 2
    low = float(beta_law.ppf(half, failed, draws - failed + 1)) if failed else 0.0
    high = float(beta_law.ppf(1 - half, failed + 1, draws - failed)) if failed < draws else 1.0
    return low, high


def counted(fails: NDArray[np.bool_], unseated: NDArray[np.bool_], warnings: tuple[str, ...] = ()) -> Estimate:
    """The estimate of plain draws (n,)."""
    failed, draws = int(fails.sum()), len(fails)
    share = failed / draws
    error = math.sqrt(max(share * (1.0 - share), 1.0 / draws) / draws)
    among = float(unseated.sum()) / failed if failed else 0.0
    return Estimate(share, error, counted_interval(failed, draws), among, draws, warnings)


def effective(weights: Array) -> float:
    """Number of equal weights that say as much (Kish 1965)."""
    square = float((weights * weights).sum())
    return float(weights.sum()) ** 2 / square if square > 0.0 else 0.0
