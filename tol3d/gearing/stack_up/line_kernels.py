"""The compiled half of tooth_pairs.py for helical gears: loss by deviating flanks along contact lines, row by row.

Every slice across the axes at a height z is a spur pair, its driver's tooth turned by kappa_1 z: what tooth_kernels.py
has of a spur pair holds in each. A pair loses as much as the slice of the common face that loses most: one at an end of
its contact line, along which levels, slopes and leans are straight, or a little beyond, where a tip edge has only
begun to leave its mate. Forms of profiles are not among them. All lengths here are transverse, along the line of
action.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from tol3d.gearing.stack_up.tooth_kernels import (
    ARRAYS,
    BY_DRIVEN,
    BY_DRIVER,
    Flank,
    GearTeeth,
    Integers,
    LineOfContact,
    TeethInRing,
    look_at,
    losses_by,
    sense_of,
    shifted,
    take,
    taken_by,
)
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import QUICK, Kernel, part, variant

BEYOND = 0.0025  # rad of roll; through slices one and two of it beyond an end of a contact line goes a parabola
FURTHEST = 16.0  # times as far its top is looked for


class ContactLine(NamedTuple):
    """Contact lines of a mesh.

    Args:
        tangent: length of the common tangent of both base circles [mm].
        start: roll of a driver's tooth at the line of centres [rad], at z = 0.
        pitch: angular pitch of the driver [rad].
        half: half width of the common face [mm].
        twist: kappa_1, by which the driver's section is turned per height [rad/mm].
        fall: by how much less a lean opens per length from the pitch point along the line of action [1/mm], of its
            opening at the upper end of the face; on the driver's right flanks.
        pitch_roll: roll of the driver at the pitch point [rad].
        square: cos(beta_b)^2.
        up: h_1 sin(beta_b) cos(beta_b), by which a foot on the mate lies higher per gap of the driver's right flanks.
        higher: how much higher than a point its foot lies on the mate [mm], as one gear stands lower.
    """

    tangent: float
    start: float
    pitch: float
    half: float
    twist: float
    fall: float
    pitch_roll: float
    square: float
    up: float
    higher: float = 0.0


class Row(NamedTuple):
    """A pair in a row.

    Args:
        side: 1 if the driver's right flanks touch, -1 if its left ones do.
        roll, mate_roll: of driver and driven at z = 0 [rad].
        lean: loss by tilted axes at the upper end of the face in the pitch point [mm].
        by_height: change per height by tilted axes of the driver's and of the driven's roll [rad/mm], and of the
            tangent of both base circles.
        aside: lean of the driven axis across the line of action, outwards from the driver's.
        strain: of the driven gear less that of the driver.
        up: by how much higher a point's foot lies on the mate than the point [mm]: where a gap is read, or one gear
            stands lower.
    """

    side: float
    roll: float
    mate_roll: float
    lean: float
    by_height: tuple[float, float, float]
    aside: float
    strain: float
    up: float


@part
def outside_of(driver: Any, driven: Any) -> float:
    """1 of two external gears, -1 of a gear in a ring."""
    return sense_of(driver) * sense_of(driven)


@part
def face_of(driver: GearTeeth, driven: GearTeeth, row: Row) -> tuple[float, float]:
    """The heights on the driver's face [mm] between which its points have their feet on the mate's."""
    half, mate_half = 0.5 * driver.face, 0.5 * driven.face
    return max(-half, -mate_half - row.up), min(half, mate_half - row.up)


@part
def in_slice(
    driver: GearTeeth, driven: GearTeeth, line: ContactLine, flank: Flank, mating: Flank, row: Row, z: float
) -> float:
    """Loss by a pair in the slice at a height [mm]."""
    on = -row.side * line.twist * z
    roll, mate_roll = row.roll + on, row.mate_roll - on * driver.base / driven.base
    along = driver.base * (roll - line.pitch_roll)
    roll, mate_roll = roll + row.by_height[0] * z, mate_roll + row.by_height[1] * z
    flat = LineOfContact(line.tangent + row.by_height[2] * z, line.start, line.pitch, 0.0)
    loss = taken_by(driver, driven, flat, flank, mating, (roll, mate_roll), 0.0)
    loss += flank.helix / driver.face * z + mating.helix / driven.face * (z + row.up)
    if row.lean != 0.0:
        loss += row.lean * (z / line.half - row.side * line.fall * along)
    if row.aside != 0.0:  # an edge beyond the line of action touches where the lean has moved its mate along the axis
        edge = driver.base * driver.tip * max(roll - driver.tip, 0.0)
        edge -= outside_of(driver, driven) * driven.base * driven.tip * max(mate_roll - driven.tip, 0.0)
        loss -= row.side * line.fall * line.half * row.aside * edge
    if row.strain != 0.0:  # base pitches differ: a pair is the later the further it lies from the pitch point
        loss -= row.strain * driver.base * (row.roll - line.pitch_roll)
    return loss


@part
def top(left: float, middle: float, right: float) -> float:
    """Place of the top of the parabola through three values at -1, 0 and 1; 0 where it has none."""
    bow = left - 2.0 * middle + right
    return 0.5 * (left - right) / bow if bow < 0.0 else 0.0


@part
def most_beyond(
    driver: GearTeeth,
    driven: GearTeeth,
    line: ContactLine,
    flank: Flank,
    mating: Flank,
    row: Row,
    end: float,
    way: float,
) -> float:
    """Largest loss by a pair `way` [mm] beyond an end of its contact line, about; -inf where the face ends."""
    low, high = face_of(driver, driven, row)
    room = (high if way > 0.0 else low) - end
    if not low <= end + 2.0 * way <= high:
        way = 0.5 * room
    if way == 0.0:
        return -math.inf
    at_end = in_slice(driver, driven, line, flank, mating, row, end)
    near = in_slice(driver, driven, line, flank, mating, row, end + way)
    far = in_slice(driver, driven, line, flank, mating, row, end + 2.0 * way)
    steps = min(max(1.0 + top(at_end, near, far), 0.0), min(room / way, FURTHEST))
    return in_slice(driver, driven, line, flank, mating, row, end + steps * way)


@part
def most_on_line(
    driver: GearTeeth, driven: GearTeeth, line: ContactLine, flank: Flank, mating: Flank, row: Row
) -> float:
    """Loss by a pair in the slice that loses most [mm]."""
    per_roll = 1.0 / (row.side * line.twist)
    first = (row.roll - driver.tip) / (row.side * line.twist - row.by_height[0])
    by_height = row.side * line.twist * driver.base / driven.base + row.by_height[1]
    last = (driven.tip - row.mate_roll) / by_height
    lower, upper = face_of(driver, driven, row)
    low, high = max(lower, min(first, last)), min(upper, max(first, last))
    way = BEYOND * abs(per_roll)
    if low > high:  # no line: the tip edges are nearest to it at an end of the face
        end = upper if low >= upper else lower
        loss = in_slice(driver, driven, line, flank, mating, row, end)
        return max(loss, most_beyond(driver, driven, line, flank, mating, row, end, -math.copysign(way, end)))
    most = in_slice(driver, driven, line, flank, mating, row, low)
    most = max(most, in_slice(driver, driven, line, flank, mating, row, high))
    most = max(most, most_beyond(driver, driven, line, flank, mating, row, low, -way))
    return max(most, most_beyond(driver, driven, line, flank, mating, row, high, way))


@variant(shifted, ContactLine)
def shifted_lines(line: ContactLine, shifts: Array, row: int) -> ContactLine:
    """Twist and lean stay."""
    start, tangent, higher = line.start + shifts[row, 0], line.tangent + shifts[row, 1], line.higher - shifts[row, 2]
    return ContactLine(
        tangent, start, line.pitch, line.half, line.twist, line.fall, line.pitch_roll, line.square, line.up, higher
    )


@variant(look_at, ContactLine)
def look_along(
    line: ContactLine,
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
    """All pairs are iterated: the contact line moves with the roll."""
    side, up = which[0], line.higher
    roll = line.start - side * azimuth
    mate_roll = (line.tangent - driver.base * roll) / driven.base
    if which[1] == BY_DRIVEN:
        mate_roll -= took / driven.base
    elif which[1] == BY_DRIVER:
        mate_roll -= apart / driven.base
        roll += (apart - took) / driver.base
    else:  # the foot is not in the slice of its point
        mate_roll -= (took + line.square * (apart - took)) / driven.base
        up = line.higher + side * line.up * (apart - took)
    # of the mate's turn there remains in a slice what its lean does not take
    leant, by_roll, by_tangent = lean[trial, 0], lean[trial, 2], lean[trial, 3]
    mate_roll -= leant * side * line.fall * driver.base * (roll - line.pitch_roll) / driven.base
    by_mate = leant / (line.half * line.square) + by_tangent - driver.base * by_roll
    by_height = (by_roll, by_mate / driven.base, by_tangent)
    row = Row(float(side), roll, mate_roll, leant, by_height, lean[trial, 4], lean[trial, 1], up)
    return most_on_line(driver, driven, line, pair[0], pair[1], row), True


take_on_lines = Kernel(take, (GearTeeth, GearTeeth, ContactLine), ARRAYS, level=QUICK)
take_in_rings = Kernel(take, (TeethInRing, TeethInRing, ContactLine), ARRAYS, level=QUICK)


def taken(
    mesh: tuple[Sequence[float], Sequence[float], Sequence[float]],
    how: Sequence[int],
    built: tuple[Array, Array, Integers],
    rows: tuple[Integers, Array, Array, Array, Array],
) -> Array:
    """Loss of backlash by the flanks of a side in the transverse section [mm], (rows,); as tooth_kernels.taken."""
    if len(mesh[0]) > len(GearTeeth._fields):
        return losses_by(take_in_rings, (TeethInRing, ContactLine), mesh, how, built, rows)
    return losses_by(take_on_lines, (GearTeeth, ContactLine), mesh, how, built, rows)
