"""Involute flanks of internal pairs: an external pinion inside a ring, whose flanks are concave.

The flank of a ring is the involute of an external tooth, its space, with the material on the other side; it touches a
pinion's flank that unwinds the same way. With s = 1 of the pinion and -1 of the ring a point at the distance rho from
the mate's axis has the gap s (sqrt(rho^2 - r_b^2) - r_b t) from the mate's flank: as of spur gears, see spur.py, but
what lies outside a space is inside its tooth. Along a flank counts s t, the roll of a ring backwards: it grows from
root to tip on both.
"""

import math
from typing import NamedTuple

from tol3d.gearing.engines.exact.foot import (
    PER_TURN,
    TURN,
    alike,
    foot,
    grown,
    internal,
    line_of_action,
    section,
    straight,
    turn_to,
)
from tol3d.gearing.engines.exact.numbers import ALIKE, NOWHERE, Facing, Nearest, Pose
from tol3d.gearing.engines.exact.spur import involute_foot, involute_turn
from tol3d.numerics.compiled import variant


class InternalTooth(NamedTuple):
    """Flanks of one gear of an internal pair.

    Args:
        base, per_base: base radius [mm] and one over it.
        half: half the angle [rad] that the involutes' own tooth takes at its base: of a ring the space, about the
            middle of the ring's tooth, which is less by half a pitch.
        begin, end: roll times sense [rad] where the flank begins at the root, and at the tip.
        low, high: ends of the face [mm], along the axis.
        sense: 1 of the pinion, -1 of the ring.
    """

    base: float
    per_base: float
    half: float
    begin: float
    end: float
    low: float
    high: float
    sense: float


internal(InternalTooth)
alike(InternalTooth)
straight(InternalTooth)
variant(foot, InternalTooth)(involute_foot)
variant(turn_to, InternalTooth)(involute_turn)


@variant(grown, InternalTooth)
def internal_grown(tooth: InternalTooth, scale: float) -> InternalTooth:
    """Every length grows."""
    base, low, high = tooth.base * scale, tooth.low * scale, tooth.high * scale
    return InternalTooth(base, 1.0 / base, tooth.half, tooth.begin, tooth.end, low, high, tooth.sense)


@variant(section, InternalTooth)
def internal_section(tooth: InternalTooth, share: float) -> InternalTooth:
    """One height."""
    at = tooth.low + share * (tooth.high - tooth.low)
    return InternalTooth(tooth.base, tooth.per_base, tooth.half, tooth.begin, tooth.end, at, at, tooth.sense)


@variant(line_of_action, InternalTooth)
def internal_line_of_action(
    internal_tooth: InternalTooth, mate: InternalTooth, pose: Pose, facing: Facing, face: float
) -> Nearest:
    """On parallel axes flanks touch on the line that touches both base circles, whose ends are T apart.

    From these the flanks stand r_b t away, t = alpha_w + half - sigma (azimuth off the line of centres): the gap is
    r_b t of the ring less that of the pinion and T, the same for every pair of one base pitch.
    """
    own_azimuth, mate_azimuth, sigma, offset = facing
    nowhere = Nearest(0.0, 0.0, NOWHERE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False, 0.0)
    square, bases = (
        pose.x * pose.x + pose.y * pose.y,
        -internal_tooth.sense * internal_tooth.base - mate.sense * mate.base,
    )
    if pose.xz != 0.0 or pose.yz != 0.0 or square <= bases * bases:
        return nowhere
    low, high = max(internal_tooth.low, mate.low - pose.z), min(internal_tooth.high, mate.high - pose.z)
    if low > high:
        return nowhere
    tangent = math.sqrt(square - bases * bases)
    working = math.atan2(tangent, bases)
    # the teeth meet beyond the pinion's axis, seen from the ring's
    cx, cy = -mate.sense * pose.x, -mate.sense * pose.y
    centres = math.atan2(cy, cx)
    # turned about z against each other, the gears see one direction at different azimuths
    twist = math.atan2(pose.yx, pose.xx) if pose.yx != 0.0 else 0.0
    angle = working + internal_tooth.half - sigma * (own_azimuth + twist - centres)
    roll = angle - TURN * math.floor(angle * PER_TURN + 0.5)
    angle = working + mate.half - sigma * (mate_azimuth - centres)
    mate_roll = angle - TURN * math.floor(angle * PER_TURN + 0.5)
    gap = -internal_tooth.sense * internal_tooth.base * roll - mate.sense * mate.base * mate_roll - tangent - offset
    profile, foot_at = internal_tooth.sense * roll, mate.sense * mate_roll
    touching = foot_at + gap * mate.per_base
    if not (
        internal_tooth.begin <= profile <= internal_tooth.end
        and mate.begin <= foot_at <= mate.end
        and touching <= mate.end
    ):
        return nowhere
    scale = 1.0 / square
    ux, uy = scale * (cx * bases - sigma * cy * tangent), scale * (cy * bases + sigma * cx * tangent)
    out = mate.sense * sigma
    nx, ny = out * uy, -out * ux
    along = mate.sense * mate.base * mate_roll + gap + offset
    at = min(max(face, low), high)
    x, y = mate.base * ux + along * nx, mate.base * uy + along * ny
    return Nearest(gap, gap * mate.per_base, ALIKE, profile, at, x, y, at + pose.z, nx, ny, 0.0, False, 0.0)
