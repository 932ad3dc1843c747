"""Statistics of a run, folded block by block: memory does not grow with the number of trials.

The terms of measures that are sums, pooled block by block.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import Agreement, CountGrid, Grid
from tol3d.statistics.estimates.grid import BINS
from tol3d.statistics.estimates.lazy import quick_products
from tol3d.statistics.estimates.variance_shares import Products, plain_products
from tol3d.study.system.breakdown import Breakdown
from tol3d.study.system.dependent import DependentlyJudged
from tol3d.study.system.draw import Each, JudgedDraw
from tol3d.study.system.measure import Measure
from tol3d.study.system.outcome import (
    ANALYTIC,
    GEOMETRIC,
    METHODS,
    Columns,
    Outcome,
    Statuses,
    outcome_of,
    value_column,
)
from tol3d.study.system.pooled import PooledTerms
from tol3d.study.system.system import Described, System
from tol3d.study.tallies.curve_tally import BINS as ORDER_BINS
from tol3d.study.tallies.curve_tally import (
    ENDS,
    CurveTally,
    added,
    amplitudes_of,
    counted,
    end_name,
    gathered,
    grid_name,
    judged_ends,
    reason_counts,
    status_counts,
)
from tol3d.study.tallies.joint import JointTally, limited
from tol3d.study.tallies.regression import DIFFERENCE, Among, Sums, merged, target_sums
from tol3d.study.tallies.replicated import rows_of_replicates
from tol3d.study.tallies.sample import Sample
from tol3d.study.trials.simulation import Simulation
from tol3d.units import FACTORS


@dataclass(frozen=True)
class Disagreement:
    """Differences (geometric - analytic) of the trials in which a scalar measure has both, in its unit.

    Args:
        sums: with the measure's features.
        largest: the largest |difference|, 0 without trials.
        trial: the first trial that has it; -1 without trials.
    """

    sums: Sums
    largest: float
    trial: int

    @classmethod
    def of(cls, first: int, difference: Array, sums: Sums) -> "Disagreement":
        """Disagreement in a block that begins at trial `first`; difference (trials,), nan if a method has no value."""
        size = np.where(np.isnan(difference), -1.0, np.abs(difference))
        at = int(np.argmax(size))
        return cls(sums, float(size[at]), first + at) if size[at] >= 0.0 else cls(sums, 0.0, -1)

    def merge(self, other: "Disagreement") -> "Disagreement":
        """Both blocks as one."""
        further = other if other.trial >= 0 and (self.trial < 0 or other.largest > self.largest) else self
        return Disagreement(merged(self.sums, other.sums), further.largest, further.trial)


PILOT_TRIALS = 64  # the study's first trials; they give sigma to 9 %
GRID_SIGMAS = 12.0  # the grid spans the mean +- this many sigma of both methods: bins of 1.8e-4 sigma, 1.3 nm
LEAST_SPAN = 1e-3  # mm or rad; for a model in which nothing varies
MOST_COUNTED = 4095  # of a measure that counts


def grids_of(system: System, pilot: Columns) -> Mapping[str, Grid]:
    """The empty grid of each scalar measure, and of each order of a curve's spectrum, by spectrum_tally's names.

    A function of system and seed alone, so that any blocks add up.

    Args:
        system: that is measured.
        pilot: columns of the study's first PILOT_TRIALS trials, for any number of trials.
    """
    grids = {
        measure.name: grid_of(measure, _values(system, measure, pilot))
        for measure in system.measures
        if measure.take != "curve"
    }
    for measure in system.measures:
        grids |= _spectrum_grids(system, measure, pilot)
        if measure.take == "curve":
            curves = _values(system, measure, pilot)
            for end in judged_ends(measure):
                grids[end_name(measure.name, end)] = grid_of(measure, [ENDS[end](curve) for curve in curves])
    return grids


def _values(system: Described, measure: Measure, pilot: Columns) -> list[Array]:
    """The pilot's values of a measure by each method that was used, nan if a trial could not be assembled."""
    methods = [method for method in METHODS if value_column(method, measure.name) in pilot]
    return [outcome_of(pilot, method, measure.name, system.statuses.lacking).values for method in methods]


def _spectrum_grids(system: System, measure: Measure, pilot: Columns) -> dict[str, Grid]:
    """Grids of amplitudes, which are at least 0."""
    spectrum = measure.spectrum
    if spectrum is None or measure.take != "curve":
        return {}
    found = [
        amplitudes
        for value in _values(system, measure, pilot)
        if len(amplitudes := amplitudes_of(measure, spectrum, value))
    ]
    reach = np.max([own.mean(axis=0) + GRID_SIGMAS * own.std(axis=0) for own in found], axis=0, initial=0.0)
    spans = np.maximum(np.broadcast_to(reach, len(spectrum.orders)), LEAST_SPAN * measure.per_internal).tolist()
    return {grid_name(measure.name, k): Grid.empty(0.0, span / ORDER_BINS, ORDER_BINS) for k, span in enumerate(spans)}


def grid_of(measure: Measure, columns: Sequence[Array]) -> Grid:
    """The empty grid of a measure, by the pilot's values by each method (trials,), in its unit.

    By values alone, so that it is the same where other tolerances are tried as where a scene states them.
    """
    if measure.unit in FACTORS["count"]:
        return CountGrid.up_to(MOST_COUNTED)
    known = [good for values in columns if len(good := values[~np.isnan(values)])]
    spans = [(float(good.mean()), float(good.std())) for good in known]
    reach = [max(GRID_SIGMAS * sigma, LEAST_SPAN * measure.per_internal) for _, sigma in spans]
    lower = min(mean - half for (mean, _), half in zip(spans, reach, strict=True))
    upper = max(mean + half for (mean, _), half in zip(spans, reach, strict=True))
    return Grid.empty(lower, (upper - lower) / BINS, BINS)


@dataclass(frozen=True)
class MeasureTally:
    """All that is kept of one measure.

    `status` counts the statuses of its trials by the geometric method, `reasons` the causes of failures.
    """

    status: Mapping[str, int]
    reasons: Mapping[str, int]
    analytic: Sample
    geometric: Sample | None
    agreement: Agreement | None
    analytic_regressors: Sums
    geometric_regressors: Sums | None
    disagreement: Disagreement | None

    def merge(self, other: "MeasureTally") -> "MeasureTally":
        """Both tallies as one."""
        return MeasureTally(
            added(self.status, other.status),
            gathered(self.reasons, other.reasons),
            self.analytic.merge(other.analytic),
            self.geometric.merge(other.geometric) if self.geometric and other.geometric else None,
            self.agreement.merge(other.agreement) if self.agreement and other.agreement else None,
            merged(self.analytic_regressors, other.analytic_regressors),
            merged(self.geometric_regressors, other.geometric_regressors)
            if self.geometric_regressors and other.geometric_regressors
            else None,
            self.disagreement.merge(other.disagreement) if self.disagreement and other.disagreement else None,
        )


@dataclass(frozen=True)
class _Block:
    """One block of columns, and which of its rows belong to each replicate."""

    simulation: Simulation
    columns: Columns
    rows: Mapping[int, slice]
    first: int

    def outcomes(self, measures: Sequence[Measure]) -> dict[tuple[str, str], Outcome]:
        """Outcomes of each measure by each method that was used, by method and name."""
        lacking = self.simulation.system.statuses.lacking
        keys = [(method, measure.name) for measure in measures for method in METHODS]
        return {
            (method, name): outcome_of(self.columns, method, name, lacking)
            for method, name in keys
            if value_column(method, name) in self.columns
        }

    @property
    def products(self) -> Products:
        return quick_products() if self.simulation.method.compiled else plain_products

    def tally(
        self, measures: Sequence[Measure], grids: Mapping[str, Grid], found: Mapping[tuple[str, str], Outcome]
    ) -> tuple[dict[str, MeasureTally], Among]:
        """Tallies of scalar measures, `found` their outcomes, and known sums of columns among each other."""
        statuses = self.simulation.system.statuses
        values = {key: own.values for key, own in found.items()}
        both = [measure.name for measure in measures if (GEOMETRIC, measure.name) in values]
        values |= {(DIFFERENCE, name): values[GEOMETRIC, name] - values[ANALYTIC, name] for name in both}
        sums, among = target_sums(self.simulation, self.columns, values, self.products)
        tallies = {}
        for measure in measures:
            analytic, geometric = found[ANALYTIC, measure.name], found.get((GEOMETRIC, measure.name))
            empty = grids[measure.name]
            tallies[measure.name] = MeasureTally(
                status_counts(statuses, self.columns, measure),
                reason_counts(self.columns, measure),
                Sample.of(measure, analytic, empty, self.rows),
                Sample.of(measure, geometric, empty, self.rows) if geometric else None,
                Agreement.of(geometric.values, analytic.values) if geometric else None,
                sums[ANALYTIC, measure.name],
                sums[GEOMETRIC, measure.name] if geometric else None,
                Disagreement.of(self.first, values[DIFFERENCE, measure.name], sums[DIFFERENCE, measure.name])
                if geometric
                else None,
            )
        return tallies, among


@dataclass(frozen=True)
class Tally:
    """Statistics of a whole run so far.

    Args:
        trials: their number.
        status: number of them by status, that of the worst of their measures.
        unphysical: how many trials have a draw below what a contributor can be, or beyond what its drawing allows, by
            its name.
        measures, curves: by name.
        terms: of breakdowns, by measure and method.
        joint: joint results of measures.
    """

    trials: int
    status: Mapping[str, int]
    unphysical: Mapping[str, int]
    measures: Mapping[str, MeasureTally]
    curves: Mapping[str, CurveTally]
    terms: Mapping[str, Mapping[str, PooledTerms]]
    joint: JointTally

    @classmethod
    def of(cls, simulation: Simulation, grids: Mapping[str, Grid], columns: Columns, first: int = 0) -> "Tally":
        """Tally of one block that begins at trial `first`; `grids` as grids_of gives them."""
        trials = len(next(iter(columns.values())))
        system, statuses = simulation.system, simulation.system.statuses
        rows = rows_of_replicates(simulation.study, first, trials)
        scalars = [measure for measure in system.measures if measure.take != "curve"]
        curves = [measure for measure in system.measures if measure.take == "curve"]
        block = _Block(simulation, columns, rows, first)
        found = block.outcomes(scalars)
        together = found | block.outcomes(limited(curves))
        tallies, among = block.tally(scalars, grids, found)
        return cls(
            trials,
            counted(statuses, columns.get("status"), trials),
            _unphysical(system, columns),
            tallies,
            {measure.name: CurveTally.of(statuses, measure, columns, grids, rows) for measure in curves},
            pooled_terms(system.breakdowns, statuses, columns),
            JointTally.of(system.measures, together, rows, block.products, among),
        )

    def merge(self, other: "Tally") -> "Tally":
        """Both tallies as one; fold blocks in their order."""
        return Tally(
            self.trials + other.trials,
            added(self.status, other.status),
            added(self.unphysical, other.unphysical),
            {name: tally.merge(other.measures[name]) for name, tally in self.measures.items()},
            {name: tally.merge(other.curves[name]) for name, tally in self.curves.items()},
            merged_terms(self.terms, other.terms),
            self.joint.merge(other.joint),
        )


def _unphysical(system: Described, columns: Columns) -> dict[str, int]:
    known = {own.name: own for own in system.contributors}

    def components(name: str) -> list[NDArray[np.float64]]:
        own = known[name]
        return [np.asarray(columns[column], dtype=np.float64) * own.per_unit for column in own.columns]

    counts = {}
    for name, contributor in known.items():
        draw = contributor.draw
        if contributor.least is not None:
            # of a length with a direction the first component is the length; features have one each
            lengths = components(name) if isinstance(draw, Each) else components(name)[:1]
            counts[name] = int(np.count_nonzero(np.min(lengths, axis=0) < contributor.least))
        elif isinstance(draw, DependentlyJudged):
            given = {read: np.stack(components(read)) for read in draw.reads}
            counts[name] = int(np.count_nonzero(draw.beyond_given(given, *components(name))))
        elif isinstance(draw, JudgedDraw):
            counts[name] = int(np.count_nonzero(draw.beyond(*components(name))))
    return counts


Pooled = Mapping[str, Mapping[str, PooledTerms]]
"""Pooled terms by measure and method."""


def pooled_terms(breakdowns: Sequence[Breakdown], statuses: Statuses, columns: Columns) -> Pooled:
    """The terms of every breakdown, of one block."""
    found: dict[str, dict[str, PooledTerms]] = {}
    for breakdown in breakdowns:
        methods = found.setdefault(breakdown.measure, {})
        for method in METHODS:
            if value_column(method, breakdown.measure) in columns:
                whole = outcome_of(columns, method, breakdown.measure, statuses.lacking)
                if pooled := PooledTerms.of(breakdown, method, columns, whole):
                    methods[method] = pooled
    return found


def merged_terms(mine: Pooled, its: Pooled) -> Pooled:
    """Both blocks as one."""
    return {name: {key: own.merge(its[name][key]) for key, own in methods.items()} for name, methods in mine.items()}
