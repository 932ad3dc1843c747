"""Rest positions of a shaft at successive positions, by first-order gaps: a compiled programme that goes on from each.

Contacts are those of `stack_up.py`, worked out position by position. Contacts that are met at one position are those
that the next one begins with, in the same trial, with the inverse of their rows, which do not change; a trial still has
the same bits alone and among thousands. What a sum
over the positions changes with is known beside it: the multipliers of the contacts met, which the sides of contacts and
offsets of gears get their share of.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import kernel, part
from tol3d.numerics.programme import OK, exchanged, new_rooms, solve_lp

INVERTED_ANEW: Final = 64  # positions after which it is, for each exchange of rows rounds it once


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
    weight: Any, side: float, r: int, across: Any, places: Any, directions: Any, phases: Any, turned: Any, slopes: Any
) -> None:
    """Add the contributions of a contact's multiplier to its side and to the offsets of its gears; see sides_at."""
    on_sides, on_central, on_planet = slopes
    centrals, own = turned
    count = places.shape[0]
    on_sides[1 if side > 0.0 else 0, r] += weight
    if r >= count * directions.shape[0]:
        return
    k, m = r // count, r % count
    g = places[m]
    outwards = weight * across[m, 0] * (1.0 if side > 0.0 else -1.0)
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
def pull(
    coefficient: Any, turn: Any, basis: Any, rooms: Any,
    across: Any, places: Any, directions: Any, phases: Any, turned: Any, slopes: Any,
) -> None:  # fmt: skip
    """Add the derivatives of an end by the contacts met, times its coefficient; see pulled and programme.solve_lp."""
    for j in range(basis.shape[0]):
        weight = 0.0
        for u in range(basis.shape[0]):
            weight += turn[u] * rooms[1][u, j]
        pulled(coefficient * weight, rooms[2][j], basis[j], across, places, directions, phases, turned, slopes)


@kernel(
    arrays="f8[:,::1], f8[:,::1], f8[:,::1], f8[:,:,::1], f8[:,:,:,::1], f8[:,::1], i8[::1], f8[:,::1], f8[:,::1], "
    "f8[:,:,::1], f8[:,::1], f8[::1], f8[::1], i8[::1], f8[:,::1], f8[:,::1], i1[::1], i8[::1], f8[::1], "
    "f8[:,:,::1], f8[:,:,::1], f8[:,:,:,::1]"
)
def first_order_curve(
    rows: Any, lower: Any, upper: Any, central: Any, planet: Any,
    across: Any, places: Any, directions: Any, phases: Any,
    centrals_turned: Any, planets_turned: Any, turn: Any, wanted: Any, begun: Any,
    coefficients: Any, ends: Any, status: Any, decided: Any, amount: Any,
    on_sides: Any, on_central: Any, on_planet: Any,
) -> None:  # fmt: skip
    """The end of one coordinate at positions of trials, and the derivatives of a sum of such ends.

    Args:
        rows: of the contacts and springs (rows, unknowns) [mm a rad].
        lower, upper: of the rows (trials, rows) without offsets of gears [mm].
        central, planet, across, places, directions, phases: see sides_at; offsets (trials, ...).
        centrals_turned, planets_turned: see sides_at, of the positions that all trials share (positions, ...), or of
            each trial's own, one after the other (trials x positions, ...).
        turn, wanted, begun: see programme.ranges; the end that is wanted (unknowns,).
        coefficients: of the ends in the sum (trials, positions); where there are any, other positions are left out.
        ends: of the coordinate (trials, positions), written; 0 where the set jams.
        status, decided, amount: the worst position's; see programme.ranges.
        on_sides, on_central, on_planet: zeros; change of the sum by lower and upper sides (trials, 2, rows) and by
            offsets, written.
    """
    count, trials, positions = rows.shape[1], ends.shape[0], ends.shape[1]
    rooms = new_rooms(count)
    x, basis = np.empty(count), np.empty(count, np.int64)
    low, high = np.empty(rows.shape[0]), np.empty(rows.shape[0])
    shared = planets_turned.shape[0] == positions
    for i in range(trials):
        status[i], decided[i], amount[i] = OK, -1, 0.0
        summed = np.any(coefficients[i] != 0.0)
        afresh = True
        for p in range(positions):
            if summed and coefficients[i, p] == 0.0:
                continue
            at = p if shared else i * positions + p
            turned = (centrals_turned[at], planets_turned[at])
            sides_at(
                (central[i], planet[i]), (lower[i], upper[i]), low, high, across, places, directions, phases, turned
            )
            for attempt in range(2):
                if afresh or attempt == 1:
                    for j in range(count):
                        basis[j], rooms[2][j] = begun[j], 1.0
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
                if found >= status[i]:
                    status[i], decided[i], amount[i] = found, row, max(amount[i], lacking)
                continue
            for j in range(count):
                ends[i, p] += turn[j] * x[j]
            if summed:
                slopes = (on_sides[i], on_central[i], on_planet[i])
                pull(coefficients[i, p], turn, basis, rooms, across, places, directions, phases, turned, slopes)
