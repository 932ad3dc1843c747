"""What the analytic road of an RV reducer leaves out on purpose: the bend of the path of pin centres.

It adds the square of how far a pin stands along the path, by deviations and by the profile's shift, see flank_bend. Of
that the product of both is of first order, for the shift stays while deviations shrink; and near the roots, where the
path bends within a millimetre, the square alone may let another pin be first. Over a turn the road also leaves out by
how much the first stage shifts the angle of the cranks. With both, turns are those of the exact road but for terms of
third order; what is neglected is the difference that both make, trial by trial.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.flank_bend import BentStage
from tol3d.cycloid.linear import LinearStage
from tol3d.cycloid.measure import RVMeasure
from tol3d.cycloid.roads import RVRoad
from tol3d.cycloid.rv_trials import RVTrials
from tol3d.cycloid.turning import LinearTurning, Turning, led_angles
from tol3d.system.taken import taken
from tol3d.system.trials import Trials

Array = NDArray[np.float64]

BEND: Final = "the bend of flanks, and which pin touches"


@dataclass(frozen=True)
class BentTurning(LinearTurning):
    """To first order, with the bend of the path of each pin, and with cranks as the first stage leads them."""

    @property
    def stage(self) -> LinearStage:
        """See LinearTurning."""
        return BentStage.of(self.own.linear)

    def phis(self, turns: Array, beta: Array) -> Array:
        """See LinearTurning."""
        return led_angles(self.own, turns, beta)


def neglected(system: RVTrials, measure: RVMeasure, trials: Trials) -> Mapping[str, Array]:
    """By how much what is left out changes a measure, in its unit: (trials,) by its words; of a curve nothing."""
    if measure.take == "curve" or system.own.plays:
        return {}
    bent, straight = (_taken(system, measure, trials, road(system.own)) for road in (BentTurning, LinearTurning))
    return {BEND: measure.per_internal * np.abs(bent - straight)}


def _taken(system: RVTrials, measure: RVMeasure, trials: Trials, turning: Turning) -> Array:
    return taken(measure, RVRoad(system, turning).answers(trials, (measure,)).values[measure.name])
