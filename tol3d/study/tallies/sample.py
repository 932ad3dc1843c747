"""One method's sample of one measure: gathered block by block, shown in summary.json."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tol3d.statistics.estimates import CountGrid, Grid, LimitCounts, Moments, pp
from tol3d.statistics.estimates.limits import quantile_pp
from tol3d.statistics.estimates.performance_bounds import CHANCE, Bounds, rank_below
from tol3d.study.runs.summary import sample as summary
from tol3d.study.runs.summary.values import made
from tol3d.study.system.measure import Measure
from tol3d.study.system.outcome import Mask, Outcome
from tol3d.study.system.pooled_statistic import Pool
from tol3d.study.tallies.performance import OUTER, Judged, Side
from tol3d.study.tallies.replicated import Replicated, students_half
from tol3d.study.trials.study import PpkBy

QUANTILES = (OUTER, 0.5, 1 - OUTER)


def in_unit(measure: Measure, value: float | None) -> float | None:
    """A length or angle in the measure's unit; None stays None."""
    return None if value is None else value * measure.per_internal


def lacking_of(measure: Measure, outcome: Outcome) -> Mask | None:
    """Trials of status "lacking", which are below every lower limit.

    But for a range: that of a build whose parts overlap says nothing of how far it swings, so it counts as failed only.
    """
    return None if measure.take == "range" else outcome.lacking


@dataclass(frozen=True)
class Sample:
    """One method's sample of one measure.

    Args:
        moments, grid: of the trials that were assembled.
        limits: of all trials.
        deepest: the largest overlap of a trial, as a value below 0; inf if none is known.
        replicated: the sample by replicates where its trials are not independent, and its errors are theirs then.
    """

    moments: Moments
    grid: Grid | CountGrid
    limits: LimitCounts
    deepest: float
    replicated: Replicated | None = None

    @classmethod
    def of(cls, measure: Measure, outcome: Outcome, empty: Grid, rows: Mapping[int, slice]) -> "Sample":
        """Sample of a block.

        Args:
            measure: that was read.
            outcome: of the block's trials, values (trials,).
            empty: the measure's grid.
            rows: which of them belong to each replicate; empty for independent trials.
        """
        values, lacking = outcome.values, lacking_of(measure, outcome)
        good = values[~np.isnan(values)]
        lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
        return cls(
            moments=Moments.of(good),
            grid=empty.add(good),
            limits=LimitCounts.of(values, lower, upper, lacking),
            deepest=outcome.deepest,
            replicated=Replicated.of(values, rows, lower, upper, lacking) if rows else None,
        )

    def merge(self, other: "Sample") -> "Sample":
        """Both samples as one."""
        return Sample(
            self.moments.merge(other.moments),
            self.grid.merge(other.grid),
            self.limits.merge(other.limits),
            min(self.deepest, other.deepest),
            self.replicated.merge(other.replicated) if self.replicated and other.replicated else None,
        )

    @property
    def side(self) -> Side:
        """Its values, as a limit judges them."""
        replicates = [*self.replicated.moments.values()] if self.replicated else []
        moments, grid = self.moments, self.grid
        return Side(
            moments,
            replicates,
            lambda p: quantile(moments, grid, p),
            lambda p, chance: quantile_bounds(moments, grid, p, chance),
        )


def sample_summary(measure: Measure, sample: Sample, asked: PpkBy | None = None) -> summary.Sample:
    """A sample as summary.json shows it, in the measure's unit; `asked` is the requested basis of Ppk."""
    moments, limits = sample.moments, sample.limits
    lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
    errors = sample.replicated or _Independent(moments, limits)
    judged = Judged(lower, upper, sample.side, sample.side, limits, errors.out_interval_ppm)
    performance = judged.performance(asked)
    pooled = {statistic.name: finite(statistic.of(_pool(sample))) for statistic in measure.pooled_statistics}
    low, middle, high = (finite(quantile(moments, sample.grid, p)) for p in QUANTILES)
    return made(
        summary.Sample,
        count=moments.count,
        trials=limits.total,
        mean=finite(moments.mean) if moments.count else None,
        sigma=finite(moments.sigma),
        low_3sigma=finite(moments.mean - 3 * moments.sigma),
        high_3sigma=finite(moments.mean + 3 * moments.sigma),
        sample_min=finite(moments.minimum),
        sample_max=finite(moments.maximum),
        p0_135=low,
        p50=middle,
        p99_865=high,
        p0_135_95=both(quantile_bounds(moments, sample.grid, OUTER, CHANCE)),
        p99_865_95=both(quantile_bounds(moments, sample.grid, 1 - OUTER, CHANCE)),
        quantile_error=sample.grid.quantile_error,
        outside_grid=sample.grid.underflow + sample.grid.overflow,
        below_limit_ppm=finite(limits.below_limit.ppm),
        below_limit_ppm_95=listed(errors.below_interval_ppm),
        above_limit_ppm=finite(limits.above_limit.ppm),
        above_limit_ppm_95=listed(errors.above_interval_ppm),
        failed_ppm=finite(limits.failures.ppm),
        out_ppm=finite(limits.out_of_limits.ppm),
        out_ppm_95=listed(errors.out_interval_ppm),
        deepest_overlap=finite(sample.deepest),
        mean_se=finite(errors.mean_se),
        sigma_se=finite(errors.sigma_se),
        mean_95=mean_interval(moments, errors),
        sigma_95=sigma_interval(moments, errors),
        error_by="sample" if sample.replicated is None else "replicates",
        skewness=finite(moments.skewness),
        kurtosis=finite(moments.excess_kurtosis),
        pp=finite(
            quantile_pp(lower, upper, low, high) if performance.by == "quantiles" else pp(lower, upper, moments.sigma)
        ),
        ppk=finite(performance.ppk),
        ppk_95=both(performance.bounds) if performance.ppk is not None else None,
        ppk_by=performance.by,
        ppk_reason=performance.reason or None,
        pooled=pooled or None,
    )


def _pool(sample: Sample) -> Pool:
    moments = sample.moments
    return Pool(
        moments.mean, moments.sigma, moments.minimum, moments.maximum, lambda p: quantile(moments, sample.grid, p)
    )


@dataclass(frozen=True)
class _Independent:
    """Errors of a sample of independent trials."""

    moments: Moments
    limits: LimitCounts

    @property
    def mean_se(self) -> float:
        return self.moments.mean_se

    @property
    def sigma_se(self) -> float:
        return self.moments.sigma_se

    @property
    def freedom(self) -> int:
        return self.moments.count - 1

    @property
    def below_interval_ppm(self) -> tuple[float, float] | None:
        return self.limits.below_limit.interval_ppm() if self.limits.total else None

    @property
    def above_interval_ppm(self) -> tuple[float, float] | None:
        return self.limits.above_limit.interval_ppm() if self.limits.total else None

    @property
    def out_interval_ppm(self) -> tuple[float, float] | None:
        return self.limits.out_of_limits.interval_ppm() if self.limits.total else None


Errors = Replicated | _Independent


def quantile(moments: Moments, grid: Grid, p: float) -> float | None:
    """The grid's quantile of a sample, which lies within a bin, not beyond the sample's own ends."""
    value = grid.quantile(p)
    return None if value is None else min(max(value, moments.minimum), moments.maximum)


def quantile_bounds(moments: Moments, grid: Grid, p: float, chance: float) -> Bounds:
    """Bounds of the quantile of a sample's law, each by a chance of error; infinite where the trials are too few.

    Order statistics, read from the grid to a bin outside them.
    """
    count = moments.count
    if not count:
        return -math.inf, math.inf
    low, high = rank_below(count, p, chance), rank_below(count, 1 - p, chance)
    lower = quantile(moments, grid, (low - 0.5) / count) if low else None
    upper = quantile(moments, grid, (count - high + 0.5) / count) if high else None
    return (
        -math.inf if lower is None else max(lower - grid.quantile_error, moments.minimum),
        math.inf if upper is None else min(upper + grid.quantile_error, moments.maximum),
    )


def mean_interval(moments: Moments, errors: Errors) -> list[float | None]:
    """Bounds of the true mean, 95 % confidence, by Student's t; null where its error is not known."""
    half = students_half(errors.mean_se, errors.freedom)
    return [finite(moments.mean - half), finite(moments.mean + half)]


def sigma_interval(moments: Moments, errors: Errors) -> list[float | None]:
    """Bounds of the true sigma, 95 % confidence, by Student's t; null where its error is not known.

    Of n trials of a net the mean hardly varies, so that the mean square is to be divided by n, not by n - 1 as of
    independent ones: the lower bound counts from that.
    """
    half, own = students_half(errors.sigma_se, errors.freedom), moments.sigma
    least = own if isinstance(errors, _Independent) else own * math.sqrt(1 - 1 / max(moments.count, 1))
    return [finite(max(least - half, 0.0)) if math.isfinite(half) else None, finite(own + half)]


def finite(value: float | None) -> float | None:
    """JSON has no nan: an unknown value (a sigma of one trial) is null."""
    return None if value is None or not math.isfinite(value) else value


def both(bounds: Bounds) -> list[float | None]:
    """Both bounds, as JSON has them; null for none."""
    return [finite(bounds[0]), finite(bounds[1])]


def listed(interval: tuple[float, float] | None) -> list[float] | None:
    """Both ends, as JSON has them."""
    return None if interval is None else list(interval)
