"""Rows of builds through the contact: the loops that every kind of pair has in common."""

import math

import numpy as np

from tol3d.engines.exact.compiled import part
from tol3d.engines.exact.foot import grown, section
from tol3d.engines.exact.nearest import SHARP_FALL, nearest
from tol3d.engines.exact.numbers import PairNumbers, Pose
from tol3d.engines.exact.seating import (
    FREE,
    INTERFERING,
    OUT_OF_RANGE,
    SEATED,
    WITHOUT_CONTACT,
    Build,
    closed,
    driver_turn,
    look,
    pose_at,
    turned,
)

DRIVEN_ANGLE, GAP, DRIVEN_TURN, DRIVER_TURN, CONTACT = 0, 1, 2, 3, 4
READINGS = 7  # columns of what is read of a row: the four above, and the contact's x, y, z


@part
def pair_numbers(numbers):
    """PairNumbers from an array."""
    return PairNumbers(
        numbers[0],
        numbers[1],
        numbers[2],
        numbers[3],
        numbers[4],
        numbers[5],
        numbers[6],
        numbers[7],
        numbers[8],
        numbers[9],
        numbers[10],
        numbers[11],
    )


@part
def build_of(shafts, centre, flank_turn, flank_offset, row, driver, driven):
    """The Build of a row: the driven shaft's frame sees the driver's."""
    a, b = shafts[row, driver], shafts[row, driven]
    x, y, z = a[0, 3] - b[0, 3], a[1, 3] - b[1, 3], a[2, 3] - b[2, 3]
    pose = Pose(
        b[0, 0] * a[0, 0] + b[1, 0] * a[1, 0] + b[2, 0] * a[2, 0],
        b[0, 0] * a[0, 1] + b[1, 0] * a[1, 1] + b[2, 0] * a[2, 1],
        b[0, 0] * a[0, 2] + b[1, 0] * a[1, 2] + b[2, 0] * a[2, 2],
        b[0, 1] * a[0, 0] + b[1, 1] * a[1, 0] + b[2, 1] * a[2, 0],
        b[0, 1] * a[0, 1] + b[1, 1] * a[1, 1] + b[2, 1] * a[2, 1],
        b[0, 1] * a[0, 2] + b[1, 1] * a[1, 2] + b[2, 1] * a[2, 2],
        b[0, 2] * a[0, 0] + b[1, 2] * a[1, 0] + b[2, 2] * a[2, 0],
        b[0, 2] * a[0, 1] + b[1, 2] * a[1, 1] + b[2, 2] * a[2, 1],
        b[0, 2] * a[0, 2] + b[1, 2] * a[1, 2] + b[2, 2] * a[2, 2],
        b[0, 0] * x + b[1, 0] * y + b[2, 0] * z,
        b[0, 1] * x + b[1, 1] * y + b[2, 1] * z,
        b[0, 2] * x + b[1, 2] * y + b[2, 2] * z,
    )
    return Build(
        pose,
        centre[row, driver, 0],
        centre[row, driver, 1],
        centre[row, driven, 0],
        centre[row, driven, 1],
        flank_turn[row, driver],
        flank_turn[row, driven],
        flank_offset[row, driver] + flank_offset[row, driven],
    )


@part
def within_reach(pair, nominal, build):
    """Whether the candidate teeth are those of the nominal pose still."""
    p = build.pose
    square = (p.xx - nominal[0]) ** 2 + (p.xy - nominal[1]) ** 2 + (p.xz - nominal[2]) ** 2
    square += (p.yx - nominal[3]) ** 2 + (p.yy - nominal[4]) ** 2 + (p.yz - nominal[5]) ** 2
    square += (p.zx - nominal[6]) ** 2 + (p.zy - nominal[7]) ** 2 + (p.zz - nominal[8]) ** 2
    dx, dy, dz = p.x - nominal[9], p.y - nominal[10], pair.along * (p.z - nominal[11])
    return math.sqrt(dx * dx + dy * dy + dz * dz) + math.sqrt(square / 2.0) * pair.lever <= pair.reach


@part
def backlashes(
    pinion,
    wheel,
    pair_array,
    nominal,
    which,
    shafts,
    centre,
    flank_turn,
    flank_offset,
    scale,
    driver_angles,
    readings,
    teeth,
    status,
):
    """Seat every row and read it.

    Args:
        pinion, wheel: the nominal teeth of driver and driven.
        pair_array: PairNumbers as an array.
        nominal: (12,), the nominal Pose of the driver's shaft in the driven's.
        which: driver and driven in the arrays of the build; working flank; teeth; whether contact and gap are those of
            the section; whether the turns of driven and of driver are wanted.
        shafts, centre, flank_turn, flank_offset, scale: of a Build, (rows, gears, ...).
        driver_angles: (rows,) [rad].
        readings: (rows, READINGS), written: the driven gear's angle at rest [rad], the gap of the non-working flanks
            [mm], the turns of driven and driver until they touch [rad], the contact on the driver, world [mm].
        teeth: (rows,), written: the driver's tooth that touches.
        status: (rows,), written.
    """
    driver_index, driven_index = which[0], which[1]
    sigma = float(which[2])
    pair = pair_numbers(pair_array)
    tapers = pair.along > 0.0
    for row in range(len(driver_angles)):
        build = build_of(shafts, centre, flank_turn, flank_offset, row, driver_index, driven_index)
        driver = grown(pinion, scale[row, driver_index])
        driven = grown(wheel, scale[row, driven_index])
        angle = driver_angles[row]
        readings[row, :] = np.nan
        teeth[row] = 0
        if not within_reach(pair, nominal, build):
            status[row] = OUT_OF_RANGE
            continue
        start = pair.driven_start - angle / pair.ratio
        side = look(driver, driven, pair, build, angle, start, angle, sigma, which[3], which[4], 1.0)
        driven_angle, side = closed(side, driver, driven, pair, build, angle, start, sigma, which[3], which[4])
        if side.gap == math.inf or not side.known:
            status[row] = OUT_OF_RANGE if side.gap < math.inf else WITHOUT_CONTACT
            continue
        other = look(driver, driven, pair, build, angle, driven_angle, angle, -sigma, which[3], which[5], 0.0)
        if not other.known:
            status[row] = OUT_OF_RANGE
            continue
        status[row] = INTERFERING if other.gap < -FREE else SEATED
        readings[row, DRIVEN_ANGLE] = driven_angle
        readings[row, GAP] = other.gap
        fx, fy = turned(build.driven_x, build.driven_y, driven_angle)
        out = flank_offset[row, driver_index]
        x, y, z = side.x + fx - out * side.nx, side.y + fy - out * side.ny, side.z - out * side.nz
        shaft = shafts[row, driven_index]
        for k in range(3):
            readings[row, CONTACT + k] = shaft[k, 0] * x + shaft[k, 1] * y + shaft[k, 2] * z + shaft[k, 3]
        teeth[row] = side.tooth
        if which[6]:
            if which[5] != which[4] or (tapers and not which[4]):
                other = look(driver, driven, pair, build, angle, driven_angle, angle, -sigma, which[3], which[4], 1.0)
            end, _ = closed(other, driver, driven, pair, build, angle, driven_angle, -sigma, which[3], which[4])
            readings[row, DRIVEN_TURN] = abs(end - driven_angle)
        if which[7]:
            readings[row, DRIVER_TURN] = abs(
                driver_turn(driver, driven, pair, build, angle, driven_angle, -sigma, which[3], which[4])
            )


@part
def gaps(
    pinion,
    wheel,
    pair_array,
    which,
    shafts,
    centre,
    flank_turn,
    flank_offset,
    scale,
    driver_angles,
    driven_angles,
    driver_teeth,
    wanted,
    value,
    vectors,
):
    """Gaps of the tooth pairs that are asked for.

    Args:
        pinion ... scale: as in `backlashes`, but for `which`: driver, driven, flank, whether of the section.
        driver_angles, driven_angles: (rows,) [rad].
        driver_teeth, wanted: (rows, pairs).
        value: (rows, pairs) [mm], written; nan where not wanted, inf where the faces do not overlap.
        vectors: (rows, pairs, 3, 3), written: points on driver and driven, normal from driver to driven; world.
    """
    driver_index, driven_index = which[0], which[1]
    sigma = float(which[2])
    pair = pair_numbers(pair_array)
    for row in range(len(driver_angles)):
        build = build_of(shafts, centre, flank_turn, flank_offset, row, driver_index, driven_index)
        driver = grown(pinion, scale[row, driver_index])
        driven = grown(wheel, scale[row, driven_index])
        pose = pose_at(build, driver_angles[row], driven_angles[row])
        middle = section(driver, pair.section)
        own = middle if which[3] else driver
        fx, fy = turned(build.driven_x, build.driven_y, driven_angles[row])
        shaft = shafts[row, driven_index]
        for k in range(driver_teeth.shape[1]):
            value[row, k] = np.nan
            vectors[row, k] = np.nan
            if not wanted[row, k]:
                continue
            tooth = float(driver_teeth[row, k])
            mating = -tooth if sigma > 0.0 else -tooth - 1.0
            azimuth = driver_angles[row] + pair.driver_pitch * tooth
            near = nearest(
                own,
                driven,
                pose,
                azimuth - sigma * build.driver_turn,
                driven_angles[row] + pair.driven_pitch * mating - sigma * build.driven_turn,
                sigma,
                build.offset,
                pair.at_pitch - pair.per_azimuth * sigma * azimuth,
                middle.low,
                0.0,
                SHARP_FALL,
            )
            value[row, k] = near.gap
            ahead, back = flank_offset[row, driver_index], near.gap + flank_offset[row, driver_index]
            for i in range(3):
                normal = shaft[i, 0] * near.nx + shaft[i, 1] * near.ny + shaft[i, 2] * near.nz
                point = shaft[i, 0] * (near.x + fx) + shaft[i, 1] * (near.y + fy) + shaft[i, 2] * near.z + shaft[i, 3]
                vectors[row, k, 0, i] = point - ahead * normal
                vectors[row, k, 1, i] = point - back * normal
                vectors[row, k, 2, i] = -normal
