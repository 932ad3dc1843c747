"""The compiled half of tooth_pairs.py: loss of backlash by deviating flanks of a mesh, row by row.

Formulas are those of the stack-up, independent of poses and kernels of the exact engine.
"""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.effects import FORM, HELIX, SHAPES, SLOPE, UNIFORM
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import QUICK, Kernel, part, variant
from tol3d.numerics.quick_angles import cos_and_sin

Integers = NDArray[np.int64]

FAR = 0.1  # mm; a pair whose loss is smaller by more than this is not iterated: it cannot become the largest
AGAIN = 2.0  # times the change by an iteration is more than all further ones together
LOOKS = 3  # iterations of pairs; each changes an edge's loss by a twentieth of the previous change
LEAST_ROLL = 1e-3  # rad; nearer to the base circle the radius of curvature of an involute is too small
BY_NONE, BY_DRIVEN, BY_DRIVER = 0, 1, 2  # gear that turns until a side touches; none if its gap is read


class GearTeeth(NamedTuple):
    """Nominal flanks of a gear.

    Args:
        base: base radius [mm].
        form, tip: rolls at which flanks begin and end [rad].
        face: width of the face [mm].
        wave_rate, wave_middle: phase of the form's waves per roll [1], and the roll at which it is 0 [rad]; a rate of
            0 is a barrel, see FlankDeviation in effects.py.
    """

    base: float
    form: float
    tip: float
    face: float
    wave_rate: float
    wave_middle: float


class TeethInRing(NamedTuple):
    """Nominal flanks of a gear of an internal pair; all rolls count times its sense, from root to tip.

    Args:
        base ... wave_middle: as of GearTeeth.
        sense: 1 of the inner gear, -1 of the ring.
    """

    base: float
    form: float
    tip: float
    face: float
    wave_rate: float
    wave_middle: float
    sense: float


def sense_of(gear: Any) -> float:
    """1 of an external gear, -1 of a ring; one variant a kind."""
    raise NotImplementedError


@variant(sense_of, GearTeeth)
def external_sense(gear: GearTeeth) -> float:
    """Rolls count as they are."""
    return 1.0


@variant(sense_of, TeethInRing)
def sense_in_ring(gear: TeethInRing) -> float:
    """Its own."""
    return gear.sense


class LineOfContact(NamedTuple):
    """Line of contact of a mesh's pairs.

    Args:
        tangent: length of the common tangent of both base circles [mm]; of an internal pair negative.
        start: roll of a driver's tooth at the line of centres [rad].
        pitch: angular pitch of the driver [rad].
        half: half width of the face that is read [mm]; 0 for a section.
    """

    tangent: float
    start: float
    pitch: float
    half: float


class Flank(NamedTuple):
    """Deviations of a flank [mm]: uniform, slope of the profile, its form, and helix along the face."""

    uniform: float
    slope: float
    form: float
    helix: float


def shifted(line: Any, shifts: Array, row: int) -> Any:
    """The line by the shifts of a row, as in `take`; one variant a kind."""
    raise NotImplementedError


def look_at(
    line: Any,
    driver: GearTeeth,
    driven: GearTeeth,
    which: Integers,
    pair: tuple[Flank, Flank],
    azimuth: float,
    apart: float,
    lean: Array,
    trial: int,
    took: float,
) -> tuple[float, bool]:
    """Loss by a pair [mm] after the turning gear has turned by the loss `took`; and True if another turn changes it.

    One variant a kind of line.

    Args:
        line, driver, driven, which: as in `take`.
        pair: flanks of driver and driven.
        azimuth: of the driver's tooth [rad].
        apart: as in `take`, of the row.
        lean, trial: as in `take`, and the trial of the row.
        took: loss by the previous iteration [mm]; 0 before the first.
    """
    raise NotImplementedError


@part
def flank_in(numbers: Array, trial: int, tooth: int, teeth: int, side: int) -> Flank:
    """Deviations of a flank in a trial, from `numbers` (trials, coefficients), without columns if none deviates.

    The tooth may be up to a turn below 0 or above `teeth`.
    """
    if numbers.shape[1] == 0:
        return Flank(0.0, 0.0, 0.0, 0.0)
    place = tooth + teeth if tooth < 0 else (tooth - teeth if tooth >= teeth else tooth)
    slot = SHAPES * (2 * place + side)
    row = numbers[trial]
    return Flank(row[slot + UNIFORM], row[slot + SLOPE], row[slot + FORM], row[slot + HELIX])


@part
def profile_at(gear: GearTeeth, flank: Flank, roll: float) -> tuple[float, float]:
    """Offset of a flank in the middle of the face [mm] at a roll [rad], and its change per roll [mm/rad]."""
    if flank.slope == 0.0 and flank.form == 0.0:
        return flank.uniform, 0.0
    length = gear.tip - gear.form
    inside = min(max(roll, gear.form), gear.tip)
    u = (inside - 0.5 * (gear.form + gear.tip)) / length
    out, by_place = flank.uniform + flank.slope * u, flank.slope
    if flank.form != 0.0:
        if gear.wave_rate == 0.0:
            out += flank.form * (1.0 / 3.0 - 4.0 * u * u)
            by_place -= 8.0 * flank.form * u
        else:
            cos, sin = cos_and_sin(gear.wave_rate * (inside - gear.wave_middle))
            out += 0.5 * flank.form * cos
            by_place -= 0.5 * flank.form * gear.wave_rate * length * sin
    return out, by_place / length


@part
def met(gear: GearTeeth, mate: GearTeeth, roll: float, mate_roll: float) -> float:
    """Roll at which a flank meets the mate's tip edge, d [rad] beyond its end: an arc rho d further on.

    An arc v of an involute from roll t ends at roll sqrt(t^2 + 2 v/r_b), of a ring's towards its tip at less.
    """
    sense, arc = sense_of(gear), sense_of(mate) * mate.base * mate.tip * (mate_roll - mate.tip)
    begin = max(sense * roll, 0.0)
    return sense * math.sqrt(max(begin * begin + sense * 2.0 * arc / gear.base, 0.0))


@part
def gone(gear: GearTeeth, mate: GearTeeth, roll: float, tangent: float) -> float:
    """Distance of a gear's tip edge from its mate's flank [mm], if its pair lies beyond the path of contact.

    The edge lies r_b (e(d) + t_tip n(d)) off its gear's axis: e points to the contact of the common tangent with the
    gear's base circle, n along that tangent, both turned by d = t - t_tip. The tangent from the edge to the mate's base
    circle has length L and touches it th further on, so that the mate's flank is L - r_bm (t_m - th) away. In an
    internal pair both circles lie on one side of the tangent, and a ring's edge turns the other way.
    """
    beyond, base, mate_base = roll - gear.tip, gear.base, mate.base
    sense, outside = sense_of(mate), sense_of(gear) * sense_of(mate)
    cos, sin = cos_and_sin(beyond)
    x = outside * (base + outside * mate_base - base * (cos - gear.tip * sin))
    y = sense * (tangent - base * (sin + gear.tip * cos))
    length = math.sqrt(max(x * x + y * y - mate_base * mate_base, 0.0))
    further = math.atan2(y * mate_base - x * length, x * mate_base + y * length)
    return sense * length - (tangent - base * (gear.tip + beyond)) + sense * mate_base * further


@part
def aside(
    driver: GearTeeth, driven: GearTeeth, slope: float, mate_slope: float, roll: float, mate_roll: float
) -> float:
    """Additional loss by a pair whose flanks slope and so touch beside the line of action [mm]; slopes [mm/rad].

    As the driver's point rolls on by dt, the foot on the mate rolls back by rho_1/rho_2 dt, and both flanks curve away
    by b dt^2/2, b = rho_1^2 (1/rho_1 + 1/rho_2), a ring's radius negative: with a slope g they touch g/b further on and
    lose g^2/(2 b) more, or less if a flank ends before. Beyond the path of contact the way of an edge beyond its end
    counts, too.
    """
    if slope == 0.0 and mate_slope == 0.0:
        return 0.0
    sense, mate_sense = sense_of(driver), sense_of(driven)
    inside = min(max(roll, driver.form, sense * max(sense * roll, LEAST_ROLL)), driver.tip)
    mate_inside = min(max(mate_roll, driven.form, mate_sense * max(mate_sense * mate_roll, LEAST_ROLL)), driven.tip)
    rho, mate_rho = sense * driver.base * inside, mate_sense * driven.base * mate_inside
    back, bend = rho / mate_rho, rho * (mate_sense * rho + sense * mate_rho) / mate_rho
    steep = slope - mate_slope * back
    if steep == 0.0:
        return 0.0
    steep += bend * (max(roll - driver.tip, 0.0) - max(mate_roll - driven.tip, 0.0) / back)
    low = max(driver.form - inside, (mate_inside - driven.tip) / back)
    high = min(driver.tip - inside, (mate_inside - driven.form) / back)
    on = min(max(steep / bend, low), high)
    return steep * on - 0.5 * bend * on * on


@part
def taken_by(
    driver: GearTeeth,
    driven: GearTeeth,
    line: LineOfContact,
    flank: Flank,
    mating: Flank,
    rolls: tuple[float, float],
    lean: float,
) -> float:
    """Loss by a pair at some rolls [rad], less the distance of its edges from their mates [mm]."""
    roll, mate_roll = rolls
    out, slope = profile_at(driver, flank, roll)
    mate_out, mate_slope = profile_at(driven, mating, mate_roll)
    more = aside(driver, driven, slope, mate_slope, roll, mate_roll)
    if line.half > 0.0:
        more += abs((flank.helix / driver.face + mating.helix / driven.face) * line.half + lean)
    if mate_roll > driven.tip:
        out, _ = profile_at(driver, flank, met(driver, driven, roll, mate_roll))
        more -= gone(driven, driver, mate_roll, line.tangent)
    if roll > driver.tip:
        mate_out, _ = profile_at(driven, mating, met(driven, driver, mate_roll, roll))
        more -= gone(driver, driven, roll, line.tangent)
    return out + mate_out + more


@part
def changes(driver: GearTeeth, driven: GearTeeth, flank: Flank, mating: Flank, rolls: tuple[float, float]) -> bool:
    """True if a pair's loss depends on its rolls: a flank has a slope or a form, or an edge touches."""
    if flank.slope != 0.0 or flank.form != 0.0 or mating.slope != 0.0 or mating.form != 0.0:
        return True
    return rolls[0] > driver.tip or rolls[1] > driven.tip


@variant(shifted, LineOfContact)
def shifted_line(line: LineOfContact, shifts: Array, row: int) -> LineOfContact:
    """Half the face stays."""
    return LineOfContact(line.tangent + shifts[row, 1], line.start + shifts[row, 0], line.pitch, line.half)


@variant(look_at, LineOfContact)
def look_at_pair(
    line: LineOfContact,
    driver: GearTeeth,
    driven: GearTeeth,
    which: Integers,
    pair: tuple[Flank, Flank],
    azimuth: float,
    apart: float,
    lean: Array,
    trial: int,
    took: float,
) -> tuple[float, bool]:
    """Pairs whose loss does not depend on their rolls are not iterated."""
    roll = line.start - which[0] * azimuth
    mate_roll = (line.tangent - driver.base * roll) / driven.base
    if which[1] == BY_DRIVEN:
        mate_roll -= took / driven.base
    else:
        mate_roll -= apart / driven.base
        if which[1] == BY_DRIVER:
            roll += (apart - took) / driver.base
    rolls = (roll, mate_roll)
    loss = taken_by(driver, driven, line, pair[0], pair[1], rolls, lean[trial, 0])
    return loss, changes(driver, driven, pair[0], pair[1], rolls)


def take(
    driver: Any,
    driven: Any,
    line: Any,
    which: Integers,
    numbers: Array,
    mating_numbers: Array,
    trial: Integers,
    first: Integers,
    angles: Array,
    lean: Array,
    apart: Array,
    shifts: Array,
    losses: Array,
) -> None:
    """Compute the loss of backlash by the flanks of a side.

    Args:
        driver, driven, line: the mesh.
        which: side, 1 if the driver's right flanks touch, -1 if its left ones do; the gear that turns, see BY_NONE;
            number of pairs that may touch; teeth by which tooth 0 of driver, and of driven, is ahead of the mesh's
            tooth 0; numbers of teeth of driver and driven.
        numbers, mating_numbers: deviations of the flanks of driver and driven, (trials, teeth x 2 x SHAPES) [mm], of
            each tooth right flanks first; no columns if none deviates.
        trial: (rows,), trial of each row.
        first: (rows,), the driver's first tooth that may touch, as the mesh counts; the others follow against `side`.
        angles: (rows,), of the driver [rad].
        lean: (trials, 1), or of a ContactLine (trials, 5), as ToothPairs.taken has them.
        apart: (rows,), gap of the side before [mm]; no rows if it touches already.
        shifts: (rows, 2), additional roll of a driver's tooth at the line of centres [rad], and additional length of
            the common tangent [mm]; of a ContactLine (rows, 3), with the driven teeth's shift along the axes [mm]; no
            rows if axes are at their nominal places.
        losses: (rows,) [mm], written; positive where the side touches earlier.
    """
    side, count, right = which[0], which[2], 0 if which[0] == 1 else 1
    took, moved, again = np.empty(count), np.empty(count), np.empty(count, dtype=np.bool_)
    in_ring = sense_of(driver) * sense_of(driven) < 0.0
    mate_right, step = (1 - right, -side) if in_ring else (right, side)
    for row in range(len(losses)):
        number, open_by, most = trial[row], apart[row] if len(apart) else 0.0, 0.0
        place, mate_place = (first[row] - which[3]) % which[5], (-first[row] - right - which[4]) % which[6]
        if in_ring:
            mate_place = (first[row] - mate_right - which[4]) % which[6]
        again[:] = True
        took[:] = 0.0
        moved_line = line
        if len(shifts):
            moved_line = shifted(line, shifts, row)
        for _ in range(LOOKS):  # a gear turned by its pair's loss is at another roll
            for k in range(count):
                if again[k]:
                    flank = flank_in(numbers, number, place - side * k, which[5], right)
                    mating = flank_in(mating_numbers, number, mate_place + step * k, which[6], mate_right)
                    azimuth = angles[row] + (first[row] - side * k) * line.pitch
                    pair, before = (flank, mating), took[k]
                    took[k], again[k] = look_at(
                        moved_line, driver, driven, which, pair, azimuth, open_by, lean, number, before
                    )
                    moved[k] = min(AGAIN * abs(took[k] - before), FAR)
            most, looks = took.max(), False
            for k in range(count):
                again[k] = again[k] and took[k] > most - moved[k]
                looks = looks or again[k]
            if not looks:
                break
        losses[row] = most


ARRAYS = (
    "int64[::1], float64[:, ::1], float64[:, ::1], int64[::1], int64[::1], float64[::1], float64[:, ::1], "
    "float64[::1], float64[:, ::1], float64[::1]"
)


def losses_by(
    kernel: Kernel,
    kinds: tuple[Callable[..., Any], Callable[..., Any]],
    mesh: tuple[Sequence[float], Sequence[float], Sequence[float]],
    how: Sequence[int],
    built: tuple[Array, Array, Integers],
    rows: tuple[Integers, Array, Array, Array, Array],
) -> Array:
    """Loss of backlash by the flanks of a side [mm], (rows,).

    Args:
        kernel, kinds: `take` for kinds of teeth and line, and these.
        mesh: numbers of driver, driven and line; see the kinds.
        how: `which` of `take`.
        built: deviations of both gears' flanks, and the trial of each row, as in `take`.
        rows: first, angles, lean, apart and shifts, as in `take`.
    """
    losses = np.empty(len(rows[0]))
    each = (np.require(row, requirements=["C", "W"]) for row in rows)
    driver, driven, line = kinds[0](*mesh[0]), kinds[0](*mesh[1]), kinds[1](*mesh[2])
    kernel(driver, driven, line, np.array(how), *built, *each, losses)
    return losses


take_on_line = Kernel(take, (GearTeeth, GearTeeth, LineOfContact), ARRAYS, level=QUICK)
taken = partial(losses_by, take_on_line, (GearTeeth, LineOfContact))
