"""Deviations of the gears, planets and pins of a set in some trials, and the turn of a shaft by either method."""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.reducers.deviations import Acts, Along, Deviations, shaped
from tol3d.numerics.arrays import Array, Places
from tol3d.numerics.programme import NO_ROOM


@dataclass(frozen=True)
class Deviated(Deviations):
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
        shaft_slide: play of each shaft along its axis (trials, shafts) [mm].
        planet_slide: of each planet on its pin (trials, planets).
    """

    central_thickness: Array
    planet_thickness: Array
    central_offset: Array
    planet_offset: Array
    central_clocking: Array
    planet_clocking: Array
    pins: Array
    aside: Array
    shaft_slide: Array
    planet_slide: Array

    @classmethod
    def nothing(cls, model: PlanetarySet, trials: int) -> "Deviated":
        """No deviations."""
        centrals, gears, planets = len(model.meshes), len(model.gears), model.planets
        return cls(
            np.zeros((trials, centrals)),
            np.zeros((trials, gears, planets)),
            np.zeros((trials, centrals, 2)),
            np.zeros((trials, gears, planets, 2)),
            np.zeros((trials, centrals)),
            np.zeros((trials, gears, planets)),
            np.zeros((trials, planets, 2)),
            np.zeros((trials, centrals, 2)),
            np.zeros((trials, len(model.shafts))),
            np.zeros((trials, planets)),
        )

    def reached(self, model: PlanetarySet, acts: Acts) -> tuple[Array, Along]:
        """See Deviations; components of offsets are in the gear's own frame, whose x goes through tooth 0's middle."""
        pins = {"pin": self.pins, "pin outwards": self.pins[:, :, 0], "pin round": self.pins[:, :, 1]}
        if acts.effect in pins:
            return pins[acts.effect], shaped(pins[acts.effect])
        if acts.effect == "slide":
            into = self.shaft_slide[:, model.shafts.index(acts.gear)] if acts.gear else self.planet_slide
            return into, shaped(into)
        centrals = [mesh.central.name for mesh in model.meshes]
        of_planets = acts.gear not in centrals
        place = [gear.name for gear in model.gears].index(acts.gear) if of_planets else centrals.index(acts.gear)
        arrays = {
            "thickness": (self.central_thickness, self.planet_thickness),
            "offset": (self.central_offset, self.planet_offset),
            "clocking": (self.central_clocking, self.planet_clocking),
            "aside": (self.aside, self.aside),
        }
        into = arrays[acts.effect][of_planets][:, place]
        facing = 0.0 if of_planets else model.meshes[place].facing
        return into, partial(_turned, facing) if acts.effect == "offset" and facing else shaped(into)


def _turned(facing: float, offsets: Array) -> Array:
    """Offsets of a central gear (trials, 2) from the frame of its tooth 0, which stands at an azimuth [rad]."""
    cos, sin = math.cos(facing), math.sin(facing)
    return np.stack([cos * offsets[:, 0] - sin * offsets[:, 1], sin * offsets[:, 0] + cos * offsets[:, 1]], -1)


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

    def play(self, own: PlanetarySet, deviated: Deviated, shaft: str) -> Array:
        """From end to end (trials,) [rad], with what shafts screw as they slide; of a set that jams its shortfall.

        That is the shortfall of each contact at the arm of the shaft, negative.
        """
        slid = (deviated.shaft_slide * np.abs(own.slide_turns(shaft))).sum(axis=1)
        lacking = -2 * self.lacking / own.arm(shaft)
        return np.where(self.status == NO_ROOM, lacking, self.ends[:, 1] - self.ends[:, 0] + slid)

    @property
    def written(self) -> tuple[Array, NDArray[np.int8], Places, Array]:
        """Arrays that kernels write."""
        return self.ends, self.status, self.row, self.lacking


def cosines_and_sines(turns: Array) -> Array:
    """Cosines and sines of turns (...), (..., 2)."""
    angles = 2 * np.pi * (turns - np.round(turns))
    return np.ascontiguousarray(np.stack([np.cos(angles), np.sin(angles)], axis=-1))
