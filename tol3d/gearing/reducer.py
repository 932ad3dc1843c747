"""Reducers known by their data sheets, the same on both roads."""

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Model

Array = NDArray[np.float64]


def reducer_backlash(model: Model, name: str, deviations: Array) -> Array:
    """Angular backlash of a reducer at the shaft that it drives [rad], (trials,).

    Args:
        model, name: the reducer.
        deviations: (trials, components) [mm, rad, K]; a contributor may draw it, else it is the data sheet's maximum.
    """
    reducer = next(reducer for reducer in model.reducers if reducer.name == name)
    total = np.full(len(deviations), reducer.backlash)
    for contributor in model.contributors:
        if rate := contributor.effect.play_of(name):
            total = total + rate * deviations[:, model.component_slices[contributor.name].start]
    return total
