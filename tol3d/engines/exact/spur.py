"""Involute flanks of spur gears: the foot of a point on the mate's flank, in closed form.

A point at the distance rho from the mate's axis lies on a tangent of its base circle, s = sqrt(rho^2 - r_b^2) from
where that touches, at the azimuth psi. The mate's flank crosses that tangent at right angles r_b t from there,
t = sigma (psi - azimuth) + eta_b its roll: the gap is s - r_b t, and it closes as the mate turns by gap / r_b.
"""

import math
from typing import NamedTuple

from tol3d.engines.exact.compiled import variant
from tol3d.engines.exact.foot import foot, grown, section
from tol3d.engines.exact.numbers import Foot

SHORTEST_TANGENT = 1e-9  # mm; a point within the base circle has none


class SpurTooth(NamedTuple):
    """Flanks of a spur gear.

    Args:
        base: base radius [mm].
        half: half the angle [rad] that a tooth takes at its base.
        begin, end: roll [rad] where the flank begins and at the tip.
        low, high: ends of the face [mm], along the axis.
    """

    base: float
    half: float
    begin: float
    end: float
    low: float
    high: float


@variant(grown, SpurTooth)
def spur_grown(tooth, scale):
    """Every length grows."""
    return SpurTooth(tooth.base * scale, tooth.half, tooth.begin, tooth.end, tooth.low * scale, tooth.high * scale)


@variant(section, SpurTooth)
def spur_section(tooth, share):
    """One height."""
    at = tooth.low + share * (tooth.high - tooth.low)
    return SpurTooth(tooth.base, tooth.half, tooth.begin, tooth.end, at, at)


@variant(foot, SpurTooth)
def spur_foot(own, mate, pose, own_azimuth, mate_azimuth, sigma, offset, roll, z):
    """See foot.foot: the point at a roll [rad] and a height [mm]."""
    beta = sigma * (roll - own.half) + own_azimuth
    cos, sin = math.cos(beta), math.sin(beta)
    px = own.base * (cos + sigma * roll * sin)
    py = own.base * (sin - sigma * roll * cos)
    x = pose.xx * px + pose.xy * py + pose.xz * z + pose.x
    y = pose.yx * px + pose.yy * py + pose.yz * z + pose.y
    height = pose.zx * px + pose.zy * py + pose.zz * z + pose.z
    square = x * x + y * y
    tangent = math.sqrt(max(square - mate.base * mate.base, SHORTEST_TANGENT * SHORTEST_TANGENT))
    ux = x * mate.base - sigma * y * tangent
    uy = y * mate.base + sigma * x * tangent
    angle = sigma * (math.atan2(uy, ux) - mate_azimuth) + mate.half
    at_roll = angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)
    ux /= square
    uy /= square
    nx, ny = sigma * uy, -sigma * ux
    # the point moves along (cos, sin) as it rolls, across it as that turns
    vx, vy = pose.xx * cos + pose.xy * sin, pose.yx * cos + pose.yy * sin
    wx, wy = pose.xy * cos - pose.xx * sin, pose.yy * cos - pose.yx * sin
    towards = nx * vx + ny * vy
    across = own.base * roll * (ux * vx + uy * vy)
    sideways = ux * pose.xz + uy * pose.yz
    gap = tangent - mate.base * at_roll - offset
    return Foot(
        gap,
        gap / mate.base,
        at_roll,
        height,
        tangent / mate.base,
        x,
        y,
        height,
        nx,
        ny,
        0.0,
        own.base * roll * towards,
        nx * pose.xz + ny * pose.yz,
        own.base * (towards + sigma * roll * (nx * wx + ny * wy)) + across * across / tangent,
        across * sideways / tangent,
        sideways * sideways / tangent,
        0.0,
        1.0 / mate.base,
    )
