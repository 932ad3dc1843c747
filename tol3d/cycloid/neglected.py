"""What the analytic road of an RV reducer leaves out on purpose: the bend of the path of pin centres.

It adds the square of how far a pin stands along the path, by deviations and by the profile's shift, see flank_bend. Of
that the product of both is of first order, for the shift stays while deviations shrink; and near the roots, where the
path bends within a millimetre, the square alone may let another pin be first.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.first_stage import crank_turns, first_order_mesh
from tol3d.cycloid.flank_bend import along_flank
from tol3d.cycloid.measure import RVMeasure
from tol3d.cycloid.rv_deviated import RVDeviated
from tol3d.cycloid.rv_trials import RVTrials
from tol3d.cycloid.turn_regressors import TAKEN, weights_of
from tol3d.cycloid.turning import LinearTurning
from tol3d.system.trials import Trials

Array = NDArray[np.float64]

BEND: Final = "the bend of flanks, and which pin touches"


def neglected(system: RVTrials, measure: RVMeasure, trials: Trials) -> Mapping[str, Array]:
    """Largest change of a measure that is left out, in its unit: (trials,) by what is left out; see System.

    Of a harmonic that of a curve which is off by its mean size at every position in phase; of a curve nothing.
    """
    if measure.take == "curve":
        return {}
    deviated = system.deviated(trials)
    turns = system.turns(measure.positions, trials)
    at_each = _of_one_position if measure.take == "value" else _of_positions
    senses = (1, -1) if measure.reading == "lost motion" else (measure.sense,)
    bent = sum((at_each(system, measure, deviated, turns, sense) for sense in senses), np.zeros(len(trials)))
    return {BEND: measure.per_internal * bent}


def _of_one_position(system: RVTrials, measure: RVMeasure, deviated: RVDeviated, turns: Array, sense: int) -> Array:
    """The largest of all pins that may be first (trials,) [rad]: no other one surely stops the output before them."""
    own, phis = system.own.linear, system.own.crank_angles(turns)[:, 0]
    aside = _aside(system, deviated)
    allowed, bends = [], []
    for disc in range(own.discs):
        found, pins = own.allowed(deviated.stage, disc, phis, 1 if sense > 0 else -1, aside)
        for turn, pin in zip(found.T, pins, strict=True):
            at = np.broadcast_to(phis, turn.shape), np.full(len(turn), disc * own.profile.pins + pin)
            deviating, shifted, factor = along_flank(own, deviated.stage, *at, np.where(np.isfinite(turn), turn, 0.0))
            allowed.append(sense * turn)
            bends.append(np.abs(factor * (deviating + shifted) ** 2))
    first, bent = np.array(allowed), np.array(bends)
    may_be = np.where(first - bent <= (first + bent).min(axis=0), bent, 0.0).max(axis=0)
    return np.asarray(may_be + _at_the_edge(system, deviated, turns, sense))


def _aside(system: RVTrials, deviated: RVDeviated) -> Array | None:
    """See LinearStage.touches."""
    width = system.own.width
    return None if width is None else deviated.disc_tilts * (width / 2)


def _at_the_edge(system: RVTrials, deviated: RVDeviated, turns: Array, sense: int) -> Array:
    """What pins change (trials,) [rad] that work or not by how far the first stage has turned the cranks."""
    own = system.own
    beta, _ = crank_turns(own, deviated, turns, sense, first_order_mesh)
    edge = float(np.abs(beta).max(initial=0.0)) / (1.0 - own.profile.shortening)  # a lever changes less, of the largest
    if edge == 0.0:
        return np.zeros(len(beta))
    windows = (max(own.window - edge, 0.0), min(own.window + edge, 1.0 - edge))
    wide, narrow = (
        replace(own.linear, window=each).touches(
            deviated.stage, own.crank_angles(turns), 1 if sense > 0 else -1, _aside(system, deviated)
        )
        for each in windows
    )
    return np.abs(wide.turns - narrow.turns)[:, 0]


def _of_positions(system: RVTrials, measure: RVMeasure, deviated: RVDeviated, turns: Array, sense: int) -> Array:
    """That of the pins that touch at the positions that are taken, added up (trials,) [rad]."""
    own = system.own
    found = LinearTurning(own).turned(deviated, turns, sense)
    weights = np.full(found.turns.shape, 4.0 / found.turns.shape[1])  # of a harmonic, peak to peak
    if measure.take in TAKEN:
        weights = np.abs(weights_of(measure, found.turns))
    phis = np.broadcast_to(own.crank_angles(turns), weights.shape)
    total = np.zeros(len(weights))
    for position in np.flatnonzero(weights.any(axis=0)):
        at = phis[:, position], found.places[:, position], found.turns[:, position]
        deviating, shifted, factor = along_flank(own.linear, deviated.stage, *at)
        total += weights[:, position] * np.abs(factor * (deviating + shifted) ** 2)
    return total
