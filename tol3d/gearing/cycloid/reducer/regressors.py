"""Regressors of the measures of an RV reducer: first-order terms of the contributors where its pin and planet touch."""

from collections.abc import Mapping, Sequence

import numpy as np

from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.resting import linear_rates, linear_turning, lost_motion_rates
from tol3d.gearing.cycloid.reducer.trials import RVTrials
from tol3d.gearing.cycloid.reducer.turning import Turned
from tol3d.gearing.reducers.trials import ReducerMeasure
from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.output_system import component_values
from tol3d.study.system.regressors import has_square
from tol3d.study.system.system import Columns
from tol3d.study.system.taken import weights_taken
from tol3d.study.system.trials import Trials


def regress_touching(
    system: RVTrials,
    measure: ReducerMeasure,
    contributors: Sequence[Contributor],
    columns: Columns,
    rows: Mapping[str, Array],
) -> None:
    """Write contributors' rows (regressors, trials) of a measure at one position, see System.regress."""
    trials = system.trials_again(columns)
    turns = system.turns_at(measure, trials)
    slopes = slopes_at(system, measure, system.deviated(trials), turns)
    for contributor in contributors:
        values, acts = component_values(contributor, columns), system.acts[contributor.name]
        scale = system.own.profile.pitch_radius / (contributor.draw.sigma or 1.0)
        if has_square(contributor):
            rows[contributor.name][0] = scale * slopes.term(system.own, acts, values)
            np.square(rows[contributor.name][0], out=rows[contributor.name][1])
            continue
        for k, row in enumerate(rows[contributor.name]):
            alone = np.zeros_like(values)
            alone[:, k] = values[:, k]
            row[...] = scale * slopes.term(system.own, acts, alone)


def slopes_at(system: RVTrials, measure: ReducerMeasure, deviated: RVDeviated, turns: Array) -> RVDeviated:
    """Change of a measure at turns of the output (trials,) by each deviation, by the pin and planet that touch."""
    if measure.is_free_turn:
        return lost_motion_rates(system.own, deviated, turns)
    return linear_rates(system.own, deviated, turns, measure.load)


TAKEN = ("min", "max", "range")  # a harmonic would take the rates at every position


def slopes_over_turn(system: RVTrials, measure: ReducerMeasure, trials: Trials) -> RVDeviated:
    """The same of an extreme or a range, by the contacts at the positions that are taken of each trial."""
    deviated, at = system.deviated(trials), system.turns(measure.positions, trials)
    turned = linear_turning(system.own).turned(deviated, at, measure.load)
    weights = weights_taken(measure, turned.turns)
    rows, positions = np.nonzero(weights)
    places, planets = (
        np.broadcast_to(own, weights.shape)[rows, positions][:, None] for own in (turned.places, turned.planets)
    )
    found = Turned(turned.turns[rows, positions][:, None], places, planets)
    rates = linear_rates(system.own, deviated[rows], at[0, positions], measure.load, found)
    return rates.summed(rows, weights[rows, positions], len(trials))
