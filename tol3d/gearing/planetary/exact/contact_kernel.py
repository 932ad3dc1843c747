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
contacts that are met are those that the next position begins with. There each planet's own turn is eliminated: any two
of its meshes leave a row of two sides in which it does not occur, so that shafts and springs alone are unknown.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy, eliminated, fill, fill_matrix
from tol3d.numerics.programme import OK, STALLED, new_rooms, solve_lp
from tol3d.numerics.quick_angles import azimuth

STILL: Final = 1e-11  # rad; turns change by less: at 100 mm that is 1e-9 mm
MOST_STEPS: Final = 25
LOOSE: Final = 20.0  # twice the two contacts of a pair, with ratios of base radii up to 4
SMALL: Final = 0.0625  # rad; the first term that a series leaves out is 1e-19 there


@nested
def write_facing(turns: Any, number: int, senses: Any, distance: float, facing: Any) -> None:
    """Write cosine and sine of the turns of central gears, of planets' pins about the axis, and of planets.

    Those of small turns are series, which take a fifth of the time.
    """
    first = facing.shape[0] - 2 * number
    for i in range(facing.shape[0]):
        turn = turns[i] if i < first else turns[first]
        if i >= first + number:
            turn = turns[i - number + 1]
        elif i >= first:
            for j in range(senses.shape[1]):
                turn += senses[i - first, j] * turns[first + 1 + number + j] / distance
        if abs(turn) < SMALL:
            t = turn * turn
            facing[i, 0] = 1.0 - t * (
                1.0 / 2 - t * (1.0 / 24 - t * (1.0 / 720 - t * (1.0 / 40320 - t * (1.0 / 3628800))))
            )
            facing[i, 1] = turn * (1.0 - t * (1.0 / 6 - t * (1.0 / 120 - t * (1.0 / 5040 - t * (1.0 / 362880)))))
        else:
            facing[i, 0], facing[i, 1] = np.cos(turn), np.sin(turn)


@nested
def gaps_at(
    shape: Any, given: Any, turns: Any, facing: Any, near: Any, rows: Any, opening: Any, lower: Any, upper: Any
) -> bool:  # fmt: skip
    """Write the rows of a trial at some turns, and their sides against those turns; False where base circles overlap.

    The difference of two arc tangents is that of their tangents' difference over 1 + their product.

    Args:
        shape: of each mesh r_bC, r_bP, s, tan alpha_w (meshes, 4) and the gear of the planets (meshes,); cosine and
            sine of each planet's azimuth (planets, 2); how springs push each planet (planets, springs); the radius of
            the pins' circle [mm].
        given: of the trial, before these turns: centres of central gears off the axis (meshes, 2), of planets' gears
            off their pins (gears, planets, 2), places of pins (planets, 2), the planets' circle beside each central
            gear's axis (meshes, 2), which turns with nothing; clearance of each flank by thinning, the nominal one
            included, and movement of n by clocking (planets, meshes).
        turns: of central gears, carrier, planets; then displacements by springs [mm].
        facing: cosines and sines (meshes + 2 planets, 2), see write_facing, to write in.
        near: 1 for planets whose rows are written (planets,); those of others stay.
        rows: of the contacts (contacts, turns), 0 where a turn does not move a mesh; the others are written.
        opening: both flanks by each turn in the same form, as it moves the centres; written.
    """
    meshes, places, planets, senses, distance = shape
    central, planet, pin, aside, room, middle = given
    count = meshes.shape[0]
    number = planets.shape[0]
    write_facing(turns, number, senses, distance, facing)
    for k in range(number):
        if near[k] == 0:
            continue
        cos_h, sin_h = facing[count + k, 0], facing[count + k, 1]
        pin_x, pin_y = cos_h * pin[k, 0] - sin_h * pin[k, 1], sin_h * pin[k, 0] + cos_h * pin[k, 1]
        psi, cos_p, sin_p = turns[count + 1 + k], facing[count + number + k, 0], facing[count + number + k, 1]
        for m in range(count):
            r_c, r_p, s, tan_w = meshes[m, 0], meshes[m, 1], meshes[m, 2], meshes[m, 3]
            base = r_c + s * r_p
            g = places[m]
            off_x = cos_p * planet[g, k, 0] - sin_p * planet[g, k, 1]
            off_y = sin_p * planet[g, k, 0] + cos_p * planet[g, k, 1]
            theta, cos_c, sin_c = turns[m], facing[m, 0], facing[m, 1]
            own_x = cos_c * central[m, 0] - sin_c * central[m, 1]
            own_y = sin_c * central[m, 0] + cos_c * central[m, 1]
            x, y = pin_x + off_x - own_x + aside[m, 0], pin_y + off_y - own_y + aside[m, 1]
            square = x * x + y * y
            if not square > base * base:
                return False
            tan = np.sqrt(square - base * base) / base
            more = tan - tan_w
            involute = more - azimuth(more, 1.0 + tan * tan_w)  # inv alpha' - inv alpha_w
            c, e = planets[k, 0], planets[k, 1]
            gamma = azimuth(c * y - e * x, c * x + e * y)
            n = r_p * psi + s * (r_c * theta - base * gamma) + middle[k, m]
            opened = room[k, m] + s * base * involute
            across = s * base / square  # a centre moved across by d shifts n by -s cos alpha' d
            r = k * count + m
            rows[r, m] = s * r_c + across * (own_x * x + own_y * y)
            rows[r, count] = -across * (pin_x * x + pin_y * y)
            rows[r, count + 1 + k] = r_p - across * (off_x * x + off_y * y)
            apart = across * tan  # centres that come apart by d open flanks by s sin alpha' d
            opening[r, m] = apart * (own_y * x - own_x * y)
            opening[r, count] = apart * (pin_x * y - pin_y * x)
            opening[r, count + 1 + k] = apart * (off_x * y - off_y * x)
            for j in range(senses.shape[1]):
                rows[r, count + 1 + number + j] = senses[k, j] * rows[r, count] / distance
                opening[r, count + 1 + number + j] = senses[k, j] * opening[r, count] / distance
            upper[r] = opened - n
            lower[r] = -opened - n
    return True


@nested
def seated(
    shape: Any, given: Any, spring_ends: Any, unknowns: Any, objective: Any, basis: Any, rooms: Any, turns: Any
) -> tuple[int, int, float]:  # fmt: skip
    """Turn as far along an objective as contacts let; like programme.solve_lp, again and again from where that leads.

    Args:
        shape, given: see gaps_at.
        spring_ends: least and largest displacement by each spring (2, springs) [mm].
        unknowns: places of the programme's unknowns among the turns.
        objective, basis: see programme.solve_lp.
        rooms: those of programme.solve_lp; cosines and sines, all planets, slopes, opening, rows, lower, upper and x to
            write in.
        turns: zeros; written.
    """
    solving, facing, near, slopes, opening, rows, lower, upper, x = rooms
    springs = spring_ends.shape[1]
    contacts = slopes.shape[0]
    found, row, lacking = STALLED, -1, 0.0
    for _ in range(MOST_STEPS):
        if not gaps_at(shape, given, turns, facing, near, slopes, opening, lower, upper):
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
    near = np.empty(planets.shape[0], np.int64)
    fill_matrix(slopes, 0.0)
    for k in range(near.shape[0]):
        near[k] = 1
    rooms = (
        solving,
        np.empty((meshes.shape[0] + 2 * planets.shape[0], 2)),
        near,
        slopes,
        np.empty((contacts, turns.shape[0])),
        rows,
        sides[0],
        sides[1],
        np.empty(count),
    )
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


@nested
def turn_offsets(central: Any, planet: Any, centrals: Any, own: Any, now: Any) -> None:
    """Write offsets of central gears (meshes, 2) and planets' gears (gears, planets, 2) turned by cosine and sine."""
    for m in range(central.shape[0]):
        now[0][m, 0] = centrals[m, 0] * central[m, 0] - centrals[m, 1] * central[m, 1]
        now[0][m, 1] = centrals[m, 1] * central[m, 0] + centrals[m, 0] * central[m, 1]
    for g in range(planet.shape[0]):
        for k in range(planet.shape[1]):
            now[1][g, k, 0] = own[0] * planet[g, k, 0] - own[1] * planet[g, k, 1]
            now[1][g, k, 1] = own[1] * planet[g, k, 0] + own[0] * planet[g, k, 1]


@nested
def without_planets(
    count: int, near: Any, slopes: Any, lower: Any, upper: Any, others: Any, rows: Any, low: Any, high: Any
) -> None:  # fmt: skip
    """Write the rows of any two meshes of each planet in which its own turn does not occur, and their sides.

    With p the slopes by the planet's turn, above 0, either mesh leaves it a range of turns: these overlap
    (Fourier and Motzkin) where lower - f upper' <= (row - f row') x <= upper - f lower', f = p / p'.

    Args:
        count: of the meshes of a planet.
        near, slopes, lower, upper: see gaps_at.
        others: places among the turns of all unknowns but planets' turns.
        rows, low, high: of the pairs (planets x pairs, others), written.
    """
    r = -1
    for k in range(near.shape[0]):
        for m in range(1, count):
            one = k * count + m
            for other in range(k * count, one):
                r += 1
                if near[k] == 1:
                    f = slopes[one, count + 1 + k] / slopes[other, count + 1 + k]
                    for j in range(others.shape[0]):
                        rows[r, j] = slopes[one, others[j]] - f * slopes[other, others[j]]
                    low[r], high[r] = lower[one] - f * upper[other], upper[one] - f * lower[other]


@nested
def stepped(count: int, near: Any, rows: Any, low: Any, high: Any, x: Any, most: float) -> None:
    """Move the sides of pairs of meshes by a step, and write which planets have one with no more room than `most`."""
    r = -1
    for k in range(near.shape[0]):
        near[k] = 0
        for _ in range(count * (count - 1) // 2):
            r += 1
            taken = 0.0
            for j in range(x.shape[0]):
                taken += rows[r, j] * x[j]
            low[r] -= taken
            high[r] -= taken
            if not min(high[r], -low[r]) > most:
                near[k] = 1


@nested
def planet_turn(k: int, count: int, slopes: Any, opening: Any, lower: Any, upper: Any, others: Any, x: Any) -> float:
    """Least turn of a planet on its pin after which its meshes have room, where other unknowns have changed by x."""
    least, most = -np.inf, np.inf
    for r in range(k * count, (k + 1) * count):
        taken, opened = 0.0, 0.0
        for j in range(others.shape[0]):
            taken += slopes[r, others[j]] * x[j]
            opened += opening[r, others[j]] * x[j]
        own, opens = slopes[r, count + 1 + k], opening[r, count + 1 + k]
        least = max(least, (lower[r] - taken - opened) / (own + opens))
        most = min(most, (upper[r] - taken + opened) / (own - opens))
    found: float = min(max(0.0, least), most) if least < most else 0.5 * (least + most)
    return found


@nested
def refined(
    count: int, near: Any, gaps: Any, others: Any, programme: Any, sides: Any, matrix: Any, right: Any, x: Any
) -> None:  # fmt: skip
    """Move the point to where the contacts met meet with what turns open them by, which rows of two sides leave out.

    Args:
        count, near, others: see without_planets.
        gaps: slopes, opening, lower and upper sides of the contacts.
        programme: basis, rows, lower and upper sides of pairs and springs.
        sides: at which rows of the basis are met.
        matrix, right: to write in.
        x: the point; written.
    """
    slopes, opening, lower, upper = gaps
    basis, rows, low, high = programme
    pairs = count * (count - 1) // 2
    for j in range(x.shape[0]):
        r, side = basis[j], 1.0 if sides[j] > 0.0 else -1.0
        k, other, m = r // pairs, r % pairs, 1
        if r >= pairs * near.shape[0] or near[k] == 0:
            right[j] = high[r] if side > 0.0 else low[r]
            for i in range(x.shape[0]):
                matrix[j, i] = rows[r, i]
            continue
        while other >= m:
            other -= m
            m += 1
        one, other, own = k * count + m, k * count + other, count + 1 + k
        f = (slopes[one, own] - side * opening[one, own]) / (slopes[other, own] + side * opening[other, own])
        right[j] = upper[one] - f * lower[other] if side > 0.0 else lower[one] - f * upper[other]
        for i in range(x.shape[0]):
            at = others[i]
            matrix[j, i] = slopes[one, at] - side * opening[one, at]
            matrix[j, i] -= f * (slopes[other, at] + side * opening[other, at])
    sign, _ = eliminated(matrix, right, x.shape[0])
    if sign != 0.0:
        copy(x, right)


@nested
def followed(
    shape: Any, given: Any, spring_ends: Any, others: Any, objective: Any, basis: Any, loose: float, rooms: Any,
    turns: Any,
) -> bool:  # fmt: skip
    """Go on along an objective from turns and a basis near the end; True if it is reached. See seated.

    A planet's turn takes no part in an objective, and is as little as its meshes let it be. Planets that a step leaves
    more room than the next ones can take are left out of these. Rows leave out what shifts of centres by turns open
    both flanks by; contacts that are met have it added, see refined, and a step leaves out squares. Of each turn that
    is at most the offsets of centres times it, for each of the two contacts of a pair. LOOSE times offsets and the sum
    of all steps bounds what rows that are left out are wrong by.

    Args:
        others, objective, basis: of the unknowns that are no planet's turn, see without_planets; rows of the basis are
            of its pairs, then of springs.
        loose: LOOSE times all offsets of centres [mm].
        rooms: those of programme.solve_lp; cosines and sines, planets, slopes, opening, lower, upper, rows of pairs and
            springs, their sides, x, and equations to write in.
    """
    solving, facing, near, slopes, opening, lower, upper, rows, low, high, x, matrix, right = rooms
    count, number, springs = shape[0].shape[0], shape[2].shape[0], spring_ends.shape[1]
    first, gone = turns.shape[0] - springs, 0.0
    for k in range(number):
        near[k] = 1
    for _ in range(MOST_STEPS):
        if not gaps_at(shape, given, turns, facing, near, slopes, opening, lower, upper):
            return False
        without_planets(count, near, slopes, lower, upper, others, rows, low, high)
        for spring in range(springs):
            r = rows.shape[0] - springs + spring
            for j in range(others.shape[0]):
                rows[r, j] = 1.0 if others[j] == first + spring else 0.0
            low[r] = spring_ends[0, spring] - turns[first + spring]
            high[r] = spring_ends[1, spring] - turns[first + spring]
        found, _, _ = solve_lp(rows, low, high, objective, basis, solving, x)
        if found != OK:
            return False
        refined(
            count, near, (slopes, opening, lower, upper), others, (basis, rows, low, high), solving[2], matrix, right, x
        )  # fmt: skip
        moved = 0.0
        for j in range(others.shape[0]):
            turns[others[j]] += x[j]
            moved = max(moved, abs(x[j]))
        for k in range(number):
            if near[k] == 1:
                own = planet_turn(k, count, slopes, opening, lower, upper, others, x)
                turns[count + 1 + k] += own
                moved = max(moved, abs(own))
        if moved < STILL:
            return True
        gone += moved
        stepped(count, near, rows, low, high, x, loose * gone)
    return False


@kernel(
    arrays="f8[:,::1], i8[::1], f8[:,::1], f8[:,::1], f8, f8[:,:,::1], f8[:,:,:,::1], f8[:,:,::1], f8[:,:,::1], "
    "f8[:,:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,::1], f8[:,::1], i8[::1], f8[::1], i8[::1], i8, f8[::1], f8[:,::1]"
)
def placed_curve(
    meshes: Any, places: Any, planets: Any, senses: Any, distance: float,
    central: Any, planet: Any, pin: Any, aside: Any, room: Any, middle: Any,
    centrals_turned: Any, planets_turned: Any, spring_ends: Any, others: Any, wanted: Any, begun: Any, turn: int,
    loose: Any, ends: Any,
) -> None:  # fmt: skip
    """The end of one coordinate at positions that all trials share; for the arguments see seated_ranges and followed.

    Args:
        central, planet: offsets (trials, ...) where the first position's are not turned yet.
        centrals_turned, planets_turned: cosine and sine of each central gear's turn against the carrier (positions,
            meshes, 2), and of a planet's (positions, 2).
        others, wanted, begun: unknowns but planets' turns, their objective, and rows of the first basis.
        turn: place of the coordinate among the turns.
        loose: see followed (trials,).
        ends: of the coordinate (trials, positions), written; not a number where the position before, or none where that
            was none, does not lead to it: `seated` tells why.
    """
    rest, springs, contacts = others.shape[0], senses.shape[1], meshes.shape[0] * planets.shape[0]
    basis, turns = np.empty(rest, np.int64), np.empty(meshes.shape[0] + 1 + planets.shape[0] + springs)
    slopes, opening = np.empty((contacts, turns.shape[0])), np.empty((contacts, turns.shape[0]))
    pairs = contacts * (meshes.shape[0] - 1) // 2 + springs
    fill_matrix(slopes, 0.0)
    fill_matrix(opening, 0.0)
    solving = new_rooms(rest)
    rooms = (
        solving, np.empty((meshes.shape[0] + 2 * planets.shape[0], 2)), np.empty(planets.shape[0], np.int64), slopes,
        opening, np.empty(contacts), np.empty(contacts),
        np.empty((pairs, rest)), np.empty(pairs), np.empty(pairs), np.empty(rest), np.empty((rest, rest)),
        np.empty(rest),
    )  # fmt: skip
    shape = (meshes, places, planets, senses, distance)
    now = (np.empty((meshes.shape[0], 2)), np.empty((planet.shape[1], planet.shape[2], 2)))
    for i in range(central.shape[0]):
        found = False
        for p in range(ends.shape[1]):
            turn_offsets(central[i], planet[i], centrals_turned[p], planets_turned[p], now)
            given = (now[0], now[1], pin[i], aside[i], room[i], middle[i])
            if not found:
                fill(turns, 0.0)
                for j in range(rest):
                    basis[j], solving[2][j] = begun[j], 1.0
            found = followed(shape, given, spring_ends, others, wanted, basis, loose[i], rooms, turns)
            ends[i, p] = turns[turn] if found else np.nan
