"""Slopes of a measure of a set: multipliers of the contacts that are met in a trial times their sides."""

from functools import reduce

import numpy as np

from tol3d.planetary.first_order.stack_up import StackUp
from tol3d.planetary.model.deviated import Deviated
from tol3d.planetary.trials import SetTrials
from tol3d.reducers.trials import ReducerMeasure
from tol3d.system.taken import weights_taken
from tol3d.system.trials import Trials


def slopes_of(system: SetTrials, measure: ReducerMeasure, trials: Trials) -> Deviated:
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
    ends = method.followed(deviated, turns, shaft, stands, own.end(measure.load)).ends
    coefficients = own.sense * weights_taken(measure, own.sense * ends)
    return method.slopes(deviated, turns, shaft, stands, own.end(measure.load), np.ascontiguousarray(coefficients))
