"""Statistics of a response's trials: mean, sigma, quantiles, Ppk and fractions out of limits, as a run of them has."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from tol3d.analyses.response import Response, Values
from tol3d.numerics.arrays import Array
from tol3d.study.runs.summary.sample import Sample as SampleSummary
from tol3d.study.system.measure import Measure
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC, outcome_of, status_column, value_column
from tol3d.study.tallies.replicated import rows_of_replicates
from tol3d.study.tallies.sample import Sample, sample_summary
from tol3d.study.tallies.tally import PILOT_TRIALS, grid_of


def pilots_of(response: Response, deviations: Array, positions: Mapping[str, Array], values: Values) -> Sequence[Array]:
    """Values of the first trials (trials, measures) by which a run lays its grids, by each method that it reads.

    Args:
        response, deviations, positions, values: as of `results_of`.
    """
    first = slice(0, PILOT_TRIALS)
    pilots = [values.values[first]]
    if response.method is not None:
        by_theory = replace(response, method=None)
        pilots.append(by_theory.values(deviations[first], {name: own[first] for name, own in positions.items()}).values)
    return pilots


def results_of(
    response: Response,
    deviations: Array,
    positions: Mapping[str, Array],
    values: Values,
    *,
    measures: Sequence[Measure] | None = None,
    pilots: Sequence[Array] | None = None,
) -> Mapping[str, SampleSummary]:
    """Statistics of the study's first trials by measure, in its unit, of the method that the response reads.

    The first of them are read by the analytic method too, so that quantiles are read from a run's grid.

    Args:
        response: whose measures they are.
        deviations, positions: of the trials, as `Response.drawn` gives them: at least one.
        values: of the trials.
        measures: the response's, with other limits; default: as they are.
        pilots: of `pilots_of`, where they are known: then nothing is evaluated.
    """
    system, study = response.simulation.system, response.simulation.study
    pilots = pilots_of(response, deviations, positions, values) if pilots is None else pilots
    method = ANALYTIC if response.method is None else GEOMETRIC
    rows, found = rows_of_replicates(study, 0, len(deviations)), {}
    for k, (measure, judged) in enumerate(zip(response.measures, measures or response.measures, strict=True)):
        columns = {
            value_column(method, measure.name): values.values[:, k],
            status_column(measure.name): values.statuses[:, k],
        }
        form = system.closed_form(measure) if response.source(measure) is measure else None
        grid = grid_of(measure, form, [pilot[:, k] for pilot in pilots])
        outcome = outcome_of(columns, method, measure.name, system.statuses.lacking)
        found[measure.name] = sample_summary(judged, Sample.of(judged, outcome, grid, rows), study.ppk_by)
    return found
