"""Spherical-involute flanks of bevel gears: the foot of a point on the mate's flank, in closed form.

The plane through the point that touches the mate's base cone holds the flank's normal too. In it the point has the
in-plane angle q and the flank q_f = sin(beta) times its roll: the gap is R sin(q - q_f), and it closes as the mate
turns by (q - q_f)/sin(beta). See gears/spherical_involute.py for the plane and its vectors t, e; a is its normal.
"""

import math
from typing import NamedTuple

from tol3d.gearing.engines.exact.foot import (
    PER_TURN,
    TURN,
    alike,
    external,
    foot,
    grown,
    line_of_action,
    section,
    straight,
    turn_to,
)
from tol3d.gearing.engines.exact.numbers import NOWHERE, Facing, Foot, Nearest, Pose, arcsine, sine
from tol3d.numerics.compiled import inlined, variant

LEAST_RISE = 1e-9  # mm; a point within the base cone has no such plane


class BevelTooth(NamedTuple):
    """Flanks of a bevel gear.

    Args:
        base, cosine: sine and cosine of the base angle.
        per_base, per_cosine: one over them.
        half: half the angle [rad] that a tooth takes at its base, about the axis.
        begin, end: in-plane angle [rad] where the flank begins and at the tip.
        low, high: ends of the face [mm], from the apex.
    """

    base: float
    cosine: float
    per_base: float
    per_cosine: float
    half: float
    begin: float
    end: float
    low: float
    high: float


external(BevelTooth)
alike(BevelTooth)
straight(BevelTooth)


@variant(grown, BevelTooth)
def bevel_grown(tooth: BevelTooth, scale: float) -> BevelTooth:
    """It grows about its apex: angles stay."""
    low, high = tooth.low * scale, tooth.high * scale
    return BevelTooth(
        tooth.base, tooth.cosine, tooth.per_base, tooth.per_cosine, tooth.half, tooth.begin, tooth.end, low, high
    )


@variant(section, BevelTooth)
def bevel_section(tooth: BevelTooth, share: float) -> BevelTooth:
    """One distance from the apex."""
    at = tooth.low + share * (tooth.high - tooth.low)
    return BevelTooth(
        tooth.base, tooth.cosine, tooth.per_base, tooth.per_cosine, tooth.half, tooth.begin, tooth.end, at, at
    )


@inlined
def in_mate(pose: Pose, x: float, y: float, z: float) -> tuple[float, float, float]:
    """A vector of own frame in the mate's."""
    return (
        pose.xx * x + pose.xy * y + pose.xz * z,
        pose.yx * x + pose.yy * y + pose.yz * z,
        pose.zx * x + pose.zy * y + pose.zz * z,
    )


@variant(foot, BevelTooth)
def bevel_foot(bevel_tooth: BevelTooth, mate: BevelTooth, pose: Pose, facing: Facing, q: float, radius: float) -> Foot:
    """See foot.foot: the point at an in-plane angle [rad] and a cone distance [mm]."""
    own_azimuth, mate_azimuth, sigma, offset = facing
    f = own_azimuth + sigma * (q * bevel_tooth.per_base - bevel_tooth.half)
    cos, sin = math.cos(f), math.sin(f)
    cos_q, sin_q = math.cos(q), math.sin(q)
    # P = R (cos q t - sigma sin q e)
    dx = cos_q * bevel_tooth.base * cos + sigma * sin_q * sin
    dy = cos_q * bevel_tooth.base * sin - sigma * sin_q * cos
    dz = cos_q * bevel_tooth.cosine
    ex, ey, ez = in_mate(pose, dx, dy, dz)
    x, y, z = radius * ex + pose.x, radius * ey + pose.y, radius * ez + pose.z
    square = x * x + y * y
    high, low = math.sqrt(square) * mate.cosine, z * mate.base
    rise = math.sqrt(max((high - low) * (high + low), LEAST_RISE * LEAST_RISE))  # R cos(beta) sin q
    at = math.atan2(rise, z)
    ux = x * low - sigma * y * rise
    uy = y * low + sigma * x * rise
    angle = sigma * (math.atan2(uy, ux) - mate_azimuth) + mate.half
    foot_q = mate.base * (angle - TURN * math.floor(angle * PER_TURN + 0.5))
    beyond = at - foot_q
    distance = math.sqrt(square + z * z)
    nearness = 1.0 / distance
    sin_beyond = sine(beyond)
    cos_beyond = math.sqrt(1.0 - sin_beyond * sin_beyond)
    scale = mate.per_cosine / square
    ux *= scale
    uy *= scale
    sin_at, cos_at = rise * nearness * mate.per_cosine, z * nearness * mate.per_cosine
    sin_foot = sin_at * cos_beyond - cos_at * sin_beyond
    cos_foot = cos_at * cos_beyond + sin_at * sin_beyond
    nx = -(sin_foot * mate.base * ux - sigma * cos_foot * uy)
    ny = -(sin_foot * mate.base * uy + sigma * cos_foot * ux)
    nz = -sin_foot * mate.cosine
    ax, ay, az = mate.cosine * ux, mate.cosine * uy, -mate.base
    # dP/dq = R sin q cot(beta) a, and a turns along sigma e cot(beta)
    cot = bevel_tooth.cosine * bevel_tooth.per_base
    bx, by, bz = bevel_tooth.cosine * cos, bevel_tooth.cosine * sin, -bevel_tooth.base
    vx, vy, vz = in_mate(pose, bx, by, bz)
    wx, wy, wz = pose.xy * cos - pose.xx * sin, pose.yy * cos - pose.yx * sin, pose.zy * cos - pose.zx * sin
    towards = nx * vx + ny * vy + nz * vz
    turning = nx * wx + ny * wy + nz * wz
    speed = radius * sin_q * cot
    across = speed * (ax * vx + ay * vy + az * vz)
    sideways = ax * ex + ay * ey + az * ez
    curvature = z / rise * nearness
    gap, face, touching = distance * sin_beyond - offset, distance * cos_beyond, at - offset * nearness
    by_profile, by_face = speed * towards, nx * ex + ny * ey + nz * ez
    bend = radius * cot * (cos_q * towards + sin_q * cot * sigma * turning) + across * across * curvature
    twist, bow = sin_q * cot * towards + across * sideways * curvature, sideways * sideways * curvature
    return Foot(gap, foot_q, face, touching, x, y, z, nx, ny, nz, by_profile, by_face, bend, twist, bow, nearness)


@variant(turn_to, BevelTooth)
def bevel_turn(mate: BevelTooth, gap: float, offset: float, at: Foot) -> float:
    """The in-plane angles of point and flank differ by as much as sin(beta) times the turn."""
    beyond = arcsine((gap + offset) * at.nearness)
    if offset != 0.0:
        beyond -= arcsine(offset * at.nearness)
    return beyond * mate.per_base


@variant(line_of_action, BevelTooth)
def bevel_line_of_action(bevel_tooth: BevelTooth, mate: BevelTooth, pose: Pose, facing: Facing, face: float) -> Nearest:
    """Nothing is closed as soon as the apexes part."""
    return Nearest(0.0, 0.0, NOWHERE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False, 0.0)
