"""Nearest points of two flanks: Newton's method on the gap over profile and face, ends of both flanks included.

`foot` gives the gap of a point of one flank from the other's endless flank, with its derivatives: nothing else is
needed of a kind of gears.
"""

import math
from typing import Any

from tol3d.gearing.engines.exact.foot import begun, foot, leaning, line_of_action, turn_to
from tol3d.gearing.engines.exact.numbers import AT_EDGE, BEYOND, CLOSED, NOWHERE, Facing, Foot, Nearest, Pose
from tol3d.numerics.compiled import part

STEPS = 20  # Newton takes one or two from the line of action; more only where a face ends
QUICK_FALL = 1e-8  # mm; enough for the gap: it is a parabola to 1e-4 of such a step's fall
SHARP_FALL = 1e-14  # mm; for points and normals too
END = 1e-9  # mm; a foot so near to an end of the face is at it
SHORT = 1e-3  # mm; of a last step along the face
LEVEL = 1e-13  # fall per length along a generator that is no more than rounding
FLAT = 1e-15  # 1/mm; bow of the gap along the face that is no more than rounding


@part
def down_to(slope: float, bow: float, low: float, high: float) -> float:
    """The way to the lowest point of `slope w + bow w^2/2` between two ends."""
    if bow > FLAT:
        return min(max(-slope / bow, low), high)
    if slope == 0.0:
        return min(max(0.0, low), high)
    return low if slope > 0.0 else high


@part
def started(own: Any, lean: float, start: float, face: float) -> tuple[float, float]:
    """The start on own flank for a profile parameter and a face: along its generator as far as the profile goes."""
    if lean != 0.0:
        beyond = start - min(max(start, own.begin), own.end)
        moved = min(max(face + beyond / lean, own.low), own.high)
        start, face = start - lean * (moved - face), moved
    return min(max(start, own.begin), own.end), face


@part
def slanted(
    own: Any, lean: float, at: Foot, place: tuple[float, float], by_face: float, along: float, ends: tuple[float, float]
) -> tuple[float, float]:
    """The steps across the generators and along them to the lowest gap over a flank whose generators lean.

    On an end of the profile a step along the face takes `lean` times itself across the generators.

    Args:
        own: its teeth.
        lean: see foot.leaning.
        at: the foot at `place`, (profile, face).
        by_face: derivative of the gap along the generator.
        along: step along it to the lowest gap, were the profile endless.
        ends: of that step, where the common face ends.
    """
    profile, per_bend = place[0], 1.0 / at.bend
    moved = profile - (at.by_profile + at.twist * along) * per_bend - lean * along
    end = min(max(moved, own.begin), own.end)
    if end != moved:
        first = end - profile
        slope = by_face + at.twist * first + lean * (at.by_profile + at.bend * first)
        along = down_to(slope, at.bow + lean * (2.0 * at.twist + lean * at.bend), ends[0], ends[1])
        moved = profile - (at.by_profile + at.twist * along) * per_bend - lean * along
    return min(max(moved, own.begin), own.end) - profile + lean * along, along


@part
def lowest(
    own: Any, mate: Any, pose: Pose, facing: Facing, start: float, face: float, per_turn: float, last_fall: float
) -> tuple[Foot, float, float, float, bool]:
    """The lowest gap over own flank, and where: (foot, last fall, profile, face, whether the faces overlap).

    Args:
        own, mate: the gears' teeth; of `own`, low and high bound the search along the face.
        pose: mate from own.
        facing: which flanks.
        start, face: where to start on `own`.
        per_turn: 1 to look for the smallest turn of the mate, 0 for the smallest gap.
        last_fall: [mm], a step that lowers the gap by less is the last; it is not looked at again.
    """
    lean = leaning(own, facing.sigma)
    profile, face = started(own, lean, start, face)
    fall, steps = 0.0, STEPS
    while True:
        at = foot(own, mate, pose, facing, profile, face)
        # a point that the mate turns to touches it as far from the apex as the point is, not as its foot is
        there = at.face + 0.5 * per_turn * at.gap * at.gap * at.nearness
        low, high = max(own.low, face + mate.low - there), min(own.high, face + mate.high - there)
        if low > high:
            return at, fall, profile, face, False
        by_face = at.by_face - per_turn * at.gap * at.nearness
        per_bend = 1.0 / at.bend
        slope = by_face - at.twist * at.by_profile * per_bend
        along = down_to(slope, at.bow - at.twist * at.twist * per_bend, low - face, high - face)
        moved = profile - (at.by_profile + at.twist * along) * per_bend
        aside = min(max(moved, own.begin), own.end) - profile
        if lean != 0.0:
            if abs(slope) < LEVEL:  # parallel axes: all of a generator is as near
                along = min(max(0.0, low - face), high - face)
            aside, along = slanted(own, lean, at, (profile, face), by_face, along, (low - face, high - face))
        elif profile + aside != moved:
            # held by an end of the profile: along the face the gap falls as it does there
            along = down_to(by_face + at.twist * aside, at.bow, low - face, high - face)
            moved = profile - (at.by_profile + at.twist * along) * per_bend
            aside = min(max(moved, own.begin), own.end) - profile
        fall = at.by_profile * aside + by_face * along
        fall += 0.5 * (at.bend * aside * aside + at.bow * along * along) + at.twist * aside * along
        profile += aside
        if lean != 0.0:
            profile -= lean * along
        face += along
        steps -= 1
        if (abs(fall) < last_fall and abs(along) < SHORT) or steps == 0:
            return at, fall, profile, face, True


@part
def inverse(pose: Pose) -> Pose:
    """Own from mate, of mate from own."""
    x = -(pose.xx * pose.x + pose.yx * pose.y + pose.zx * pose.z)
    y = -(pose.xy * pose.x + pose.yy * pose.y + pose.zy * pose.z)
    z = -(pose.xz * pose.x + pose.yz * pose.y + pose.zz * pose.z)
    return Pose(pose.xx, pose.yx, pose.zx, pose.xy, pose.yy, pose.zy, pose.xz, pose.yz, pose.zz, x, y, z)


@part
def nearest(
    own: Any, mate: Any, pose: Pose, facing: Facing, start: float, face: float, per_turn: float, last_fall: float
) -> Nearest:
    """The nearest points of two flanks; arguments as in `lowest`.

    Where the foot would lie beyond an end of the mate's profile, its tip edge most often, that edge is nearest to own
    flank: the same search the other way round.
    """
    straight = line_of_action(own, mate, pose, facing, face)
    if straight.how != NOWHERE:
        return straight
    first = begun(own, mate, pose, facing, start, face)
    at, fall, profile, face, overlap = lowest(own, mate, pose, facing, first.profile, first.face, per_turn, last_fall)
    offset = facing.offset
    lean = (at.gap + offset) * at.nearness * at.nearness
    if not overlap:
        return Nearest(math.inf, math.inf, CLOSED, profile, face, at.x, at.y, at.z, at.nx, at.ny, at.nz, False, lean)
    # where the mate's face ends, its edge is nearest to own flank: to second order the gap is the same, not the normal
    inside = own.low < face < own.high and own.begin < profile < own.end
    face_ends = last_fall <= SHARP_FALL and inside and not mate.low + END < at.face < mate.high - END
    if mate.begin <= at.profile <= mate.end and not face_ends:
        gap = at.gap + fall
        turn = turn_to(mate, gap, offset, at)
        how = CLOSED if mate.begin <= at.touching <= mate.end else AT_EDGE
        if leaning(mate, facing.sigma) != 0.0 and not mate.low + SHORT < at.face < mate.high - SHORT:
            how = AT_EDGE  # the foot moves along the mate's face as the gap closes
        if profile <= own.begin:  # below it there is neither flank nor edge
            how = BEYOND
        at_end = not own.begin < profile < own.end
        return Nearest(gap, turn, how, profile, face, at.x, at.y, at.z, at.nx, at.ny, at.nz, at_end, lean)
    edge, edge_face = min(max(at.profile, mate.begin), mate.end), at.face
    if first.known:
        edge, edge_face = first.mate_profile, first.mate_face
    back = Facing(facing.mate_azimuth, facing.own_azimuth, facing.sigma, offset)
    its, its_fall, its_own, _, overlap = lowest(mate, own, inverse(pose), back, edge, edge_face, per_turn, last_fall)
    if not overlap:
        return Nearest(math.inf, math.inf, CLOSED, profile, face, at.x, at.y, at.z, at.nx, at.ny, at.nz, False, lean)
    how = AT_EDGE if own.begin < its.profile <= own.end and at.profile >= mate.begin else BEYOND
    if first.known and how == BEYOND:  # both searches left the other's flank: the lowest place on both of them stays
        at = foot(own, mate, pose, facing, first.profile, first.face)
        turn, at_end = turn_to(mate, at.gap, offset, at), not own.begin < first.profile < own.end
        return Nearest(
            at.gap, turn, AT_EDGE, first.profile, first.face, at.x, at.y, at.z, at.nx, at.ny, at.nz, at_end, 0.0
        )
    # the foot on own flank, and the way from the mate's edge to it, in the mate's frame
    apart = its.gap + offset
    px, py, pz = its.x - apart * its.nx, its.y - apart * its.ny, its.z - apart * its.nz
    x = pose.xx * px + pose.xy * py + pose.xz * pz + pose.x
    y = pose.yx * px + pose.yy * py + pose.yz * pz + pose.y
    z = pose.zx * px + pose.zy * py + pose.zz * pz + pose.z
    nx = -(pose.xx * its.nx + pose.xy * its.ny + pose.xz * its.nz)
    ny = -(pose.yx * its.nx + pose.yy * its.ny + pose.yz * its.nz)
    nz = -(pose.zx * its.nx + pose.zy * its.ny + pose.zz * its.nz)
    arm = abs(ny * x - nx * y)
    gap = its.gap + its_fall
    at_end = not (mate.begin < its_own < mate.end and own.begin < its.profile < own.end)
    return Nearest(gap, gap / arm, how, its.profile, its.face, x, y, z, nx, ny, nz, at_end, 0.0)
