"""The exact method: sets as placed, and the turn of shafts until contacts stop them; see contact_kernel.py."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tol3d.gearing.planetary.exact.contact_kernel import LOOSE, placed_curve, seated_ranges
from tol3d.gearing.planetary.model.deviated import Deviated, Free, cosines_and_sines
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.numerics.arrays import Array, Places
from tol3d.numerics.plane import turned
from tol3d.numerics.programme import OK, first_basis


@dataclass(frozen=True)
class Contact:
    """Placed sets, and free turns of their shafts."""

    own: PlanetarySet

    @cached_property
    def _meshes(self) -> Array:
        """Constants r_bC, r_bP, s, tan alpha_w of each mesh (meshes, 4)."""
        return np.array(
            [
                (mesh.central.base_radius, mesh.planet.base_radius, mesh.sense, math.tan(mesh.working_pressure_angle))
                for mesh in self.own.meshes
            ]
        )

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """Free turn of a shaft while another one and the held one stand, at turns (trials,) of the output."""
        return self.seated(deviated, turns, shaft, stands)[0]

    def seated(
        self, deviated: Deviated, turns: Array, shaft: str, stands: str, ends: Sequence[int] = (0, 1)
    ) -> tuple[Free, Array]:
        """The same, and the turns [rad] of shafts and planets, and displacements by springs [mm], at two ends.

        Those are (trials, 2, shafts + planets + springs), beyond where no backlash would have them.
        """
        own, found = self.own, Free.of(len(turns))
        reached = np.empty((len(turns), 2, own.all_rows.shape[1]))
        objective, wanted, begun = own.asked(stands, shaft)
        seated_ranges(
            *self.given(deviated, turns),
            np.stack(own.spring_ends),
            np.array(own.unknowns(stands)),
            objective,
            np.ascontiguousarray(wanted[list(ends)]),
            begun,
            found.ends,
            reached,
            *found.written[1:],
        )
        return found, reached

    def followed(self, deviated: Deviated, turns: Array, shaft: str, stands: str, end: int) -> Free:
        """The lower (0) or upper (1) end of a shaft's turn at turns (positions,) of the output; see free."""
        own, found = self.own, Free.of(len(deviated.pins), len(turns))
        rates, planet = own.gear_rates
        others, begun = self._without_planets(stands)
        wanted = own.wanted(stands, shaft)[end]
        placed_curve(
            *self.given(deviated, np.zeros(len(found.ends))),
            cosines_and_sines(turns[:, None] * rates),
            cosines_and_sines(turns * planet),
            np.stack(own.spring_ends),
            others,
            wanted[[own.unknowns(stands).index(place) for place in others]],
            begun,
            own.shafts.index(shaft),
            LOOSE * _offsets(deviated),
            found.ends,
        )
        found.status[:], found.row[:], found.lacking[:] = OK, -1, 0.0
        self._seat_lacking(found, deviated, turns, shaft, stands, end)
        return found

    def _seat_lacking(self, found: Free, deviated: Deviated, turns: Array, shaft: str, stands: str, end: int) -> None:
        """Write the ends that are lacking at positions, each sought by itself; 0 and the status where there is none."""
        trials, positions = np.nonzero(np.isnan(found.ends))
        if not len(trials):
            return
        alone, _ = self.seated(deviated[trials], turns[positions], shaft, stands, [end, end])
        found.ends[trials, positions] = np.where(alone.status == OK, alone.ends[:, 0], 0.0)
        for at, trial in enumerate(trials):
            if alone.status[at] > OK and alone.status[at] >= found.status[trial]:
                found.status[trial], found.row[trial] = alone.status[at], alone.row[at]
                found.lacking[trial] = max(found.lacking[trial], alone.lacking[at])

    def _without_planets(self, stands: str) -> tuple[Places, Places]:
        """Unknowns but planets' turns (others,), and the first basis of rows of pairs of meshes, in kernel order."""
        own, count = self.own, len(self.own.meshes)
        first = len(own.shafts)
        others = [place for place in own.unknowns(stands) if not first <= place < first + own.planets]
        rows = [own.all_rows[count * own.planets :]]
        for planet in reversed(range(own.planets)):
            its = own.all_rows[planet * count : (planet + 1) * count]
            its = its / its[:, first + planet, None]
            rows.insert(0, np.array([its[one] - its[other] for one in range(count) for other in range(one)]))
        return np.array(others), first_basis(np.concatenate(rows)[:, others])

    def given(self, deviated: Deviated, turns: Array) -> tuple[Any, ...]:
        """Input of gaps_at from the set and from trials whose output stands at turns (trials,)."""
        own = self.own
        directions = np.stack([np.cos(own.azimuths), np.sin(own.azimuths)], axis=-1)
        places = np.array([own.gear_of(mesh) for mesh in own.meshes])
        room = np.array([mesh.clearance for mesh in own.meshes]) + np.zeros((len(turns), own.planets, len(places)))
        cosines = np.array([mesh.central.along_action for mesh in own.meshes])
        thicker = deviated.central_thickness[:, None] + deviated.planet_thickness[:, places].swapaxes(1, 2)
        meshes, placed = self._meshes, self._placed(deviated, turns, directions)
        middle = meshes[:, 1] * deviated.planet_clocking[:, places].swapaxes(1, 2)
        middle = middle + meshes[:, 2] * meshes[:, 0] * deviated.central_clocking[:, None]
        return (
            meshes,
            places,
            directions,
            own.senses,
            own.centre_distance,
            *placed,
            np.ascontiguousarray(deviated.aside),
            np.ascontiguousarray(self._slid(deviated, placed, room - thicker * cosines / 2)),
            np.ascontiguousarray(middle),
        )

    def _slid(self, deviated: Deviated, placed: tuple[Array, ...], room: Array) -> Array:
        """Rooms (trials, planets, meshes) with those of planets that slide; teeth that fit no space never do.

        Args:
            deviated: of the trials.
            placed: see `_placed`.
            room: of each flank where centres lie in their places [mm].
        """
        if not deviated.planet_slide.any():
            return room
        own, (central, planet, pins) = self.own, placed
        places = [own.gear_of(mesh) for mesh in own.meshes]
        apart = pins[:, :, None] + planet[:, places].swapaxes(1, 2) - central[:, None] + deviated.aside[:, None]
        base = np.array([mesh.sense * mesh.base_radii for mesh in own.meshes])
        angles = np.arccos(np.minimum(np.abs(base) / np.hypot(apart[..., 0], apart[..., 1]), 1.0))
        working = np.array([mesh.working_pressure_angle for mesh in own.meshes])
        opened = room + base * ((np.tan(angles) - angles) - (np.tan(working) - working))
        slid = deviated.planet_slide[:, :, None] * (np.abs(own.planet_slides) / 2)
        return np.asarray(room + np.where(opened >= 0.0, slid, 0.0))

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


def _offsets(deviated: Deviated) -> Array:
    """Sum of the largest offsets of centres of each kind (trials,) [mm]."""
    kinds = (deviated.central_offset, deviated.planet_offset, deviated.pins, deviated.aside)
    return np.asarray(sum(np.sqrt((kind * kind).sum(axis=-1)).reshape(len(kind), -1).max(axis=1) for kind in kinds))
