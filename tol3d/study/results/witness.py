"""The witness: some of a study's trials made again and measured by another engine, which knows its own errors.

The trials are drawn by a stream of their own, so they are the same for any execution of the study.
"""

from typing import cast

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.samplers.monte_carlo import uniforms
from tol3d.study.runs.summary.agreement import Witnessed, WitnessSummary
from tol3d.study.runs.summary.values import made
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Method, WitnessMethod
from tol3d.study.system.outcome import GEOMETRIC, Columns, status_column, value_column
from tol3d.study.system.system import Methods
from tol3d.study.system.trials import joined
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

STREAM = ("witness", "trial")


def witness_of(system: Methods) -> str | None:
    """The engine that can check the others; None if there is none."""
    return next((name for name, kind in system.methods.items() if kind.witness), None)


def witness_summary(simulation: Simulation, method: Method, trials: int) -> WitnessSummary:
    """Findings of the witness for `study.witness` trials of a run, as summary.json shows them.

    Args:
        simulation: of the run, whose study asks for a witness.
        method: the one that measured the run.
        trials: number of trials of the run.

    Returns:
        the differences witness - engine of each measure, in its unit, and the part that the witness's errors explain.
    """
    system, study = simulation.system, simulation.study
    name = witness_of(system)
    if name is None:
        raise ValueError(f"{system.name} has no witness")
    chosen = witnessed_trials(study.seed, trials, study.witness)
    again = joined([drawn(simulation, trial, 1) for trial in chosen.tolist()])
    witness = cast(WitnessMethod, system.method(name, system.materials(name)))
    measures = [measure for measure in system.measures if witness.reads(measure)]
    seen, given = (columns_of(system, each, again, measures) for each in (witness, method))
    return made(
        WitnessSummary,
        engine=name,
        trials=len(chosen),
        chord_error_um=1000 * witness.chord_error,
        measures={
            measure.name: _witnessed(_difference(seen, given, measure), chosen, witness.bounds(measure))
            for measure in measures
        },
        status_differences=int(np.count_nonzero(seen["status"] != given["status"])),
    )


def witness_warnings(simulation: Simulation, witness: WitnessSummary) -> list[str]:
    """A sentence for each measure that differs by more than is explained, and one for trials of another status."""
    units = {measure.name: measure.unit for measure in simulation.system.measures}
    engine = witness.engine.upper()
    found = [
        f"witness: {name} by {engine} differs by {own.max_abs_difference:.3g} {units[name]} in trial "
        f"{own.trial_of_the_largest}; its chords explain {own.expected_at_most:.3g} {units[name]}, its other "
        f"errors {own.allowance:.3g} {units[name]}"
        for name, own in witness.measures.items()
        if (own.max_abs_difference or 0.0) > own.expected_at_most + own.allowance
    ]
    if other := witness.status_differences:
        found.append(f"witness: by {engine} {other} of {witness.trials} trials end with another status")
    return found


def witnessed_trials(seed: int, trials: int, wanted: int) -> NDArray[np.int64]:
    """Trials of a study that are measured again: distinct, ascending, all of them if there are no more.

    A function of the three numbers alone. Each set of `wanted` trials is as likely as any other: for every top from
    trials - wanted on, one of the trials up to it is taken, or the top itself where that one was taken before.
    Source: Bentley, Floyd, Programming pearls: a sample of brilliance (CACM 30(9), 1987).
    """
    count = min(wanted, trials)
    tops = range(trials - count, trials)
    chosen: set[int] = set()
    for top, u in zip(tops, uniforms(seed, *STREAM, 0, count).tolist(), strict=True):
        pick = int(u * (top + 1))
        chosen.add(top if pick in chosen else pick)
    return np.array(sorted(chosen), dtype=np.int64)


def _difference(seen: Columns, given: Columns, measure: Measure) -> Array:
    """Difference of two engines, (trials,) or (trials, positions); nan where trials end with another status.

    A build that one engine finds to overlap and another does not differs by more than their errors.
    """
    column = value_column(GEOMETRIC, measure.name)
    difference = np.asarray(seen[column], dtype=np.float64) - np.asarray(given[column], dtype=np.float64)
    status = status_column(measure.name)
    difference[seen[status] != given[status]] = np.nan
    return difference


def _witnessed(difference: Array, chosen: NDArray[np.int64], bounds: tuple[float, float]) -> Witnessed:
    """Differences of some trials, (trials,) or of a curve (trials, positions), nan if either has no value."""
    each = difference.reshape(len(chosen), -1)
    known = ~np.isnan(each)
    compared = int(np.count_nonzero(known.any(axis=1)))
    size = np.where(known, np.abs(each), -1.0)
    values = each[known]
    return made(
        Witnessed,
        max_abs_difference=float(size.max()) if compared else None,
        mean_difference=float(values.mean()) if compared else None,
        rms_difference=float(np.sqrt((values**2).mean())) if compared else None,
        trial_of_the_largest=int(chosen[size.max(axis=1).argmax()]) if compared else None,
        compared=compared,
        expected_at_most=bounds[0],
        allowance=bounds[1],
    )
