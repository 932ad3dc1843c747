"""The exact road: flanks of gears where they really lie, and how far shafts turn until contacts stop them.

Gears are placed: their centres off their axes, pins off their places, all of it turned as far as shafts and planets
have. What the flanks of a mesh leave along their common normal is exact for rigid involutes on parallel axes: with W
from the central gear's centre to the planet's, |W| = a', cos alpha' = R/a', R = r_bC + s r_bP, gamma the azimuth of W,

    gap = c + s R (inv alpha' - inv alpha_w) -+ n,    n = r_bP psi + s (r_bC theta - R gamma),

less half the thickness deviations (ISO 21771-1:2024, 5.6, with each flank by itself). The gaps are linear in the turns
but for what moves the centres: the programme takes the slopes of n at the turns reached, goes as far as they let it,
and finds gaps and slopes anew, until nothing moves. What opens both flanks while centres move is found again each
time, so that at the end all gaps are those of the turns reached.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.gears.involute import involute
from tol3d.numerics.compiled import kernel, part
from tol3d.numerics.programme import OK, STALLED, farthest
from tol3d.planetary.deviated import Deviated
from tol3d.planetary.free import Free, turned
from tol3d.planetary.planetary_set import PlanetarySet

Array = NDArray[np.float64]

STILL: Final = 1e-11  # rad; turns change by less: at 100 mm that is 1e-9 mm
MOST_STEPS: Final = 25


@part
def gaps_at(shape: Any, given: Any, turns: Any, rows: Any, lower: Any, upper: Any) -> bool:
    """Write the rows of a trial at some turns, and their sides against those turns; False where base circles overlap.

    Args:
        shape: of each mesh r_bC, r_bP, s, inv alpha_w (meshes, 4) and the gear of the planets (meshes,); cosine and
            sine of each planet's azimuth (planets, 2); how springs push each planet (planets, springs); the radius of
            the pins' circle [mm].
        given: of the trial, before these turns: centres of central gears off the axis (meshes, 2), of planets' gears
            off their pins (gears, planets, 2), places of pins (planets, 2), the planets' circle beside each central
            gear's axis (meshes, 2), which turns with nothing; what thinning leaves each flank, nominal clearance
            included, and what clocking moves n by (planets, meshes).
        turns: of central gears, carrier, planets; then displacements by springs [mm].
    """
    meshes, places, planets, senses, distance = shape
    central, planet, pin, aside, room, middle = given
    count = meshes.shape[0]
    number = planets.shape[0]
    for k in range(number):
        turn = turns[count]
        for j in range(senses.shape[1]):
            turn += senses[k, j] * turns[count + 1 + number + j] / distance
        cos_h, sin_h = np.cos(turn), np.sin(turn)
        pin_x, pin_y = cos_h * pin[k, 0] - sin_h * pin[k, 1], sin_h * pin[k, 0] + cos_h * pin[k, 1]
        psi = turns[count + 1 + k]
        cos_p, sin_p = np.cos(psi), np.sin(psi)
        for m in range(count):
            r_c, r_p, s, inv_w = meshes[m, 0], meshes[m, 1], meshes[m, 2], meshes[m, 3]
            base = r_c + s * r_p
            g = places[m]
            off_x = cos_p * planet[g, k, 0] - sin_p * planet[g, k, 1]
            off_y = sin_p * planet[g, k, 0] + cos_p * planet[g, k, 1]
            theta = turns[m]
            cos_c, sin_c = np.cos(theta), np.sin(theta)
            own_x = cos_c * central[m, 0] - sin_c * central[m, 1]
            own_y = sin_c * central[m, 0] + cos_c * central[m, 1]
            x, y = pin_x + off_x - own_x + aside[m, 0], pin_y + off_y - own_y + aside[m, 1]
            apart = np.sqrt(x * x + y * y)
            if not apart > base:
                return False
            tan = np.sqrt((apart - base) * (apart + base)) / base
            inv = tan - np.arctan(tan)
            c, e = planets[k, 0], planets[k, 1]
            gamma = np.arctan2(c * y - e * x, c * x + e * y)
            n = r_p * psi + s * (r_c * theta - base * gamma) + middle[k, m]
            opened = room[k, m] + s * base * (inv - inv_w)
            cos = base / apart  # of the working pressure angle; a centre moved across by d shifts n by -s cos d
            r = k * count + m
            for j in range(rows.shape[1]):
                rows[r, j] = 0.0
            along_x, along_y = x / apart, y / apart
            rows[r, m] = s * r_c - s * cos * (-own_x * along_x - own_y * along_y)
            rows[r, count] = -s * cos * (pin_x * along_x + pin_y * along_y)
            rows[r, count + 1 + k] = r_p - s * cos * (off_x * along_x + off_y * along_y)
            for j in range(senses.shape[1]):
                rows[r, count + 1 + number + j] = senses[k, j] * rows[r, count] / distance
            upper[r] = opened - n
            lower[r] = -opened - n
    return True


@part
def seated(
    shape: Any, given: Any, pushed: Any, unknowns: Any, objective: Any, basis: Any, rooms: Any, turns: Any
) -> tuple[int, int, float]:  # fmt: skip
    """Turn as far along an objective as contacts let; like programme.farthest, again and again from where that leads.

    Args:
        shape, given: see gaps_at.
        pushed: least and largest displacement by each spring (2, springs) [mm].
        unknowns: places of the programme's unknowns among the turns.
        objective, basis: see programme.farthest.
        rooms: those of programme.farthest; slopes, rows, lower, upper and x to write in.
        turns: zeros; written.
    """
    solving, slopes, rows, lower, upper, x = rooms
    springs = pushed.shape[1]
    contacts = slopes.shape[0]
    found, row, lacking = STALLED, -1, 0.0
    for _ in range(MOST_STEPS):
        if not gaps_at(shape, given, turns, slopes, lower, upper):
            return STALLED, -1, 0.0
        for r in range(contacts):
            for j in range(unknowns.shape[0]):
                rows[r, j] = slopes[r, unknowns[j]]
        for spring in range(springs):
            place = turns.shape[0] - springs + spring
            for j in range(unknowns.shape[0]):
                rows[contacts + spring, j] = 1.0 if unknowns[j] == place else 0.0
            lower[contacts + spring] = pushed[0, spring] - turns[place]
            upper[contacts + spring] = pushed[1, spring] - turns[place]
        found, row, lacking = farthest(rows, lower, upper, objective, basis, solving, x)
        if found != OK:
            return found, row, lacking
        moved = 0.0
        for j in range(unknowns.shape[0]):
            turns[unknowns[j]] += x[j]
            moved = max(moved, abs(x[j]))
        if moved < STILL:
            return OK, -1, 0.0
    return STALLED, -1, 0.0


@kernel(
    arrays="f8[:,::1], i8[::1], f8[:,::1], f8[:,::1], f8, f8[:,:,::1], f8[:,:,:,::1], f8[:,:,::1], f8[:,:,::1], "
    "f8[:,:,::1], f8[:,:,::1], f8[:,::1], i8[::1], f8[::1], f8[:,::1], i8[::1], f8[:,::1], f8[:,:,::1], "
    "i1[::1], i8[::1], f8[::1]"
)
def seated_ranges(
    meshes: Any, places: Any, planets: Any, senses: Any, distance: float,
    central: Any, planet: Any, pin: Any, aside: Any, room: Any, middle: Any,
    pushed: Any, unknowns: Any, turn: Any, wanted: Any, begun: Any,
    ends: Any, reached: Any, status: Any, decided: Any, amount: Any,
) -> None:  # fmt: skip
    """Both ends of one coordinate in trials, and all turns there; see seated and programme.ranges."""
    count, springs = unknowns.shape[0], senses.shape[1]
    contacts = meshes.shape[0] * planets.shape[0]
    solving = (
        np.empty((count, count)), np.empty((count, count)), np.empty(count), np.empty(count), np.empty(count)
    )  # fmt: skip
    basis, turns = np.empty(count, np.int64), np.empty(meshes.shape[0] + 1 + planets.shape[0] + springs)
    slopes, rows = np.empty((contacts, turns.shape[0])), np.empty((contacts + springs, count))
    rooms = (solving, slopes, rows, np.empty(contacts + springs), np.empty(contacts + springs), np.empty(count))
    shape = (meshes, places, planets, senses, distance)
    for i in range(central.shape[0]):
        status[i], decided[i], amount[i] = OK, -1, 0.0
        given = (central[i], planet[i], pin[i], aside[i], room[i], middle[i])
        for end in range(2):
            turns[:] = 0.0
            for j in range(count):
                basis[j], solving[2][j] = begun[j], 1.0
            found, row, lacking = seated(shape, given, pushed, unknowns, wanted[end], basis, rooms, turns)
            if found != OK:
                status[i], decided[i], amount[i] = found, row, lacking
                ends[i, 0] = ends[i, 1] = np.nan
                reached[i] = np.nan
                break
            reached[i, end] = turns
            ends[i, end] = 0.0
            for j in range(count):
                ends[i, end] += turn[j] * turns[unknowns[j]]


@dataclass(frozen=True)
class Contact:
    """Sets as they are placed, and how far their shafts turn."""

    own: PlanetarySet

    @cached_property
    def _meshes(self) -> Array:
        """Of each mesh r_bC, r_bP, s, inv alpha_w (meshes, 4)."""
        return np.array(
            [
                (mesh.central.base_radius, mesh.planet.base_radius, mesh.sense, involute(mesh.working_pressure_angle))
                for mesh in self.own.meshes
            ]
        )

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """How far a shaft turns while another one and the held one stand, at turns (trials,) of the output."""
        return self.seated(deviated, turns, shaft, stands)[0]

    def seated(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> tuple[Free, Array]:
        """The same, and the turns [rad] of shafts and planets, and displacements by springs [mm], at both ends.

        Those are (trials, 2, shafts + planets + springs), beyond where no backlash would have them.
        """
        own, found = self.own, Free.of(len(turns))
        reached = np.empty((len(turns), 2, own.all_rows.shape[1]))
        seated_ranges(
            *self.given(deviated, turns),
            np.stack(own.pushed),
            np.array(own.unknowns(stands)),
            own.objective(stands, shaft),
            own.wanted(stands, shaft),
            own.begun(stands),
            found.ends,
            reached,
            found.status,
            found.row,
            found.lacking,
        )
        return found, reached

    def given(self, deviated: Deviated, turns: Array) -> tuple[Any, ...]:
        """What gaps_at takes of the set and of trials whose output stands at turns (trials,)."""
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
        own, planet_turns = self.own, float(self.own.planet_turns)
        rates = np.array([float(mesh.turn * self.own.planet_turns) for mesh in own.teeth.meshes])
        clocked = deviated.central_clocking / (2 * np.pi), deviated.planet_clocking / (2 * np.pi)
        central = turned(deviated.central_offset, turns[:, None] * rates + clocked[0])
        phases = (own.phases + np.array(own.azimuths)) / (2 * np.pi)
        planet = turned(deviated.planet_offset, planet_turns * turns[:, None, None] + phases + clocked[1])
        radial = own.centre_distance + deviated.pins[..., :1]
        across = np.stack([-directions[:, 1], directions[:, 0]], axis=-1)
        pins = radial * directions + deviated.pins[..., 1:] * across
        return tuple(np.ascontiguousarray(each) for each in (central, planet, pins))  # type: ignore[return-value]
