"""What the gears, planets and pins of a set deviate by in some trials, as both roads get it."""

import math
from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.planetary_set import PlanetarySet

Array = NDArray[np.float64]

Effect = Literal["thickness", "offset", "clocking", "pin"]


@dataclass(frozen=True)
class Acts:
    """What a contributor acts on.

    Args:
        effect: thickness and clocking of a gear, offset of its teeth from its axis, or of pins from their places.
        gear: the gear's name; "" of pins.
        direction: of pins, "radial" or "tangential" where the deviation is one of them alone.
        factor: what the deviation counts for, such as 1/cos(alpha) of a thickness along the normals.
    """

    effect: Effect
    gear: str = ""
    direction: Literal["radial", "tangential", ""] = ""
    factor: float = 1.0


@dataclass(frozen=True)
class Deviated:
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
        """Add what a contributor does.

        Args:
            own: the set.
            acts: on what.
            components: of the contributor (trials, components) [mm or rad]; of planets x and y of one after the other,
                offsets in the gear's own frame, whose x goes through the middle of tooth 0.
        """
        if acts.effect == "pin":
            if acts.direction:
                self.pins[:, :, int(acts.direction == "tangential")] += components
            else:
                self.pins[...] += components.reshape(self.pins.shape)
            return
        centrals = [mesh.central.name for mesh in own.meshes]
        of_planets = acts.gear not in centrals
        place = [gear.name for gear in own.gears].index(acts.gear) if of_planets else centrals.index(acts.gear)
        into = self._array(acts.effect, of_planets)[:, place]
        own_components = acts.factor * components.reshape(into.shape)
        into += own_components if of_planets else _turned(own_components, acts, own.meshes[place].facing)

    def of(self, own: PlanetarySet, acts: Acts) -> Array:
        """What stands where a contributor acts, a component each (trials, components): of slopes, its own."""
        if acts.effect == "pin":
            found = self.pins[:, :, int(acts.direction == "tangential")] if acts.direction else self.pins
            return found.reshape(len(found), -1)
        centrals = [mesh.central.name for mesh in own.meshes]
        of_planets = acts.gear not in centrals
        place = [gear.name for gear in own.gears].index(acts.gear) if of_planets else centrals.index(acts.gear)
        found = self._array(acts.effect, of_planets)[:, place]
        found = found if of_planets else _turned(found, acts, -own.meshes[place].facing)
        return acts.factor * found.reshape(len(found), -1)

    def plus(self, other: "Deviated") -> "Deviated":
        """Both added up."""
        return Deviated(*(getattr(self, each.name) + getattr(other, each.name) for each in fields(self)))

    def _array(self, effect: Effect, of_planets: bool) -> Array:
        arrays = {
            "thickness": (self.central_thickness, self.planet_thickness),
            "offset": (self.central_offset, self.planet_offset),
            "clocking": (self.central_clocking, self.planet_clocking),
        }
        return arrays[effect][of_planets]


def _turned(components: Array, acts: Acts, angle: float) -> Array:
    """Offsets of a central gear (trials, 2) turned by an angle [rad]; what is no offset as it is."""
    if acts.effect != "offset" or not angle:
        return components
    cos, sin = math.cos(angle), math.sin(angle)
    return np.stack(
        [cos * components[:, 0] - sin * components[:, 1], sin * components[:, 0] + cos * components[:, 1]], -1
    )
