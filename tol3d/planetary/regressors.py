"""Regressors of a measure of a set: the part of each contributor in it, trial by trial.

A free turn is the optimum of a linear programme: the multipliers of the contacts that are met in a trial times their
sides. Sides are linear in the deviations, so with the contacts of that trial the turn is a sum of parts, one of each
contributor, and none is left over; what turns from trial to trial is which contacts are met. So it is with whatever
adds or subtracts turns at positions: lost motions, extremes, ranges, and a harmonic along its own phase.

A contributor's part is its regressor. Its share of the variance is then the covariance of its part with the measure:
of the absolute value of a normal sum, whose parts neither raise nor lower it on average, that is each one's share of
the variance of the sum.
"""

from functools import reduce

import numpy as np

from tol3d.planetary.first_order.stack_up import StackUp
from tol3d.planetary.model.deviated import Deviated
from tol3d.planetary.trials import PlanetaryMeasure, SetTrials
from tol3d.system.output_system import Parts
from tol3d.system.taken import weights_taken
from tol3d.system.trials import Trials


def parts_met(system: SetTrials, measure: PlanetaryMeasure, trials: Trials) -> Parts:
    """Parts of contributors in a measure, by the contacts that are met in each trial."""
    slopes = slopes_of(system, measure, trials)
    return lambda own, off: (slopes.of(system.own, system.acts[own.name]) * off).sum(axis=1)


def slopes_of(system: SetTrials, measure: PlanetaryMeasure, trials: Trials) -> Deviated:
    """Change of a measure [rad] of each trial by a unit of each deviation, while contacts that are met stay the same.

    By first-order gaps; zeros of trials that jam.
    """
    own, deviated, shaft = system.own, system.deviated(trials), measure.shaft
    method, stands = StackUp(own), own.opposite(measure.shaft)
    if measure.is_free_turn:
        turns = np.broadcast_to(system.turns(measure.positions, trials), (len(trials), 1))
        ones = np.ones((len(trials), 1))
        read = [(method, 1.0)]
        if measure.reading == "low stiffness":
            read = [(StackUp(system.overcome), 1.0), (method, -1.0)]
        found = [
            each.slopes(deviated, turns, shaft, stands, end, sign * (2 * end - 1) * ones)
            for each, sign in read
            for end in range(2)
        ]
        return reduce(Deviated.plus, found)
    turns = np.array(measure.positions.fixed) / (2 * np.pi)
    ends = method.followed(deviated, turns, shaft, stands, measure.end(own)).ends
    coefficients = measure.sense(own) * weights_taken(measure, measure.sense(own) * ends)
    return method.slopes(deviated, turns, shaft, stands, measure.end(own), np.ascontiguousarray(coefficients))
