"""Helical gears whose flanks deviate tooth by tooth: feet and lines of action as of HelicalTooth, less flank offsets.

In each transverse section a flank stands out of its involute by an offset of roll and height, along the tangent of the
base circle; cos(beta_b) of that is the offset d along the normals, which all coefficients mean. A point of it lies on
the same screw surface turned by d/(r_b cos beta_b), in its section as much further on the string. Along the contact
line of a pair the involutes do not curve away: there the offsets of both flanks alone decide where it touches. Levels
and slopes are straight along it, and an end is lowest. Forms of profiles are not among them. Neglected terms are of the
order of (a slope)^2 times the offset, 1e-8 um.
"""

import math
from typing import Any, NamedTuple

from tol3d.gearing.engines.exact.deviated import (
    AHEAD,
    LEAST_BEND,
    PLACES,
    SHAPES,
    START,
    TEETH,
    FlankOffsets,
    Offset,
    is_level,
    offset_at,
    offsets_in,
)
from tol3d.gearing.engines.exact.foot import (
    begun,
    external,
    first_face,
    flank_of,
    flanks_in,
    foot,
    grown,
    leaning,
    line_of_action,
    middle_face,
    never_quickly,
    no_promise,
    opening,
    promise,
    quick_turn,
    section,
    sense_of,
    turn_to,
)
from tol3d.gearing.engines.exact.helical import HelicalTooth, between
from tol3d.gearing.engines.exact.nearest import started
from tol3d.gearing.engines.exact.numbers import CLOSED, NOWHERE, Facing, Foot, Nearest, Pose, Start
from tol3d.numerics.compiled import part, variant

ACROSS = 2  # Newton's steps across the line at each height


class DeviatedHelicalTooth(NamedTuple):
    """Flanks of a helical gear, and the offset of one of them.

    Args:
        base ... high: as of HelicalTooth.
        scale ... helix: as of DeviatedTooth.
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
    scale: float
    middle: float
    per_length: float
    per_face: float
    waves: float
    level: float
    slope: float
    form: float
    helix: float


def plain_screw(tooth: Any) -> Any:
    """The screw involutes from which flanks deviate; one variant a kind."""
    raise NotImplementedError


def of_screw(tooth: Any, screw: Any, scale: float, flank: tuple[float, float, float, float]) -> Any:
    """Deviations of other involutes: level, slope, form and helix [mm] of a flank; one variant a kind."""
    raise NotImplementedError


external(DeviatedHelicalTooth)
variant(first_face, DeviatedHelicalTooth)(middle_face)
variant(promise, DeviatedHelicalTooth)(no_promise)
variant(flanks_in, DeviatedHelicalTooth)(offsets_in)
variant(quick_turn, DeviatedHelicalTooth)(never_quickly)


@variant(plain_screw, DeviatedHelicalTooth)
def external_screw(tooth: DeviatedHelicalTooth) -> HelicalTooth:
    """Without the offsets."""
    t = tooth
    return HelicalTooth(t.base, t.per_arm, t.cosine, t.rise, t.twist, t.half, t.begin, t.end, t.low, t.high)


@variant(of_screw, DeviatedHelicalTooth)
def deviated_external_screw(
    tooth: DeviatedHelicalTooth, screw: HelicalTooth, scale: float, flank: tuple[float, float, float, float]
) -> DeviatedHelicalTooth:
    """With the offsets."""
    s, t = screw, tooth
    return DeviatedHelicalTooth(
        s.base,
        s.per_arm,
        s.cosine,
        s.rise,
        s.twist,
        s.half,
        s.begin,
        s.end,
        s.low,
        s.high,
        t.scale * scale,
        t.middle,
        t.per_length,
        t.per_face / scale,
        t.waves,
        flank[0],
        flank[1],
        flank[2],
        flank[3],
    )


@part
def own_flank(tooth: Any) -> tuple[float, float, float, float]:
    """Coefficients of the flank [mm]."""
    return tooth.level, tooth.slope, tooth.form, tooth.helix


@variant(grown, DeviatedHelicalTooth)
def deviated_screw_grown(tooth: Any, scale: float) -> Any:
    """Every length grows."""
    return of_screw(tooth, grown(plain_screw(tooth), scale), scale, own_flank(tooth))


@variant(section, DeviatedHelicalTooth)
def deviated_screw_section(tooth: Any, share: float) -> Any:
    """One height."""
    return of_screw(tooth, section(plain_screw(tooth), share), 1.0, own_flank(tooth))


@variant(leaning, DeviatedHelicalTooth)
def deviated_screw_leaning(tooth: Any, sigma: float) -> Any:
    """dt/dz = -sigma kappa along a generator."""
    return sense_of(tooth) * sigma * tooth.twist


@variant(flank_of, DeviatedHelicalTooth)
def deviated_screw_flank(
    tooth: DeviatedHelicalTooth, flanks: FlankOffsets, gear: int, place: float, sigma: float
) -> Any:
    """The flank of one tooth, with its coefficients."""
    at = PLACES * gear
    start = flanks.places[at + START]
    if start < 0:
        return tooth
    teeth = flanks.places[at + TEETH]
    own = (int(place) - flanks.places[at + AHEAD]) % teeth
    side = sigma if gear == 0 else sigma * opening(tooth)
    slot = start + SHAPES * (2 * own + (0 if side > 0.0 else 1))
    values, scale = flanks.values, tooth.scale
    numbers = (scale * values[slot], scale * values[slot + 1], scale * values[slot + 2], scale * values[slot + 3])
    return of_screw(tooth, plain_screw(tooth), 1.0, numbers)


@part
def offset_on(tooth: Any, roll: float, z: float) -> Offset:
    """Offset of a flank at a roll [rad] and a height [mm]; beyond an end of its profile it goes on straight."""
    inside = min(max(roll, tooth.begin), tooth.end)
    at = offset_at(tooth, inside, z)
    if inside == roll:
        return at
    return Offset(at.value + at.by_roll * (roll - inside), at.by_roll, at.by_face, 0.0)


@variant(foot, DeviatedHelicalTooth)
def deviated_screw_foot(deviated_tooth: Any, mate: Any, pose: Pose, facing: Facing, roll: float, z: float) -> Foot:
    """See foot.foot: for the point of own deviated flank, the gap is reduced by the mate's offset at the foot.

    As the point rolls on by dt the foot goes back by r_b t dt over the radius of curvature of the mate's section; along
    own generator it goes along the mate's. A flank that slopes by s is nearer by s^2/2 of the gap.
    """
    own_azimuth, mate_azimuth, sigma, offset = facing
    own = deviated_tooth
    first = offset_on(own, roll, z)
    on = first.value * own.per_arm
    before = Facing(own_azimuth - sigma * sense_of(own) * on, mate_azimuth, sigma, offset)
    at = foot(plain_screw(own), plain_screw(mate), pose, before, roll + on, z)
    # out of the foot along the normal comes what stands out along the tangent from further back on its generator
    level = offset_on(mate, at.profile, at.face).value
    further = level * mate.rise * mate.rise * mate.per_arm
    profile, face = at.profile - further, at.face + level * at.nz
    second = offset_on(mate, profile, face)
    out, apart = second.value, at.gap + offset
    tangent = max(sense_of(mate) * (apart * mate.cosine + mate.base * at.profile), mate.base * 1e-9)
    # across generators a step of the roll is r_b t cos(beta_b) long
    slope = second.by_roll / (tangent * mate.cosine)
    out += 0.5 * slope * slope * (apart - out)
    lean, mate_lean = leaning(own, sigma), leaning(mate, sigma)
    back = -own.base * sense_of(own) * roll / tangent
    along = -mate_lean * pose.zz + sigma * (at.nx * pose.yz - at.ny * pose.xz) / (tangent * mate.cosine)
    by_face = at.by_face - first.by_face + lean * first.by_roll - second.by_face * pose.zz - second.by_roll * along
    return Foot(
        at.gap - out,
        profile,
        face,
        at.touching if is_level(own) and is_level(mate) else math.inf,
        at.x,
        at.y,
        at.z,
        at.nx,
        at.ny,
        at.nz,
        at.by_profile - first.by_roll - second.by_roll * back,
        by_face,
        max(at.bend - first.bend - second.bend * back * back, LEAST_BEND * own.base),
        at.twist + lean * first.bend - second.bend * back * along,
        at.bow - first.bend * lean * lean - second.bend * along * along,
        0.0,
    )


@variant(turn_to, DeviatedHelicalTooth)
def deviated_screw_turn(mate: Any, gap: float, offset: float, at: Foot) -> Any:
    """As flanks of HelicalTooth; on the way the foot comes to where the mate stands out by another length."""
    turn = gap * mate.per_arm
    if is_level(mate):
        return turn
    here = offset_on(mate, at.profile, at.face).value
    for _ in range(2):
        way = turn / mate.per_arm
        there = offset_on(mate, at.profile + way * mate.cosine / mate.base, at.face + way * at.nz)
        turn = (gap + here - there.value) * mate.per_arm
    return turn


@variant(line_of_action, DeviatedHelicalTooth)
def deviated_screw_line_of_action(deviated_tooth: Any, mate: Any, pose: Pose, facing: Facing, face: float) -> Nearest:
    """Nearest points of parallel screw surfaces as for HelicalTooth, but with the pair's own gap; else nowhere."""
    own_azimuth, mate_azimuth, sigma, offset = facing
    out = deviated_tooth.level + mate.level
    if not (is_level(deviated_tooth) and is_level(mate)):
        return Nearest(0.0, 0.0, NOWHERE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False, 0.0)
    apart = Facing(own_azimuth, mate_azimuth, sigma, offset + out)
    near = line_of_action(plain_screw(deviated_tooth), plain_screw(mate), pose, apart, face)
    how = NOWHERE if near.how == NOWHERE else CLOSED
    back = deviated_tooth.level
    x, y, z = near.x - back * near.nx, near.y - back * near.ny, near.z - back * near.nz
    return Nearest(
        near.gap, near.turn, how, near.profile, near.face, x, y, z, near.nx, near.ny, near.nz, near.at_end, 0.0
    )


class Lowest(NamedTuple):
    """Lowest gap of a pair at one height, near its contact line.

    Args:
        gap: [mm].
        roll, z: where on own flank [rad; mm].
        profile, face: of the foot on the mate [rad; mm].
    """

    gap: float
    roll: float
    z: float
    profile: float
    face: float


@part
def lowest_at(own: Any, mate: Any, pose: Pose, facing: Facing, roll: float, z: float) -> Lowest:
    """The lowest gap at a height [mm], across the generators from a roll [rad]."""
    roll = min(max(roll, own.begin), own.end)
    gap, profile, face = 0.0, 0.0, 0.0
    for _ in range(ACROSS):
        at = foot(own, mate, pose, facing, roll, z)
        step = min(max(roll - at.by_profile / at.bend, own.begin), own.end) - roll
        gap = at.gap + at.by_profile * step + 0.5 * at.bend * step * step
        roll, profile, face = roll + step, at.profile, at.face
    return Lowest(gap, roll, z, profile, face)


@variant(begun, DeviatedHelicalTooth)
def deviated_screw_begun(deviated_tooth: Any, mate: Any, pose: Pose, facing: Facing, roll: float, z: float) -> Start:
    """The lower end of the contact line; the start stays where there is none.

    Along the line on which the flanks of both gears lie all offsets and leans are straight.
    """
    own = deviated_tooth
    lean, mate_lean = leaning(own, facing.sigma), leaning(mate, facing.sigma)
    roll, z = started(own, lean, roll, z)
    here = lowest_at(own, mate, pose, facing, roll, z)
    start, best = here.roll + lean * z, Lowest(math.inf, roll, z, 0.0, 0.0)
    low, high = max(own.low, z + mate.low - here.face), min(own.high, z + mate.high - here.face)
    low, high = between(low, high, start, lean, own.begin, own.end)
    low, high = between(low, high, here.profile + mate_lean * z, mate_lean, mate.begin, mate.end)
    for k in range(2 if low <= high else 0):
        end = low if k == 0 else high
        here = lowest_at(own, mate, pose, facing, start - lean * end, end)
        if here.gap < best.gap:
            best = here
    return Start(best.roll, best.z, best.profile, best.face, best.gap < math.inf)
