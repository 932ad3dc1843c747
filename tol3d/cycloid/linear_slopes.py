"""What a sum of turns of a cycloid stage changes by, and each contributor's part in it, trial by trial.

The turn of a trial is the clearance over the lever at the pin that touches, plus that pin's rates times the trial's
deviations. So it is a sum of parts, one of each contributor; which pin touches changes from trial to trial. The same
holds of whatever adds or subtracts turns at positions: extremes, ranges, lost motions, a harmonic along its own phase.
"""

from dataclasses import fields
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.deviated import Deviated
from tol3d.cycloid.linear import LinearStage

Array = NDArray[np.float64]

ROWS_AT_ONCE: Final = 4096  # rates of so many turns stand in memory, a few thousand bytes each


def summed_rates(stage: LinearStage, phis: Array, places: NDArray[np.int64], weights: Array) -> Deviated:
    """Change of a weighted sum of each trial's turns by a unit of each deviation, while the same pins touch.

    Args:
        stage: the cycloid stage.
        phis: crank angles (trials, positions), or (1, positions) that are those of every trial [rad].
        places: pins that touch (trials, positions), see FirstTouches.
        weights: of the turns (trials, positions); turns of weight 0 take no time.

    Returns:
        In the form of the deviations, (trials, ...) [rad/mm or rad/rad].
    """
    trials = len(places)
    found = Deviated.nothing(trials, stage.profile.pins, stage.discs, stage.cranks)
    at = np.broadcast_to(phis, places.shape)
    trial, position = np.nonzero(weights)
    for first in range(0, len(trial), ROWS_AT_ONCE):
        rows, columns = trial[first : first + ROWS_AT_ONCE], position[first : first + ROWS_AT_ONCE]
        rates = stage.rates(at[rows, columns], places[rows, columns])
        own, starts = np.unique(rows, return_index=True)
        for field in fields(found):
            each = getattr(rates, field.name)
            weighted = each * weights[rows, columns].reshape(-1, *[1] * (each.ndim - 1))
            getattr(found, field.name)[own] += np.add.reduceat(weighted, starts, axis=0)
    return found


def part(slopes: Deviated, own: Deviated) -> Array:
    """What some deviations contribute (trials,) [rad]: the sum of all of them times their slopes."""
    pairs = ((getattr(slopes, field.name), getattr(own, field.name)) for field in fields(slopes))
    return np.asarray(sum((slope * value).reshape(len(value), -1).sum(axis=1) for slope, value in pairs))
