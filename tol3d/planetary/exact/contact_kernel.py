"""The exact method: flanks of gears in their true poses, and turns of shafts until contacts stop them.

Gears are placed: their centres off their axes, pins off their places, all of it turned as far as shafts and planets
have. What the flanks of a mesh leave along their common normal is exact for rigid involutes on parallel axes: with W
from the central gear's centre to the planet's, |W| = a', cos alpha' = R/a', R = r_bC + s r_bP, gamma the azimuth of W,

    gap = c + s R (inv alpha' - inv alpha_w) -+ n,    n = r_bP psi + s (r_bC theta - R gamma),

less half the thickness deviations (ISO 21771-1:2024, 5.6, with each flank by itself). The gaps are linear in the turns
but for what moves the centres: the programme takes the slopes of n at the turns reached, goes as far as they let it,
and finds gaps and slopes anew, until nothing moves. What opens both flanks while centres move is found again each
time, so that at the end all gaps are those of the turns reached.

Over positions, one end of the turn alone: where the shafts stand, less what they have turned without backlash, and the
contacts that are met are those that the next position begins with.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import kernel, part
from tol3d.numerics.programme import OK, STALLED, new_rooms, solve_lp

STILL: Final = 1e-11  # rad; turns change by less: at 100 mm that is 1e-9 mm
MOST_STEPS: Final = 25


@part
def gaps_at(shape: Any, given: Any, turns: Any, centres: Any, rows: Any, lower: Any, upper: Any) -> bool:
    """Write the rows of a trial at some turns, and their sides against those turns; False where base circles overlap.

    Args:
        shape: of each mesh r_bC, r_bP, s, inv alpha_w (meshes, 4) and the gear of the planets (meshes,); cosine and
            sine of each planet's azimuth (planets, 2); how springs push each planet (planets, springs); the radius of
            the pins' circle [mm].
        given: of the trial, before these turns: centres of central gears off the axis (meshes, 2), of planets' gears
            off their pins (gears, planets, 2), places of pins (planets, 2), the planets' circle beside each central
            gear's axis (meshes, 2), which turns with nothing; clearance of each flank by thinning, the nominal one
            included, and movement of n by clocking (planets, meshes).
        turns: of central gears, carrier, planets; then displacements by springs [mm].
        centres: of central gears there (meshes, 2), to write in.
    """
    meshes, places, planets, senses, distance = shape
    central, planet, pin, aside, room, middle = given
    count = meshes.shape[0]
    number = planets.shape[0]
    for m in range(count):
        cos_c, sin_c = np.cos(turns[m]), np.sin(turns[m])
        centres[m, 0] = cos_c * central[m, 0] - sin_c * central[m, 1]
        centres[m, 1] = sin_c * central[m, 0] + cos_c * central[m, 1]
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
            theta, own_x, own_y = turns[m], centres[m, 0], centres[m, 1]
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
    shape: Any, given: Any, spring_ends: Any, unknowns: Any, objective: Any, basis: Any, rooms: Any, turns: Any
) -> tuple[int, int, float]:  # fmt: skip
    """Turn as far along an objective as contacts let; like programme.solve_lp, again and again from where that leads.

    Args:
        shape, given: see gaps_at.
        spring_ends: least and largest displacement by each spring (2, springs) [mm].
        unknowns: places of the programme's unknowns among the turns.
        objective, basis: see programme.solve_lp.
        rooms: those of programme.solve_lp; centres, slopes, rows, lower, upper and x to write in.
        turns: zeros; written.
    """
    solving, centres, slopes, rows, lower, upper, x = rooms
    springs = spring_ends.shape[1]
    contacts = slopes.shape[0]
    found, row, lacking = STALLED, -1, 0.0
    for _ in range(MOST_STEPS):
        if not gaps_at(shape, given, turns, centres, slopes, lower, upper):
            return STALLED, -1, 0.0
        for r in range(contacts):
            for j in range(unknowns.shape[0]):
                rows[r, j] = slopes[r, unknowns[j]]
        for spring in range(springs):
            place = turns.shape[0] - springs + spring
            for j in range(unknowns.shape[0]):
                rows[contacts + spring, j] = 1.0 if unknowns[j] == place else 0.0
            lower[contacts + spring] = spring_ends[0, spring] - turns[place]
            upper[contacts + spring] = spring_ends[1, spring] - turns[place]
        found, row, lacking = solve_lp(rows, lower, upper, objective, basis, solving, x)
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
    spring_ends: Any, unknowns: Any, turn: Any, wanted: Any, begun: Any,
    ends: Any, reached: Any, status: Any, decided: Any, amount: Any,
) -> None:  # fmt: skip
    """Both ends of one coordinate in trials, and all turns there; see seated and programme.ranges."""
    count, springs = unknowns.shape[0], senses.shape[1]
    contacts = meshes.shape[0] * planets.shape[0]
    solving = new_rooms(count)
    basis, turns = np.empty(count, np.int64), np.empty(meshes.shape[0] + 1 + planets.shape[0] + springs)
    slopes, rows = np.empty((contacts, turns.shape[0])), np.empty((contacts + springs, count))
    sides = np.empty(contacts + springs), np.empty(contacts + springs)
    rooms = (solving, np.empty((meshes.shape[0], 2)), slopes, rows, sides[0], sides[1], np.empty(count))
    shape = (meshes, places, planets, senses, distance)
    for i in range(central.shape[0]):
        status[i], decided[i], amount[i] = OK, -1, 0.0
        given = (central[i], planet[i], pin[i], aside[i], room[i], middle[i])
        for end in range(2):
            turns[:] = 0.0
            for j in range(count):
                basis[j], solving[2][j] = begun[j], 1.0
            found, row, lacking = seated(shape, given, spring_ends, unknowns, wanted[end], basis, rooms, turns)
            if found != OK:
                status[i], decided[i], amount[i] = found, row, lacking
                ends[i, 0] = ends[i, 1] = np.nan
                reached[i] = np.nan
                break
            reached[i, end] = turns
            ends[i, end] = 0.0
            for j in range(count):
                ends[i, end] += turn[j] * turns[unknowns[j]]


@part
def turn_offsets(central: Any, planet: Any, centrals: Any, own: Any, now: Any) -> None:
    """Write offsets of central gears (meshes, 2) and planets' gears (gears, planets, 2) turned by cosine and sine."""
    for m in range(central.shape[0]):
        now[0][m, 0] = centrals[m, 0] * central[m, 0] - centrals[m, 1] * central[m, 1]
        now[0][m, 1] = centrals[m, 1] * central[m, 0] + centrals[m, 0] * central[m, 1]
    for g in range(planet.shape[0]):
        for k in range(planet.shape[1]):
            now[1][g, k, 0] = own[0] * planet[g, k, 0] - own[1] * planet[g, k, 1]
            now[1][g, k, 1] = own[1] * planet[g, k, 0] + own[0] * planet[g, k, 1]


@kernel(
    arrays="f8[:,::1], i8[::1], f8[:,::1], f8[:,::1], f8, f8[:,:,::1], f8[:,:,:,::1], f8[:,:,::1], f8[:,:,::1], "
    "f8[:,:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,::1], f8[:,::1], i8[::1], f8[::1], f8[::1], i8[::1], "
    "f8[:,::1], i1[::1], i8[::1], f8[::1]"
)
def placed_curve(
    meshes: Any, places: Any, planets: Any, senses: Any, distance: float,
    central: Any, planet: Any, pin: Any, aside: Any, room: Any, middle: Any,
    centrals_turned: Any, planets_turned: Any, spring_ends: Any, unknowns: Any, turn: Any, wanted: Any, begun: Any,
    ends: Any, status: Any, decided: Any, amount: Any,
) -> None:  # fmt: skip
    """The end of one coordinate at positions that all trials share; for the arguments see seated_ranges.

    Args:
        central, planet: offsets (trials, ...) where the first position's are not turned yet.
        centrals_turned, planets_turned: cosine and sine of each central gear's turn against the carrier (positions,
            meshes, 2), and of a planet's (positions, 2).
        wanted: objective (unknowns,).
        ends: of the coordinate (trials, positions), written; 0 where the set jams.
        status, decided, amount: the worst position's.
    """
    count, springs = unknowns.shape[0], senses.shape[1]
    contacts = meshes.shape[0] * planets.shape[0]
    solving = new_rooms(count)
    basis, turns = np.empty(count, np.int64), np.empty(meshes.shape[0] + 1 + planets.shape[0] + springs)
    slopes, rows = np.empty((contacts, turns.shape[0])), np.empty((contacts + springs, count))
    sides = np.empty(contacts + springs), np.empty(contacts + springs)
    rooms = (solving, np.empty((meshes.shape[0], 2)), slopes, rows, sides[0], sides[1], np.empty(count))
    shape = (meshes, places, planets, senses, distance)
    now = (np.empty((meshes.shape[0], 2)), np.empty((planet.shape[1], planet.shape[2], 2)))
    for i in range(central.shape[0]):
        status[i], decided[i], amount[i] = OK, -1, 0.0
        afresh = True
        for p in range(ends.shape[1]):
            turn_offsets(central[i], planet[i], centrals_turned[p], planets_turned[p], now)
            given = (now[0], now[1], pin[i], aside[i], room[i], middle[i])
            for attempt in range(2):
                if afresh or attempt == 1:
                    turns[:] = 0.0
                    for j in range(count):
                        basis[j], solving[2][j] = begun[j], 1.0
                found, row, lacking = seated(shape, given, spring_ends, unknowns, wanted, basis, rooms, turns)
                if found == OK or afresh:
                    break
            ends[i, p] = 0.0
            afresh = found != OK
            if afresh:
                if found >= status[i]:
                    status[i], decided[i], amount[i] = found, row, max(amount[i], lacking)
                continue
            for j in range(count):
                ends[i, p] += turn[j] * turns[unknowns[j]]
