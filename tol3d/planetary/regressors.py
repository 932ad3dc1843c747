"""What a measure of a set sees of contributors: the part that each has in it, trial by trial.

A free turn is the optimum of a linear programme: the multipliers of the contacts that are met in a trial times their
sides. Sides are linear in the deviations, so with the contacts of that trial the turn is a sum of parts, one of each
contributor, and none is left over; what turns from trial to trial is which contacts are met. So it is with whatever
adds or subtracts turns at positions: lost motions, extremes, ranges, and a harmonic along its own phase.

A contributor's part is its regressor. Its share of the variance is then the covariance of its part with the measure:
of the absolute value of a normal sum, whose parts neither raise nor lower it on average, that is each one's share of
the variance of the sum.
"""

from collections.abc import Mapping, Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.first_order.stack_up import StackUpCurves
from tol3d.planetary.model.deviated import Deviated
from tol3d.planetary.trials import PlanetaryMeasure, SetTrials
from tol3d.system.contributor import Contributor
from tol3d.system.system import Columns
from tol3d.system.taken import ROWS_AT_ONCE
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


def regress(
    system: SetTrials,
    measure: PlanetaryMeasure,
    contributors: Sequence[Contributor],
    columns: Columns,
    rows: Mapping[str, Array],
) -> None:
    """Write contributors' rows (regressors, trials): first its part, in the measure's unit; see System.regress."""
    values = {
        own.name: np.stack(
            [np.asarray(columns[name], dtype=np.float64) * own.per_unit for name in own.columns], axis=-1
        )
        for own in system.contributors
    }
    deviations = np.concatenate([values[own.name] for own in system.contributors], axis=1)
    turns = np.asarray(columns[system.position_column], dtype=np.float64) / 360.0
    at_once = max(1, ROWS_AT_ONCE // measure.positions.in_a_trial)
    for own in contributors:
        rows[own.name][...] = 0.0
    for first in range(0, len(deviations), at_once):
        part = slice(first, first + at_once)
        trials = Trials(deviations[part], {system.own.name: turns[part]})
        slopes = slopes_of(system, measure, trials)
        for own in contributors:
            turning = system.turns_at_random(own, measure.positions)
            off = values[own.name][part] - np.array(own.draw.mean(turning=turning))
            along = slopes.of(system.own, system.acts[own.name])
            rows[own.name][0, part] = (along * off).sum(axis=1) * measure.per_internal


def slopes_of(system: SetTrials, measure: PlanetaryMeasure, trials: Trials) -> Deviated:
    """Change of a measure [rad] of each trial by a unit of each deviation, while contacts that are met stay the same.

    By first-order gaps; zeros of trials that jam.
    """
    own, deviated, shaft = system.own, system.deviated(trials), measure.shaft
    road, stands = StackUpCurves(own), own.opposite(measure.shaft)
    if measure.is_free_turn:
        turns = measure.turns_of(trials.positions[own.name])[:, None]
        ones = np.ones((len(trials), 1))
        read = [(road, 1.0)]
        if measure.reading == "low stiffness":
            read = [(StackUpCurves(system.overcome), 1.0), (road, -1.0)]
        found = [
            each.slopes(deviated, turns, shaft, stands, end, sign * (2 * end - 1) * ones)
            for each, sign in read
            for end in range(2)
        ]
        return reduce(Deviated.plus, found)
    turns = np.array(measure.positions.fixed) / (2 * np.pi)
    ends = road.followed(deviated, turns, shaft, stands, measure.end(own)).ends
    coefficients = measure.sense(own) * measure.weights(measure.sense(own) * ends)
    return road.slopes(deviated, turns, shaft, stands, measure.end(own), np.ascontiguousarray(coefficients))
