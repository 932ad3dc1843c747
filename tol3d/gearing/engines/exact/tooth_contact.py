"""Contact of two deviated flanks of spur gears with parallel axes, from the line of action of their involutes.

In general Newton's method goes from foot to foot, see nearest.py, and each foot takes sines and arcs. Here all pairs
share the line of action, and points beside it take a root. A point of own flank that lies d of roll short of that line
moves by s = rho_1 - r_1 d per roll, at an angle d to it. Its foot on the mate has gone th round the mate's axis, and a
string L long leads to it, so that the involutes' gap has grown by L - rho_2 + r_2 th, per roll by s sin(d - th), and th
changes by -(s/L) cos(d - th).
"""

import math
from typing import NamedTuple

import numpy as np

from tol3d.gearing.engines.exact.deviated import LEAST_BEND, DeviatedTooth, Offset, is_level, offset_of, wave_at
from tol3d.gearing.engines.exact.flank_contact import (
    ALL_TEETH,
    Look,
    MeshBuild,
    Turn,
    azimuths,
    first_tooth,
    mating_tooth,
    pose_at,
)
from tol3d.gearing.engines.exact.foot import PER_TURN, TURN, flank_of, section
from tol3d.gearing.engines.exact.numbers import SMALL, Pose, arcsine, sine, turned
from tol3d.numerics.compiled import part

STEPS = 4  # of Newton's; two do nearly always
LAST_FALL = 1e-9  # mm; a step that lowers the gap by less is the last
SHORTEST = 0.1  # mm; near to its base circle an involute is too sharp to be a parabola
EDGE_SHARE = 0.5  # of b d^2/2 by which a tip edge has left its mate at least, see edge_gap
ECCENTRIC = 3e-5  # mm; as seating.ASIDE, by which a mate may move aside on the way to contact
LATER = (
    0.9  # of the gap of a tip edge over the base radius: its arm is no longer than the tip radius, see touches_later
)


class Sight(NamedTuple):
    """One flank side of gears with parallel axes, as they stand.

    Args:
        clear: whether they are, and their faces overlap.
        tangent: length of the tangent of both base circles [mm].
        own, mate: rolls of teeth whose azimuth is 0 where they touch on it [rad].
        low, high: ends of the common face on own gear [mm].
        nx, ny: direction of the tangent, from mate to own flank.
    """

    clear: bool
    tangent: float
    own: float
    mate: float
    low: float
    high: float
    nx: float
    ny: float


class Touch(NamedTuple):
    """A pair of flanks.

    Args:
        known: whether it touches well within both flanks, and all below holds.
        gap: [mm], along the normal of the mate's involute.
        turn: of the mate until it is closed [rad].
        along: by how much the normal there has turned from the line of action [rad].
    """

    known: bool
    gap: float
    turn: float
    along: float


@part
def sight(deviated_tooth: DeviatedTooth, mate: DeviatedTooth, pose: Pose, sigma: float) -> Sight:
    """One side of two gears; see spur.spur_line_of_action."""
    square, bases = pose.x * pose.x + pose.y * pose.y, deviated_tooth.base + mate.base
    low, high = max(deviated_tooth.low, mate.low - pose.z), min(deviated_tooth.high, mate.high - pose.z)
    parallel = pose.xz == 0.0 and pose.yz == 0.0 and pose.zz > 0.0
    if not parallel or square <= bases * bases or low > high:
        return Sight(False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    tangent = math.sqrt(square - bases * bases)
    working, centres = math.atan2(tangent, bases), math.atan2(pose.y, pose.x)
    twist = math.atan2(pose.yx, pose.xx) if pose.yx != 0.0 else 0.0
    first = working + deviated_tooth.half + sigma * (centres + math.pi - twist)
    second = working + mate.half + sigma * centres
    ux, uy = pose.x * bases - sigma * pose.y * tangent, pose.y * bases + sigma * pose.x * tangent
    return Sight(True, tangent, first, second, low, high, sigma * uy / square, -sigma * ux / square)


@part
def wrapped(angle: float) -> float:
    """An angle between minus half a turn and half a turn [rad]."""
    return angle - TURN * math.floor(angle * PER_TURN + 0.5)


@part
def beside(base: float, mate_base: float, rho: float, mate_rho: float, d: float) -> tuple[float, float, float]:
    """Added distance from the mate of a point d [rad] of roll beside the line of action, its string, the foot's angle.

    [mm; mm; rad], of an involute whose point on that line has radii of curvature rho and mate_rho to either side.
    """
    sin = sine(d)
    cos = math.sqrt(1.0 - sin * sin)
    short = rho - base * d
    x = mate_base + base * sin * sin / (1.0 + cos) + short * sin
    y = mate_rho + rho - base * sin - short * cos
    square = x * x + y * y
    string = math.sqrt(square - mate_base * mate_base)
    theta = arcsine((y * mate_base - x * string) / square)
    return string - mate_rho + mate_base * theta, string, theta


@part
def near_offset(tooth: DeviatedTooth, roll: float, z: float, cos: float, sin: float, by: float) -> Offset:
    """Offset of a flank at a roll [rad], from the phase of its waves at a roll that is smaller by `by`."""
    if tooth.form == 0.0 or tooth.waves == 0.0:
        return offset_of(tooth, roll, z, 1.0, 0.0)
    across = sine(TURN * tooth.waves * by * tooth.per_length)
    along = math.sqrt(1.0 - across * across)
    return offset_of(tooth, roll, z, cos * along - sin * across, sin * along + cos * across)


@part
def most_out(tooth: DeviatedTooth) -> float:
    """Bound of a flank's offset anywhere, once as it is and twice more by its shapes [mm]."""
    u = max(abs(tooth.begin - tooth.middle), abs(tooth.end - tooth.middle)) * tooth.per_length
    form = 0.5 if tooth.waves != 0.0 else 1.0 / 3.0 + 4.0 * u * u
    z = max(abs(tooth.low), abs(tooth.high)) * tooth.per_face
    return tooth.level + 3.0 * (abs(tooth.slope) * u + abs(tooth.form) * form + abs(tooth.helix) * z)


@part
def edge_gap(deviated_tooth: DeviatedTooth, mate: DeviatedTooth, tangent: float, beyond: float) -> float:
    """Least distance of own tip edge from the mate [mm] for a pair so far beyond the path of contact [rad].

    Just beyond it is b d^2/2, b = rho T/(T - rho) with the edge's radius of curvature rho: the mate's, T - rho, grows
    by less than the arc r_b d on the way.
    """
    radius = deviated_tooth.base * deviated_tooth.end
    mating = max(tangent - radius, 0.0) + deviated_tooth.base * beyond
    return EDGE_SHARE * 0.5 * radius * tangent / mating * beyond * beyond


@part
def level_touch(deviated_tooth: DeviatedTooth, mate: DeviatedTooth, gap: float, mate_roll: float) -> Touch:
    """Touch of two parallel involutes, plain flanks a gap [mm] apart, at the mate's roll [rad]."""
    gap -= deviated_tooth.level + mate.level
    turn = gap * mate.per_base
    return Touch(mate_roll + turn <= mate.end, gap, turn, 0.0)


@part
def height(deviated_tooth: DeviatedTooth, mate: DeviatedTooth, low: float, high: float, face: float) -> float:
    """Height on own face with the largest sum of both offsets [mm], between two ends; `face` if they are level."""
    lean = deviated_tooth.helix * deviated_tooth.per_face + mate.helix * mate.per_face
    return high if lean > 0.0 else (low if lean < 0.0 else min(max(face, low), high))


@part
def touched(
    mate: DeviatedTooth,
    gap: float,
    out: float,
    roll: float,
    z: float,
    wave: tuple[float, float],
    by: float,
    along: float,
) -> Touch:
    """Touch over a gap [mm] at a roll [rad] of the mate with offset `out` there; its waves as in near_offset."""
    turn = gap * mate.per_base
    if not mate.begin <= roll + turn <= mate.end:
        return Touch(False, 0.0, 0.0, 0.0)
    if not is_level(mate):
        for _ in range(2):  # on the way the foot comes to where the mate stands out by another length
            there = near_offset(mate, roll + turn, z, wave[0], wave[1], turn + by)
            turn = (gap + out - there.value) * mate.per_base
    return Touch(abs(turn + by) < SMALL, gap, turn, along)


@part
def touch(
    deviated_tooth: DeviatedTooth,
    mate: DeviatedTooth,
    tangent: float,
    gap: float,
    rolls: tuple[float, float],
    heights: tuple[float, float],
) -> Touch:
    """Touch of two flanks whose involutes are a gap [mm] apart on the line of action, or of own tip edge.

    Args:
        own, mate: the flanks.
        tangent: length of the tangent of both base circles [mm].
        gap: of the involutes that all teeth have.
        rolls: at which those would touch, of own and mate [rad].
        heights: at which flanks are evaluated, of own and mate [mm].
    """
    unknown = Touch(False, 0.0, 0.0, 0.0)
    roll, least = rolls[0], rolls[0] - deviated_tooth.end
    rho, mate_rho = deviated_tooth.base * roll, tangent - deviated_tooth.base * roll
    if roll < deviated_tooth.begin or rho < SHORTEST or mate_rho < SHORTEST:
        return unknown
    if least <= 0.0 and mate.begin <= rolls[1] <= mate.end and is_level(deviated_tooth) and is_level(mate):
        return level_touch(deviated_tooth, mate, gap, rolls[1])
    start = max(least, 0.0)
    d, grown, theta = start, 0.0, 0.0
    cos, sin = wave_at(deviated_tooth, roll - start)
    first = offset_of(deviated_tooth, roll - start, heights[0], cos, sin)
    string = mate_rho - first.value
    if start > 0.0:
        grown, string, theta = beside(deviated_tooth.base, mate.base, rho + first.value, string, start)
    begin = theta
    mate_roll = rolls[1] - begin
    mate_cos, mate_sin = wave_at(mate, mate_roll)
    second = offset_of(mate, mate_roll, heights[1], mate_cos, mate_sin)
    fall = math.inf
    for _ in range(STEPS):
        speed = rho + first.value - deviated_tooth.base * d
        ratio = speed / string
        by_d = speed * sine(d - theta) + first.by_roll - second.by_roll * ratio
        bend = speed * (1.0 + ratio) - first.bend - second.bend * ratio * ratio
        bend = max(bend, LEAST_BEND * deviated_tooth.base)
        on = max(d - by_d / bend, least)
        fall = 0.5 * by_d * by_d / bend if on > least else 0.0
        if on == d or (on > least and fall < LAST_FALL):
            break
        d, own_roll, fall = on, roll - on, math.inf
        if own_roll <= deviated_tooth.begin or d - start > SMALL:
            return unknown
        first = near_offset(deviated_tooth, own_roll, heights[0], cos, sin, start - d)
        grown, string, theta = beside(deviated_tooth.base, mate.base, rho + first.value, mate_rho - first.value, d)
        mate_roll = rolls[1] - theta
        second = near_offset(mate, mate_roll, heights[1], mate_cos, mate_sin, begin - theta)
    if fall >= LAST_FALL or not mate.begin <= mate_roll <= mate.end:
        return unknown
    found = gap - first.value + grown - second.value - fall
    return touched(mate, found, second.value, mate_roll, heights[1], (mate_cos, mate_sin), begin - theta, theta)


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


def turn_by_line(driver: DeviatedTooth, build: MeshBuild, at: Turn, look: Look) -> tuple[bool, float]:
    """See foot.quick_turn: of parallel axes, pairs in action one after the other, edges only to know they are later."""
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
