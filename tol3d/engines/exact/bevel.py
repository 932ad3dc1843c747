"""Spherical-involute flanks of bevel gears: the foot of a point on the mate's flank, in closed form.

The plane through the point that touches the mate's base cone holds the flank's normal too. In it the point has the
in-plane angle q and the flank q_f = sin(beta) times its roll: the gap is R sin(q - q_f), and it closes as the mate
turns by (q - q_f)/sin(beta). See gears/spherical_involute.py for the plane and its vectors t, e; a is its normal.
"""

import math
from typing import NamedTuple

from tol3d.engines.exact.compiled import part, variant
from tol3d.engines.exact.foot import foot, grown, section
from tol3d.engines.exact.numbers import Foot

SMALL = 0.02  # rad; below it the sine's series of three terms is exact to 1e-15 of itself
LEAST_RISE = 1e-9  # mm; a point within the base cone has no such plane


class BevelTooth(NamedTuple):
    """Flanks of a bevel gear.

    Args:
        base, cosine: sine and cosine of the base angle.
        half: half the angle [rad] that a tooth takes at its base, about the axis.
        begin, end: in-plane angle [rad] where the flank begins and at the tip.
        low, high: ends of the face [mm], from the apex.
    """

    base: float
    cosine: float
    half: float
    begin: float
    end: float
    low: float
    high: float


@part
def small_sine(angle):
    """The sine, quick where the angle is small."""
    if abs(angle) > SMALL:
        return math.sin(angle)
    square = angle * angle
    return angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)))


@variant(grown, BevelTooth)
def bevel_grown(tooth, scale):
    """It grows about its apex: angles stay."""
    low, high = tooth.low * scale, tooth.high * scale
    return BevelTooth(tooth.base, tooth.cosine, tooth.half, tooth.begin, tooth.end, low, high)


@variant(section, BevelTooth)
def bevel_section(tooth, share):
    """One distance from the apex."""
    at = tooth.low + share * (tooth.high - tooth.low)
    return BevelTooth(tooth.base, tooth.cosine, tooth.half, tooth.begin, tooth.end, at, at)


@variant(foot, BevelTooth)
def bevel_foot(own, mate, pose, own_azimuth, mate_azimuth, sigma, offset, q, radius):
    """See foot.foot: the point at an in-plane angle [rad] and a cone distance [mm]."""
    f = own_azimuth + sigma * (q / own.base - own.half)
    cos, sin = math.cos(f), math.sin(f)
    cos_q, sin_q = math.cos(q), math.sin(q)
    # P = R (cos q t - sigma sin q e)
    dx = cos_q * own.base * cos + sigma * sin_q * sin
    dy = cos_q * own.base * sin - sigma * sin_q * cos
    dz = cos_q * own.cosine
    ex = pose.xx * dx + pose.xy * dy + pose.xz * dz
    ey = pose.yx * dx + pose.yy * dy + pose.yz * dz
    ez = pose.zx * dx + pose.zy * dy + pose.zz * dz
    x, y, z = radius * ex + pose.x, radius * ey + pose.y, radius * ez + pose.z
    square = x * x + y * y
    outwards = math.sqrt(square)
    high, low = outwards * mate.cosine, z * mate.base
    rise = math.sqrt(max((high - low) * (high + low), LEAST_RISE * LEAST_RISE))  # R cos(beta) sin q
    at = math.atan2(rise, z)
    ux = x * low - sigma * y * rise
    uy = y * low + sigma * x * rise
    angle = sigma * (math.atan2(uy, ux) - mate_azimuth) + mate.half
    roll = angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)
    beyond = at - mate.base * roll
    distance = math.sqrt(square + z * z)
    sin_beyond, cos_beyond = small_sine(beyond), 1.0 - 2.0 * small_sine(0.5 * beyond) ** 2
    ux /= square * mate.cosine
    uy /= square * mate.cosine
    sin_at, cos_at = rise / (distance * mate.cosine), z / (distance * mate.cosine)
    sin_foot = sin_at * cos_beyond - cos_at * sin_beyond
    cos_foot = cos_at * cos_beyond + sin_at * sin_beyond
    nx = -(sin_foot * mate.base * ux - sigma * cos_foot * uy)
    ny = -(sin_foot * mate.base * uy + sigma * cos_foot * ux)
    nz = -sin_foot * mate.cosine
    ax, ay, az = mate.cosine * ux, mate.cosine * uy, -mate.base
    # dP/dq = R sin q cot(beta) a, and a turns along sigma e cot(beta)
    cot = own.cosine / own.base
    bx, by, bz = own.cosine * cos, own.cosine * sin, -own.base
    vx = pose.xx * bx + pose.xy * by + pose.xz * bz
    vy = pose.yx * bx + pose.yy * by + pose.yz * bz
    vz = pose.zx * bx + pose.zy * by + pose.zz * bz
    wx, wy, wz = pose.xy * cos - pose.xx * sin, pose.yy * cos - pose.yx * sin, pose.zy * cos - pose.zx * sin
    towards = nx * vx + ny * vy + nz * vz
    turning = nx * wx + ny * wy + nz * wz
    speed = radius * sin_q * cot
    across = speed * (ax * vx + ay * vy + az * vz)
    sideways = ax * ex + ay * ey + az * ez
    by_face = nx * ex + ny * ey + nz * ez
    curvature = cos_at / (sin_at * distance)
    return Foot(
        distance * sin_beyond - offset,
        (beyond - (math.asin(offset / distance) if offset != 0.0 else 0.0)) / mate.base,
        mate.base * roll,
        distance * cos_beyond,
        at,
        x,
        y,
        z,
        nx,
        ny,
        nz,
        speed * towards,
        by_face,
        radius * cot * (cos_q * towards + sin_q * cot * sigma * turning) + across * across * curvature,
        sin_q * cot * towards + across * sideways * curvature,
        sideways * sideways * curvature,
        1.0 / distance,
        1.0 / (distance * cos_beyond * mate.base),
    )
