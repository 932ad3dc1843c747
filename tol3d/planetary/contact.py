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
from tol3d.planetary.deviated import Deviated
from tol3d.planetary.free import Free, turned
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.programme import OK, STALLED, farthest

Array = NDArray[np.float64]

STILL: Final = 1e-11  # rad; turns change by less: at 100 mm that is 1e-9 mm
MOST_STEPS: Final = 25


@part
def gaps_at(meshes: Any, places: Any, planets: Any, given: Any, turns: Any, rows: Any, lower: Any, upper: Any) -> bool:
    """Write the rows of a trial at some turns, and their sides against those turns; False where base circles overlap.

    Args:
        meshes: of each mesh r_bC, r_bP, s, inv alpha_w (meshes, 4).
        places: of each mesh the gear of the planets (meshes,).
        planets: cosine and sine of each azimuth (planets, 2).
        given: of the trial, before these turns: centres of central gears off the axis (meshes, 2), of planets' gears
            off their pins (gears, planets, 2), places of pins (planets, 2); what thinning leaves each flank, nominal
            clearance included, and what clocking moves n by (planets, meshes).
        turns: of central gears, carrier, planets.
    """
    count = meshes.shape[0]
    central, planet, pin, room, middle = given
    turn = turns[count]
    cos_h, sin_h = np.cos(turn), np.sin(turn)
    for k in range(planets.shape[0]):
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
            x, y = pin_x + off_x - own_x, pin_y + off_y - own_y
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
            upper[r] = opened - n
            lower[r] = -opened - n
    return True


@kernel(
    arrays="f8[:,::1], i8[::1], f8[:,::1], f8[:,:,::1], f8[:,:,:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,:,::1], i8[::1], "
    "f8[::1], i8[:,::1], f8[:,::1], i1[::1], i8[::1], f8[::1]"
)
def seated_ranges(
    meshes: Any, places: Any, planets: Any, central: Any, planet: Any, pin: Any, room: Any, middle: Any,
    unknowns: Any, objective: Any, begun: Any, ends: Any, status: Any, decided: Any, amount: Any,
) -> None:  # fmt: skip
    """Both ends of one coordinate in trials; see gaps_at and programme.ranges."""
    count = unknowns.shape[0]
    coordinates = meshes.shape[0] + 1 + planets.shape[0]
    contacts = meshes.shape[0] * planets.shape[0]
    rooms = (
        np.empty((count, count)), np.empty((count, count)), np.empty(count), np.empty(count), np.empty(count)
    )  # fmt: skip
    x, basis, turns = np.empty(count), np.empty(count, np.int64), np.empty(coordinates)
    slopes, rows = np.empty((contacts, coordinates)), np.empty((contacts, count))
    lower, upper = np.empty(contacts), np.empty(contacts)
    for i in range(central.shape[0]):
        status[i], decided[i], amount[i] = OK, -1, 0.0
        for end in range(2):
            sense = 1.0 if end == 0 else -1.0
            turns[:] = 0.0
            for j in range(count):
                basis[j], rooms[2][j] = begun[end, j], 1.0
            found, row, lacking = STALLED, -1, 0.0
            for _ in range(MOST_STEPS):
                given = (central[i], planet[i], pin[i], room[i], middle[i])
                if not gaps_at(meshes, places, planets, given, turns, slopes, lower, upper):
                    found = STALLED
                    break
                for r in range(contacts):
                    for j in range(count):
                        rows[r, j] = slopes[r, unknowns[j]]
                found, row, lacking = farthest(rows, lower, upper, objective, sense, basis, rooms, x)
                if found != OK:
                    break
                moved = 0.0
                for j in range(count):
                    turns[unknowns[j]] += x[j]
                    moved = max(moved, abs(x[j]))
                if moved < STILL:
                    break
                found = STALLED
            if found != OK:
                status[i], decided[i], amount[i] = found, row, lacking
                ends[i, 0] = ends[i, 1] = np.nan
                break
            value = 0.0
            for j in range(count):
                value += objective[j] * turns[unknowns[j]]
            ends[i, 1 - end] = value


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
        own, found = self.own, Free.of(len(turns))
        directions = np.stack([np.cos(own.azimuths), np.sin(own.azimuths)], axis=-1)
        places = np.array([own.gear_of(mesh) for mesh in own.meshes])
        room = np.array([mesh.clearance for mesh in own.meshes]) + np.zeros((len(turns), own.planets, len(places)))
        cosines = np.array([math.cos(mesh.central.pressure_angle) for mesh in own.meshes])
        thicker = deviated.central_thickness[:, None] + deviated.planet_thickness[:, places].swapaxes(1, 2)
        meshes = self._meshes
        middle = meshes[:, 1] * deviated.planet_clocking[:, places].swapaxes(1, 2)
        middle = middle + meshes[:, 2] * meshes[:, 0] * deviated.central_clocking[:, None]
        seated_ranges(
            meshes,
            places,
            directions,
            *self._placed(deviated, turns, directions),
            np.ascontiguousarray(room - thicker * cosines / 2),
            np.ascontiguousarray(middle),
            np.array(own.unknowns(stands)),
            own.objective(stands, shaft),
            own.begun(stands),
            found.ends,
            found.status,
            found.row,
            found.lacking,
        )
        return found

    def _placed(self, deviated: Deviated, turns: Array, directions: Array) -> tuple[Array, Array, Array]:
        """Centres of central gears (trials, meshes, 2), of planets' gears off pins (trials, gears, planets, 2), pins.

        The carrier's nominal turn is taken out of all of them; gears are turned as far as no backlash would have them.
        """
        own, planet_turns = self.own, float(self.own.planet_turns)
        rates = np.array([float(mesh.turn * self.own.planet_turns) for mesh in own.teeth.meshes])
        central = turned(deviated.central_offset, turns[:, None] * rates)
        phases = np.array([own.phase(planet) + own.azimuths[planet] for planet in range(own.planets)]) / (2 * np.pi)
        planet = turned(deviated.planet_offset, planet_turns * turns[:, None, None] + phases)
        radial = own.centre_distance + deviated.pins[..., :1]
        across = np.stack([-directions[:, 1], directions[:, 0]], axis=-1)
        pins = radial * directions + deviated.pins[..., 1:] * across
        return tuple(np.ascontiguousarray(each) for each in (central, planet, pins))  # type: ignore[return-value]
