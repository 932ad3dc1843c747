"""The exact method: sets as placed, and the turn of shafts until contacts stop them; see contact_kernel.py."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tol3d.gears.involute import involute
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import turned
from tol3d.planetary.exact.contact_kernel import placed_curve, seated_ranges
from tol3d.planetary.model.deviated import Deviated, Free, cosines_and_sines
from tol3d.planetary.model.planetary_set import PlanetarySet


@dataclass(frozen=True)
class Contact:
    """Placed sets, and free turns of their shafts."""

    own: PlanetarySet

    @cached_property
    def _meshes(self) -> Array:
        """Constants r_bC, r_bP, s, inv alpha_w of each mesh (meshes, 4)."""
        return np.array(
            [
                (mesh.central.base_radius, mesh.planet.base_radius, mesh.sense, involute(mesh.working_pressure_angle))
                for mesh in self.own.meshes
            ]
        )

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """Free turn of a shaft while another one and the held one stand, at turns (trials,) of the output."""
        return self.seated(deviated, turns, shaft, stands)[0]

    def seated(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> tuple[Free, Array]:
        """The same, and the turns [rad] of shafts and planets, and displacements by springs [mm], at both ends.

        Those are (trials, 2, shafts + planets + springs), beyond where no backlash would have them.
        """
        own, found = self.own, Free.of(len(turns))
        reached = np.empty((len(turns), 2, own.all_rows.shape[1]))
        seated_ranges(
            *self.given(deviated, turns),
            np.stack(own.spring_ends),
            np.array(own.unknowns(stands)),
            *own.asked(stands, shaft),
            found.ends,
            reached,
            *found.written[1:],
        )
        return found, reached

    def followed(self, deviated: Deviated, turns: Array, shaft: str, stands: str, end: int) -> Free:
        """The lower (0) or upper (1) end of a shaft's turn at turns (positions,) of the output; see free."""
        own, found = self.own, Free.of(len(deviated.pins), len(turns))
        rates, planet = own.gear_rates
        placed_curve(
            *self.given(deviated, np.zeros(len(found.ends))),
            cosines_and_sines(turns[:, None] * rates),
            cosines_and_sines(turns * planet),
            np.stack(own.spring_ends),
            np.array(own.unknowns(stands)),
            *own.asked(stands, shaft, end),
            *found.written,
        )
        return found

    def given(self, deviated: Deviated, turns: Array) -> tuple[Any, ...]:
        """Input of gaps_at from the set and from trials whose output stands at turns (trials,)."""
        own = self.own
        directions = np.stack([np.cos(own.azimuths), np.sin(own.azimuths)], axis=-1)
        places = np.array([own.gear_of(mesh) for mesh in own.meshes])
        room = np.array([mesh.clearance for mesh in own.meshes]) + np.zeros((len(turns), own.planets, len(places)))
        cosines = np.array([math.cos(mesh.central.pressure_angle) for mesh in own.meshes])
        thicker = deviated.central_thickness[:, None] + deviated.planet_thickness[:, places].swapaxes(1, 2)
        meshes = self._meshes
        middle = meshes[:, 1] * deviated.planet_clocking[:, places].swapaxes(1, 2)
        middle = middle + meshes[:, 2] * meshes[:, 0] * deviated.central_clocking[:, None]
        return (
            meshes,
            places,
            directions,
            own.senses,
            own.centre_distance,
            *self._placed(deviated, turns, directions),
            np.ascontiguousarray(deviated.aside),
            np.ascontiguousarray(room - thicker * cosines / 2),
            np.ascontiguousarray(middle),
        )

    def _placed(self, deviated: Deviated, turns: Array, directions: Array) -> tuple[Array, Array, Array]:
        """Centres of central gears (trials, meshes, 2), of planets' gears off pins (trials, gears, planets, 2), pins.

        The carrier's nominal turn is taken out of all of them; gears are turned as far as no backlash would have them.
        """
        own, (rates, planet_turns) = self.own, self.own.gear_rates
        clocked = deviated.central_clocking / (2 * np.pi), deviated.planet_clocking / (2 * np.pi)
        central = turned(deviated.central_offset, turns[:, None] * rates + clocked[0])
        phases = (own.phases + np.array(own.azimuths)) / (2 * np.pi)
        planet = turned(deviated.planet_offset, planet_turns * turns[:, None, None] + phases + clocked[1])
        radial = own.centre_distance + deviated.pins[..., :1]
        across = np.stack([-directions[:, 1], directions[:, 0]], axis=-1)
        pins = radial * directions + deviated.pins[..., 1:] * across
        return tuple(np.ascontiguousarray(each) for each in (central, planet, pins))  # type: ignore[return-value]
