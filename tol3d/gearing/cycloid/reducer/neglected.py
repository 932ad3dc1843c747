"""Terms that the analytic method of an RV reducer neglects: the path of pin centres bends.

The method takes every gap along the normal of the place where the pin nominally is. Deviations, the turn and the
profile's shift put the pin D off that place along the path, whose curvature kappa then leaves kappa D^2/2 more. Near
roots of lobes the path bends sharply: with K = 0.77 and 40 pins its concave radius is half a millimetre where the lever
is 0.7 of the largest, and the square alone may let another pin be first. Of D the shift's part stays while deviations
shrink, so that products of it with deviations are of first order. Over a turn it also leaves out by how much the
first stage shifts the angle of the cranks. With both, turns are those of the exact method but for terms of third order;
what is neglected is the difference that both make, trial by trial.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from typing_extensions import override

from tol3d.gearing.cycloid.first_order.linear import LinearStage
from tol3d.gearing.cycloid.reducer.trials import RVMethod, RVTrials
from tol3d.gearing.cycloid.reducer.turning import LinearTurning, Turning, led_angles
from tol3d.gearing.reducers.trials import ReducerMeasure
from tol3d.numerics.arrays import Array
from tol3d.study.system.taken import taken
from tol3d.study.system.trials import Trials


@dataclass(frozen=True)
class BentStage(LinearStage):
    """A cycloid stage whose first-order turns have the bend of the path of each pin besides."""

    bends = True


BEND: Final = "the bend of flanks, and which pin touches"


@dataclass(frozen=True)
class BentTurning(LinearTurning):
    """First-order turning with the bend of the path of each pin, and with cranks as the first stage leads them."""

    @property
    @override
    def stage(self) -> LinearStage:
        return BentStage.of(self.own)

    @override
    def phis(self, turns: Array, beta: Array) -> Array:
        return led_angles(self.own, turns, beta)


def neglected(system: RVTrials, measure: ReducerMeasure, trials: Trials) -> Mapping[str, Array]:
    """Effect of the neglected terms on a measure, in its unit: (trials,) by its words; of a curve nothing."""
    if measure.take == "curve" or system.own.plays:
        return {}
    bent, straight = (_taken(system, measure, trials, method(system.own)) for method in (BentTurning, LinearTurning))
    return {BEND: measure.per_internal * np.abs(bent - straight)}


def _taken(system: RVTrials, measure: ReducerMeasure, trials: Trials, turning: Turning) -> Array:
    return taken(measure, RVMethod(system, turning).answers(trials, (measure,)).values[measure.name])
