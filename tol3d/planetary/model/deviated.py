"""Deviations of the gears, planets and pins of a set in some trials, and the turn of a shaft by either method."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.gears.tooth_measures import ToothMeasure
from tol3d.numerics.arrays import Array, Places
from tol3d.numerics.trial_arrays import TrialArrays
from tol3d.planetary.model.planetary_set import PlanetarySet

Effect = Literal["thickness", "offset", "clocking", "pin"]


@dataclass(frozen=True)
class Acts:
    """Effect of a contributor on the set, and its factor.

    Args:
        effect: thickness and clocking of a gear, offset of its teeth from its axis, or of pins from their places.
        gear: the gear's name; "" of pins.
        direction: of pins, "radial" or "tangential" where the deviation is one of them alone.
        factor: multiplier of the deviation, such as 1/cos(alpha) for a thickness along the normals.
        over: how teeth are measured, where the scene says so.
    """

    effect: Effect
    gear: str = ""
    direction: Literal["radial", "tangential", ""] = ""
    factor: float = 1.0
    over: ToothMeasure | None = None


@dataclass(frozen=True)
class Deviated(TrialArrays):
    """Deviations of a set (trials, ...).

    Args:
        central_thickness: arc at the reference circle (trials, centrals) [mm], positive is thicker.
        planet_thickness: of the gears of planets (trials, gears, planets).
        central_offset: centre of the teeth off the axis where nothing has turned (trials, centrals, 2) [mm].
        planet_offset: the same of planets (trials, gears, planets, 2), off the pin.
        central_clocking, planet_clocking: turn of the teeth on what carries them [rad].
        pins: outwards and counter-clockwise off their places (trials, planets, 2) [mm].
        aside: the axis of the planets' circle off that of each central gear (trials, centrals, 2) [mm], in the frame of
            the carrier, where it stands without backlash.
    """

    central_thickness: Array
    planet_thickness: Array
    central_offset: Array
    planet_offset: Array
    central_clocking: Array
    planet_clocking: Array
    pins: Array
    aside: Array

    @classmethod
    def nothing(cls, own: PlanetarySet, trials: int) -> "Deviated":
        """No deviations."""
        centrals, gears, planets = len(own.meshes), len(own.gears), own.planets
        return cls(
            np.zeros((trials, centrals)),
            np.zeros((trials, gears, planets)),
            np.zeros((trials, centrals, 2)),
            np.zeros((trials, gears, planets, 2)),
            np.zeros((trials, centrals)),
            np.zeros((trials, gears, planets)),
            np.zeros((trials, planets, 2)),
            np.zeros((trials, centrals, 2)),
        )

    def add(self, own: PlanetarySet, acts: Acts, components: Array) -> None:
        """Add the effect of a contributor.

        Args:
            components: of the contributor (trials, components) [mm or rad]; of planets x and y of one after the other,
                offsets in the gear's own frame, whose x goes through the middle of tooth 0.
        """
        into, facing = self._reached(own, acts)
        into += _turned(acts.factor * components.reshape(into.shape), acts, facing)

    def of(self, own: PlanetarySet, acts: Acts) -> Array:
        """Values at the place where a contributor acts, a component each (trials, components): of slopes, its own."""
        found, facing = self._reached(own, acts)
        return acts.factor * _turned(found, acts, -facing).reshape(len(found), -1)

    def _reached(self, own: PlanetarySet, acts: Acts) -> tuple[Array, float]:
        """The array that is acted on, and the azimuth of tooth 0 of a central gear [rad]; 0 of planets and pins."""
        if acts.effect == "pin":
            return self.pins[:, :, int(acts.direction == "tangential")] if acts.direction else self.pins, 0.0
        centrals = [mesh.central.name for mesh in own.meshes]
        of_planets = acts.gear not in centrals
        place = [gear.name for gear in own.gears].index(acts.gear) if of_planets else centrals.index(acts.gear)
        arrays = {
            "thickness": (self.central_thickness, self.planet_thickness),
            "offset": (self.central_offset, self.planet_offset),
            "clocking": (self.central_clocking, self.planet_clocking),
        }
        return arrays[acts.effect][of_planets][:, place], 0.0 if of_planets else own.meshes[place].facing


def _turned(components: Array, acts: Acts, angle: float) -> Array:
    """Offsets of a central gear (trials, 2) turned by an angle [rad]; other arrays unchanged."""
    if acts.effect != "offset" or not angle:
        return components
    cos, sin = math.cos(angle), math.sin(angle)
    return np.stack(
        [cos * components[:, 0] - sin * components[:, 1], sin * components[:, 0] + cos * components[:, 1]], -1
    )


@dataclass(frozen=True)
class Free:
    """Free turn of a shaft in some trials.

    Args:
        ends: smallest and largest turn (trials, 2) [rad], nan where the set cannot be assembled; or where the shaft
            rests at positions one after another (trials, positions), 0 where the set jams.
        status: of the programme, the worst position's (trials,).
        row: planet x meshes + mesh that has no room (trials,), -1 where all have.
        lacking: largest shortfall of each contact of a closed loop [mm] (trials,).
    """

    ends: Array
    status: NDArray[np.int8]
    row: Places
    lacking: Array

    @classmethod
    def of(cls, trials: int, positions: int = 2) -> "Free":
        """Room for some trials."""
        return cls(
            np.zeros((trials, positions)), np.empty(trials, np.int8), np.empty(trials, np.int64), np.empty(trials)
        )

    @property
    def written(self) -> tuple[Array, NDArray[np.int8], Places, Array]:
        """Arrays that kernels write."""
        return self.ends, self.status, self.row, self.lacking


def cosines_and_sines(turns: Array) -> Array:
    """Cosines and sines of turns (...), (..., 2)."""
    angles = 2 * np.pi * (turns - np.round(turns))
    return np.ascontiguousarray(np.stack([np.cos(angles), np.sin(angles)], axis=-1))
