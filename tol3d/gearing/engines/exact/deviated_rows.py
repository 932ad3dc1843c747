"""Rows of builds whose flanks deviate tooth by tooth: as in rows.py, each with the offsets of its build."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines.exact.deviated import DeviatedTooth, FlankOffsets
from tol3d.gearing.engines.exact.flank_contact import (
    ALL_TEETH,
    Look,
    MeshBuild,
    Turn,
    azimuths,
    closed,
    first_tooth,
    mating_tooth,
    pose_at,
    seen,
    standing,
)
from tol3d.gearing.engines.exact.foot import flank_of, section
from tol3d.gearing.engines.exact.numbers import PairNumbers, Pose, turned
from tol3d.gearing.engines.exact.reach import within_reach
from tol3d.gearing.engines.exact.rests import rest_row as every_rest_row
from tol3d.gearing.engines.exact.rows import FREE, build_of, fault_of, gap_row, looks_of, read_row, write_contact
from tol3d.gearing.engines.exact.tooth_contact import Sight, Touch, edge_gap, height, most_out, sight, touch, wrapped
from tol3d.gearing.engines.status import INTERFERES, OK, OUT_OF_RANGE
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import part

Integers = NDArray[np.int64]


def read_deviated_rows(
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
        pinion ... scale: as in rows.read_rows.
        offsets, builds: of FlankDeviations, its values and rows.
        places: of driver and driven, see deviated.FlankOffsets.
        driver_angles ... status: as in rows.read_rows.
    """
    gears, looks = (which[0], which[1]), looks_of(pair, which)
    for row in range(len(driver_angles)):
        own = FlankOffsets(offsets[builds[row]], places)
        build = build_of(pinion, wheel, pair, nominal, gears, shafts, centre, flank_turn, flank_offset, scale, row, own)
        read_row(build, which, looks, shafts, flank_offset, scale, row, driver_angles[row], readings, teeth, status)


def gap_deviated_rows(
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
    """Gaps of the tooth pairs that are asked for; arguments as in rows.gap_rows and above."""
    gears = (which[0], which[1])
    for row in range(len(driver_angles)):
        own = FlankOffsets(offsets[builds[row]], places)
        build = build_of(pinion, wheel, pair, nominal, gears, shafts, centre, flank_turn, flank_offset, scale, row, own)
        angles = (driver_angles[row], driven_angles[row])
        gap_row(build, which, shafts, flank_offset, row, angles, driver_teeth, wanted, value, vectors, at_end)


ECCENTRIC = 3e-5  # mm; as seating.ASIDE, by which a mate may move aside on the way to contact
LATER = (
    0.9  # of the gap of a tip edge over the base radius: its arm is no longer than the tip radius, see touches_later
)


@part
def turns_later(mate: DeviatedTooth, gap: float, first: Touch) -> bool:
    """True if a pair with a gap of a tip edge [mm], or more, certainly touches after the first pair."""
    arm = mate.base * (1.0 + 0.5 * mate.end * mate.end)  # beyond the tip radius, sqrt(1 + t^2) times the base radius
    return gap > max(first.gap, 0.0) and LATER * gap / arm > first.turn


@part
def far_beyond(
    deviated_tooth: DeviatedTooth, mate: DeviatedTooth, tangent: float, gap: float, rolls: tuple[float, float]
) -> float:
    """The least gap [mm] of a pair beyond the path of contact, whose involutes there are a gap apart."""
    least, beyond, mate_beyond = (
        gap - most_out(deviated_tooth) - most_out(mate),
        rolls[0] - deviated_tooth.end,
        rolls[1] - mate.end,
    )
    if beyond > 0.0:
        least += edge_gap(deviated_tooth, mate, tangent, beyond)
    if mate_beyond > 0.0:
        least += edge_gap(mate, deviated_tooth, tangent, mate_beyond)
    return least


@part
def aside(at: Turn, line: Sight, its: Touch, sigma: float, base: float) -> float:
    """The turn [rad] that closes a pair whose mate, eccentric, moves aside as it turns; see seating.aside."""
    turn = its.turn
    if at.fx != 0.0 or at.fy != 0.0:
        nx, ny = turned(line.nx, line.ny, sigma * its.along)
        for _ in range(2):
            fx, fy = turned(at.fx, at.fy, -sigma * turn)
            turn = its.turn - (nx * (fx - at.fx) + ny * (fy - at.fy)) / base
    return turn


@part
def quick_turn(build: MeshBuild, at: Turn, look: Look) -> tuple[bool, float]:
    """The smallest turn of the driven gear [rad] that closes a pair of a side; True if it is certain."""
    sigma, pose, mate = look.sigma, pose_at(build, at), build.driven
    middle = section(build.driver, build.pair.section)
    own = middle if look.in_section else build.driver
    line = sight(own, mate, pose, sigma)
    if not line.clear or look.teeth != ALL_TEETH:
        return False, 0.0
    first, count = first_tooth(build.pair, at.driver, sigma, look.teeth)
    best = Touch(False, np.inf, np.inf, 0.0)
    for edges in (False, True):
        for step in range(count):
            tooth = sigma * (first + step)
            azimuth, mate_azimuth = azimuths(build, at, sigma, tooth)
            rolls = (wrapped(line.own - sigma * azimuth), wrapped(line.mate - sigma * mate_azimuth))
            if edges != (rolls[0] > own.end or rolls[1] > mate.end):
                continue
            flank = flank_of(own, build.flanks, 0, tooth, sigma)
            mating = flank_of(mate, build.flanks, 1, mating_tooth(mate, tooth, sigma), sigma)
            gap = line.tangent - own.base * rolls[0] - mate.base * rolls[1] - build.offset
            if edges and turns_later(mate, far_beyond(flank, mating, line.tangent, gap, rolls), best):
                continue
            z = height(flank, mating, line.low, line.high, middle.low)
            if rolls[1] > mate.end:  # of its edge only the gap is known
                back, heights = (rolls[1], rolls[0]), (z + pose.z, z)
                its = touch(mating, flank, line.tangent, gap, back, heights)
                if not (its.known and turns_later(mate, its.gap, best)):
                    return False, 0.0
                continue
            its = touch(flank, mating, line.tangent, gap, rolls, (z, z + pose.z))
            if not its.known:
                return False, 0.0
            best = Touch(True, min(best.gap, its.gap), min(best.turn, aside(at, line, its, sigma, mate.base)), 0.0)
    known = best.known and (abs(at.fx) + abs(at.fy)) * abs(best.turn) < ECCENTRIC
    return known, best.turn


@part
def rest_row(
    build: MeshBuild,
    which: Integers,
    shafts: Array,
    flank_offset: Array,
    scale: Array,
    row: int,
    driver_angles: Array,
    rests: Array,
    contact: Array,
    teeth: Integers,
    status: NDArray[np.int8],
) -> None:
    """Seat a build at every position on both sides; arguments as in `rest_deviated_rows`, and the row's build."""
    gears, pair, sigma = (which[0], which[1]), build.pair, float(which[2])
    rests[row] = np.nan
    contact[row] = np.nan
    teeth[row] = 0
    status[row] = OUT_OF_RANGE
    if not within_reach(build, scale[row, gears[0]], scale[row, gears[1]]):
        return
    opened = sigma * (build.driver_turn / pair.ratio + build.driven_turn)
    turned_on = [opened, -opened]
    for k in range(len(driver_angles)):
        angle = driver_angles[k]
        middle, arm, fault = pair.driven_start - angle / pair.ratio, build.driven.base, OK
        for side in range(2):
            look = Look(sigma if side == 0 else -sigma, which[3], which[4] != 0, 1.0)
            start = standing(build, angle, middle + turned_on[side])
            known, turn = quick_turn(build, start, look) if k > 0 else (False, 0.0)
            driven = start.driven - look.sigma * turn
            if not known:
                at, touching = closed(seen(build, start, angle, look), build, start, look)
                own = fault_of(touching)
                fault = max(fault, own)
                if own != OK:
                    continue
                driven = at.driven
                arm = abs(touching.ny * touching.x - touching.nx * touching.y)
                if k == 0:
                    write_contact(contact[row, side], touching, shafts[row, gears[1]], flank_offset[row, gears[0]])
                    teeth[row, side] = touching.tooth
            rests[row, k, side] = driven
            turned_on[side] = driven - middle
        if fault == OK and sigma * (turned_on[1] - turned_on[0]) * arm < -FREE:
            fault = INTERFERES
        status[row, k] = fault


def rest_all_deviated_rows(
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
    rests: Array,
    contact: Array,
    teeth: Integers,
    status: NDArray[np.int8],
) -> None:
    """As rest_deviated_rows, every position evaluated as usual."""
    gears = (which[0], which[1])
    for row in range(len(shafts)):
        own = FlankOffsets(offsets[builds[row]], places)
        build = build_of(pinion, wheel, pair, nominal, gears, shafts, centre, flank_turn, flank_offset, scale, row, own)
        every_rest_row(build, which, shafts, flank_offset, scale, row, driver_angles, rests, contact, teeth, status)


def rest_deviated_rows(
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
    rests: Array,
    contact: Array,
    teeth: Integers,
    status: NDArray[np.int8],
) -> None:
    """Seat every build at every position on both sides; arguments as in rests.rest_rows and above.

    Where axes are parallel all positions but the first take their contact from the line of action, see
    tooth_contact.py: pairs in action one after the other, edges only to know that they touch later. All other cases are
    evaluated as usual.
    """
    gears = (which[0], which[1])
    for row in range(len(shafts)):
        own = FlankOffsets(offsets[builds[row]], places)
        build = build_of(pinion, wheel, pair, nominal, gears, shafts, centre, flank_turn, flank_offset, scale, row, own)
        rest_row(build, which, shafts, flank_offset, scale, row, driver_angles, rests, contact, teeth, status)
