"""Robots: builds that stay as they are while their trains stand in many places, so that a robot has a mean of its own.

A robot's own mean is taken at one position at random in each P-th of the long period, and its error is read at one more
position, that of the study's trial: uncompensated, robot i is trial i of the run. Positions that were evenly spread
would hide errors that turn P times in the long period; these are never worse than independent ones.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing import AnyStage, Played, TrainPlay
from tol3d.numerics.arrays import Array
from tol3d.statistics.samplers import MonteCarlo, Stream

State = Literal["before", "batch", "robot"]

STATES: Final[tuple[State, ...]] = ("before", "batch", "robot")
"""The error as it is, less the batch's mean, less the robot's own mean."""


@dataclass(frozen=True, eq=False)
class Robots:
    """Robots of a batch, one a trial of the study.

    Args:
        seated: which of them could be seated at every position, (robots,).
        played: at all their positions, the study's own last.
        lost: lost motion there by method, (robots,) [arcmin].
        own: each robot's mean of the part of it that is compensated, by method, (robots,) [arcmin].
    """

    seated: NDArray[np.bool_]
    played: Played
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


def simulated_robots(play: TrainPlay, compensated: Sequence[AnyStage], positions: int) -> Robots:
    """Robots, as many as the study has trials.

    Args:
        play: lost motion of their train.
        compensated: the stages that count for a robot's own mean.
        positions: P.
    """
    played = play.played(positions, partial(_shares, play.simulation.study.seed, positions))
    return Robots(
        seated=played.seated,
        played=played,
        lost={method: played.lost(method)[:, -1] for method in played.methods},
        own={method: _own_mean(played, method, compensated) for method in played.methods},
    )


def _own_mean(played: Played, method: str, compensated: Sequence[AnyStage]) -> Array:
    at_shaft = [stage.factor * _mean(played.of_stage(method, stage)[:, :-1]) for stage in compensated]
    return np.sum(at_shaft, axis=0) if at_shaft else np.zeros(len(played.seated))


def _mean(values: Array) -> Array:
    """Mean of each row, from its first value: a row of equal values has that mean to the last bit."""
    first = values[:, :1]
    return np.asarray(first[:, 0] + (values - first).mean(axis=1))


def _shares(seed: int, positions: int, drive: str, first: int, count: int) -> Array:
    """Shares of a drive's long period, (robots, P): one uniform in each P-th of it."""
    draws = MonteCarlo(seed)
    streams = [Stream(drive, f"position {k} of {positions} of a robot", 0) for k in range(positions)]
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
