"""What a measure of an RV reducer sees of contributors: their first-order terms where its pin and planet touch.

Which pin of which disc touches decides what a deviation does, so that it is found anew of each trial, to first order.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.measure import RVMeasure
from tol3d.cycloid.resting import linear_rates, linear_turning
from tol3d.cycloid.rv_deviated import RVDeviated
from tol3d.cycloid.rv_trials import RVTrials
from tol3d.system.contributor import Contributor
from tol3d.system.regressors import has_square
from tol3d.system.system import Columns

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
