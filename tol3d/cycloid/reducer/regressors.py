"""Regressors of the measures of an RV reducer: first-order terms of the contributors where its pin and planet touch.

Which pin of which disc touches decides what a deviation does, so that it is found anew in each trial. Over a turn the
output's turn at a position is a sum of parts, one of each contributor by the rates of the pin and planet that touch
there, and of what the modification leaves at that pin. What is taken of a turn adds and subtracts turns at positions
that are found anew of each trial. A contributor's part is its regressor; its share is the covariance of its part with
the measure.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from tol3d.cycloid.reducer.deviated import RVDeviated
from tol3d.cycloid.reducer.resting import linear_rates, linear_turning
from tol3d.cycloid.reducer.trials import RVMeasure, RVTrials
from tol3d.cycloid.reducer.turning import Turned
from tol3d.numerics.arrays import Array
from tol3d.system.contributor import Contributor
from tol3d.system.output_system import Parts, component_values
from tol3d.system.regressors import has_square
from tol3d.system.system import Columns
from tol3d.system.taken import weights_taken
from tol3d.system.trials import Trials


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
        values = component_values(own, columns)
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
    """Turns that a measure reads, and their signs."""
    return ((1, 1.0), (-1, -1.0)) if measure.reading == "lost motion" else ((measure.sense, 1.0),)


def _rates(system: RVTrials, deviated: RVDeviated, turns: Array, sense: tuple[int, float]) -> tuple[float, RVDeviated]:
    return sense[1], linear_rates(system.own, deviated, turns, sense[0])


def _term(system: RVTrials, name: str, rates: Sequence[tuple[float, RVDeviated]], values: Array) -> Array:
    own = system.acts[name]
    return sum((counts * rate.term(own, values) for counts, rate in rates), np.zeros(len(values)))


TAKEN = ("min", "max", "range")  # a harmonic would take the rates at every position


def parts_over_turn(system: RVTrials, measure: RVMeasure, trials: Trials) -> Parts:
    """Parts of contributors in an extreme or a range, by the rates at the positions that are taken of each trial."""
    deviated, at = system.deviated(trials), system.turns(measure.positions, trials)
    turned = linear_turning(system.own).turned(deviated, at, measure.sense)
    weights = weights_taken(measure, turned.turns)
    rows, positions = np.nonzero(weights)
    places, planets = (
        np.broadcast_to(own, weights.shape)[rows, positions][:, None] for own in (turned.places, turned.planets)
    )
    found = Turned(turned.turns[rows, positions][:, None], places, planets)
    rates = linear_rates(system.own, deviated[rows], at[0, positions], measure.sense, found)

    def part_of(own: Contributor, off: Array) -> Array:
        terms = weights[rows, positions] * rates.term(system.acts[own.name], off[rows])
        return np.asarray(np.bincount(rows, terms, minlength=len(off)), dtype=np.float64)

    return part_of
