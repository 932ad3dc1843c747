"""An RV reducer of one trial where its first pin touches, and further on as its cranks turn."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.gearing.cycloid.exact.places import StagePlaces, StageShapes, usual_shapes
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.first_stage import crank_turns, held_stage, placed_mesh
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.reducer.turning import led_angles, output_turns
from tol3d.numerics.arrays import Array

BACK, AHEAD = -1, 1
NOWHERE: Final = -1


@dataclass(frozen=True, eq=False)
class SeatedReducer:
    """A reducer at one moment.

    Args:
        places: of all parts of the cycloid stage.
        touching: the disc and the pin that touch, counted from 0; None between both sides of a lost motion.
    """

    places: StagePlaces
    touching: tuple[int, int] | None

    @property
    def output(self) -> float:
        """Turn of the carrier [rad], counter-clockwise."""
        return self.places.carrier_turned

    @property
    def contact(self) -> Array | None:
        """Contact point of disc and pin (2,) [mm]: on the line from the pin to the pole of the disc's rolling."""
        if self.touching is None:
            return None
        disc, pin = self.touching
        stage = self.places.stage
        azimuth = self.places.cranks_turned + float(self.places.stage.throws[disc])
        pole = stage.profile.eccentricity * stage.profile.pins * np.exp(1j * azimuth)
        at = self.places.pins[pin].at
        radius = stage.profile.pin_radius + float(self.places.deviated.pin_radii[0, pin])
        touched = at + radius * (pole - at) / abs(pole - at)
        return np.array([touched.real, touched.imag])


@dataclass(frozen=True, eq=False)
class ShownReducer:
    """A reducer of one trial, its output turned back by its load.

    Args:
        deviated: of one trial.
        turns: of the output, nominally.
        width: of a disc [mm]; None: a usual one.
        crank_hole: diameter of the discs' crank holes [mm]; None: as large as walls allow.
    """

    own: RVSet
    deviated: RVDeviated
    turns: float
    width: float | None = None
    crank_hole: float | None = None

    @cached_property
    def shapes(self) -> StageShapes:
        """Shapes of the reducer's parts."""
        first = self.own.first
        gears = None if first is None else (first.pair.pinion, first.pair.wheel)
        return usual_shapes(self.own.contact, self.width, self.crank_hole, gears)

    @cached_property
    def seated(self) -> SeatedReducer:
        """Reducer with the output turned back by the load.

        Raises:
            InputError: no pin touches.
        """
        return self.at(np.zeros(1), BACK)[0]

    def at(self, beyond: Array, sense: int) -> tuple[SeatedReducer, ...]:
        """Further on, in contact.

        Args:
            beyond: turns of the output (positions,) from its nominal position in the trial.
            sense: AHEAD where the output has turned counter-clockwise until a pin touches, or BACK.

        Raises:
            InputError: no pin touches.
        """
        own, turns = self.own, (self.turns + beyond)[None]
        beta, _ = crank_turns(own, self.deviated, turns, sense, placed_mesh)
        stage = held_stage(own, self.deviated)
        found = own.contact.touches(stage, led_angles(own, turns, beta), (float(sense),))
        if (found.places < 0).any():
            raise InputError("no pin touches the discs of this build; choose another trial")
        rolled = found.turns[..., 0]
        phis = own.crank_angles(turns) + own.profile.lobes * (
            rolled - output_turns(own, self.deviated, turns, sense, rolled, beta)
        )
        pins = own.profile.pins
        return tuple(
            SeatedReducer(StagePlaces(own.contact, stage, float(phi), float(turn)), divmod(int(place), pins))
            for phi, turn, place in zip(phis[0], rolled[0], found.places[0, :, 0], strict=True)
        )


def turned(shown: ShownReducer, frames: int) -> tuple[SeatedReducer, ...]:
    """The cranks turn once, counter-clockwise, the output follows clockwise with its load behind it."""
    way = -np.linspace(0.0, 1.0, frames) / shown.own.profile.lobes
    return shown.at(way, AHEAD)


def swung(shown: ShownReducer, frames: int) -> tuple[SeatedReducer, ...]:
    """The output goes evenly through its lost motion, clockwise end first, while the input stands."""
    back, ahead = (shown.at(np.zeros(1), sense)[0] for sense in (BACK, AHEAD))
    between = [
        SeatedReducer(_between(back.places, ahead.places, share), None)
        for share in np.linspace(0.0, 1.0, frames)[1:-1].tolist()
    ]
    return (back, *between, ahead)


def _between(back: StagePlaces, ahead: StagePlaces, share: float) -> StagePlaces:
    phi, turn = ((1 - share) * one + share * other for one, other in ((back.phi, ahead.phi), (back.turn, ahead.turn)))
    return replace(back, phi=phi, turn=turn)


def carrier_angles(states: Sequence[SeatedReducer]) -> list[float]:
    """Turns of the output from the first state on [deg]."""
    return [math.degrees(state.output - states[0].output) for state in states]
