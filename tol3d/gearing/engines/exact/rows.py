"""Contacts of meshes, build by build: the loops common to all kinds of pairs; kernels.py compiles them."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines.exact.flank_contact import (
    Look,
    MeshBuild,
    Side,
    Turn,
    closed,
    driven_on,
    driver_turn,
    pair_nearest,
    pose_at,
    seen,
    standing,
)
from tol3d.gearing.engines.exact.foot import flanks_in, grown, opening, section
from tol3d.gearing.engines.exact.nearest import SHARP_FALL
from tol3d.gearing.engines.exact.numbers import PairNumbers, Pose
from tol3d.gearing.engines.exact.reach import within_reach
from tol3d.gearing.engines.status import INTERFERES, NO_CONTACT, OK, OUT_OF_RANGE
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import part
from tol3d.numerics.loops import fill

Integers = NDArray[np.int64]

FREE = 1e-6  # mm; a gap of the non-working flanks below minus this is an interference
DRIVEN_ANGLE, GAP, DRIVEN_TURN, DRIVER_TURN, CONTACT = 0, 1, 2, 3, 4  # columns of a row's readings
READINGS = 7  # number of these columns: four, and x, y, z of the contact


@part
def pose_of(shafts: Array, row: int, driver: int, driven: int) -> Pose:
    """Pose of the driver's shaft in the driven shaft's frame; `shafts` (rows, gears, 4, 4) as in a Build."""
    a, b = shafts[row, driver], shafts[row, driven]
    x, y, z = a[0, 3] - b[0, 3], a[1, 3] - b[1, 3], a[2, 3] - b[2, 3]
    return Pose(
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


@part
def build_of(
    pinion: Any,
    wheel: Any,
    pair: PairNumbers,
    nominal: Pose,
    gears: tuple[int, int],
    shafts: Array,
    centre: Array,
    flank_turn: Array,
    flank_offset: Array,
    scale: Array,
    row: int,
    flanks: Any,
) -> MeshBuild:
    """The mesh of a row; `flanks` are offsets of single flanks as in MeshBuild, other arguments as in `read_rows`."""
    driver, driven = gears
    return MeshBuild(
        grown(pinion, scale[row, driver]),
        grown(wheel, scale[row, driven]),
        pair,
        pose_of(shafts, row, driver, driven),
        nominal,
        centre[row, driver, 0],
        centre[row, driver, 1],
        centre[row, driven, 0],
        centre[row, driven, 1],
        flank_turn[row, driver],
        opening(wheel) * flank_turn[row, driven],
        flank_offset[row, driver] + flank_offset[row, driven],
        flanks,
    )


class Looks(NamedTuple):
    """Evaluations of the sides of a mesh.

    Args:
        working: of the working flanks, for their contact.
        gap: of the non-working flanks, for their gap.
        closing: of the non-working flanks, for the turn of the driven gear until they touch.
        gap_closes: True if `gap` serves for that turn, too.
        of_driver: of the non-working flanks, for the turn of the driver until they touch.
    """

    working: Look
    gap: Look
    closing: Look
    gap_closes: bool
    of_driver: Look


@part
def looks_of(pair: PairNumbers, which: Integers) -> Looks:
    """Evaluations of the sides; `which` as in `read_rows`."""
    sigma, contact, tapers = float(which[2]), which[4] != 0, pair.along > 0.0
    return Looks(
        Look(sigma, which[3], contact, 1.0),
        Look(-sigma, which[3], which[5] != 0, 0.0),
        Look(-sigma, which[3], contact, 1.0),
        which[5] == which[4] and (which[4] != 0 or not tapers),
        Look(-sigma, which[3], contact, 0.0),
    )


@part
def free_turn(build: MeshBuild, at: Turn, other: Side, angle: float, looks: Looks) -> float:
    """Turn of the driven gear [rad] until the non-working flanks touch; NaN where it is not known.

    Args:
        build: the mesh.
        at: the gears with the working flanks in contact.
        other: the non-working side there, by `looks.gap`.
        angle: of the driver [rad].
        looks: evaluations.
    """
    sense, near_at, near = looks.working.sigma * opening(build.driven), at, other
    if not looks.gap_closes:  # the smallest gap nearly gives the turn
        near_at = driven_on(at, sense * other.turn)
        near = seen(build, near_at, angle, looks.closing)
    end, last = closed(near, build, near_at, looks.closing)
    return sense * (end.driven - at.driven) if last.known and last.acts and last.gap < math.inf else math.nan


@part
def fault_of(side: Side) -> int:
    """OK if a side could be evaluated; else NO_CONTACT or OUT_OF_RANGE."""
    if side.gap == math.inf and side.acts:
        return NO_CONTACT
    return OUT_OF_RANGE if side.gap == math.inf or not side.known or not side.acts else OK


@part
def write_contact(contact: Array, side: Side, shaft: Array, out: float) -> None:
    """Write the point of contact on the driver's flank (3,), in the world; `out` is the flank's offset [mm]."""
    x, y, z = side.x - out * side.nx, side.y - out * side.ny, side.z - out * side.nz
    for k in range(3):
        contact[k] = shaft[k, 0] * x + shaft[k, 1] * y + shaft[k, 2] * z + shaft[k, 3]


@part
def gap_row(
    build: MeshBuild,
    which: Integers,
    shafts: Array,
    flank_offset: Array,
    row: int,
    angles: tuple[float, float],
    driver_teeth: Integers,
    wanted: NDArray[np.bool_],
    value: Array,
    vectors: Array,
    at_end: NDArray[np.bool_],
) -> None:
    """Gaps of the tooth pairs of one row; arguments as in `gap_rows`, and the row's build and gear angles [rad]."""
    gears, sigma = (which[0], which[1]), float(which[2])
    at = standing(build, angles[0], angles[1])
    pose = pose_at(build, at)
    middle = section(build.driver, build.pair.section)
    driver = middle if which[3] else build.driver
    shaft = shafts[row, gears[1]]
    for k in range(driver_teeth.shape[1]):
        value[row, k] = np.nan
        vectors[row, k] = np.nan
        at_end[row, k] = False
        if not wanted[row, k]:
            continue
        tooth = float(driver_teeth[row, k])
        near = pair_nearest(build, at, sigma, tooth, pose, driver, middle.low, 0.0, SHARP_FALL)
        value[row, k] = near.gap
        if near.gap == math.inf:
            continue
        at_end[row, k] = near.at_end
        ahead, back = flank_offset[row, gears[0]], near.gap + flank_offset[row, gears[0]]
        x, y = near.x + at.fx, near.y + at.fy
        for i in range(3):
            normal = shaft[i, 0] * near.nx + shaft[i, 1] * near.ny + shaft[i, 2] * near.nz
            point = shaft[i, 0] * x + shaft[i, 1] * y + shaft[i, 2] * near.z + shaft[i, 3]
            vectors[row, k, 0, i] = point - ahead * normal
            vectors[row, k, 1, i] = point - back * normal
            vectors[row, k, 2, i] = -normal


def read_rows(
    pinion: Any,
    wheel: Any,
    pair: PairNumbers,
    nominal: Pose,
    which: Integers,
    shafts: Array,
    centre: Array,
    flank_turn: Array,
    flank_offset: Array,
    scale: Array,
    offsets: Array,
    builds: Integers,
    places: Integers,
    driver_angles: Array,
    readings: Array,
    teeth: Integers,
    status: NDArray[np.int8],
) -> None:
    """Seat every row and read it.

    Args:
        pinion, wheel: the nominal teeth of driver and driven.
        pair: which of them may meet.
        nominal: pose of the driver's shaft in the driven shaft's frame, of the nominal pair.
        which: indices of driver and driven in the arrays of the build; sign of the working flank; teeth, see Look; 1 if
            the contact, and if the gap, are read in the section; 1 if the turns of driven, and of driver, are wanted.
        shafts, centre, flank_turn, flank_offset, scale: of a Build, (rows, gears, ...).
        offsets, builds, places: of single flanks, as in foot.flanks_in.
        driver_angles: (rows,) [rad].
        readings: (rows, READINGS), written: the driven gear's angle in contact [rad], the gap of the non-working flanks
            [mm], the turns of driven and driver until they touch [rad], the contact on the driver in the world [mm];
            gap and turns are below 0 where those flanks overlap. NaN where not known or not wanted.
        teeth, status: (rows,), written: the touching tooth of the driver, and the status of the mesh.
    """
    gears, looks = (which[0], which[1]), looks_of(pair, which)
    sigma = looks.working.sigma
    for row in range(len(driver_angles)):
        own = flanks_in(pinion, offsets, builds, places, row)
        build = build_of(pinion, wheel, pair, nominal, gears, shafts, centre, flank_turn, flank_offset, scale, row, own)
        angle = driver_angles[row]
        fill(readings[row], np.nan)
        teeth[row], status[row] = 0, OUT_OF_RANGE
        if not within_reach(build, scale[row, gears[0]], scale[row, gears[1]]):
            continue
        opened = build.driver_turn / pair.ratio + build.driven_turn
        start = standing(build, angle, pair.driven_start - angle / pair.ratio + sigma * opened)
        at, side = closed(seen(build, start, angle, looks.working), build, start, looks.working)
        status[row] = fault_of(side)
        if status[row] != OK:
            continue
        other = seen(build, at, angle, looks.gap)
        status[row] = fault_of(other)
        if status[row] != OK:
            continue
        status[row] = INTERFERES if other.gap < -FREE else OK
        readings[row, DRIVEN_ANGLE] = at.driven
        readings[row, GAP] = other.gap
        write_contact(readings[row, CONTACT:], side, shafts[row, gears[1]], flank_offset[row, gears[0]])
        teeth[row] = side.tooth
        if which[6]:
            readings[row, DRIVEN_TURN] = free_turn(build, at, other, angle, looks)
        if which[7]:
            readings[row, DRIVER_TURN] = sigma * driver_turn(build, at, looks.of_driver)


def gap_rows(
    pinion: Any,
    wheel: Any,
    pair: PairNumbers,
    nominal: Pose,
    which: Integers,
    shafts: Array,
    centre: Array,
    flank_turn: Array,
    flank_offset: Array,
    scale: Array,
    offsets: Array,
    builds: Integers,
    places: Integers,
    driver_angles: Array,
    driven_angles: Array,
    driver_teeth: Integers,
    wanted: NDArray[np.bool_],
    value: Array,
    vectors: Array,
    at_end: NDArray[np.bool_],
) -> None:
    """Gaps of the wanted tooth pairs.

    Args:
        pinion ... places: as in `read_rows`, but `which`: indices of driver and driven; sign of the flank; 1 for the
            section.
        driver_angles, driven_angles: (rows,) [rad].
        driver_teeth, wanted: (rows, pairs).
        value: (rows, pairs) [mm], written; NaN where not wanted, inf where the faces do not overlap.
        vectors: (rows, pairs, 3, 3), written: points on driver and driven [mm], normal from driver to driven; world.
        at_end: (rows, pairs), written: True where either flank ends at its point.
    """
    gears = (which[0], which[1])
    for row in range(len(driver_angles)):
        own = flanks_in(pinion, offsets, builds, places, row)
        build = build_of(pinion, wheel, pair, nominal, gears, shafts, centre, flank_turn, flank_offset, scale, row, own)
        angles = (driver_angles[row], driven_angles[row])
        gap_row(build, which, shafts, flank_offset, row, angles, driver_teeth, wanted, value, vectors, at_end)
