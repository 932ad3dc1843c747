"""Torque against turn of a set whose flexible carrier presses its planets apart with one spring.

Up to the breakaway torque the spring holds the planets where contacts stop them; beyond it gives way, and the shaft
crosses what the rigid set has as dead band at a stiffness that is the spring's alone. Friction between the halves of
the carrier makes the way back another one: a loop of hysteresis.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.planetary.deviated import Deviated
from tol3d.planetary.displaced_ends import DisplacedEnds, displaced_ends
from tol3d.planetary.planetary_set import PlanetarySet

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LeafSpring:
    """What presses planets apart, by the displacement S of each along the circle of the pins.

    Args:
        force: Q0 against S where contacts stop the planets [N], its work being Q0 S.
        stiffness: k against S [N/mm], 0 or more.
        friction: that opposes S wherever it moves [N], its work being lost.
    """

    force: float
    stiffness: float
    friction: float = 0.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"{name}: expected 0 or more, got {value}")
        if not self.force > self.friction:
            raise InputError(f"friction: expected less than the force of {self.force} N, got {self.friction} N")


def turns_under(
    own: PlanetarySet, deviated: Deviated, torques: Array, shaft: str, spring: LeafSpring, turns: float = 0.0
) -> Array:
    """Turn of a shaft [rad] under torques (torques,) [N mm], one after the other, the opposite one held.

    By first-order gaps. The work of torque and spring, T theta(S) + Q0 (S - S0) - k (S - S0)^2/2, has the rate g(S):
    S0 is the displacement at which contacts stop the planets, theta(S) the end of the shaft's play, concave along T.
    Planets stay while |g| is no more than the friction, and otherwise move until it is. They begin at S0. A shaft
    without torque stays where it is, as long as contacts let it.

    Args:
        own: a set with one spring.
        deviated: of one trial.
        torques: on the shaft, positive is counter-clockwise.
        shaft: the input or the output.
        spring: its force, stiffness and friction.
        turns: of the output, at which gears stand.

    Raises:
        InputError: no spring or several, or planets that find no room.
    """
    ends = displaced_ends(own, deviated, shaft, turns)
    at, turn = ends.closed, 0.0
    found = np.empty(len(torques))
    for place, torque in enumerate(torques):
        opened = _rests(ends, torque, spring, spring.force - spring.friction)
        shut = _rests(ends, torque, spring, spring.force + spring.friction)
        at = min(max(at, opened), shut)
        low, high = ends.at(at)
        turn = min(max(turn, low), high) if torque == 0.0 else high if torque > 0.0 else low
        found[place] = turn
    return found


def breakaway(
    own: PlanetarySet, deviated: Deviated, shaft: str, spring: LeafSpring, turns: float = 0.0
) -> tuple[float, float]:
    """Torques [N mm] at which the spring begins to give way: clockwise (negative) and counter-clockwise.

    Where all gaps are alike it is Q0 rS (1 - kappa)/(4 (1 + kappa)) at the sun of a 3K set, with the friction added to
    Q0. Infinite where contacts that stop the planets do not turn the shaft. See turns_under.
    """
    ends = displaced_ends(own, deviated, shaft, turns)
    slopes = [float(side.slopes[-1]) if len(side.slopes) else 0.0 for side in (ends.low, ends.high)]
    lost = spring.force + spring.friction
    return (-lost / slopes[0] if slopes[0] > 0.0 else -np.inf), (-lost / slopes[1] if slopes[1] < 0.0 else np.inf)


def _rests(ends: DisplacedEnds, torque: float, spring: LeafSpring, force: float) -> float:
    """Displacement [mm] at which the work of a torque and of a spring with that force where planets stop is largest."""
    side = ends.high if torque > 0.0 else ends.low
    for piece in reversed(range(len(side.slopes))):
        begin, end = float(side.knots[piece]), float(side.knots[piece + 1])
        rate = torque * float(side.slopes[piece]) + force  # at S0; k (S0 - S) more at S
        if rate + spring.stiffness * (ends.closed - end) >= 0.0:
            return end
        if spring.stiffness > 0.0 and rate + spring.stiffness * (ends.closed - begin) > 0.0:
            return ends.closed + rate / spring.stiffness
    return float(side.knots[0])
