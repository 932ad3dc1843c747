"""Ends of a measure's bars: mean ∓ 3 sigma, or quantiles if trials do not reach that far."""

import math
from dataclasses import dataclass
from typing import Final

from tol3d.report.column import Column
from tol3d.report.number import COUNTED
from tol3d.runs.summary.measure import MeasureSummary

SHORT_OF_3_SIGMA: Final = 2.5  # sigma; a quantile nearer to the mean than this is no end of a normal law
BY_CHANCE: Final = 1e-3  # probability, at most, that so many trials of a normal law all stay that near to their mean
QUANTILES: Final = ("p0.135", "p99.865")
THREE_SIGMA: Final = ("low_3sigma", "high_3sigma")
QUANTILES_MEAN: Final = "; marked are the 0.135 % and 99.865 % quantiles, because the trials end before mean ± 3 sigma"


@dataclass(frozen=True)
class Ends:
    """The ends of a bar in the measure's unit, None if unknown, and their names."""

    low: float | None
    high: float | None
    words: tuple[str, str] = ("−3σ", "+3σ")

    @classmethod
    def of(cls, column: Column, *, bounded: bool) -> "Ends":
        """Ends of a column of a measure, `bounded` or not."""
        if bounded and all(column.value(key) is not None for key in QUANTILES):
            low, high = (column.value(key) for key in QUANTILES)
            return cls(low, high, ("0.135 %", "99.865 %"))
        low, high = (column.value(key) for key in THREE_SIGMA)
        return cls(low, high)


def is_bounded(measure: MeasureSummary) -> bool:
    """True if mean ∓ 3 sigma lies where a measure has no values.

    Below 0 that is of counts and ranges, else where trials end before: a range near 0, a sum of a few uniform laws.
    """
    sample = measure.sample(measure.best_method)
    if sample is None:
        return False
    known = (sample.mean, sample.sigma, sample.count, sample.p0_135, sample.p99_865)
    return (_is_never_negative(measure) and _reaches_below_0(*known[:2])) or _ends_early(*known)


def _is_never_negative(measure: MeasureSummary) -> bool:
    """True for counts and peak-to-peak values."""
    return measure.unit in COUNTED or measure.take in ("range", "harmonic")


def _reaches_below_0(mean: float | None, sigma: float | None) -> bool:
    return mean is not None and sigma is not None and mean - 3 * sigma < 0.0


def _ends_early(
    mean: float | None, sigma: float | None, count: int | None, low: float | None, high: float | None
) -> bool:
    """True if an outer quantile of a sample lies nearer to its mean than for any normal distribution.

    Within SHORT_OF_3_SIGMA of it, with trials enough to be sure: n of a normal law all stay within k sigma on one side
    of their mean with a chance of (1 − Φ(−k))^n.

    >>> [_ends_early(0.0, 1.0, count, -1.73, 1.73) for count in (100, 1000)]
    [False, True]
    """
    if mean is None or not sigma or count is None or low is None or high is None:
        return False
    nearest = max(0.0, min(mean - low, high - mean))  # a far outlier pulls the mean out of its quantiles
    if nearest > SHORT_OF_3_SIGMA * sigma:
        return False
    beyond = math.erfc(nearest / sigma / math.sqrt(2)) / 2
    return bool(count * math.log1p(-beyond) < math.log(BY_CHANCE))
