"""Ppk of a measure: by quantiles, by the share out of limits, or by mean and sigma; the reason, and its bounds."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from tol3d.statistics.estimates import LimitCounts, Moments, equivalent_ppk
from tol3d.statistics.estimates.limits import normal_share, ppk_beyond, quantile_ppk
from tol3d.statistics.estimates.moments import kurtosis_se, skewness_se
from tol3d.statistics.estimates.performance_bounds import (
    OF_THE_MEDIAN,
    Bounds,
    index_bounds,
    least_of,
    quantile_index_bounds,
    replicates_bounds,
)
from tol3d.study.trials.study import PpkBy

By = Literal["quantiles", "share out of limits", "mean and sigma"]

OUTER: Final = 0.00135  # beyond each outer quantile of ISO 22514-2
NOT_NORMAL: Final = 0.2  # of skewness or excess kurtosis; less moves a Ppk of 1 by a tenth at most
SURE: Final = 5.0  # standard errors of a normal law's; by chance once in two million
CONSTANT: Final = 1e-7  # of a limit's distance; a smaller sigma is rounding
FEWEST: Final = math.ceil(1 / OUTER)  # trials; of fewer less than one lies beyond an outer quantile


UNBOUNDED: Final[Bounds] = (-math.inf, math.inf)


@dataclass(frozen=True)
class Side:
    """Values that a limit judges: all of a measure, or of curves the lowest or the highest of each.

    Args:
        moments: of the trials that have a value.
        replicates: the same of each replicate; empty for independent trials.
        quantile: the value below which a share of them lies; None if unknown.
        bounds: of that value, each by a chance of error; infinite where the trials have none.
    """

    moments: Moments
    replicates: Sequence[Moments]
    quantile: Callable[[float], float | None]
    bounds: Callable[[float, float], Bounds] = lambda share, chance: UNBOUNDED

    @property
    def not_normal(self) -> str:
        """Skewness or excess kurtosis if it differs from a normal law's beyond chance; else nothing.

        The error is that of as many independent trials of a normal law. Replicates may vary more, their spread counts
        then.
        """
        own, count = self.moments, self.moments.count
        parts = (
            [replicate.skewness for replicate in self.replicates],
            [replicate.excess_kurtosis for replicate in self.replicates],
        )
        errors = (_larger(skewness_se(count), parts[0]), _larger(kurtosis_se(count), parts[1]))
        values = {"skewness": own.skewness, "excess kurtosis": own.excess_kurtosis}
        for (word, value), error in zip(values.items(), errors, strict=True):
            if abs(value) > max(NOT_NORMAL, SURE * error):
                return f"{word} {value:.2f}"
        return ""

    def pair(self, first: float, second: float) -> tuple[float, float] | None:
        """Two quantiles; None where one is not known or trials are too few for it."""
        low, high = self.quantile(first), self.quantile(second)
        return None if self.moments.count < FEWEST or low is None or high is None else (low, high)


def _larger(error: float, replicates: Sequence[float]) -> float:
    """The larger of an error and that by the spread of replicates."""
    spread = float(np.std(replicates, ddof=1)) / math.sqrt(len(replicates)) if len(replicates) > 1 else 0.0
    return max(error, spread if math.isfinite(spread) else 0.0)


@dataclass(frozen=True)
class Performance:
    """A Ppk, the rule by which it was found, and the reason; None if trials do not suffice.

    Its bounds hold the true one of that rule with 95 % confidence; infinite where the trials give none.
    """

    ppk: float | None
    by: By
    reason: str
    bounds: Bounds = UNBOUNDED


def varying(side: Side, margin: float) -> float:
    """Sigma of what a limit judges; 0 where it is rounding beside the limit's distance."""
    sigma = side.moments.sigma
    return sigma if sigma > CONSTANT * abs(margin) else 0.0


@dataclass(frozen=True)
class Judged:
    """Limits of a measure, and the statistics of its trials against them.

    Args:
        lower, upper: the limits; None for none.
        low, high: values that the one and the other judges.
        counts: of all trials.
        interval: bounds of the true share out of limits [ppm]; None if unknown.
    """

    lower: float | None
    upper: float | None
    low: Side
    high: Side
    counts: LimitCounts
    interval: tuple[float, float] | None

    def performance(self, asked: PpkBy | None) -> Performance:
        """Performance by the share out of limits if any build failed, else as asked, else by the law of the trials.

        Mean and sigma are of a normal law. By quantiles it is taken where a skewness or kurtosis is not one's, and
        where a normal law would have a share out that the trials refute, so that Ppk and verdict do not contradict
        each other.
        """
        if (self.lower, self.upper) == (None, None):
            return Performance(None, "mean and sigma", "")
        if self.counts.failed:
            found, why = equivalent_ppk(self.counts.out_of_limits), f"{self.counts.failed} failed"
            low, high = self.interval or (0.0, 1e6)
            bounds = ppk_beyond(high * 1e-6), ppk_beyond(low * 1e-6)
            return Performance(found, "share out of limits", why, bounds)
        if not any(varying(side, margin) for side, margin in self._sides):
            return Performance(None, "mean and sigma", "")
        reason = "as asked" if asked else next(self._reasons_against_normal(), "")
        if asked == "sigma" or not reason:
            indices = [margin / (3 * sigma) for side, margin in self._sides if (sigma := varying(side, margin))]
            return Performance(min(indices, default=None), "mean and sigma", reason, least_of(self._by_moments))
        found = quantile_ppk(self.lower, self.upper, self.low.pair(OUTER, 0.5), self.high.pair(0.5, 1 - OUTER))
        few = any(side.moments.count < FEWEST for side, _ in self._sides)
        reason = f"{reason}; under {FEWEST} trials" if few else reason
        return Performance(found, "quantiles", reason, least_of(self._by_quantiles))

    def _by_moments(self, chance: float) -> list[Bounds]:
        """Bounds of the index of each limit, by mean and sigma."""
        found = []
        for (side, margin), sign in zip(self._sides, self._signs, strict=True):
            if (sigma := varying(side, margin)) and side.replicates:
                limit = side.moments.mean - sign * margin
                parts = [
                    (replicate.mean - limit) / replicate.sigma if replicate.m2 > 0 else math.nan
                    for replicate in side.replicates
                ]
                parts = [sign * part / 3 for part in parts]
                found.append(replicates_bounds(margin / (3 * sigma), parts, chance))
            elif sigma:
                found.append(index_bounds(side.moments, margin, sign, chance))
        return found

    def _by_quantiles(self, chance: float) -> list[Bounds]:
        """The same by quantiles, as of independent trials: nets have no larger errors of a share, but for chance."""
        found = []
        for (side, margin), sign in zip(self._sides, self._signs, strict=True):
            median = side.bounds(0.5, OF_THE_MEDIAN * chance)
            outer = side.bounds(OUTER if sign > 0 else 1 - OUTER, (1 - OF_THE_MEDIAN) * chance)
            found.append(quantile_index_bounds(median, outer, side.moments.mean - sign * margin))
        return found

    @property
    def _signs(self) -> list[float]:
        """Signs of the limits that there are: +1 of the lower one, -1 of the upper one."""
        return [sign for limit, sign in ((self.lower, 1.0), (self.upper, -1.0)) if limit is not None]

    @property
    def _sides(self) -> list[tuple[Side, float]]:
        """The values that each limit judges, and its distance from their mean."""
        found = []
        if self.lower is not None:
            found.append((self.low, self.low.moments.mean - self.lower))
        if self.upper is not None:
            found.append((self.high, self.upper - self.high.moments.mean))
        return found

    def _reasons_against_normal(self) -> Iterator[str]:
        yield from (words for side, _ in self._sides if (words := side.not_normal))
        shares = [normal_share(margin, sigma) for side, margin in self._sides if (sigma := varying(side, margin))]
        out = 1e6 * sum(shares)
        if shares and self.interval and not self.interval[0] <= out <= self.interval[1]:
            yield f"a normal law would have {out / 1e4:.3g} % out"
