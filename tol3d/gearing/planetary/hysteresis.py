"""A shaft turned there and back against the spring of a flexible carrier: the torque curve of one trial."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.spring_curve import DisplacedEnds, LeafSpring, breakaway, displaced_ends, turns_under
from tol3d.gearing.planetary.summary_types import TorqueCurve
from tol3d.numerics.arrays import Array
from tol3d.study.runs.summary.values import made
from tol3d.units import RAD_PER_ARCMIN

LEVEL: Final = 1e-6  # rad/mm; of slopes of 0.1 rad/mm and more, what is left of a level piece by rounding


@dataclass(frozen=True)
class Hysteresis:
    """Hysteresis from no torque to the peak, to the same backwards, and to the peak again.

    Args:
        shaft: the one that is turned, the opposite one held.
        torques: on it (steps,) [N mm], positive is counter-clockwise.
        turns: its turn (steps,) [rad].
        breakaway: torques from which it turns, clockwise and counter-clockwise [N mm].
        rigid: ends of its play with a rigid carrier [rad]; None where that has no room.
    """

    shaft: str
    torques: Array
    turns: Array
    breakaway: tuple[float, float]
    rigid: tuple[float, float] | None

    @property
    def lost_motion(self) -> float:
        """Turn between the last ways through no torque, back and on [rad]: the remainder by springs and friction."""
        quarter = len(self.torques) // 5
        return float(self.turns[2 * quarter] - self.turns[4 * quarter])

    def csv(self) -> str:
        """A row a step."""
        rows = [f"{torque!r},{turn!r}" for torque, turn in zip(self.torques.tolist(), self.minutes, strict=True)]
        return "\n".join(["torque [N mm],turn [arcmin]", *rows, ""])

    @property
    def curve(self) -> TorqueCurve:
        """The same as summary.json has it."""
        return made(
            TorqueCurve,
            shaft=self.shaft,
            torque_n_mm=[float(torque) for torque in self.torques],
            turn_arcmin=self.minutes,
            breakaway_n_mm=list(self.breakaway),
            rigid_arcmin=None if self.rigid is None else [end / RAD_PER_ARCMIN for end in self.rigid],
        )

    @property
    def minutes(self) -> list[float]:
        """Turns [arcmin]."""
        return [float(turn) for turn in self.turns / RAD_PER_ARCMIN]


def crossing(ends: DisplacedEnds, spring: LeafSpring) -> float:
    """Torque [N mm] at which the shaft has crossed the region of low stiffness next to the breakaway, either way.

    It may go on a little under many times as much: where springs are nearly in line with what stops the planets. 0
    where it never turns against the spring.
    """
    torques = [0.0]
    for side, sense in ((ends.low, 1.0), (ends.high, -1.0)):
        if len(side.slopes) and sense * side.slopes[-1] > LEVEL:
            force = spring.force + spring.friction + spring.stiffness * float(side.knots[-1] - side.knots[-2])
            torques.append(force / abs(float(side.slopes[-1])))
    return max(torques)


def hysteresis(
    own: PlanetarySet, deviated: Deviated, shaft: str, spring: LeafSpring, peak: float, steps: int = 100
) -> Hysteresis:
    """Hysteresis of one trial, at the first position of the gears; see spring_curve.turns_under.

    Args:
        own: a set with one spring.
        deviated: of one trial.
        shaft: the input or the output.
        spring: its force, stiffness and friction.
        peak: largest torque [N mm].
        steps: torques from none to the peak.

    Raises:
        InputError: another shaft, no peak, no spring or several, or planets that find no room.
    """
    if shaft not in (own.input, own.output):
        raise InputError(f"shaft: expected {own.input!r} or {own.output!r}, got {shaft!r}")
    if not (math.isfinite(peak) and peak > 0.0):
        raise InputError(f"peak: expected more than 0 N mm, got {peak}")
    if steps < 1:
        raise InputError(f"steps: expected 1 or more, got {steps}")
    rising = np.arange(steps + 1) / steps
    falling = rising[-2::-1]
    ends = displaced_ends(own, deviated, shaft)
    torques = peak * np.concatenate([rising, falling, -rising[1:], -falling, rising[1:]])
    return Hysteresis(
        shaft,
        torques,
        turns_under(own, deviated, torques, shaft, spring),
        breakaway(own, deviated, shaft, spring),
        ends.at(0.0) if ends.least <= 0.0 else None,
    )
