"""The compiled half of tooth_pairs.py for helical gears: loss by deviating flanks along contact lines, row by row.

Every slice across the axes at a height z is a spur pair, its driver's tooth turned by kappa_1 z: what tooth_kernels.py
has of a spur pair holds in each. A pair loses as much as the slice of the common face that loses most: one at an end of
its contact line, along which levels, slopes and leans are straight, or a little beyond, where a tip edge has only
begun to leave its mate. Forms of profiles are not among them. All lengths here are transverse, along the line of
action.
"""

import math
from functools import partial
from typing import NamedTuple

from tol3d.gearing.stack_up.tooth_kernels import (
    ARRAYS,
    BY_DRIVEN,
    BY_DRIVER,
    Flank,
    GearTeeth,
    Integers,
    LineOfContact,
    look_at,
    losses_by,
    shifted,
    take,
    taken_by,
)
from tol3d.numerics.compiled import QUICK, Kernel, part, variant

BEYOND = 0.02  # rad of roll; through slices one and two of it beyond an end of a contact line goes a parabola


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


class Row(NamedTuple):
    """A pair in a row.

    Args:
        side: 1 if the driver's right flanks touch, -1 if its left ones do.
        roll, mate_roll: of driver and driven at z = 0 [rad].
        lean: loss by tilted axes at the upper end of the face in the pitch point [mm].
        strain: of the driven gear less that of the driver.
        up: by how much higher a point's foot lies on the mate than the point [mm], where a gap is read.
    """

    side: float
    roll: float
    mate_roll: float
    lean: float
    strain: float
    up: float


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
    flat = LineOfContact(line.tangent, line.start, line.pitch, 0.0)
    loss = taken_by(driver, driven, flat, flank, mating, (roll, mate_roll), 0.0)
    loss += flank.helix / driver.face * z + mating.helix / driven.face * (z + row.up)
    if row.lean != 0.0:
        along = driver.base * (roll - line.pitch_roll)
        loss += row.lean * (z / line.half - row.side * line.fall * along)
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
    if not low <= end + 2.0 * way <= high:
        way = 0.5 * ((high if way > 0.0 else low) - end)
    if way == 0.0:
        return -math.inf
    at_end = in_slice(driver, driven, line, flank, mating, row, end)
    near = in_slice(driver, driven, line, flank, mating, row, end + way)
    far = in_slice(driver, driven, line, flank, mating, row, end + 2.0 * way)
    share = min(max(top(at_end, near, far), -1.0), 1.0)
    return in_slice(driver, driven, line, flank, mating, row, end + (1.0 + share) * way)


@part
def most_on_line(
    driver: GearTeeth, driven: GearTeeth, line: ContactLine, flank: Flank, mating: Flank, row: Row
) -> float:
    """Loss by a pair in the slice that loses most [mm]."""
    per_roll = 1.0 / (row.side * line.twist)
    first = (row.roll - driver.tip) * per_roll
    last = (driven.tip - row.mate_roll) * driven.base / driver.base * per_roll
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
def shifted_lines(line: ContactLine, roll: float, tangent: float) -> ContactLine:
    """Twist and lean stay."""
    start, tangent = line.start + roll, line.tangent + tangent
    return ContactLine(
        tangent, start, line.pitch, line.half, line.twist, line.fall, line.pitch_roll, line.square, line.up
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
    lean: tuple[float, float],
    took: float,
) -> tuple[float, bool]:
    """All pairs are iterated: the contact line moves with the roll."""
    side = which[0]
    roll, up = line.start - side * azimuth, 0.0
    mate_roll = (line.tangent - driver.base * roll) / driven.base
    if which[1] == BY_DRIVEN:
        mate_roll -= took / driven.base
    elif which[1] == BY_DRIVER:
        mate_roll -= apart / driven.base
        roll += (apart - took) / driver.base
    else:  # the foot is not in the slice of its point
        mate_roll -= line.square * apart / driven.base
        up = side * line.up * apart
    row = Row(float(side), roll, mate_roll, lean[0], lean[1], up)
    return most_on_line(driver, driven, line, pair[0], pair[1], row), True


take_on_lines = Kernel(take, (GearTeeth, GearTeeth, ContactLine), ARRAYS, level=QUICK)
taken = partial(losses_by, take_on_lines, ContactLine)
"""Loss of backlash by the flanks of a side in the transverse section [mm], (rows,)."""
