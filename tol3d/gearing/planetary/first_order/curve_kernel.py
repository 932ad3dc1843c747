"""Rest positions of a shaft at successive positions, by first-order gaps: a compiled programme that goes on from each.

Contacts are those of `stack_up.py`, worked out position by position. Contacts that are met at one position are those
that the next one begins with, in the same trial, with the inverse of their rows, which do not change; a trial still has
the same bits alone and among thousands. Contacts met are noted beside the ends, where they change. The derivatives of
any sum of ends follow from their multipliers: gears turn on while contacts stay, so that their turns are summed first,
and the sides of contacts and offsets of gears get their share once for each set of contacts.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import kernel, part
from tol3d.numerics.loops import fill, fill_matrix
from tol3d.numerics.programme import OK, exchanged, inverted, new_rooms, solve_lp

INVERTED_ANEW: Final = 64  # positions after which it is, for each exchange of rows rounds it once
AS_BEFORE: Final = -1  # contacts are those of the position before
NONE_MET: Final = -2  # the set jams


@part
def sides_at(
    given: Any, fixed: Any, lower: Any, upper: Any, across: Any, places: Any, directions: Any, phases: Any, turned: Any
) -> None:
    """Write the sides of a trial's contacts where its gears stand turned.

    Args:
        given: offsets of central gears (meshes, 2) and of planets' gears (gears, planets, 2) in their own frames [mm].
        fixed: sides of all rows without offsets (rows,), lower and upper [mm].
        lower, upper: (rows,), written.
        across: what an offset outwards opens each flank by, and one across moves both by (meshes, 2).
        places: gear of the planets of each mesh.
        directions, phases: cosine and sine (planets, 2) of each planet's azimuth, and of its gears against it.
        turned: cosine and sine of each central gear's turn against the carrier (meshes, 2), and of a planet's (2,).
    """
    central, planet = given
    centrals, own = turned
    count = places.shape[0]
    for r in range(lower.shape[0]):
        lower[r], upper[r] = fixed[0][r], fixed[1][r]
    for k in range(directions.shape[0]):
        cos_p = own[0] * phases[k, 0] - own[1] * phases[k, 1]
        sin_p = own[1] * phases[k, 0] + own[0] * phases[k, 1]
        for m in range(count):
            g = places[m]
            cos_c = centrals[m, 0] * directions[k, 0] + centrals[m, 1] * directions[k, 1]
            sin_c = centrals[m, 1] * directions[k, 0] - centrals[m, 0] * directions[k, 1]
            outwards = cos_p * planet[g, k, 0] - sin_p * planet[g, k, 1] - cos_c * central[m, 0] + sin_c * central[m, 1]
            round_ = sin_p * planet[g, k, 0] + cos_p * planet[g, k, 1] - sin_c * central[m, 0] - cos_c * central[m, 1]
            r = k * count + m
            lower[r] += across[m, 1] * round_ - across[m, 0] * outwards
            upper[r] += across[m, 1] * round_ + across[m, 0] * outwards


@part
def pulled(
    weight: Any, met: int, total: Any, across: Any, places: Any, directions: Any, phases: Any, turned: Any, slopes: Any
) -> None:  # fmt: skip
    """Add the contributions of a contact's multiplier to its side and to the offsets of its gears; see sides_at.

    Args:
        weight: the multiplier.
        met: twice the contact's row, and 1 where it is met at its upper side.
        total, turned: sums of coefficients, and of cosines and sines of turns times them.
    """
    on_sides, on_central, on_planet = slopes
    centrals, own = turned
    count = places.shape[0]
    r, upper = met // 2, met % 2
    on_sides[upper, r] += weight * total
    if r >= count * directions.shape[0]:
        return
    k, m = r // count, r % count
    g = places[m]
    outwards = weight * across[m, 0] * (1.0 if upper == 1 else -1.0)
    round_ = weight * across[m, 1]
    cos_p = own[0] * phases[k, 0] - own[1] * phases[k, 1]
    sin_p = own[1] * phases[k, 0] + own[0] * phases[k, 1]
    on_planet[g, k, 0] += cos_p * outwards + sin_p * round_
    on_planet[g, k, 1] += cos_p * round_ - sin_p * outwards
    cos_c = centrals[m, 0] * directions[k, 0] + centrals[m, 1] * directions[k, 1]
    sin_c = centrals[m, 1] * directions[k, 0] - centrals[m, 0] * directions[k, 1]
    on_central[m, 0] -= cos_c * outwards + sin_c * round_
    on_central[m, 1] -= cos_c * round_ - sin_c * outwards


@part
def noted(basis: Any, sides: Any, last: Any, met: Any) -> None:
    """Note the contacts met, unless they are the last ones."""
    changed = False
    for j in range(basis.shape[0]):
        now = 2 * basis[j] + (1 if sides[j] > 0.0 else 0)
        changed = changed or now != last[j]
        last[j] = now
    met[0] = AS_BEFORE
    if changed:
        for j in range(basis.shape[0]):
            met[j] = last[j]


@kernel(
    arrays="f8[:,::1], f8[:,::1], f8[:,::1], f8[:,:,::1], f8[:,:,:,::1], f8[:,::1], i8[::1], f8[:,::1], f8[:,::1], "
    "f8[:,:,::1], f8[:,::1], f8[::1], f8[::1], i8[::1], f8[:,::1], i1[::1], i8[::1], f8[::1], i8[:,:,::1]"
)
def first_order_curve(
    rows: Any, lower: Any, upper: Any, central: Any, planet: Any,
    across: Any, places: Any, directions: Any, phases: Any,
    centrals_turned: Any, planets_turned: Any, turn: Any, wanted: Any, begun: Any,
    ends: Any, status: Any, decided: Any, amount: Any, met: Any,
) -> None:  # fmt: skip
    """The end of one coordinate at positions of trials, and the contacts that are met there.

    Args:
        rows: of the contacts and springs (rows, unknowns) [mm a rad].
        lower, upper: of the rows (trials, rows) without offsets of gears [mm].
        central, planet, across, places, directions, phases: see sides_at; offsets (trials, ...).
        centrals_turned, planets_turned: see sides_at, of the positions that all trials share (positions, ...), or of
            each trial's own, one after the other (trials x positions, ...).
        turn, wanted, begun: see programme.ranges; the end that is wanted (unknowns,).
        ends: of the coordinate (trials, positions), written; 0 where the set jams.
        status, decided, amount: the worst position's; see programme.ranges.
        met: contacts, see pulled (trials, positions, unknowns), written where they change; the first one is AS_BEFORE
            where they do not, NONE_MET where there are none. Of no positions where they are not wanted.
    """
    count, trials, positions = rows.shape[1], ends.shape[0], ends.shape[1]
    rooms = new_rooms(count)
    x, basis, last = np.empty(count), np.empty(count, np.int64), np.empty(count, np.int64)
    low, high = np.empty(rows.shape[0]), np.empty(rows.shape[0])
    shared = planets_turned.shape[0] == positions
    for i in range(trials):
        status[i], decided[i], amount[i] = OK, -1, 0.0
        afresh = True
        for p in range(positions):
            at = p if shared else i * positions + p
            turned = (centrals_turned[at], planets_turned[at])
            sides_at(
                (central[i], planet[i]), (lower[i], upper[i]), low, high, across, places, directions, phases, turned
            )
            for attempt in range(2):
                if afresh or attempt == 1:
                    for j in range(count):
                        basis[j], rooms[2][j], last[j] = begun[j], 1.0, NONE_MET
                if afresh or attempt == 1 or p % INVERTED_ANEW == 0:
                    found, row, lacking = solve_lp(rows, low, high, wanted, basis, rooms, x)
                else:
                    _, inverse, sides, loads, shares = rooms
                    found, row, lacking = exchanged(rows, low, high, basis, inverse, sides, loads, shares, x)
                if found == OK or afresh:
                    break
            ends[i, p] = 0.0
            afresh = found != OK
            if afresh:
                if met.shape[1] > 0:
                    met[i, p, 0] = NONE_MET
                if found >= status[i]:
                    status[i], decided[i], amount[i] = found, row, max(amount[i], lacking)
                continue
            for j in range(count):
                ends[i, p] += turn[j] * x[j]
            if met.shape[1] > 0:
                noted(basis, rooms[2], last, met[i, p])


@part
def pulled_by_all(
    rows: Any, turn: Any, met: Any, basis: Any, rooms: Any, summed: Any, across: Any, places: Any, directions: Any,
    phases: Any, slopes: Any,
) -> None:  # fmt: skip
    """Add the contributions of all contacts met, by their multipliers; see pulled for what is summed."""
    for j in range(met.shape[0]):
        basis[j] = met[j] // 2
    if inverted(rows, basis, rooms[0], rooms[1]):
        for j in range(met.shape[0]):
            weight = 0.0
            for u in range(met.shape[0]):
                weight += turn[u] * rooms[1][u, j]
            if weight != 0.0:
                pulled(weight, met[j], summed[0], across, places, directions, phases, summed[1:], slopes)


@kernel(
    arrays="f8[:,::1], f8[::1], f8[:,::1], i8[::1], f8[:,::1], f8[:,::1], f8[:,:,::1], f8[:,::1], i8[:,:,::1], "
    "f8[:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,:,:,::1]"
)
def curve_slopes(
    rows: Any, turn: Any, across: Any, places: Any, directions: Any, phases: Any, centrals_turned: Any,
    planets_turned: Any, met: Any, coefficients: Any, on_sides: Any, on_central: Any, on_planet: Any,
) -> None:  # fmt: skip
    """Derivatives of a sum of the ends that first_order_curve found.

    Args:
        rows, turn, across, places, directions, phases, centrals_turned, planets_turned, met: see there.
        coefficients: of the ends in the sum (trials, positions).
        on_sides, on_central, on_planet: zeros; change of the sum by lower and upper sides (trials, 2, rows) and by
            offsets, written.
    """
    trials, positions, count = coefficients.shape[0], coefficients.shape[1], met.shape[2]
    centrals, own = np.empty((places.shape[0], 2)), np.empty(2)
    rooms, basis = new_rooms(count), np.empty(count, np.int64)
    shared = planets_turned.shape[0] == positions
    for i in range(trials):
        slopes = (on_sides[i], on_central[i], on_planet[i])
        begun, total, counted = NONE_MET, 0.0, False
        for p in range(positions + 1):
            if p == positions or met[i, p, 0] != AS_BEFORE:
                if counted:
                    pulled_by_all(
                        rows, turn, met[i, begun], basis, rooms, (total, centrals, own), across, places, directions,
                        phases, slopes,
                    )  # fmt: skip
                if p == positions:
                    break
                begun = NONE_MET if met[i, p, 0] == NONE_MET else p
                total, counted = 0.0, False
                fill(own, 0.0)
                fill_matrix(centrals, 0.0)
            coefficient, at = coefficients[i, p], p if shared else i * positions + p
            if begun < 0 or coefficient == 0.0:
                continue
            counted = True
            total += coefficient
            own[0] += coefficient * planets_turned[at, 0]
            own[1] += coefficient * planets_turned[at, 1]
            for m in range(places.shape[0]):
                centrals[m, 0] += coefficient * centrals_turned[at, m, 0]
                centrals[m, 1] += coefficient * centrals_turned[at, m, 1]
