"""Screw involute flanks of external helical gears: the foot of a point on the mate's flank, in closed form.

The section of a helical gear at the height z is that of a spur gear, turned by kappa z: see spur.py. Its flank is the
developable surface of the tangents of the base helix. Along such a generator the normal is constant, the roll t falls
by sigma kappa per height, and the normal leans out of the section by the base helix angle beta_b. A point that lies
r_b (tan alpha_R - t) off the flank in its own section lies cos(beta_b) of that off it in space, and parallel surfaces
are the same screw turned: the gap closes as the mate turns by gap/(r_b cos beta_b), whichever point is looked at.
"""

import math
from typing import NamedTuple

from tol3d.gearing.engines.exact.foot import (
    PER_TURN,
    TURN,
    as_given,
    begun,
    external,
    first_face,
    flank_of,
    foot,
    grown,
    leaning,
    line_of_action,
    promise,
    section,
    turn_to,
)
from tol3d.gearing.engines.exact.numbers import ALIKE, NOWHERE, Facing, Foot, Nearest, Pose
from tol3d.gearing.engines.exact.spur import SHORTEST_TANGENT
from tol3d.numerics.compiled import part, variant

FREE_ENDS = 0.2  # mm; by which the ends of contact lines may lie elsewhere than nominal gears have them
SQUARES = 2e-5  # mm; of leans of a milliradian over a face of 20 mm


class HelicalTooth(NamedTuple):
    """Flanks of a helical gear.

    Args:
        base, per_arm: base radius r_b [mm], and one over r_b cos(beta_b).
        cosine, rise: cos(beta_b), and h sin(beta_b), h the hand.
        twist: kappa, by which a section is turned per height [rad/mm].
        half: half the angle [rad] that a tooth takes at its base.
        begin, end: roll [rad] where the flank begins and at the tip.
        low, high: ends of the face [mm], along the axis.
    """

    base: float
    per_arm: float
    cosine: float
    rise: float
    twist: float
    half: float
    begin: float
    end: float
    low: float
    high: float


external(HelicalTooth)
variant(begun, HelicalTooth)(as_given)


@part
def resized(tooth: HelicalTooth, scale: float, low: float, high: float) -> HelicalTooth:
    """The teeth grown, between two heights [mm]."""
    base, per_arm, twist = tooth.base * scale, tooth.per_arm / scale, tooth.twist / scale
    return HelicalTooth(base, per_arm, tooth.cosine, tooth.rise, twist, tooth.half, tooth.begin, tooth.end, low, high)


@variant(grown, HelicalTooth)
def helical_grown(tooth: HelicalTooth, scale: float) -> HelicalTooth:
    """Every length grows, angles stay."""
    return resized(tooth, scale, tooth.low * scale, tooth.high * scale)


@variant(flank_of, HelicalTooth)
def helical_flank(tooth: HelicalTooth, flanks: float, gear: int, place: float, sigma: float) -> HelicalTooth:
    """All flanks are alike."""
    return tooth


@variant(section, HelicalTooth)
def helical_section(tooth: HelicalTooth, share: float) -> HelicalTooth:
    """One height."""
    at = tooth.low + share * (tooth.high - tooth.low)
    return resized(tooth, 1.0, at, at)


@variant(leaning, HelicalTooth)
def helical_leaning(tooth: HelicalTooth, sigma: float) -> float:
    """dt/dz = -sigma kappa along a generator."""
    return sigma * tooth.twist


@variant(foot, HelicalTooth)
def helical_foot(
    helical_tooth: HelicalTooth, mate: HelicalTooth, pose: Pose, facing: Facing, roll: float, z: float
) -> Foot:
    """See foot.foot: the point at a roll [rad] and a height [mm]; derivatives by the face are along the generator."""
    own_azimuth, mate_azimuth, sigma, offset = facing
    own = helical_tooth
    phi = sigma * (roll - own.half) + own_azimuth + own.twist * z
    cos, sin = math.cos(phi), math.sin(phi)
    px = own.base * (cos + sigma * roll * sin)
    py = own.base * (sin - sigma * roll * cos)
    x = pose.xx * px + pose.xy * py + pose.xz * z + pose.x
    y = pose.yx * px + pose.yy * py + pose.yz * z + pose.y
    height = pose.zx * px + pose.zy * py + pose.zz * z + pose.z
    square = x * x + y * y
    tangent = math.sqrt(max(square - mate.base * mate.base, SHORTEST_TANGENT * SHORTEST_TANGENT))
    scale = 1.0 / square
    ux, uy = scale * (x * mate.base - sigma * y * tangent), scale * (y * mate.base + sigma * x * tangent)
    angle = sigma * (math.atan2(uy, ux) - mate_azimuth - mate.twist * height) + mate.half
    same_height = angle - TURN * math.floor(angle * PER_TURN + 0.5)
    apart = (tangent - mate.base * same_height) * mate.cosine
    nx, ny, nz = sigma * mate.cosine * uy, -sigma * mate.cosine * ux, sigma * mate.rise
    # the point moves along (cos, sin) as it rolls, across it as that turns, and along its generator
    vx, vy, vz = pose.xx * cos + pose.xy * sin, pose.yx * cos + pose.yy * sin, pose.zx * cos + pose.zy * sin
    wx, wy, wz = pose.xy * cos - pose.xx * sin, pose.yy * cos - pose.yx * sin, pose.zy * cos - pose.zx * sin
    slope = own.base * own.twist
    gx, gy, gz = slope * wx + pose.xz, slope * wy + pose.yz, slope * wz + pose.zz
    towards, turning = nx * vx + ny * vy + nz * vz, nx * wx + ny * wy + nz * wz
    across = own.base * roll * (ux * vx + uy * vy)
    sideways = ux * gx + uy * gy
    curvature = mate.cosine / tangent
    return Foot(
        apart - offset,
        (tangent - apart * mate.cosine) / mate.base,
        height - apart * sigma * mate.rise,
        (tangent - offset * mate.cosine) / mate.base,
        x,
        y,
        height,
        nx,
        ny,
        nz,
        own.base * roll * towards,
        nx * gx + ny * gy + nz * gz,
        own.base * (towards + sigma * roll * turning) + across * across * curvature,
        across * sideways * curvature - sigma * slope * towards,
        sideways * sideways * curvature,
        0.0,
    )


@variant(turn_to, HelicalTooth)
def helical_turn(mate: HelicalTooth, gap: float, offset: float, at: Foot) -> float:
    """Flanks of one tooth that stand a turn apart lie r_b cos(beta_b) times that apart."""
    return gap * mate.per_arm


@part
def falling(own: HelicalTooth, mate: HelicalTooth, pose: Pose, sigma: float) -> tuple[float, float]:
    """Opening of the gap per height along the contact lines, nearly; and the tangent of both base circles [mm].

    (0, 0) of parallel axes, and where there is no such tangent.
    """
    square, bases = pose.x * pose.x + pose.y * pose.y, own.base + mate.base
    if (pose.xz == 0.0 and pose.yz == 0.0) or square <= bases * bases:
        return 0.0, 0.0
    tangent, scale = math.sqrt(square - bases * bases), 1.0 / square
    ux, uy = scale * (pose.x * bases - sigma * pose.y * tangent), scale * (pose.y * bases + sigma * pose.x * tangent)
    # the driver's strings point against the mate's: its generators lean along -(-uy, ux)
    wx, wy = pose.xx * uy - pose.yx * ux, pose.xy * uy - pose.yy * ux
    slope = own.base * own.twist
    gx = slope * (pose.xx * wx + pose.xy * wy) + pose.xz
    gy = slope * (pose.yx * wx + pose.yy * wy) + pose.yz
    gz = slope * (pose.zx * wx + pose.zy * wy) + pose.zz
    return sigma * (mate.cosine * (uy * gx - ux * gy) + mate.rise * gz), tangent


@variant(first_face, HelicalTooth)
def helical_first_face(helical_tooth: HelicalTooth, mate: HelicalTooth, pose: Pose, sigma: float, face: float) -> float:
    """The end of the common face towards which all contact lines close as axes lean; the middle of parallel axes."""
    rate, tangent = falling(helical_tooth, mate, pose, sigma)
    if tangent == 0.0:
        return face
    if rate > 0.0:
        return max(helical_tooth.low, mate.low - pose.z)
    return min(helical_tooth.high, mate.high - pose.z)


@variant(promise, HelicalTooth)
def helical_promise(
    helical_tooth: HelicalTooth, mate: HelicalTooth, pose: Pose, sigma: float, start: float, apart: float
) -> tuple[float, float]:
    """The opening by the lean at the lower end of a contact line, to first order; see stack_up/contact_lines.py.

    A line beside the flanks stands off by at least twice its distance squared over the tangent. The leeway covers
    mates that stand apart, whose lines end elsewhere, and what goes with squares of the lean.
    """
    own = helical_tooth
    rate, tangent = falling(own, mate, pose, sigma)
    if tangent == 0.0 or own.twist == 0.0:
        return 0.0, 0.0
    lean = sigma * own.twist
    begin = max(own.begin, (tangent - mate.base * mate.end) / own.base)
    first, last = (start - begin) / lean, (start - own.end) / lean
    low = max(min(first, last), own.low, mate.low - pose.z)
    high = min(max(first, last), own.high, mate.high - pose.z)
    beside = max(low - high, 0.0) * abs(lean) * own.base
    end = low if rate > 0.0 else high
    order = rate * (end - sigma * own.rise * own.cosine * own.base * start) + 2.0 * beside * beside / tangent
    leeway = abs(rate) * (FREE_ENDS + 2.0 * apart * own.cosine / abs(own.rise)) + SQUARES
    return order, leeway + abs(rate) * 2.0 * beside * own.cosine / abs(own.rise)


@part
def between(low: float, high: float, at: float, fall: float, begin: float, end: float) -> tuple[float, float]:
    """The heights between two others at which a roll `at - fall z` lies between its ends."""
    if fall == 0.0:
        return (low, high) if begin <= at <= end else (low, low - 1.0)
    first, last = (at - begin) / fall, (at - end) / fall
    return max(low, min(first, last)), min(high, max(first, last))


@variant(line_of_action, HelicalTooth)
def helical_line_of_action(
    helical_tooth: HelicalTooth, mate: HelicalTooth, pose: Pose, facing: Facing, face: float
) -> Nearest:
    """On parallel axes the flanks of a pair touch along a line: in every section as spur flanks, turned, do.

    The gap is the same along that line, and for every pair of one base pitch; see spur.spur_line_of_action. Of the line
    there are the heights at which both flanks have its rolls.
    """
    own_azimuth, mate_azimuth, sigma, offset = facing
    own = helical_tooth
    nowhere = Nearest(0.0, 0.0, NOWHERE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False, 0.0)
    square, bases = pose.x * pose.x + pose.y * pose.y, own.base + mate.base
    if pose.xz != 0.0 or pose.yz != 0.0 or square <= bases * bases:
        return nowhere
    tangent = math.sqrt(square - bases * bases)
    working = math.atan2(tangent, bases)
    centres = math.atan2(pose.y, pose.x)
    # turned about z against each other, the gears see one direction at different azimuths
    twist = math.atan2(pose.yx, pose.xx) if pose.yx != 0.0 else 0.0
    angle = working + own.half - sigma * (own_azimuth + twist - centres - math.pi)
    roll = angle - TURN * math.floor(angle * PER_TURN + 0.5)
    angle = working + mate.half - sigma * (mate_azimuth + mate.twist * pose.z - centres)
    mate_roll = angle - TURN * math.floor(angle * PER_TURN + 0.5)
    gap = (tangent - own.base * roll - mate.base * mate_roll) * mate.cosine - offset
    turn = gap * mate.per_arm
    low, high = max(own.low, mate.low - pose.z), min(own.high, mate.high - pose.z)
    low, high = between(low, high, roll, sigma * own.twist, own.begin, own.end)
    low, high = between(low, high, mate_roll, sigma * mate.twist, mate.begin, mate.end - max(turn, 0.0))
    if low > high:
        return nowhere
    at = min(max(face, low), high)
    roll -= sigma * own.twist * at
    scale = 1.0 / square
    ux, uy = scale * (pose.x * bases - sigma * pose.y * tangent), scale * (pose.y * bases + sigma * pose.x * tangent)
    nx, ny = sigma * uy, -sigma * ux
    along = tangent - own.base * roll
    x, y = mate.base * ux + along * nx, mate.base * uy + along * ny
    return Nearest(
        gap,
        turn,
        ALIKE,
        roll,
        at,
        x,
        y,
        at + pose.z,
        mate.cosine * nx,
        mate.cosine * ny,
        sigma * mate.rise,
        False,
        0.0,
    )
