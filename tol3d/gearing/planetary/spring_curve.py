"""Torque against turn of a set whose flexible carrier presses its planets apart with one spring.

Up to the breakaway torque the spring holds the planets where contacts stop them; beyond it gives way, and the shaft
crosses what the rigid set has as dead band at a stiffness that is the spring's alone. Friction between the halves of
the carrier makes the way back another one: a loop of hysteresis. Ends of the
play are piecewise linear functions of the displacement of the planets, found piece by piece.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.model.deviated import Deviated, Free
from tol3d.gearing.planetary.model.planetary_set import MOST_PUSH, PlanetarySet
from tol3d.numerics.arrays import Array
from tol3d.numerics.programme import ranges

STRAIGHT: Final = 1e-11  # rad; a point lies on a line: the programme keeps rows to 1e-12 mm
KNOT: Final = 1e-9  # rad; bends of less are none: 0.0002 arcsec
HALVINGS: Final = 30  # of the way of the spring: 0.1 mm becomes 1e-10 mm


@dataclass(frozen=True)
class Straights:
    """A piecewise linear function of the displacement.

    Args:
        knots: ends of its pieces (pieces + 1,) [mm], rising.
        values: at the knots [rad].
    """

    knots: Array
    values: Array

    @property
    def slopes(self) -> Array:
        """Slopes of the pieces [rad/mm]."""
        return np.asarray(np.diff(self.values) / np.diff(self.knots))

    def at(self, displacement: float) -> float:
        """Its value [rad]."""
        return float(np.interp(displacement, self.knots, self.values))


@dataclass(frozen=True)
class DisplacedEnds:
    """Smallest and largest turn of a shaft against the displacement of the planets.

    Args:
        low, high: both ends; the lower one is convex, the upper one concave.
    """

    low: Straights
    high: Straights

    @property
    def least(self) -> float:
        """Displacement from which on there is room [mm]."""
        return float(self.low.knots[0])

    @property
    def closed(self) -> float:
        """Displacement at which contacts stop the planets [mm]."""
        return float(self.low.knots[-1])

    def at(self, displacement: float) -> tuple[float, float]:
        """Both [rad]."""
        return self.low.at(displacement), self.high.at(displacement)


def displaced_ends(planetary_set: PlanetarySet, deviated: Deviated, shaft: str, turns: float = 0.0) -> DisplacedEnds:
    """Ends of a set with one spring, by first-order gaps; the opposite shaft stands.

    Args:
        deviated: of one trial.
        shaft: the input or the output.
        turns: of the output, at which gears stand.

    Raises:
        InputError: no spring or several, several trials, or planets that find no room.
    """
    if len(planetary_set.springs) != 1:
        raise InputError(f"expected a flexible carrier with one spring, got {len(planetary_set.springs)}")
    if len(deviated.pins) != 1:
        raise InputError(f"expected the deviations of one trial, got those of {len(deviated.pins)}")
    programme = _Programme(planetary_set, shaft, *StackUp(planetary_set).sides(deviated, np.array([turns])))
    least, closed = programme.room()
    return DisplacedEnds(*(_straights(programme, end, least, closed) for end in (0, 1)))


@dataclass(frozen=True)
class _Programme:
    """Programme of one trial: sides of its contacts (1, rows) [mm]."""

    own: PlanetarySet
    shaft: str
    lower: Array
    upper: Array

    def room(self) -> tuple[float, float]:
        """Least and largest displacement [mm] for which the set has room."""
        push = np.zeros(len(self.own.unknowns(self.own.opposite(self.shaft))))
        push[-1] = 1.0
        free = self._solved(push, np.full((1, 1), -MOST_PUSH), np.full((1, 1), MOST_PUSH))
        if free.status[0] != 0 or free.ends[0, 1] <= 0.0:
            raise InputError("planets find no room: the set jams before its spring pushes")
        return float(free.ends[0, 0]), float(free.ends[0, 1])

    def ends(self, displacements: Array) -> Array:
        """Ends of the shaft's play (displacements, 2) [rad] where planets are displaced [mm]."""
        turn = self.own.objective(self.own.opposite(self.shaft), self.shaft)
        return self._solved(turn, displacements[:, None], displacements[:, None]).ends

    def _solved(self, turn: Array, least: Array, largest: Array) -> Free:
        own, stands, count = self.own, self.own.opposite(self.shaft), len(least)
        free = Free.of(count)
        lower = np.hstack([np.repeat(self.lower, count, axis=0), least])
        upper = np.hstack([np.repeat(self.upper, count, axis=0), largest])
        begun, wanted = own.begun(stands), np.stack([-turn, turn])
        ranges(own.rows(stands), lower, upper, turn, wanted, begun, *free.written)
        return free


def _straights(programme: _Programme, end: int, least: float, closed: float) -> Straights:
    """Pieces of one end: bent pieces are halved until their knots are known."""
    knots = np.array([least, closed])
    values = programme.ends(knots)[:, end]
    bent = np.ones(1, bool)
    for _ in range(HALVINGS):
        places = np.flatnonzero(bent)
        if not len(places):
            break
        middles = (knots[places] + knots[places + 1]) / 2
        found = programme.ends(middles)[:, end]
        off = np.abs(found - (values[places] + values[places + 1]) / 2) > STRAIGHT
        bent[places] = off
        knots = np.insert(knots, places[off] + 1, middles[off])
        values = np.insert(values, places[off] + 1, found[off])
        bent = np.insert(bent, places[off] + 1, True)
    kept = [0, *_bends(knots, values, 0, len(knots) - 1), len(knots) - 1]
    return Straights(knots[kept], values[kept])


def _bends(knots: Array, values: Array, first: int, last: int) -> list[int]:
    """Points between two that a polygon needs to stay within KNOT of all (Ramer, Douglas, Peucker)."""
    if last - first < 2:
        return []
    inner = slice(first + 1, last)
    off = np.abs(np.interp(knots[inner], knots[[first, last]], values[[first, last]]) - values[inner])
    worst = first + 1 + int(np.argmax(off))
    if off.max() <= KNOT:
        return []
    return [*_bends(knots, values, first, worst), worst, *_bends(knots, values, worst, last)]


@dataclass(frozen=True)
class LeafSpring:
    """Leaf spring that presses planets apart, by the displacement S of each along the circle of the pins.

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
    planetary_set: PlanetarySet, deviated: Deviated, shaft: str, spring: LeafSpring, turns: float = 0.0
) -> tuple[float, float]:
    """Torques [N mm] at which the spring begins to give way: clockwise (negative) and counter-clockwise.

    Where all gaps are alike it is Q0 rS (1 - kappa)/(4 (1 + kappa)) at the sun of a 3K set, with the friction added to
    Q0. Infinite where contacts that stop the planets do not turn the shaft. See turns_under.
    """
    ends = displaced_ends(planetary_set, deviated, shaft, turns)
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
