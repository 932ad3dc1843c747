"""Statistics of a response's trials: mean, sigma, quantiles, Ppk and fractions out of limits, as a run of them has."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tol3d.analyses.response import Response, Values
from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import Grid
from tol3d.study.runs.summary.sample import Sample as SampleSummary
from tol3d.study.system.measure import Measure
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC, outcome_of, status_column, value_column
from tol3d.study.tallies.replicated import rows_of_replicates
from tol3d.study.tallies.sample import Sample, sample_summary
from tol3d.study.tallies.tally import PILOT_TRIALS, grid_of


def pilot_grids(
    response: Response, deviations: Array, positions: Mapping[str, Array], values: Values
) -> Mapping[str, Grid]:
    """The grids by measure from which a run's quantiles are read: its pilot trials are read by the analytic method too.

    Args:
        response: whose measures they are.
        deviations, positions: of the study's first trials; of fewer than a run's pilot all of it is evaluated.
        values: of the trials.
    """
    if len(deviations) < PILOT_TRIALS:
        deviations, positions = response.drawn(PILOT_TRIALS)
        values = response.values(deviations, positions)
    first = slice(0, PILOT_TRIALS)
    pilots = [np.where(values.seated[first], values.values[first], np.nan)]
    if response.method is not None:
        by_theory = replace(response, method=None)
        pilots.append(by_theory.values(deviations[first], {name: own[first] for name, own in positions.items()}).values)
    return {
        measure.name: grid_of(measure, [pilot[:, k] for pilot in pilots]) for k, measure in enumerate(response.measures)
    }


def results_of(
    response: Response, values: Values, grids: Mapping[str, Grid], *, measures: Sequence[Measure] | None = None
) -> Mapping[str, SampleSummary]:
    """Statistics of the study's first trials by measure, in its unit, of the method that the response reads.

    Args:
        response: whose measures they are.
        values: of the trials, at least one.
        grids: as `pilot_grids` has them.
        measures: the response's, with other limits; default: as they are.
    """
    system, study = response.simulation.system, response.simulation.study
    method = ANALYTIC if response.method is None else GEOMETRIC
    rows, found = rows_of_replicates(study, 0, len(values.values)), {}
    for k, (measure, judged) in enumerate(zip(response.measures, measures or response.measures, strict=True)):
        columns = {
            value_column(method, measure.name): values.values[:, k],
            status_column(measure.name): values.statuses[:, k],
        }
        outcome = outcome_of(columns, method, measure.name, system.statuses.lacking)
        sample = Sample.of(judged, outcome, grids[measure.name], rows)
        found[measure.name] = sample_summary(judged, sample, study.ppk_by)
    return found
