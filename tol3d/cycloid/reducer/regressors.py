"""Regressors of the measures of an RV reducer: first-order terms of the contributors where its pin and planet touch.

Which pin of which disc touches decides what a deviation does, so that it is found anew in each trial. Over a turn the
output's turn at a position is a sum of parts, one of each contributor by the rates of the pin and planet that touch
there, and of what the modification leaves at that pin. What is taken of a turn adds and subtracts turns at positions
that are found anew of each trial. A contributor's part is its regressor; its share is the covariance of its part with
the measure.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.reducer.deviated import RVDeviated
from tol3d.cycloid.reducer.resting import linear_rates, linear_turning
from tol3d.cycloid.reducer.trials import RVMeasure, RVTrials
from tol3d.cycloid.reducer.turning import Turned
from tol3d.system.contributor import Contributor
from tol3d.system.regressors import has_square
from tol3d.system.system import Columns
from tol3d.system.taken import ROWS_AT_ONCE
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


def regress_touching(
    system: RVTrials,
    measure: RVMeasure,
    contributors: Sequence[Contributor],
    columns: Columns,
    rows: Mapping[str, Array],
) -> None:
    """Write contributors' rows (regressors, trials) of a measure at one position, see System.regress."""
    deviated = system.deviated_again(columns)
    degrees = np.asarray(columns[system.position_column], dtype=np.float64)
    turns = (
        degrees / 360.0
        if measure.positions.fixed is None
        else np.full_like(degrees, measure.positions.angle / 2 / np.pi)
    )
    rates = [_rates(system, deviated, turns, sense) for sense in _senses(measure)]
    for own in contributors:
        values = np.stack([np.asarray(columns[name], dtype=np.float64) * own.per_unit for name in own.columns], axis=1)
        scale = system.own.profile.pitch_radius / (own.draw.sigma or 1.0)
        if has_square(own):
            rows[own.name][0] = scale * _term(system, own.name, rates, values)
            np.square(rows[own.name][0], out=rows[own.name][1])
            continue
        for k, row in enumerate(rows[own.name]):
            alone = np.zeros_like(values)
            alone[:, k] = values[:, k]
            row[...] = scale * _term(system, own.name, rates, alone)


def _senses(measure: RVMeasure) -> tuple[tuple[int, float], ...]:
    """Which turns a measure reads, and how they count."""
    return ((1, 1.0), (-1, -1.0)) if measure.reading == "lost motion" else ((measure.sense, 1.0),)


def _rates(system: RVTrials, deviated: RVDeviated, turns: Array, sense: tuple[int, float]) -> tuple[float, RVDeviated]:
    found = linear_turning(system.own).turned(deviated, turns[:, None], sense[0])
    return sense[1], linear_rates(system.own, deviated, turns, found, sense[0])


def _term(system: RVTrials, name: str, rates: Sequence[tuple[float, RVDeviated]], values: Array) -> Array:
    own = system.acts[name]
    return sum((counts * rate.term(own, values) for counts, rate in rates), np.zeros(len(values)))


TAKEN = ("min", "max", "range")  # a harmonic would take the rates at every position


def regress_over_turn(
    system: RVTrials,
    measure: RVMeasure,
    contributors: Sequence[Contributor],
    columns: Columns,
    rows: Mapping[str, Array],
) -> None:
    """Write contributors' rows (regressors, trials) of an extreme or a range, first its part; see System.regress."""
    values = {own.name: _values(own, columns) for own in system.contributors}
    deviations = np.concatenate([values[own.name] for own in system.contributors], axis=1)
    for own in contributors:
        rows[own.name][...] = 0.0
    at_once = max(1, ROWS_AT_ONCE // measure.positions.in_a_trial)
    for first in range(0, len(deviations), at_once):
        part = slice(first, first + at_once)
        deviated = system.deviated(Trials(deviations[part], {}))
        weights, rates = taken_rates(system, measure, deviated)
        trials, positions = np.nonzero(weights)
        for own in contributors:
            off = values[own.name][part] - np.array(own.draw.mean(turning=False))
            terms = weights[trials, positions] * rates.term(system.acts[own.name], off[trials])
            rows[own.name][0, part] = measure.per_internal * np.bincount(trials, terms, minlength=len(off))


def taken_rates(system: RVTrials, measure: RVMeasure, deviated: RVDeviated) -> tuple[Array, RVDeviated]:
    """What a measure takes of each trial's turns by the analytic road.

    Returns:
        Weights of the turns (trials, positions), most of them 0, and rates of those that are not, in their order.
    """
    turns = fixed_turns(measure)
    found = linear_turning(system.own).turned(deviated, turns, measure.sense)
    weights = weights_of(measure, found.turns)
    trials, positions = np.nonzero(weights)
    places = np.broadcast_to(found.places, weights.shape)[trials, positions][:, None]
    planets = np.broadcast_to(found.planets, weights.shape)[trials, positions][:, None]
    at = Turned(found.turns[trials, positions][:, None], places, planets)
    return weights, linear_rates(system.own, deviated.rows(trials), turns[0, positions], at, measure.sense)


def fixed_turns(measure: RVMeasure) -> Array:
    """Turns of the output (1, positions) at which every trial is read."""
    assert measure.positions.fixed is not None
    return np.array([measure.positions.fixed]) / (2 * np.pi)


def weights_of(measure: RVMeasure, turns: Array) -> Array:
    """What a measure takes of turns (trials, positions), which are read from the first on, is their sum times these."""
    found, rows = np.zeros_like(turns), np.arange(len(turns))
    if measure.take in ("max", "range"):
        found[rows, turns.argmax(axis=1)] += 1.0
    if measure.take in ("min", "range"):
        found[rows, turns.argmin(axis=1)] += -1.0 if measure.take == "range" else 1.0
    if measure.take != "range":
        found[:, 0] -= 1.0
    return found


def _values(contributor: Contributor, columns: Columns) -> Array:
    read = (np.asarray(columns[name], dtype=np.float64) for name in contributor.columns)
    return np.stack([own * contributor.per_unit for own in read], axis=1)
