"""Terms that the stack-ups of a measure neglect on purpose, in that measure: bounds, trial by trial."""

from collections.abc import Mapping

import numpy as np

from tol3d.gearing.meshing.seats import driver_angles
from tol3d.gearing.model import LostMotion, Measure, Model, TransmissionError
from tol3d.gearing.play.linked import link_trials
from tol3d.gearing.play.play import seat_key
from tol3d.gearing.stack_up import per_normal_backlash, stack_of
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Neglect
from tol3d.gears import GearPair
from tol3d.numerics.arrays import Array
from tol3d.study.system.trials import Trials


def neglected(model: Model, measure: Measure, trials: Trials) -> Mapping[str, Array]:
    """Largest neglected first-order change of a measure, in its unit: (trials,) by neglected term.

    Of several positions the one with the largest counts, for a range twice; of parallel load paths all are added up.
    """
    found: dict[str, Array] = {}
    for factor, backlash in measure.kind.backlashes:
        stack = stack_of(model, model.mesh(backlash.mesh), backlash.reading)
        angles = driver_angles(seat_key(model, measure, backlash), trials)
        per = abs(factor) * per_normal_backlash(model, backlash) * in_measure(measure)
        for neglect in stack.neglects:
            own = per * _furthest(model, stack, neglect, trials.deviations, angles)
            found[neglect.words] = found.get(neglect.words, 0.0) + own
    for factor, name in measure.kind.links:
        link = model.link(name)
        for words, free in link.neglected(link_trials(model, measure, link, trials)).items():
            own = abs(factor) * in_measure(measure) * free.max(axis=1)
            found[words] = found.get(words, 0.0) + own
    return found


def _furthest(model: Model, stack: Stack[GearPair], neglect: Neglect, deviations: Array, angles: Array) -> Array:
    positions = angles.shape[1]
    repeated = deviations if positions == 1 else np.repeat(deviations, positions, axis=0)
    driver = angles.ravel()
    bounds = neglect.bound(model.component_slices, repeated, (driver, stack.pair.driven_angle(driver)))
    return np.asarray(bounds.reshape(angles.shape).max(axis=1))


def in_measure(measure: Measure) -> float:
    """Change of a measure, in its unit, per mm or rad of the sum of its backlashes; of a range at both its ends.

    A transmission error is a difference of two positions, each of half of what changes the backlash.
    """
    kind = measure.kind
    if isinstance(kind, TransmissionError):
        return measure.per_internal
    lever = kind.tip.lever if isinstance(kind, LostMotion) and kind.tip else 1.0
    return lever * (2.0 if measure.take == "range" else 1.0) * measure.per_internal


def of_gaps(model: Model, measure: Measure, gap: float) -> float:
    """Value of a measure, in its unit, for a normal backlash [mm] in each of its meshes.

    A transmission error depends only on the two flanks that touch, at both of its positions.
    """
    if isinstance(measure.kind, TransmissionError):
        gap /= 2
    free = sum(abs(factor) * gap * per_normal_backlash(model, backlash) for factor, backlash in measure.kind.backlashes)
    return free * in_measure(measure)
