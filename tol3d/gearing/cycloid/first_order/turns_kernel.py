"""First-order turns of a cycloid stage, compiled over positions, trials and the pins that work; see linear.py.

Pins work by their nominal levers, so that their nominal numbers are those of a crank angle: where trials share their
angles, they are found once for all trials. The bend of the path of pin centres, which the analytic method neglects, may
be added to each pin's turn: kappa/2 times the square of the distance along the path from where the pin nominally is.
"""

from typing import Any, Final, NamedTuple

import numpy as np

from tol3d.numerics.compiled import kernel, part

NONE_COUNTED: Final = -1.0
NO_PIN: Final = -1
TURN: Final = 2.0 * np.pi


class LinearShape(NamedTuple):
    """Nominal numbers that the kernel reads [mm, rad]; counts are floats, too.

    Attributes:
        pins, lobes: Zp and Zc.
        eccentricity, pin_circle: a and rp.
        shift, offset, rotation: of the modification.
        least: lever of a working pin is more [mm].
        rolling: turns of the cranks in space per turn of the carrier.
        deflection: pins with at most this gap in contact are counted; below 0 for no count.
        bends: 1 where the bend of the path is added, 0 where it is neglected.
    """

    pins: float
    lobes: float
    eccentricity: float
    pin_circle: float
    shift: float
    offset: float
    rotation: float
    least: float
    rolling: float
    deflection: float
    bends: float


LEVER, NORMAL_X, NORMAL_Y, OUT, ROUND, CLEARANCE, SHIFTED, CURVATURE, WORKING = range(9)
"""Columns of the numbers of working pins: lever, normal in the world, the same seen from the pin, clearance, what the
shift moves the pin along the path by, and half the curvature of that; the last is their number."""


@part
def working_written(
    shape: Any, throws: Any, around: Any, phi: float, sense: float, pins: Any, numbers: Any
) -> int:  # fmt: skip
    """Write the pins that work at a crank angle, and their nominal numbers; how many they are.

    Args:
        throws, around, phi, sense: see first_order_turns.
        pins: disc, pin and lobe of each (discs pins, 3); written.
        numbers: see LEVER (discs pins, WORKING); written.
    """
    found, count = 0, around.shape[0]
    ratio = shape.eccentricity * shape.pins / shape.pin_circle
    circle = shape.pin_circle + shape.shift
    ground = shape.eccentricity * shape.pins / circle
    for d in range(throws.shape[0]):
        for j in range(count):
            u = TURN * j / shape.pins + (phi + throws[d]) / shape.lobes
            cos_t, sin_t = np.cos(shape.lobes * u), np.sin(shape.lobes * u)
            speed = np.sqrt(1.0 + ratio * (ratio - 2.0 * cos_t))
            lever = -shape.eccentricity * shape.lobes * sin_t / speed
            if not sense * lever > shape.least:
                continue
            out, aside = (1.0 - ratio * cos_t) / speed, -ratio * sin_t / speed
            ground_speed = np.sqrt(1.0 + ground * (ground - 2.0 * cos_t))
            bend = 1.0 + ground * (shape.pins * ground - (shape.pins + 1.0) * cos_t)
            lobe = np.floor(u * shape.lobes / TURN)
            pins[found, 0], pins[found, 1] = d, j
            pins[found, 2] = int(lobe - shape.lobes * np.floor(lobe / shape.lobes))
            numbers[found, LEVER] = lever
            numbers[found, NORMAL_X] = out * around[j, 0] - aside * around[j, 1]
            numbers[found, NORMAL_Y] = out * around[j, 1] + aside * around[j, 0]
            numbers[found, OUT], numbers[found, ROUND] = out, aside
            numbers[found, CLEARANCE] = shape.offset - shape.shift * out + shape.rotation * abs(lever)
            numbers[found, SHIFTED] = shape.shift * aside
            numbers[found, CURVATURE] = 0.5 * bend / (circle * ground_speed * ground_speed * ground_speed)
            found += 1
    return found


@part
def bent(
    shape: Any, around: Any, throw: Any, pin: Any, off: Any, numbers: Any, moved: Any, turn: float, pitch: float
) -> float:
    """Contribution of the bend of the path to a pin's turn [rad].

    Args:
        around: cosine and sine of the pin's azimuth.
        throw: cosine and sine of the disc's throw in the world.
        pin, off: the pin's displacement outwards and counter-clockwise [mm].
        moved: the disc's displacement (x, y) and its turn.
        turn, pitch: the pin's turn without it, and the lobe's pitch error [rad].
    """
    c, s = around
    x, y = pin * c - off * s - moved[0], pin * s + off * c - moved[1]
    throw_x, throw_y = shape.eccentricity * throw[0], shape.eccentricity * throw[1]
    whole = turn + moved[2] + pitch
    x += turn * shape.rolling * throw_y + whole * (shape.pin_circle * s - throw_y)
    y -= turn * shape.rolling * throw_x + whole * (shape.pin_circle * c - throw_x)
    along = numbers[NORMAL_X] * y - numbers[NORMAL_Y] * x + numbers[SHIFTED]
    found: float = numbers[CURVATURE] * along * along / (numbers[LEVER] * (1.0 + shape.rolling / shape.lobes))
    return found


@kernel(
    LinearShape,
    arrays="f8[::1], f8[:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,::1], "
    "f8, f8[:,::1], i8[:,::1], i8[:,::1]",
)
def first_order_turns(
    shape: Any, throws: Any, around: Any, placed: Any, places: Any, radii: Any, lobe_pitch: Any, lobe_profile: Any,
    aside: Any, phis: Any, sense: float, turns: Any, at: Any, counts: Any,
) -> None:  # fmt: skip
    """Turns of the carrier at which the first working pin makes contact; see LinearStage.touches.

    Args:
        throws: directions of the cranks' throws (discs,) [rad].
        around: cosine and sine of the pins' azimuths (pins, 2).
        placed: of the trials' discs (trials, discs, 7), see LinearStage.placed.
        places, radii: of pins, errors (trials, pins, 2) and (trials, pins) [mm].
        lobe_pitch, lobe_profile: errors (trials, discs, lobes) [mm].
        aside: tilts of discs times half their width (trials, discs, 2) [mm].
        phis: crank angles (trials, positions), or (1, positions) that are those of every trial [rad].
        sense: 1 counter-clockwise, -1 back.
        turns: of the carrier (trials, positions) [rad]; written, not a number where no pin works.
        at: the pin that touches, disc pins + pin; -1 where none works; written.
        counts: working pins within shape.deflection of contact; written, where that is not below 0.
    """
    discs, count = throws.shape[0], around.shape[0]
    pins, numbers = np.empty((discs * count, 3), np.int64), np.empty((discs * count, WORKING))
    allowed, moved, swung = np.empty(discs * count), np.empty((discs, 3)), np.empty((discs, 2))
    giving = 1.0 + shape.rolling / shape.lobes
    pitch_share = shape.pins / (shape.lobes * shape.pin_circle)
    for row in range(phis.shape[0]):
        first, last = (0, turns.shape[0]) if phis.shape[0] == 1 else (row, row + 1)
        for p in range(phis.shape[1]):
            phi = phis[row, p]
            number = working_written(shape, throws, around, phi, sense, pins, numbers)
            cos_phi, sin_phi = np.cos(phi), np.sin(phi)
            cos_chi, sin_chi = np.cos(phi / shape.lobes), -np.sin(phi / shape.lobes)
            cos_psi, sin_psi = cos_phi * cos_chi + sin_phi * sin_chi, sin_phi * cos_chi - cos_phi * sin_chi
            for d in range(discs):
                swung[d, 0], swung[d, 1] = np.cos(phi + throws[d]), np.sin(phi + throws[d])
            for i in range(first, last):
                for d in range(discs):
                    own = placed[i, d]
                    moved[d, 0] = cos_chi * own[0] - sin_chi * own[1] + cos_phi * own[2] - sin_phi * own[3]
                    moved[d, 1] = sin_chi * own[0] + cos_chi * own[1] + sin_phi * own[2] + cos_phi * own[3]
                    moved[d, 2] = own[4] + sin_psi * own[5] + cos_psi * own[6]
                best, begun = np.inf, NO_PIN
                for k in range(number):
                    d, j, lobe = pins[k, 0], pins[k, 1], pins[k, 2]
                    n_x, n_y = numbers[k, NORMAL_X], numbers[k, NORMAL_Y]
                    gap = numbers[k, CLEARANCE] - radii[i, j] - lobe_profile[i, d, lobe]
                    gap += numbers[k, OUT] * places[i, j, 0] + numbers[k, ROUND] * places[i, j, 1]
                    gap -= n_x * moved[d, 0] + n_y * moved[d, 1]
                    tilt_x = -sin_chi * aside[i, d, 0] - cos_chi * aside[i, d, 1]
                    tilt_y = cos_chi * aside[i, d, 0] - sin_chi * aside[i, d, 1]
                    gap -= abs(n_x * tilt_x + n_y * tilt_y)
                    pitch = pitch_share * lobe_pitch[i, d, lobe]
                    turn = (gap / numbers[k, LEVER] - moved[d, 2] - pitch) / giving
                    if shape.bends > 0.0:
                        turn += bent(
                            shape, (around[j, 0], around[j, 1]), (swung[d, 0], swung[d, 1]), places[i, j, 0],
                            places[i, j, 1], numbers[k], (moved[d, 0], moved[d, 1], moved[d, 2]), turn, pitch,
                        )  # fmt: skip
                    allowed[k] = turn
                    if sense * turn < best:
                        best, begun = sense * turn, k
                turns[i, p] = sense * best if begun != NO_PIN else np.nan
                at[i, p] = pins[begun, 0] * count + pins[begun, 1] if begun != NO_PIN else NO_PIN
                if shape.deflection >= 0.0:
                    counts[i, p] = 0
                    for k in range(number):
                        closing = (allowed[k] - turns[i, p]) * numbers[k, LEVER] * giving
                        counts[i, p] += abs(closing) <= shape.deflection
