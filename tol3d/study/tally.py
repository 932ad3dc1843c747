"""Statistics of a run, folded block by block: memory does not grow with the number of trials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines import STATUS_TEXT
from tol3d.gearing.model import Measure, Model
from tol3d.gearing.stack_up import ClosedForm, closed_form
from tol3d.runs.outcome import SEATED, Told, status_column, told
from tol3d.statistics import Agreement, FeatureSums, Grid, LimitCounts, Moments, shares
from tol3d.statistics.grid import BINS
from tol3d.statistics.lazy import quick_products
from tol3d.statistics.variance_shares import Products, plain_products
from tol3d.study.agreement.disagreement import Disagreement
from tol3d.study.regressors import acting, feature_groups, feature_key, features
from tol3d.study.replicated import rows_of_replicates
from tol3d.study.sample import Sample, finite, in_unit, lacking_of
from tol3d.study.stages import StageTallies, merged, stage_tallies

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[np.generic]]

PILOT_TRIALS = 64  # the study's first trials; they tell sigma to 9 %, and a spread that the stack-up does not see
GRID_SIGMAS = 12.0  # the grid spans the mean +- this many sigma of both roads: bins of 1.8e-4 sigma, 1.3 nm
LEAST_SPAN = 1e-3  # mm or rad; for a model in which nothing varies
HISTOGRAM_BINS = 64  # bars kept in summary.json for pictures
ROADS = ("analytic", "geometric")
DIFFERENCE = "difference"  # of the two, beside them


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
        if f"{road}:{measure.name}" not in pilot:
            continue
        values = told(pilot, road, measure.name).values
        good = values[~np.isnan(values)]
        spans += [(float(good.mean()), float(good.std()))] if len(good) else []
    reach = [max(GRID_SIGMAS * sigma, LEAST_SPAN * measure.per_internal) for _, sigma in spans]
    lower = min(mean - half for (mean, _), half in zip(spans, reach, strict=True))
    upper = max(mean + half for (mean, _), half in zip(spans, reach, strict=True))
    return Grid.empty(lower, (upper - lower) / BINS, BINS)


@dataclass(frozen=True)
class MeasureTally:
    """All that is kept of one measure; `status` counts what became of its trials on the geometric road."""

    status: Mapping[str, int]
    analytic: Sample
    geometric: Sample | None
    agreement: Agreement | None
    analytic_features: FeatureSums
    geometric_features: FeatureSums | None
    disagreement: Disagreement | None

    def merge(self, other: "MeasureTally") -> "MeasureTally":
        """Both tallies as one."""
        return MeasureTally(
            _added(self.status, other.status),
            self.analytic.merge(other.analytic),
            self.geometric.merge(other.geometric) if self.geometric and other.geometric else None,
            self.agreement.merge(other.agreement) if self.agreement and other.agreement else None,
            self.analytic_features.merge(other.analytic_features),
            self.geometric_features.merge(other.geometric_features)
            if self.geometric_features and other.geometric_features
            else None,
            self.disagreement.merge(other.disagreement) if self.disagreement and other.disagreement else None,
        )


@dataclass(frozen=True)
class _Block:
    """One block of columns, and which of its rows belong to each replicate."""

    model: Model
    columns: Columns
    rows: Mapping[int, slice]
    first: int

    def told(self, measures: Sequence[Measure]) -> dict[tuple[str, str], Told]:
        """What each road that was gone tells of each measure, by road and name."""
        keys = [(road, measure.name) for measure in measures for road in ROADS]
        return {(r, name): told(self.columns, r, name) for r, name in keys if f"{r}:{name}" in self.columns}

    @property
    def _products(self) -> Products:
        return quick_products() if self.model.study.engine == "exact" else plain_products

    def tally(self, measures: Sequence[Measure], grids: Mapping[str, Grid]) -> dict[str, MeasureTally]:
        """Tallies of scalar measures."""
        found = self.told(measures)
        values = {key: own.values for key, own in found.items()}
        both = [measure.name for measure in measures if ("geometric", measure.name) in values]
        values |= {(DIFFERENCE, name): values["geometric", name] - values["analytic", name] for name in both}
        sums = self._sums(measures, values)
        tallies = {}
        for measure in measures:
            analytic, geometric = found["analytic", measure.name], found.get(("geometric", measure.name))
            empty = grids[measure.name]
            tallies[measure.name] = MeasureTally(
                status_counts(self.columns, measure),
                Sample.of(measure, analytic, empty, self.rows),
                Sample.of(measure, geometric, empty, self.rows) if geometric else None,
                Agreement.of(geometric.values, analytic.values) if geometric else None,
                sums["analytic", measure.name],
                sums["geometric", measure.name] if geometric else None,
                Disagreement.of(self.first, values[DIFFERENCE, measure.name], sums[DIFFERENCE, measure.name])
                if geometric
                else None,
            )
        return tallies

    def _sums(
        self, measures: Sequence[Measure], values: Mapping[tuple[str, str], Array]
    ) -> dict[tuple[str, str], FeatureSums]:
        """What each road's column of each measure has in common with its features, by road and name."""
        sums: dict[tuple[str, str], FeatureSums] = {}
        for key in dict.fromkeys(map(feature_key, measures)):
            alike = [measure for measure in measures if feature_key(measure) == key]
            seen = features(self.model, alike[0], self.columns)
            roads = (*ROADS, DIFFERENCE)
            columns = {(r, m.name): values[r, m.name] for m in alike for r in roads if (r, m.name) in values}
            whole = {name: column for name, column in columns.items() if not np.isnan(np.min(column))}
            if whole:
                each = FeatureSums.of_each(seen, np.stack(list(whole.values())), self._products)
                sums |= dict(zip(whole, each, strict=True))
            for measure in alike:  # what failed is the same trials on every road of a measure that lacks some
                lacking = [(r, measure.name) for r in roads if (r, measure.name) in columns.keys() - whole.keys()]
                if lacking:
                    rows = np.stack([columns[name] for name in lacking])
                    good = ~np.isnan(rows).any(axis=0)
                    sums |= dict(
                        zip(lacking, FeatureSums.of_each(seen[:, good], rows[:, good], self._products), strict=True)
                    )
        return sums


@dataclass(frozen=True)
class CurveTally:
    """A curve measure: moments at each position, for both roads, and the trials with any position out of limits.

    A trial counts at every position, or where one of them did not seat at none.
    """

    status: Mapping[str, int]
    analytic: tuple[Moments, ...]
    geometric: tuple[Moments, ...] | None
    limits: Mapping[str, LimitCounts]
    deepest: float

    @classmethod
    def of(cls, measure: Measure, columns: Columns) -> "CurveTally":
        """Tally of one block of columns."""
        curves = {road: told(columns, road, measure.name) for road in ROADS if f"{road}:{measure.name}" in columns}
        moments = {
            road: tuple(Moments.of(column[~np.isnan(column)]) for column in own.values.T)
            for road, own in curves.items()
        }
        lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
        limits = {
            road: LimitCounts.of_spans(
                own.values.min(axis=1), own.values.max(axis=1), lower, upper, lacking_of(measure, own)
            )
            for road, own in curves.items()
        }
        return cls(
            status_counts(columns, measure),
            moments["analytic"],
            moments.get("geometric"),
            limits,
            min(own.deepest for own in curves.values()),
        )

    def merge(self, other: "CurveTally") -> "CurveTally":
        """Both tallies as one."""

        def merged(mine: tuple[Moments, ...], its: tuple[Moments, ...]) -> tuple[Moments, ...]:
            return tuple(a.merge(b) for a, b in zip(mine, its, strict=True))

        return CurveTally(
            _added(self.status, other.status),
            merged(self.analytic, other.analytic),
            merged(self.geometric, other.geometric) if self.geometric and other.geometric else None,
            {road: counts.merge(other.limits[road]) for road, counts in self.limits.items()},
            min(self.deepest, other.deepest),
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
        rows = rows_of_replicates(model.study, first, trials)
        scalars = [measure for measure in model.measures if measure.take != "curve"]
        curves = [measure for measure in model.measures if measure.take == "curve"]
        return cls(
            trials,
            _counted(columns.get("status"), trials),
            _unphysical(model, columns),
            _Block(model, columns, rows, first).tally(scalars, grids),
            {measure.name: CurveTally.of(measure, columns) for measure in curves},
            stage_tallies(model, columns),
        )

    def merge(self, other: "Tally") -> "Tally":
        """Both tallies as one; fold blocks in their order."""
        return Tally(
            self.trials + other.trials,
            _added(self.status, other.status),
            _added(self.unphysical, other.unphysical),
            {name: tally.merge(other.measures[name]) for name, tally in self.measures.items()},
            {name: tally.merge(other.curves[name]) for name, tally in self.curves.items()},
            merged(self.stages, other.stages),
        )


def status_counts(columns: Columns, measure: Measure) -> dict[str, int]:
    """How many trials of a block ended how, for one measure; those of the analytic road all seat."""
    return _counted(columns.get(status_column(measure.name)), len(columns[f"analytic:{measure.name}"]))


def _counted(status: NDArray[np.generic] | None, trials: int) -> dict[str, int]:
    """How many of the trials have each status (trials,)."""
    seated = trials if status is None else int(np.count_nonzero(status == SEATED))
    failed = (text for text in STATUS_TEXT.values() if text != SEATED)
    if seated == trials:
        return {SEATED: trials, **dict.fromkeys(failed, 0)}
    return {SEATED: seated, **{text: int(np.count_nonzero(status == text)) for text in failed}}


def _added(mine: Mapping[str, int], its: Mapping[str, int]) -> dict[str, int]:
    return {name: count + its[name] for name, count in mine.items()}


def _unphysical(model: Model, columns: Columns) -> dict[str, int]:
    counts = {}
    for contributor in model.contributors:
        if contributor.least is not None:
            drawn = np.asarray(columns[contributor.columns[0]], dtype=np.float64)
            counts[contributor.name] = int(np.count_nonzero(drawn < contributor.least / contributor.per_unit))
    return counts


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
    unknown = dict.fromkeys((contributor.name for contributor in acting(model, measure)), (None, None))
    if sums is None:
        return {**unknown}
    groups = feature_groups(model, measure)
    found = shares(sums, groups)
    told = {name: (finite(100 * found.share[name]), finite(100 * found.standard_error[name])) for name in groups}
    return {**unknown, **told}
