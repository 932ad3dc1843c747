"""Involute flanks of spur gears: the foot of a point on the mate's flank, in closed form.

A point at the distance rho from the mate's axis lies on a tangent of its base circle, s = sqrt(rho^2 - r_b^2) from
where that touches, at the azimuth psi. The mate's flank crosses that tangent at right angles r_b t from there,
t = sigma (psi - azimuth) + eta_b its roll: the gap is s - r_b t, and it closes as the mate turns by gap / r_b.
"""

import math
from typing import Any, NamedTuple

from tol3d.gearing.engines.exact.foot import (
    PER_TURN,
    TURN,
    alike,
    external,
    foot,
    grown,
    line_of_action,
    section,
    sense_of,
    straight,
    turn_to,
)
from tol3d.gearing.engines.exact.numbers import ALIKE, NOWHERE, Facing, Foot, Nearest, Pose
from tol3d.numerics.compiled import variant

SHORTEST_TANGENT = 1e-9  # mm; a point within the base circle has none


class SpurTooth(NamedTuple):
    """Flanks of a spur gear.

    Args:
        base, per_base: base radius [mm] and one over it.
        half: half the angle [rad] that a tooth takes at its base.
        begin, end: roll [rad] where the flank begins and at the tip.
        low, high: ends of the face [mm], along the axis.
    """

    base: float
    per_base: float
    half: float
    begin: float
    end: float
    low: float
    high: float


external(SpurTooth)
alike(SpurTooth)
straight(SpurTooth)


@variant(grown, SpurTooth)
def spur_grown(tooth: SpurTooth, scale: float) -> SpurTooth:
    """Every length grows."""
    base, low, high = tooth.base * scale, tooth.low * scale, tooth.high * scale
    return SpurTooth(base, 1.0 / base, tooth.half, tooth.begin, tooth.end, low, high)


@variant(section, SpurTooth)
def spur_section(tooth: SpurTooth, share: float) -> SpurTooth:
    """One height."""
    at = tooth.low + share * (tooth.high - tooth.low)
    return SpurTooth(tooth.base, tooth.per_base, tooth.half, tooth.begin, tooth.end, at, at)


@variant(foot, SpurTooth)
def involute_foot(own: Any, mate: Any, pose: Pose, facing: Facing, profile: float, z: float) -> Foot:
    """See foot.foot: the point at a roll times sense [rad] and a height [mm]; sigma is the side of unwinding."""
    own_sense, mate_sense = sense_of(own), sense_of(mate)
    own_azimuth, mate_azimuth, sigma, offset = facing
    roll = own_sense * profile
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
    foot_roll = angle - TURN * math.floor(angle * PER_TURN + 0.5)
    scale = 1.0 / square
    ux *= scale
    uy *= scale
    out = mate_sense * sigma
    nx, ny = out * uy, -out * ux
    # the point moves along (cos, sin) as it rolls, across it as that turns
    vx, vy = pose.xx * cos + pose.xy * sin, pose.yx * cos + pose.yy * sin
    wx, wy = pose.xy * cos - pose.xx * sin, pose.yy * cos - pose.yx * sin
    towards = nx * vx + ny * vy
    across = own.base * roll * (ux * vx + uy * vy)
    sideways = ux * pose.xz + uy * pose.yz
    curvature = mate_sense / tangent
    return Foot(
        mate_sense * (tangent - mate.base * foot_roll) - offset,
        mate_sense * foot_roll,
        height,
        (mate_sense * tangent - offset) * mate.per_base,
        x,
        y,
        height,
        nx,
        ny,
        0.0,
        own_sense * own.base * roll * towards,
        nx * pose.xz + ny * pose.yz,
        own.base * (towards + sigma * roll * (nx * wx + ny * wy)) + across * across * curvature,
        own_sense * across * sideways * curvature,
        sideways * sideways * curvature,
        0.0,
    )


@variant(turn_to, SpurTooth)
def involute_turn(mate: Any, gap: float, offset: float, at: Foot) -> Any:
    """Flanks of one tooth that stand a turn apart lie the base radius times that apart."""
    return gap * mate.per_base


@variant(line_of_action, SpurTooth)
def spur_line_of_action(spur_tooth: SpurTooth, mate: SpurTooth, pose: Pose, facing: Facing, face: float) -> Nearest:
    """On parallel axes flanks touch where they cross the tangent of both base circles, T long.

    From its ends the flanks stand r_b t away, t = alpha_w + eta_b - sigma (azimuth off the line of centres): what is
    left of T is the gap, the same for every pair of one base pitch.
    """
    own_azimuth, mate_azimuth, sigma, offset = facing
    nowhere = Nearest(0.0, 0.0, NOWHERE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False, 0.0)
    square, bases = pose.x * pose.x + pose.y * pose.y, spur_tooth.base + mate.base
    if pose.xz != 0.0 or pose.yz != 0.0 or square <= bases * bases:
        return nowhere
    low, high = max(spur_tooth.low, mate.low - pose.z), min(spur_tooth.high, mate.high - pose.z)
    if low > high:
        return nowhere
    tangent = math.sqrt(square - bases * bases)
    working = math.atan2(tangent, bases)
    centres = math.atan2(pose.y, pose.x)
    # turned about z against each other, the gears see one direction at different azimuths
    twist = math.atan2(pose.yx, pose.xx) if pose.yx != 0.0 else 0.0
    angle = working + spur_tooth.half - sigma * (own_azimuth + twist - centres - math.pi)
    roll = angle - TURN * math.floor(angle * PER_TURN + 0.5)
    angle = working + mate.half - sigma * (mate_azimuth - centres)
    mate_roll = angle - TURN * math.floor(angle * PER_TURN + 0.5)
    gap = tangent - spur_tooth.base * roll - mate.base * mate_roll - offset
    touching = mate_roll + gap * mate.per_base
    if not (
        spur_tooth.begin <= roll <= spur_tooth.end and mate.begin <= mate_roll <= mate.end and touching <= mate.end
    ):
        return nowhere
    scale = 1.0 / square
    ux, uy = scale * (pose.x * bases - sigma * pose.y * tangent), scale * (pose.y * bases + sigma * pose.x * tangent)
    nx, ny = sigma * uy, -sigma * ux
    along = tangent - spur_tooth.base * roll
    at = min(max(face, low), high)
    x, y = mate.base * ux + along * nx, mate.base * uy + along * ny
    return Nearest(gap, gap * mate.per_base, ALIKE, roll, at, x, y, at + pose.z, nx, ny, 0.0, False, 0.0)
