"""The analytic road: how far each flank of each mesh may go, to first order in the deviations, and what that leaves.

Along the line of action, with alpha_w the working pressure angle and s = 1 of a sun, -1 of a ring: a tooth thicker by
an arc E takes E cos(alpha)/2 from each flank; a planet displaced against its central gear by d_r outwards and d_t
counter-clockwise opens the flanks by s (sin(alpha_w) d_r +- cos(alpha_w) d_t); a gear turned on its shaft by a moves
them by r_b a. Working radii alone decide the rest: see PlanetarySet.all_rows. Nothing here sees a pose.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.programme import ranges
from tol3d.planetary.deviated import Deviated
from tol3d.planetary.free import Free, turned
from tol3d.planetary.planetary_set import PlanetarySet

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StackUp:
    """First-order gaps of a set and what they leave free."""

    own: PlanetarySet

    @cached_property
    def _relative(self) -> tuple[tuple[float, ...], float]:
        """Turns of the central gears and of a planet against the carrier, a turn of the output."""
        planet = self.own.planet_turns
        return tuple(float(mesh.turn * planet) for mesh in self.own.teeth.meshes), float(planet)

    def sides(self, deviated: Deviated, turns: Array) -> tuple[Array, Array]:
        """Lower and upper side (trials, planets x meshes) [mm] of n, at turns (trials,) of the output."""
        own = self.own
        lower = np.empty((len(turns), own.planets, len(own.meshes)))
        upper = np.empty_like(lower)
        azimuths = np.array(own.azimuths) / (2 * np.pi)
        of_centrals, of_planet = self._relative
        for place, mesh in enumerate(own.meshes):
            gear = own.gear_of(mesh)
            s, angle = mesh.sense, mesh.working_pressure_angle
            central = deviated.central_offset[:, None, place].repeat(own.planets, axis=1)
            central = turned(central, (of_centrals[place] * turns)[:, None] - azimuths)
            phases = own.phases / (2 * np.pi)
            planet = turned(deviated.planet_offset[:, gear], (of_planet * turns)[:, None] + phases)
            aside = turned(deviated.aside[:, None, place].repeat(own.planets, axis=1), -azimuths)
            apart = planet + deviated.pins - central + aside
            thicker = deviated.central_thickness[:, place, None] + deviated.planet_thickness[:, gear]
            room = mesh.clearance - thicker * np.cos(mesh.central.pressure_angle) / 2
            room = room + s * np.sin(angle) * apart[..., 0]
            moved = s * np.cos(angle) * apart[..., 1]
            moved = moved - mesh.planet.base_radius * deviated.planet_clocking[:, gear]
            moved = moved - s * mesh.central.base_radius * deviated.central_clocking[:, place, None]
            lower[:, :, place] = moved - room
            upper[:, :, place] = moved + room
        return lower.reshape(len(turns), -1), upper.reshape(len(turns), -1)

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """How far a shaft turns while another one and the held one stand."""
        own, found = self.own, Free.of(len(turns))
        sides = zip(self.sides(deviated, turns), own.pushed, strict=True)
        lower, upper = (np.hstack([side, np.tile(push, (len(turns), 1))]) for side, push in sides)
        ranges(
            own.rows(stands),
            lower,
            upper,
            own.objective(stands, shaft),
            own.wanted(stands, shaft),
            own.begun(stands),
            found.ends,
            found.status,
            found.row,
            found.lacking,
        )
        return found
