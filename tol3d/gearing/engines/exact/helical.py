"""Screw involute flanks of helical gears, internal pairs too: the foot of a point on the mate's flank, in closed form.

The section of a helical gear at the height z is that of a spur gear, turned by kappa z: see spur.py. Its flank is the
developable surface of the tangents of the base helix. Along such a generator the normal is constant, the roll t falls
by sigma kappa per height, and the normal leans out of the section by the base helix angle beta_b. A point that lies
r_b (tan alpha_R - t) off the flank in its own section lies cos(beta_b) of that off it in space, and parallel surfaces
are the same screw turned: the gap closes as the mate turns by gap/(r_b cos beta_b), whichever point is looked at.
"""

import math
from typing import Any, NamedTuple

from tol3d.gearing.engines.exact.foot import (
    PER_TURN,
    TURN,
    alike,
    as_given,
    begun,
    external,
    first_face,
    foot,
    grown,
    internal,
    leaning,
    line_of_action,
    promise,
    section,
    sense_of,
    turn_to,
    widest,
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


class InternalHelicalTooth(NamedTuple):
    """Flanks of one gear of an internal helical pair; see HelicalTooth and internal.InternalTooth.

    Args:
        base, per_arm, cosine, rise, twist: as of a helical gear.
        half: half the angle [rad] that the involutes' own tooth takes at its base: of a ring the space, about the
            middle of the ring's tooth, which is less by half a pitch.
        begin, end: roll times sense [rad] where the flank begins at the root, and at the tip.
        low, high: ends of the face [mm], along the axis.
        sense: 1 of the pinion, -1 of the ring.
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
    sense: float


def resized(tooth: Any, scale: float, low: float, high: float) -> Any:
    """The teeth grown, between two heights [mm]; one variant a kind."""
    raise NotImplementedError


@variant(resized, HelicalTooth)
def gear_resized(tooth: HelicalTooth, scale: float, low: float, high: float) -> HelicalTooth:
    """Angles stay."""
    base, per_arm, twist = tooth.base * scale, tooth.per_arm / scale, tooth.twist / scale
    return HelicalTooth(base, per_arm, tooth.cosine, tooth.rise, twist, tooth.half, tooth.begin, tooth.end, low, high)


@variant(resized, InternalHelicalTooth)
def ring_resized(tooth: InternalHelicalTooth, scale: float, low: float, high: float) -> InternalHelicalTooth:
    """Angles stay."""
    base, per_arm, twist = tooth.base * scale, tooth.per_arm / scale, tooth.twist / scale
    profile = (tooth.half, tooth.begin, tooth.end)
    return InternalHelicalTooth(base, per_arm, tooth.cosine, tooth.rise, twist, *profile, low, high, tooth.sense)


def screw_grown(tooth: Any, scale: float) -> Any:
    """Every length grows, angles stay."""
    return resized(tooth, scale, tooth.low * scale, tooth.high * scale)


def screw_section(tooth: Any, share: float) -> Any:
    """One height."""
    at = tooth.low + share * (tooth.high - tooth.low)
    return resized(tooth, 1.0, at, at)


def screw_leaning(tooth: Any, sigma: float) -> Any:
    """-sigma kappa of the roll along a generator, times the sense."""
    return sense_of(tooth) * sigma * tooth.twist


def screw_foot(own: Any, mate: Any, pose: Pose, facing: Facing, profile: float, z: float) -> Foot:
    """See foot.foot: the point at a roll times sense [rad] and a height [mm]; sigma is the side of unwinding.

    Derivatives by the face are along the generator.
    """
    own_sense, mate_sense = sense_of(own), sense_of(mate)
    own_azimuth, mate_azimuth, sigma, offset = facing
    roll = own_sense * profile
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
    apart = mate_sense * (tangent - mate.base * same_height) * mate.cosine
    out = mate_sense * sigma
    nx, ny, nz = out * mate.cosine * uy, -out * mate.cosine * ux, out * mate.rise
    # the point moves along (cos, sin) as it rolls, across it as that turns, and along its generator
    vx, vy, vz = pose.xx * cos + pose.xy * sin, pose.yx * cos + pose.yy * sin, pose.zx * cos + pose.zy * sin
    wx, wy, wz = pose.xy * cos - pose.xx * sin, pose.yy * cos - pose.yx * sin, pose.zy * cos - pose.zx * sin
    slope = own.base * own.twist
    gx, gy, gz = slope * wx + pose.xz, slope * wy + pose.yz, slope * wz + pose.zz
    towards, turning = nx * vx + ny * vy + nz * vz, nx * wx + ny * wy + nz * wz
    across = own.base * roll * (ux * vx + uy * vy)
    sideways = ux * gx + uy * gy
    curvature = mate_sense * mate.cosine / tangent
    return Foot(
        apart - offset,
        (mate_sense * tangent - apart * mate.cosine) / mate.base,
        height - apart * out * mate.rise,
        (mate_sense * tangent - offset * mate.cosine) / mate.base,
        x,
        y,
        height,
        nx,
        ny,
        nz,
        own_sense * own.base * roll * towards,
        nx * gx + ny * gy + nz * gz,
        own.base * (towards + sigma * roll * turning) + across * across * curvature,
        own_sense * (across * sideways * curvature - sigma * slope * towards),
        sideways * sideways * curvature,
        0.0,
    )


def screw_turn(mate: Any, gap: float, offset: float, at: Foot) -> Any:
    """Flanks of one tooth that stand a turn apart lie r_b cos(beta_b) times that apart."""
    return gap * mate.per_arm


@part
def falling(own: Any, mate: Any, pose: Pose, sigma: float) -> tuple[float, float]:
    """Opening of the gap per height along the contact lines, nearly; and the tangent of both base circles [mm].

    (0, 0) of parallel axes, and where there is no such tangent.
    """
    own_sense, mate_sense = sense_of(own), sense_of(mate)
    outside = own_sense * mate_sense
    square, bases = pose.x * pose.x + pose.y * pose.y, outside * (own_sense * own.base + mate_sense * mate.base)
    if (pose.xz == 0.0 and pose.yz == 0.0) or square <= bases * bases:
        return 0.0, 0.0
    tangent, scale = math.sqrt(square - bases * bases), 1.0 / square
    cx, cy = own_sense * pose.x, own_sense * pose.y  # teeth of an internal pair meet beyond the axis of the inner gear
    ux, uy = scale * (cx * bases - sigma * cy * tangent), scale * (cy * bases + sigma * cx * tangent)
    # strings of two external gears point against each other: generators of the driver lean along -(-uy, ux)
    wx, wy = outside * (pose.xx * uy - pose.yx * ux), outside * (pose.xy * uy - pose.yy * ux)
    slope = own.base * own.twist
    gx = slope * (pose.xx * wx + pose.xy * wy) + pose.xz
    gy = slope * (pose.yx * wx + pose.yy * wy) + pose.yz
    gz = slope * (pose.zx * wx + pose.zy * wy) + pose.zz
    return mate_sense * sigma * (mate.cosine * (uy * gx - ux * gy) + mate.rise * gz), tangent


def first_end(own: Any, mate: Any, pose: Pose, sigma: float, face: float) -> float:
    """The end of the common face towards which all contact lines close as axes lean; the middle of parallel axes."""
    rate, tangent = falling(own, mate, pose, sigma)
    if tangent == 0.0:
        return face
    low: float = max(own.low, mate.low - pose.z)
    high: float = min(own.high, mate.high - pose.z)
    return low if rate > 0.0 else high


def screw_promise(own: Any, mate: Any, pose: Pose, sigma: float, start: float, apart: float) -> tuple[float, float]:
    """The opening by the lean at the lower end of a contact line, to first order; see stack_up/contact_lines.py.

    A line beside the flanks stands off by at least half its distance squared over their relative radius of curvature.
    The leeway covers mates that stand apart, whose lines end elsewhere, and what goes with squares of the lean.
    """
    own_sense, mate_sense = sense_of(own), sense_of(mate)
    rate, tangent = falling(own, mate, pose, sigma)
    if tangent == 0.0 or own.twist == 0.0:
        return 0.0, 0.0
    lean = own_sense * sigma * own.twist
    begin = max(own.begin, (own_sense * mate_sense * tangent - mate.base * mate.end) / own.base)
    first, last = (start - begin) / lean, (start - own.end) / lean
    low = max(min(first, last), own.low, mate.low - pose.z)
    high = min(max(first, last), own.high, mate.high - pose.z)
    beside = max(low - high, 0.0) * abs(lean) * own.base
    end = low if rate > 0.0 else high
    order = rate * (end - own_sense * sigma * own.rise * own.cosine * own.base * start)
    order += beside * beside / (2.0 * widest(own, mate, tangent))
    aside = (pose.xz * pose.xz + pose.yz * pose.yz) * max(own.low * own.low, own.high * own.high) / tangent
    leeway = abs(rate) * (FREE_ENDS + 2.0 * apart * own.cosine / abs(own.rise)) + SQUARES + aside
    return order, leeway + abs(rate) * 2.0 * beside * own.cosine / abs(own.rise)


@part
def between(low: float, high: float, at: float, fall: float, begin: float, end: float) -> tuple[float, float]:
    """The heights between two others at which a profile `at - fall z` lies between its ends."""
    if fall == 0.0:
        return (low, high) if begin <= at <= end else (low, low - 1.0)
    first, last = (at - begin) / fall, (at - end) / fall
    return max(low, min(first, last)), min(high, max(first, last))


def screw_line_of_action(own: Any, mate: Any, pose: Pose, facing: Facing, face: float) -> Nearest:
    """On parallel axes the flanks of a pair touch along a line: in every section as spur flanks, turned, do.

    The gap is the same along that line, and for every pair of one base pitch; see spur.spur_line_of_action and, of
    rings, internal.internal_line_of_action. Of the line there are the heights at which both flanks have its rolls.
    """
    own_sense, mate_sense = sense_of(own), sense_of(mate)
    outside = own_sense * mate_sense
    own_azimuth, mate_azimuth, sigma, offset = facing
    nowhere = Nearest(0.0, 0.0, NOWHERE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False, 0.0)
    square, bases = pose.x * pose.x + pose.y * pose.y, outside * (own_sense * own.base + mate_sense * mate.base)
    if pose.xz != 0.0 or pose.yz != 0.0 or square <= bases * bases:
        return nowhere
    tangent = math.sqrt(square - bases * bases)
    working = math.atan2(tangent, bases)
    cx, cy = own_sense * pose.x, own_sense * pose.y
    centres = math.atan2(cy, cx)
    opposite = math.pi if outside > 0.0 else 0.0
    # turned about z against each other, the gears see one direction at different azimuths
    twist = math.atan2(pose.yx, pose.xx) if pose.yx != 0.0 else 0.0
    angle = working + own.half - sigma * (own_azimuth + twist - centres - opposite)
    profile = own_sense * (angle - TURN * math.floor(angle * PER_TURN + 0.5))
    angle = working + mate.half - sigma * (mate_azimuth + mate.twist * pose.z - centres)
    mate_profile = mate_sense * (angle - TURN * math.floor(angle * PER_TURN + 0.5))
    gap = (outside * tangent - own.base * profile - mate.base * mate_profile) * mate.cosine - offset
    turn = gap * mate.per_arm
    low, high = max(own.low, mate.low - pose.z), min(own.high, mate.high - pose.z)
    fall = own_sense * sigma * own.twist
    low, high = between(low, high, profile, fall, own.begin, own.end)
    low, high = between(low, high, mate_profile, mate_sense * sigma * mate.twist, mate.begin, mate.end - max(turn, 0.0))
    if low > high:
        return nowhere
    at = min(max(face, low), high)
    profile -= fall * at
    scale, out = 1.0 / square, mate_sense * sigma
    ux, uy = scale * (cx * bases - sigma * cy * tangent), scale * (cy * bases + sigma * cx * tangent)
    nx, ny = out * uy, -out * ux
    along = outside * tangent - own.base * profile
    x, y = mate.base * ux + along * nx, mate.base * uy + along * ny
    return Nearest(
        gap,
        turn,
        ALIKE,
        profile,
        at,
        x,
        y,
        at + pose.z,
        mate.cosine * nx,
        mate.cosine * ny,
        out * mate.rise,
        False,
        0.0,
    )


external(HelicalTooth)
internal(InternalHelicalTooth)
for kind in (HelicalTooth, InternalHelicalTooth):
    alike(kind)
    for function, own in (
        (grown, screw_grown),
        (section, screw_section),
        (leaning, screw_leaning),
        (foot, screw_foot),
        (turn_to, screw_turn),
        (begun, as_given),
        (first_face, first_end),
        (promise, screw_promise),
        (line_of_action, screw_line_of_action),
    ):
        variant(function, kind)(own)
