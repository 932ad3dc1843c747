"""Statistics of a run, folded block by block: memory does not grow with the number of trials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.analytic import ClosedForm, closed_form
from tol3d.engines import STATUS_TEXT
from tol3d.features import feature_groups, feature_key, features
from tol3d.model import Measure, Model
from tol3d.replicated import Replicated, rows_of_replicates
from tol3d.stages import StageTallies, merged, stage_tallies
from tol3d.statistics import Agreement, FeatureSums, Grid, LimitCounts, Moments, pp, ppk, shares
from tol3d.statistics.door import quick_products
from tol3d.statistics.grid import BINS
from tol3d.statistics.variance_shares import Products, plain_products

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[np.generic]]

PILOT_TRIALS = 64  # the study's first trials; they tell sigma to 9 %, and a spread that the stack-up does not see
GRID_SIGMAS = 12.0  # the grid spans the mean +- this many sigma of both roads: bins of 1.8e-4 sigma, 1.3 nm
LEAST_SPAN = 1e-3  # mm or rad; for a model in which nothing varies
HISTOGRAM_BINS = 64  # bars kept in summary.json for pictures
ROADS = ("analytic", "geometric")
QUANTILES = {"p0.135": 0.00135, "p50": 0.5, "p99.865": 0.99865}


def grids_of(model: Model, pilot: Columns) -> Mapping[str, Grid]:
    """The empty grid of each scalar measure: a function of model and seed alone, so that any blocks add up.

    Args:
        pilot: columns of the study's first PILOT_TRIALS trials, whatever the number of trials.
    """
    return {
        measure.name: _grid(measure, closed_form(model, measure), pilot)
        for measure in model.measures
        if measure.take != "curve"
    }


def _grid(measure: Measure, form: ClosedForm | None, pilot: Columns) -> Grid:
    spans = [(form.mean * measure.per_internal, form.sigma * measure.per_internal)] if form else []
    for road in ("analytic", "geometric"):
        values = np.asarray(pilot.get(f"{road}:{measure.name}", ()), dtype=np.float64)
        good = values[~np.isnan(values)]
        spans += [(float(good.mean()), float(good.std()))] if len(good) else []
    reach = [max(GRID_SIGMAS * sigma, LEAST_SPAN * measure.per_internal) for _, sigma in spans]
    lower = min(mean - half for (mean, _), half in zip(spans, reach, strict=True))
    upper = max(mean + half for (mean, _), half in zip(spans, reach, strict=True))
    return Grid.empty(lower, (upper - lower) / BINS, BINS)


@dataclass(frozen=True)
class Sample:
    """One road's sample of one measure: moments, limits, a fine grid of counts.

    `replicated` is the sample by replicates where its trials are not independent, and tells its errors then.
    """

    moments: Moments
    grid: Grid
    limits: LimitCounts
    replicated: Replicated | None = None

    @classmethod
    def of(cls, measure: Measure, values: Array, empty: Grid, rows: Mapping[int, slice]) -> "Sample":
        """Sample of a block; values (trials,) in the measure's unit, nan where a trial failed.

        Args:
            measure: what was measured.
            values: of the block's trials.
            empty: the measure's grid.
            rows: which of them belong to each replicate; empty for independent trials.
        """
        good = values[~np.isnan(values)]
        lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
        return cls(
            moments=Moments.of(good),
            grid=empty.add(good),
            limits=LimitCounts.of(values, lower=lower, upper=upper),
            replicated=Replicated.of(values, rows, lower, upper) if rows else None,
        )

    def merge(self, other: "Sample") -> "Sample":
        """Both samples as one."""
        return Sample(
            self.moments.merge(other.moments),
            self.grid.merge(other.grid),
            self.limits.merge(other.limits),
            self.replicated.merge(other.replicated) if self.replicated and other.replicated else None,
        )


@dataclass(frozen=True)
class MeasureTally:
    """All that is kept of one measure."""

    analytic: Sample
    geometric: Sample | None
    agreement: Agreement | None
    analytic_features: FeatureSums
    geometric_features: FeatureSums | None

    def merge(self, other: "MeasureTally") -> "MeasureTally":
        """Both tallies as one."""
        return MeasureTally(
            self.analytic.merge(other.analytic),
            self.geometric.merge(other.geometric) if self.geometric and other.geometric else None,
            self.agreement.merge(other.agreement) if self.agreement and other.agreement else None,
            self.analytic_features.merge(other.analytic_features),
            self.geometric_features.merge(other.geometric_features)
            if self.geometric_features and other.geometric_features
            else None,
        )


@dataclass(frozen=True)
class _Block:
    """One block of columns, and which of its rows belong to each replicate."""

    model: Model
    columns: Columns
    rows: Mapping[int, slice]

    def values(self, road: str, measure: Measure) -> Array | None:
        """A measure's column; None where that road was not gone."""
        column = self.columns.get(f"{road}:{measure.name}")
        return None if column is None else np.asarray(column, dtype=np.float64)

    @property
    def _products(self) -> Products:
        return quick_products() if self.model.study.engine == "exact" else plain_products

    def tally(self, measures: Sequence[Measure], grids: Mapping[str, Grid]) -> dict[str, MeasureTally]:
        """Tallies of scalar measures."""
        sums = self._sums(measures)
        tallies = {}
        for measure in measures:
            analytic, geometric = (self.values(road, measure) for road in ROADS)
            if analytic is None:
                raise ValueError(f"no analytic column of {measure.name}")
            empty = grids[measure.name]
            seen = geometric is not None
            tallies[measure.name] = MeasureTally(
                Sample.of(measure, analytic, empty, self.rows),
                Sample.of(measure, geometric, empty, self.rows) if geometric is not None else None,
                Agreement.of(geometric, analytic) if geometric is not None else None,
                sums["analytic", measure.name],
                sums["geometric", measure.name] if seen else None,
            )
        return tallies

    def _sums(self, measures: Sequence[Measure]) -> dict[tuple[str, str], FeatureSums]:
        """What each road's column of each measure has in common with its features, by road and name."""
        sums: dict[tuple[str, str], FeatureSums] = {}
        for key in dict.fromkeys(map(feature_key, measures)):
            alike = [measure for measure in measures if feature_key(measure) == key]
            seen = features(self.model, alike[0], self.columns)
            columns = {(r, m.name): column for m in alike for r in ROADS if (column := self.values(r, m)) is not None}
            whole = {name: column for name, column in columns.items() if not np.isnan(np.min(column))}
            if whole:
                each = FeatureSums.of_each(seen, np.stack(list(whole.values())), self._products)
                sums |= dict(zip(whole, each, strict=True))
            for name in columns.keys() - whole.keys():
                good = ~np.isnan(columns[name])
                sums[name] = FeatureSums.of_each(seen[:, good], columns[name][None, good], self._products)[0]
        return sums


@dataclass(frozen=True)
class CurveTally:
    """A curve measure: moments at each position, for both roads, and the trials with any position out of limits."""

    analytic: tuple[Moments, ...]
    geometric: tuple[Moments, ...] | None
    below: Mapping[str, LimitCounts]
    above: Mapping[str, LimitCounts]

    @classmethod
    def of(cls, measure: Measure, columns: Columns) -> "CurveTally":
        """Tally of one block of columns."""

        curves = {
            road: np.asarray(columns[f"{road}:{measure.name}"], dtype=np.float64)
            for road in ("analytic", "geometric")
            if f"{road}:{measure.name}" in columns
        }
        moments = {
            road: tuple(Moments.of(column[~np.isnan(column)]) for column in values.T) for road, values in curves.items()
        }
        lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
        return cls(
            moments["analytic"],
            moments.get("geometric"),
            below={road: LimitCounts.of(values.min(axis=1), lower, None) for road, values in curves.items()},
            above={road: LimitCounts.of(values.max(axis=1), None, upper) for road, values in curves.items()},
        )

    def merge(self, other: "CurveTally") -> "CurveTally":
        """Both tallies as one."""

        def merged(mine: tuple[Moments, ...], its: tuple[Moments, ...]) -> tuple[Moments, ...]:
            return tuple(a.merge(b) for a, b in zip(mine, its, strict=True))

        return CurveTally(
            merged(self.analytic, other.analytic),
            merged(self.geometric, other.geometric) if self.geometric and other.geometric else None,
            {road: counts.merge(other.below[road]) for road, counts in self.below.items()},
            {road: counts.merge(other.above[road]) for road, counts in self.above.items()},
        )


@dataclass(frozen=True)
class Tally:
    """Statistics of a whole run so far; `unphysical` counts draws below what a contributor can be."""

    trials: int
    status: Mapping[str, int]
    unphysical: Mapping[str, int]
    measures: Mapping[str, MeasureTally]
    curves: Mapping[str, CurveTally]
    stages: StageTallies

    @classmethod
    def of(cls, model: Model, grids: Mapping[str, Grid], columns: Columns, first: int = 0) -> "Tally":
        """Tally of one block that begins at trial `first`; `grids` as grids_of gives them."""
        trials = len(next(iter(columns.values())))
        status = columns.get("status")
        counts = {text: trials if text == "ok" else 0 for text in STATUS_TEXT.values()}
        if status is not None:
            counts = {text: int(np.count_nonzero(status == text)) for text in STATUS_TEXT.values()}
        rows = rows_of_replicates(model.study, first, trials)
        scalars = [measure for measure in model.measures if measure.take != "curve"]
        curves = [measure for measure in model.measures if measure.take == "curve"]
        return cls(
            trials,
            counts,
            _unphysical(model, columns),
            _Block(model, columns, rows).tally(scalars, grids),
            {measure.name: CurveTally.of(measure, columns) for measure in curves},
            stage_tallies(model, columns),
        )

    def merge(self, other: "Tally") -> "Tally":
        """Both tallies as one; fold blocks in their order."""
        return Tally(
            self.trials + other.trials,
            {text: count + other.status[text] for text, count in self.status.items()},
            {name: count + other.unphysical[name] for name, count in self.unphysical.items()},
            {name: tally.merge(other.measures[name]) for name, tally in self.measures.items()},
            {name: tally.merge(other.curves[name]) for name, tally in self.curves.items()},
            merged(self.stages, other.stages),
        )


def _unphysical(model: Model, columns: Columns) -> dict[str, int]:
    counts = {}
    for contributor in model.contributors:
        if contributor.least is not None:
            drawn = np.asarray(columns[contributor.columns[0]], dtype=np.float64)
            counts[contributor.name] = int(np.count_nonzero(drawn < contributor.least / contributor.per_unit))
    return counts


def in_unit(measure: Measure, value: float | None) -> float | None:
    """A length or angle in the measure's unit; None stays None."""
    return None if value is None else value * measure.per_internal


def sample_summary(measure: Measure, sample: Sample) -> dict[str, Any]:
    """A sample as summary.json shows it, in the measure's unit."""
    moments, limits = sample.moments, sample.limits
    lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
    errors = sample.replicated or _Independent(moments, limits)
    summary: dict[str, Any] = {
        "count": moments.count,
        "mean": moments.mean if moments.count else None,
        "sigma": moments.sigma,
        "low_3sigma": moments.mean - 3 * moments.sigma,
        "high_3sigma": moments.mean + 3 * moments.sigma,
        "sample_min": moments.minimum,
        "sample_max": moments.maximum,
        **{name: _quantile(sample, p) for name, p in QUANTILES.items()},
        "quantile_error": sample.grid.width,
        "outside_grid": sample.grid.underflow + sample.grid.overflow,
        "below_limit_ppm": limits.below_limit.ppm,
        "below_limit_ppm_95": errors.below_interval_ppm,
        "above_limit_ppm": limits.above_limit.ppm,
        "above_limit_ppm_95": errors.above_interval_ppm,
        "failed_ppm": limits.failures.ppm,
        "mean_se": errors.mean_se,
        "sigma_se": errors.sigma_se,
        "error_by": "sample" if sample.replicated is None else "replicates",
        "skewness": moments.skewness,
        "kurtosis": moments.excess_kurtosis,
        "pp": pp(lower, upper, moments.sigma),
        "ppk": ppk(lower, upper, moments.mean, moments.sigma),
    }
    return {key: _finite(value) for key, value in summary.items()}


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
    def below_interval_ppm(self) -> tuple[float, float] | None:
        return self.limits.below_limit.interval_ppm() if self.moments.count else None

    @property
    def above_interval_ppm(self) -> tuple[float, float] | None:
        return self.limits.above_limit.interval_ppm() if self.moments.count else None


def _quantile(sample: Sample, p: float) -> float | None:
    """The grid's quantile, which lies within a bin, not beyond the sample's own ends."""
    value = sample.grid.quantile(p)
    return None if value is None else min(max(value, sample.moments.minimum), sample.moments.maximum)


def _finite(value: Any) -> Any:
    """JSON has no nan: what cannot be told (a sigma of one trial) is null."""
    return None if isinstance(value, float) and not np.isfinite(value) else value


def histograms(tally: MeasureTally) -> dict[str, Any]:
    """Counts of both roads over the same bars, for pictures; in the measure's unit."""
    samples = {"analytic": tally.analytic, **({"geometric": tally.geometric} if tally.geometric else {})}
    filled = [sample.moments for sample in samples.values() if sample.moments.count]
    if not filled:
        return {}
    span = (min(m.minimum for m in filled), max(m.maximum for m in filled))
    drawn = {road: sample.grid.histogram(HISTOGRAM_BINS, span) for road, sample in samples.items()}
    edges = drawn["analytic"].edges
    return {
        "lower_edge": float(edges[0]),
        "bin_width": float(edges[1] - edges[0]),
        "counts": {road: histogram.counts.tolist() for road, histogram in drawn.items()},
    }


def share_percents(
    model: Model, measure: Measure, sums: FeatureSums | None
) -> dict[str, tuple[float | None, float | None]]:
    """Share of the variance [%] of each acting contributor by regression, its standard error; None where unknown."""
    groups = feature_groups(model, measure)
    if sums is None:
        return dict.fromkeys(groups, (None, None))
    found = shares(sums, groups)
    return {name: (_finite(100 * found.share[name]), _finite(100 * found.standard_error[name])) for name in groups}
