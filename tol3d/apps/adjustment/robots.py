"""Robots: builds that stay as they are while their trains stand in many places, so that a robot has a mean of its own.

A robot's own mean is taken at one position at random in each P-th of the long period, and its error is read at one more
position, that of the study's trial: uncompensated, robot i is trial i of the run. Positions that were evenly spread
would hide errors that turn P times in the long period; these are never worse than independent ones.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Measure
from tol3d.gearing.model.links import Drive
from tol3d.gearing.model.measure import AnyStage
from tol3d.gearing.system import gear_model
from tol3d.numerics.arrays import Array
from tol3d.samplers import MonteCarlo, Stream
from tol3d.study import Simulation, drawn
from tol3d.study.columns import columns_of
from tol3d.system import Trials
from tol3d.system.breakdown import Breakdown
from tol3d.system.method import Method
from tol3d.system.outcome import METHODS, SEATED, Columns, status_column, value_column
from tol3d.system.taken import ROWS_AT_ONCE

State = Literal["before", "batch", "robot"]

STATES: Final[tuple[State, ...]] = ("before", "batch", "robot")
"""The error as it is, less the batch's mean, less the robot's own mean."""


@dataclass(frozen=True, eq=False)
class Robots:
    """Robots of a batch, one a trial of the study.

    Args:
        seated: which of them could be seated at every position, (robots,).
        columns: at the study's own positions, see columns_of.
        lost: lost motion there by method, (robots,) [arcmin].
        own: each robot's mean of the part of it that is compensated, by method, (robots,) [arcmin].
    """

    seated: NDArray[np.bool_]
    columns: Columns
    lost: Mapping[str, Array]
    own: Mapping[str, Array]

    @property
    def count(self) -> int:
        """Number of robots drawn."""
        return len(self.seated)

    def errors(self, method: str, batch: float) -> Mapping[State, Array]:
        """Remaining error of each robot that could be assembled, (robots,) [arcmin]; `batch` is the batch's mean."""
        lost, own = self.lost[method][self.seated], self.own[method][self.seated]
        return {"before": lost, "batch": lost - batch, "robot": lost - own}


def simulated_robots(
    simulation: Simulation, method: Method | None, measure: Measure, compensated: Sequence[AnyStage], positions: int
) -> Robots:
    """Robots, as many as the study has trials.

    Args:
        simulation: one that measures the lost motion and nothing else.
        method: of its 3D simulation; None for an analytic study.
        measure: the lost motion, at a random position.
        compensated: the stages that count for a robot's own mean.
        positions: P.
    """
    at_once, trials = max(1, ROWS_AT_ONCE // (positions + 1)), simulation.study.trials
    starts = range(0, trials, at_once)
    pieces = [_columns(simulation, method, first, min(at_once, trials - first), positions) for first in starts]
    columns = {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}
    methods = [method for method in METHODS if value_column(method, measure.name) in columns]
    (breakdown,) = simulation.system.breakdowns
    return Robots(
        seated=_seated(columns, measure, trials),
        columns={name: each[:, -1] for name, each in columns.items()},
        lost={method: columns[value_column(method, measure.name)][:, -1].astype(np.float64) for method in methods},
        own={method: _own_mean(columns, method, breakdown, compensated) for method in methods},
    )


def _columns(
    simulation: Simulation, method: Method | None, first: int, count: int, positions: int
) -> dict[str, NDArray[np.generic]]:
    """Columns (robots, P + 1), the study's own position last."""
    columns = columns_of(simulation.system, method, robots_trials(simulation, first, count, positions))
    return {name: values.reshape(count, positions + 1) for name, values in columns.items()}


def _seated(columns: Columns, measure: Measure, robots: int) -> NDArray[np.bool_]:
    """Robots whose measure seats at every position, (robots,); all of them on the analytic method."""
    status = columns.get(status_column(measure.name))
    return np.ones(robots, bool) if status is None else np.all(status == SEATED, axis=1)


def _own_mean(columns: Columns, method: str, breakdown: Breakdown, compensated: Sequence[AnyStage]) -> Array:
    at_shaft = [stage.factor * _mean(columns[breakdown.column(method, stage.link)][:, :-1]) for stage in compensated]
    return np.sum(at_shaft, axis=0) if at_shaft else np.zeros(len(columns[value_column(method, breakdown.measure)]))


def _mean(values: NDArray[np.generic]) -> Array:
    """Mean of each row, from its first value: a row of equal values has that mean to the last bit."""
    first = values[:, :1].astype(np.float64)
    return np.asarray(first[:, 0] + (values.astype(np.float64) - first).mean(axis=1))


def robots_trials(simulation: Simulation, first: int, count: int, positions: int) -> Trials:
    """Robots first ... first + count - 1, each at P + 1 positions, positions fastest, the study's own last."""
    model, own = gear_model(simulation.system), drawn(simulation, first, count)
    angles: dict[str, Array] = {}
    for drive in model.layout.drives:
        root = 2 * math.pi * float(drive.turns) * _shares(drive, simulation.study.seed, first, count, positions)
        for mesh in drive.moves:
            turning = model.layout.mesh_turn[mesh]
            spread = turning.offset + float(turning.rate) * root
            angles[mesh] = np.concatenate([spread, own.positions[mesh][:, None]], axis=1).ravel()
    return Trials(np.repeat(own.deviations, positions + 1, axis=0), angles)


def _shares(drive: Drive, seed: int, first: int, count: int, positions: int) -> Array:
    """Shares of the long period, (robots, P): one uniform in each P-th of it."""
    draws = MonteCarlo(seed)
    streams = [Stream(drive.name, f"position {k} of {positions} of a robot", 0) for k in range(positions)]
    each = [(k + draws.uniforms(stream, first, count)) / positions for k, stream in enumerate(streams)]
    return np.stack(each, axis=1)


def left_of_the_mean(turns: float, positions: int) -> float:
    """Variance of a robot's own mean of a once-per-turn wave, of that of the wave itself.

    The gear makes so many turns in the long period. In a P-th of it the wave's mean is sinc(turns/P) of it, so a
    uniform position there leaves 1 - sinc^2 of its variance, and of P of them 1/P is left: 1/P where the wave turns
    often, next to nothing where it turns once.

    >>> left_of_the_mean(16, 16), round(left_of_the_mean(1, 16) * 1e6)
    (0.0625, 799)
    """
    return float(1 - np.sinc(turns / positions) ** 2) / positions
