"""First contact of cycloid discs among their pins, compiled over trials, crank angles and pins.

A first-order screen finds every working pin's turn from its nominal foot: gap / lever. It errs by the curvature of the
path over the pin's way along it from there, by the square of the turn, and by errors times the turn; the sum of these
bounds says which pins may be first, and Newton's method is run on these only. A disc that leans touches with one of its
faces, or between them where the gap is least inside.
"""

from typing import Any, Final

import numpy as np

from tol3d.gearing.cycloid.exact.pin_contact import (
    TURN,
    ContactShape,
    crank_at,
    lobe_at,
    lobe_turn,
    placed,
    standing_gap,
    touched,
    write_facing,
)
from tol3d.numerics.compiled import kernel, part

MORE: Final = 1.25  # times a pin's own turn to first order, and
LEAST_TURN: Final = 5e-6  # rad, are the turns for which its error is bounded
NO_PIN: Final = -1
MOST_CUTS: Final = 40  # of a disc's width, for the section that touches first
FLAT: Final = 1e-9  # mm, by which a gap differs between the sections that may touch first


@part
def drift(shape: Any, linkage: Any, throw: float) -> float:
    """Largest departure of a pin's rate in the disc's frame from the nominal one, due to errors [mm per rad]."""
    reach = shape.ground_circle + shape.eccentricity + 1.0
    whole = np.sqrt(linkage[6] ** 2 + linkage[7] ** 2)
    other = np.sqrt(linkage[8] ** 2 + linkage[9] ** 2) / whole
    skew = abs(linkage[7]) / whole + other
    throw_x = linkage[2] - shape.eccentricity * np.cos(throw)
    throw_y = linkage[3] - shape.eccentricity * np.sin(throw)
    found = np.sqrt(linkage[0] ** 2 + linkage[1] ** 2) + np.sqrt(linkage[4] ** 2 + linkage[5] ** 2)
    found += abs(shape.rolling) * (np.sqrt(throw_x**2 + throw_y**2) + 2.0 * skew * shape.eccentricity)
    bound: float = 2.0 * (found + (1.0 + abs(shape.rolling)) * other * reach)
    return bound


@part
def curvature_within(shape: Any, speed: float, right: float, cos_phase: float, far: float) -> float:
    """Largest curvature of the ground path [1/mm] within twice a distance of a point; inf where speed may halve.

    Along a flank, curvature rises from the root to sharpest_cosine, and falls to the tip.
    """
    ratio = shape.eccentricity * shape.pins / shape.ground_circle
    spread = 4.0 * far * shape.lobes / (shape.ground_circle * speed)
    spread *= abs(right) + spread
    low, high = max(cos_phase - spread, -1.0), min(cos_phase + spread, 1.0)
    speed_low = 1.0 + ratio * (ratio - 2.0 * high)
    speed_high = 1.0 + ratio * (ratio - 2.0 * low)
    if not 4.0 * speed_low > speed * speed:
        return np.inf
    level = 1.0 + shape.pins * ratio * ratio
    slope = (1.0 + shape.pins) * ratio
    near_root = abs(level - slope * high) / (shape.ground_circle * speed_low * np.sqrt(speed_low))
    near_tip = abs(level - slope * low) / (shape.ground_circle * speed_high * np.sqrt(speed_high))
    found: float = max(near_root, near_tip)
    return max(found, shape.sharpest) if low < shape.sharpest_cosine < high else found


@part
def bound(curvature: float, along: float, far: float) -> float:
    """Bound on the change of a gap by the bend of the path [mm]; inf where it bends too much.

    Args:
        curvature: largest within twice the distance along the path [1/mm].
        along, far: largest distance of the pin from its nominal place, along the path and in any direction [mm].
    """
    bent = curvature * far
    found: float = 0.5 * curvature * along * along / (1.0 - bent) if bent < 0.5 else np.inf
    return found


@part
def working_arc(shape: Any) -> tuple[float, float]:
    """Nearest and farthest phase of a working pin, in turns: where sin t is the window's share of the speed there.

    1 - c^2 = W^2 (1 + K^2 - 2 K c) with c = cos t, which is at most half a turn; none works where it has no root.
    """
    nominal, square = shape.eccentricity * shape.pins / shape.pin_circle, shape.window * shape.window
    root = np.sqrt(max(square * square * nominal * nominal - square * (1.0 + nominal * nominal) + 1.0, 0.0))
    middle = square * nominal
    return np.arccos(min(middle + root, 1.0)) / TURN, np.arccos(max(middle - root, -1.0)) / TURN


@part
def screened(
    shape: Any, linkage: Any, facing: Any, drifting: float, flanks: Any, pins: Any, around: Any, crank: Any,
    sense: float, arc: Any, disc: int, lean: Any, screen: Any, number: int,
) -> int:  # fmt: skip
    """Write the turn of each working pin of a disc in a sense to first order, and its error at most.

    Args:
        facing: of the disc, see pin_contact.write_facing.
        around: cosine and sine of the pins' azimuths (pins, 2).
        crank: of pin_contact.crank_at.
        sense: +1 where the disc turns counter-clockwise, -1 back; turns are counted in it.
        arc: see working_arc.
        lean: see touched, with half the disc's width for the height.
        screen: places, first turns, slacks, and levers with all that turns with them of working pins (discs pins,);
            written. A slack of inf is that of a pin whose bound is none.
        number: of working pins of the discs before.

    Returns:
        Number of working pins of these discs.
    """
    lobe_pitch, lobe_profile = flanks
    places, radii = pins
    working, firsts, slacks, arms = screen
    cos_psi, sin_psi, centre_x, centre_y = placed(linkage, crank[1], crank[2], crank[3], crank[4])
    lead, cos_lead, sin_lead, e, f = facing[0], facing[1], facing[2], facing[3], facing[4]
    cos_clock, sin_clock = facing[5], facing[6]
    cos_psi, sin_psi = cos_psi * cos_clock - sin_psi * sin_clock, sin_psi * cos_clock + cos_psi * sin_clock
    shortening = shape.eccentricity * shape.pins / shape.ground_circle
    nominal = shape.eccentricity * shape.pins / shape.pin_circle
    pitch_radius = shape.eccentricity * shape.lobes
    tau_x, tau_y = cos_clock * lean[0] + sin_clock * lean[1], cos_clock * lean[1] - sin_clock * lean[0]
    steep = tau_x * tau_x + tau_y * tau_y
    aside = np.sqrt(steep) * lean[2]
    reach = shape.ground_circle + shape.eccentricity * (1.0 + abs(shape.rolling)) + 1.0
    within, giving = max(shape.deflection, 0.0), 1.0 + shape.rolling / shape.lobes
    swung = (shape.rolling - 1.0) * shape.eccentricity
    count = around.shape[0]
    at = lead * shape.lobes / TURN + (arc[0] if sense > 0.0 else -arc[1])
    begun = int(np.floor((at - np.floor(at)) * count))
    for k in range(min(int((arc[1] - arc[0]) * count) + 3, count)):
        j = begun + k if begun + k < count else begun + k - count
        c = around[j, 0] * cos_lead - around[j, 1] * sin_lead
        s = around[j, 1] * cos_lead + around[j, 0] * sin_lead
        right = f * c - e * s
        cos_phase = e * c + f * s
        least = shape.window * shape.window * (1.0 + nominal * (nominal - 2.0 * cos_phase))
        if not (-sense * right > 0.0 and right * right > least):
            continue
        n_x, n_y = c - shortening * e, s - shortening * f
        speed = np.sqrt(n_x * n_x + n_y * n_y)
        arm = pitch_radius * abs(right) * giving  # times the speed
        per_arm = 1.0 / arm
        lobe = lobe_at(j * (TURN / shape.pins) + lead, shape.lobes)
        own = lobe_turn(shape, lobe_pitch, lobe, right)
        x, y = places[j, 0] - centre_x, places[j, 1] - centre_y
        x, y = cos_psi * x + sin_psi * y, cos_psi * y - sin_psi * x
        x, y = x + own * y, y - own * x
        x = x - shape.ground_circle * c + shape.eccentricity * e
        y = y - shape.ground_circle * s + shape.eccentricity * f
        off = radii[j] - shape.ground_radius + lobe_profile[lobe]
        first = (n_x * x + n_y * y - abs(n_x * tau_x + n_y * tau_y) * lean[2] - off * speed) * per_arm
        per_arm *= speed
        most = MORE * (abs(first) + within * per_arm) + LEAST_TURN
        away = np.sqrt(x * x + y * y) + aside
        moved = (1.0 + abs(shape.rolling)) * most + abs(own)
        rest = 0.5 * reach * moved * moved + most * (away + drifting) + reach * steep + abs(own) * aside
        turn_x = shape.ground_circle * s + swung * f
        turn_y = -shape.ground_circle * c - swung * e
        foot = n_x * (y + sense * first * turn_y) - n_y * (x + sense * first * turn_x)
        along = abs(foot) / speed + aside + reach * (most - abs(first)) + rest
        error = bound(curvature_within(shape, speed, right, cos_phase, along), along, away + reach * moved) + rest
        slack = error * per_arm
        working[number], firsts[number], arms[number] = disc * count + j, first, arm / speed
        slacks[number] = slack if slack <= most - abs(first) - within * per_arm else np.inf
        number += 1
    return number


@part
def exact(
    shape: Any, linkage: Any, facing: Any, flanks: Any, pins: Any, around: Any, crank: Any, place: int, extra: float,
    leans: Any, sense: float, enough: float,
) -> tuple[float, bool]:  # fmt: skip
    """The turn at which a pin touches; its place counts all discs' pins. Pins that are thicker touch earlier.

    For enough see touched; of a disc that leans all turns are found.
    """
    lobe_pitch, lobe_profile = flanks
    places, radii = pins
    disc, j = place // around.shape[0], place % around.shape[0]
    meets = facing[disc]
    u = j * (TURN / shape.pins) + meets[0]
    pin = (places[j, 0], places[j, 1], radii[j], around[j, 0], around[j, 1])
    own = (lobe_pitch[disc], lobe_profile[disc])
    x, y, high = leans[disc, 0], leans[disc, 1], leans[disc, 2]
    low = -high
    flat = x * x + y * y == 0.0 or high == 0.0
    most = enough if flat else np.inf
    turn, above, found = touched(shape, linkage[disc], meets, own, pin, crank, u, extra, (x, y, high), sense, most)
    if flat or not found:
        return turn, found
    other, below, found = touched(shape, linkage[disc], meets, own, pin, crank, u, extra, (x, y, low), sense, most)
    # a pin on a right flank is cleared by a larger turn, on a left one by a smaller one
    right = np.sin(meets[0] * shape.lobes - TURN * j / shape.pins) > 0.0
    turn = max(turn, other) if right else min(turn, other)
    for _ in range(MOST_CUTS):
        if not (found and below < 0.0 < above):
            break
        height = (low * above - high * below) / (above - below)
        other, slope, found = touched(
            shape, linkage[disc], meets, own, pin, crank, u, extra, (x, y, height), sense, most
        )
        turn = max(turn, other) if right else min(turn, other)
        if abs(slope) * (high - low) < FLAT:
            break
        if slope < 0.0:
            low, below = height, slope
        else:
            high, above = height, slope
    return turn, found


@part
def clear(
    shape: Any, linkage: Any, throws: Any, flanks: Any, pins: Any, around: Any, crank: Any, place: int, turn: float,
    leans: Any,
) -> bool:  # fmt: skip
    """True if a pin has a gap at the carrier's position, on a leaning disc at both faces and between them."""
    lobe_pitch, lobe_profile = flanks
    places, radii = pins
    disc, j = place // around.shape[0], place % around.shape[0]
    u = TURN * j / shape.pins + (crank[0] + throws[disc]) / shape.lobes
    pin = (places[j, 0], places[j, 1], radii[j])
    own = (lobe_pitch[disc], lobe_profile[disc])
    x, y, high = leans[disc, 0], leans[disc, 1], leans[disc, 2]
    for height in (-high, 0.0, high):
        clock = -throws[disc] / shape.lobes
        if not standing_gap(shape, linkage[disc], clock, own, pin, crank, u, turn, (x, y, height)) > 0.0:
            return False
    return True


@part
def first_of(
    shape: Any, linkage: Any, throws: Any, facing: Any, flanks: Any, pins: Any, around: Any, crank: Any, sense: float,
    screen: Any, number: int, leans: Any,
) -> tuple[float, int]:  # fmt: skip
    """The first contact in a sense: the carrier's turn and the pin's place; NaN where there is none, or none is known.

    Pins of which Newton's method finds no turn are in the way unless they are clear where the others stop the discs.
    """
    working, firsts, slacks, _ = screen
    best = np.inf
    begun = NO_PIN
    for k in range(number):
        if firsts[k] < best:
            best, begun = firsts[k], k
    if begun == NO_PIN:
        return np.nan, NO_PIN
    turn, found = exact(shape, linkage, facing, flanks, pins, around, crank, working[begun], 0.0, leans, sense, np.inf)
    at, missed = begun, 0
    if not found:
        turn, at, missed = sense * np.inf, NO_PIN, 1
    for k in range(number):
        if k != begun and firsts[k] - slacks[k] < sense * turn:
            other, found = exact(
                shape, linkage, facing, flanks, pins, around, crank, working[k], 0.0, leans, sense, sense * turn
            )  # fmt: skip
            if not found:
                missed += 1
            elif sense * other < sense * turn:
                turn, at = other, k
    if at == NO_PIN:
        return np.nan, NO_PIN
    if missed > 0:
        for k in range(number):
            if k == at or not firsts[k] - slacks[k] < sense * turn:
                continue
            _, found = exact(
                shape, linkage, facing, flanks, pins, around, crank, working[k], 0.0, leans, sense, np.inf
            )  # fmt: skip
            if not found and not (
                firsts[k] > sense * turn
                and clear(shape, linkage, throws, flanks, pins, around, crank, working[k], turn, leans)
            ):
                return np.nan, NO_PIN
    return turn, working[at]


@part
def near(
    shape: Any, linkage: Any, facing: Any, flanks: Any, pins: Any, around: Any, crank: Any, sense: float, screen: Any,
    number: int, turn: float, leans: Any,
) -> int:  # fmt: skip
    """Number of working pins with a gap of at most shape.deflection at a turn."""
    working, firsts, slacks, arms = screen
    count = 0
    for k in range(number):
        room = sense * turn - firsts[k] + shape.deflection / arms[k]
        if room > slacks[k]:
            count += 1
        elif room >= -slacks[k]:
            other, found = exact(
                shape, linkage, facing, flanks, pins, around, crank, working[k], shape.deflection, leans, sense, np.inf
            )  # fmt: skip
            if found and sense * other <= sense * turn:
                count += 1
    return count


@kernel(
    ContactShape,
    arrays="f8[::1], f8[:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,::1], "
    "f8[::1], f8[:,:,::1], i8[:,:,::1], i8[:,:,::1]",
)
def first_contacts(
    shape: Any, throws: Any, around: Any, linkage: Any, places: Any, radii: Any, lobe_pitch: Any, lobe_profile: Any,
    leans: Any, phis: Any, senses: Any, turns: Any, at: Any, counts: Any,
) -> None:  # fmt: skip
    """First contacts of trials at crank angles.

    Args:
        throws: directions of the cranks' throws (discs,) [rad].
        around: cosine and sine of the pins' azimuths (pins, 2).
        linkage: of the trials' discs (trials, discs, 10), see contact.linkage.
        places, radii: of pins (trials, pins, 2) and (trials, pins) [mm].
        lobe_pitch, lobe_profile: errors (trials, discs, lobes) [mm].
        leans: of the discs (trials, discs, 3): tau in the frame of a disc's holes, and half its width [mm].
        phis: crank angles (trials, positions) [rad].
        senses: +1 and -1 (senses,).
        turns: the carrier's, beyond -phi / Zc (trials, positions, senses) [rad]; written.
        at: the pin that touches, disc pins + pin; -1 where none was found; written.
        counts: working pins within shape.deflection of contact; written, where that is not below 0.
    """
    discs, count = throws.shape[0], around.shape[0]
    screen = (
        np.empty(discs * count, np.int64), np.empty(discs * count), np.empty(discs * count), np.empty(discs * count)
    )  # fmt: skip
    drifting, facing = np.empty(discs), np.empty((discs, 9))
    for disc in range(discs):
        facing[disc, 5], facing[disc, 6] = np.cos(throws[disc] / shape.lobes), -np.sin(throws[disc] / shape.lobes)
        facing[disc, 7], facing[disc, 8] = np.cos(throws[disc]), np.sin(throws[disc])
    arc = working_arc(shape)
    for i in range(phis.shape[0]):
        pins = (places[i], radii[i])
        flanks = (lobe_pitch[i], lobe_profile[i])
        for disc in range(discs):
            drifting[disc] = drift(shape, linkage[i, disc], throws[disc])
        for p in range(phis.shape[1]):
            crank = crank_at(shape, phis[i, p])
            for disc in range(discs):
                write_facing(shape, throws[disc], crank, facing[disc])
            for s in range(senses.shape[0]):
                number = 0
                for disc in range(discs):
                    own = (lobe_pitch[i, disc], lobe_profile[i, disc])
                    number = screened(
                        shape, linkage[i, disc], facing[disc], drifting[disc], own, pins, around, crank,
                        senses[s], arc, disc, leans[i, disc], screen, number,
                    )  # fmt: skip
                turn, place = first_of(
                    shape, linkage[i], throws, facing, flanks, pins, around, crank, senses[s], screen, number, leans[i]
                )  # fmt: skip
                turns[i, p, s] = turn
                at[i, p, s] = place
                if shape.deflection >= 0.0:
                    counts[i, p, s] = 0
                    if place != NO_PIN:
                        counts[i, p, s] = near(
                            shape, linkage[i], facing, flanks, pins, around, crank, senses[s], screen, number, turn,
                            leans[i],
                        )  # fmt: skip
