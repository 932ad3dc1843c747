"""A set moved: turned in contact, swung through its play, or opened by its flexible carrier, state after state."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.gearing.placed import PlacedGear
from tol3d.planetary.contact import Contact
from tol3d.planetary.deviated import Deviated
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.shown import ShownSet, placed_gears, placed_pins

Array = NDArray[np.float64]

LOW, HIGH = 0, 1
"""Ends of a shaft's turn, clockwise and counter-clockwise."""


@dataclass(frozen=True, eq=False)
class MovedSet:
    """A set at one moment.

    Args:
        gears: central gears, then those of each planet.
        pins: axes of the planets (2,) [mm].
        turns: of the output, beyond where the trial has it, where no backlash would have it.
        at: turns of shafts and planets [rad] beyond that, and displacements by springs [mm].
        free: how far the output turns with the input held [rad], at this displacement.
    """

    gears: tuple[PlacedGear, ...]
    pins: tuple[Array, ...]
    turns: float
    at: Array
    free: float


def turned(shown: ShownSet, frames: int) -> tuple[MovedSet, ...]:
    """The input turns counter-clockwise and the output follows in contact, its load resisting.

    Planets go as far as from their place to the next, or turn once where the carrier stands.

    Args:
        shown: the set of a trial.
        frames: how many.
    """
    own = shown.own
    carrier = -float(own.turn(own.held) * own.planet_turns)  # turns a turn of the output
    way = 1 / (own.planets * abs(carrier)) if carrier else 1 / abs(float(own.planet_turns))
    sense = 1.0 if own.ratio > 0 else -1.0
    beyond = sense * way * np.linspace(0.0, 1.0, frames)
    ends, reached = _seated(own, shown.deviated, shown.turns + beyond)
    behind = LOW if sense > 0.0 else HIGH
    return tuple(
        _state(shown, own, float(turns), at[behind], end) for turns, at, end in zip(beyond, reached, ends, strict=True)
    )


def swung(shown: ShownSet, frames: int) -> tuple[MovedSet, ...]:
    """The output goes from its clockwise to its counter-clockwise end with the input held.

    Between both ends every coordinate goes evenly: contacts are linear in them but for some thousandths.
    """
    ends, reached = _seated(shown.own, shown.deviated, np.array([shown.turns]))
    between = np.linspace(0.0, 1.0, frames)[:, None]
    way = (1 - between) * reached[0, LOW] + between * reached[0, HIGH]
    return tuple(_state(shown, shown.own, 0.0, at, ends[0]) for at in way)


def opened(shown: ShownSet, frames: int) -> tuple[MovedSet, ...]:
    """The flexible carrier turns its planets apart, from 0 to where its springs hold them; the output at its end.

    Args:
        shown: a set with springs.
        frames: how many.

    Raises:
        InputError: springs do not open it.
    """
    first = len(shown.own.shafts) + shown.own.planets
    _, reached = _seated(shown.own, shown.deviated, np.array([shown.turns]))
    last = reached[0, HIGH, first:]
    if not (last > 0.0).all():
        raise InputError("the carrier does not open: no spring finds room to push the planets apart")
    states = []
    for share in np.linspace(0.0, 1.0, frames)[:-1]:
        own = displaced(shown.own, share * last)
        ends, reached = _seated(own, shown.deviated, np.array([shown.turns]))
        states.append(_state(shown, own, 0.0, reached[0, HIGH], ends[0]))
    ends, reached = _seated(shown.own, shown.deviated, np.array([shown.turns]))
    return (*states, _state(shown, shown.own, 0.0, reached[0, HIGH], ends[0]))


def displaced(own: PlanetarySet, displacements: Sequence[float] | Array) -> PlanetarySet:
    """The set with each of its springs set to a displacement [mm]."""
    springs = zip(own.springs, displacements, strict=True)
    return replace(own, springs=tuple(replace(spring, displacement=float(at)) for spring, at in springs))


def _seated(own: PlanetarySet, deviated: Deviated, turns: Array) -> tuple[Array, Array]:
    """Ends of the output's turn (positions, 2) [rad] and all coordinates there (positions, 2, coordinates).

    Raises:
        InputError: the set jams.
    """
    rows = Deviated(*(np.repeat(getattr(deviated, own.name), len(turns), axis=0) for own in fields(deviated)))
    free, reached = Contact(own).seated(rows, turns, own.output, own.opposite(own.output))
    if free.status.any():
        raise InputError("the set jams, so that nothing of it moves; choose another trial")
    return free.ends, reached


def _state(shown: ShownSet, own: PlanetarySet, beyond: float, at: Array, ends: Array) -> MovedSet:
    gears = placed_gears(own, shown.made, shown.deviated, shown.turns + beyond, at)
    pins = placed_pins(own, shown.deviated, shown.turns + beyond, at)
    return MovedSet(gears, pins, beyond, at, float(ends[1] - ends[0]))


def shaft_turn(own: PlanetarySet, state: MovedSet, shaft: str) -> float:
    """How far a shaft has turned [rad], counted from where no backlash would have it in the trial."""
    rate = float((own.turn(shaft) - own.turn(own.held)) * own.planet_turns)
    return 2 * math.pi * rate * state.turns + float(state.at[own.shafts.index(shaft)])
