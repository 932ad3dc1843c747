"""Spur gears whose flanks deviate tooth by tooth: feet and lines of action as of SpurTooth, less flank offsets.

A flank stands out of the involute along its normals by a smooth offset of roll and height, micrometres over
millimetres. Neglected terms are of the order of (its slope)^2 times itself, 1e-8 um.
"""

import math
from typing import Any, NamedTuple

from tol3d.gearing.engines.exact.foot import (
    Integers,
    external,
    flank_of,
    flanks_in,
    foot,
    grown,
    line_of_action,
    section,
    straight,
    turn_to,
)
from tol3d.gearing.engines.exact.numbers import CLOSED, NOWHERE, Facing, Foot, Nearest, Pose
from tol3d.gearing.engines.exact.spur import SpurTooth
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import part, variant

TURN = 2.0 * math.pi
START, TEETH, AHEAD = 0, 1, 2  # of a gear's places: where its coefficients begin, -1 without; its teeth; their count
PLACES = 3
SHAPES = 4  # coefficients of a flank
LEAST_BEND = (
    0.05  # of the base radius; towards a base circle the gap bends less, then the other way: Newton would climb
)


class DeviatedTooth(NamedTuple):
    """Flanks of a spur gear, and the offset of one of them.

    Args:
        base ... high: as of SpurTooth.
        scale: by which the gear has grown.
        middle, per_length: of the profile's rolls, and one over their span [rad, 1/rad].
        per_face: one over the width of the whole face [1/mm].
        waves: of the form, see FlankDeviation in effects.py.
        level, slope, form, helix: of the flank [mm]; 0 where none is meant.
    """

    base: float
    per_base: float
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


class FlankOffsets(NamedTuple):
    """Offsets of single flanks of a build.

    Args:
        values: its coefficients [mm].
        places: of driver and driven, PLACES each.
    """

    values: Any
    places: Any


class Offset(NamedTuple):
    """Offset of a flank at a point, outwards [mm]: its derivatives by roll and height, and the second one by roll."""

    value: float
    by_roll: float
    by_face: float
    bend: float


@part
def plain(tooth: DeviatedTooth) -> SpurTooth:
    """The involutes from which flanks deviate."""
    return SpurTooth(tooth.base, tooth.per_base, tooth.half, tooth.begin, tooth.end, tooth.low, tooth.high)


@part
def of_plain(tooth: DeviatedTooth, spur_tooth: SpurTooth, scale: float) -> DeviatedTooth:
    """The same deviations of other involutes."""
    return DeviatedTooth(
        spur_tooth.base,
        spur_tooth.per_base,
        spur_tooth.half,
        spur_tooth.begin,
        spur_tooth.end,
        spur_tooth.low,
        spur_tooth.high,
        tooth.scale * scale,
        tooth.middle,
        tooth.per_length,
        tooth.per_face / scale,
        tooth.waves,
        tooth.level,
        tooth.slope,
        tooth.form,
        tooth.helix,
    )


@part
def is_level(tooth: Any) -> bool:
    """True if a flank is a parallel involute."""
    level: bool = tooth.slope == 0.0 and tooth.form == 0.0 and tooth.helix == 0.0
    return level


@part
def wave_at(tooth: DeviatedTooth, roll: float) -> tuple[float, float]:
    """Cosine and sine of a flank's waves at a roll [rad]; (1, 0) where it has none."""
    if tooth.form == 0.0 or tooth.waves == 0.0:
        return 1.0, 0.0
    u = (roll - tooth.middle) * tooth.per_length
    phase = TURN * tooth.waves * u
    return math.cos(phase), math.sin(phase)


@part
def offset_of(tooth: DeviatedTooth, roll: float, z: float, cos: float, sin: float) -> Offset:
    """Offset of a flank at a roll [rad] and a height [mm], from the phase of its waves there."""
    u = (roll - tooth.middle) * tooth.per_length
    value = tooth.level + tooth.slope * u + tooth.helix * tooth.per_face * z
    by_roll, bend = tooth.slope, 0.0
    if tooth.form != 0.0:
        if tooth.waves == 0.0:
            value += tooth.form * (1.0 / 3.0 - 4.0 * u * u)
            by_roll -= 8.0 * tooth.form * u
            bend = -8.0 * tooth.form
        else:
            rate = TURN * tooth.waves
            wave = 0.5 * tooth.form * cos
            value += wave
            by_roll -= 0.5 * tooth.form * rate * sin
            bend = -rate * rate * wave
    length = tooth.per_length
    return Offset(value, by_roll * length, tooth.helix * tooth.per_face, bend * length * length)


@part
def offset_at(tooth: Any, roll: float, z: float) -> Offset:
    """Offset of a flank at a roll [rad] and a height [mm]."""
    cos, sin = wave_at(tooth, roll)
    return offset_of(tooth, roll, z, cos, sin)


def offsets_in(tooth: Any, offsets: Array, builds: Integers, places: Integers, row: int) -> FlankOffsets:
    """Those of its build."""
    return FlankOffsets(offsets[builds[row]], places)


external(DeviatedTooth)
straight(DeviatedTooth)
variant(flanks_in, DeviatedTooth)(offsets_in)


@variant(grown, DeviatedTooth)
def deviated_grown(tooth: DeviatedTooth, scale: float) -> DeviatedTooth:
    """Every length grows."""
    return of_plain(tooth, grown(plain(tooth), scale), scale)


@variant(section, DeviatedTooth)
def deviated_section(tooth: DeviatedTooth, share: float) -> DeviatedTooth:
    """One height."""
    return of_plain(tooth, section(plain(tooth), share), 1.0)


@variant(flank_of, DeviatedTooth)
def deviated_flank(tooth: DeviatedTooth, flanks: FlankOffsets, gear: int, place: float, sigma: float) -> DeviatedTooth:
    """The flank of one tooth, with its coefficients."""
    at = PLACES * gear
    start = flanks.places[at + START]
    if start < 0:
        return tooth
    teeth = flanks.places[at + TEETH]
    own = (int(place) - flanks.places[at + AHEAD]) % teeth
    side = 0 if sigma > 0.0 else 1
    slot = start + SHAPES * (2 * own + side)
    values, scale = flanks.values, tooth.scale
    return DeviatedTooth(
        tooth.base,
        tooth.per_base,
        tooth.half,
        tooth.begin,
        tooth.end,
        tooth.low,
        tooth.high,
        scale,
        tooth.middle,
        tooth.per_length,
        tooth.per_face,
        tooth.waves,
        scale * values[slot],
        scale * values[slot + 1],
        scale * values[slot + 2],
        scale * values[slot + 3],
    )


@variant(foot, DeviatedTooth)
def deviated_foot(
    deviated_tooth: DeviatedTooth, mate: DeviatedTooth, pose: Pose, facing: Facing, roll: float, z: float
) -> Foot:
    """See foot.foot: for the point of own deviated flank, the gap is reduced by the mate's offset at the foot.

    A point d outside an involute lies on one that is turned by d/r_b, d/r_b of roll further on. As it rolls on by dt,
    its foot's roll goes back by r_b t dt over the foot's radius of curvature: both flanks are parallel where they are
    nearest, to the order of their slopes. A flank that slopes by s is nearer by s^2/2 of the gap.
    """
    own_azimuth, mate_azimuth, sigma, offset = facing
    first = offset_at(deviated_tooth, roll, z)
    ahead = first.value * deviated_tooth.per_base
    before = Facing(own_azimuth - sigma * ahead, mate_azimuth, sigma, offset)
    at = foot(plain(deviated_tooth), plain(mate), pose, before, roll + ahead, z)
    second = offset_at(mate, at.profile, at.face)
    out = second.value
    if at.profile > 0.0:
        slope = second.by_roll / (mate.base * at.profile)
        out += 0.5 * slope * slope * (at.gap + offset - out)
    tangent = max(at.gap + offset + mate.base * at.profile, mate.base * 1e-9)
    back = -deviated_tooth.base * roll / tangent
    lean = sigma * (at.nx * pose.yz - at.ny * pose.xz) / tangent
    return Foot(
        at.gap - out,
        at.profile,
        at.face,
        at.touching - out * mate.per_base,
        at.x,
        at.y,
        at.z,
        at.nx,
        at.ny,
        at.nz,
        at.by_profile - first.by_roll - second.by_roll * back,
        at.by_face - first.by_face - second.by_face * pose.zz - second.by_roll * lean,
        max(at.bend - first.bend - second.bend * back * back, LEAST_BEND * deviated_tooth.base),
        at.twist,
        at.bow,
        0.0,
    )


@variant(turn_to, DeviatedTooth)
def deviated_turn(mate: DeviatedTooth, gap: float, offset: float, at: Foot) -> float:
    """As flanks of SpurTooth; on the way the foot comes to where the mate stands out by another length.

    The distance along the line of action is not shortened by the slope that shortens the gap.
    """
    turn = gap * mate.per_base
    if is_level(mate):
        return turn
    first = offset_at(mate, at.profile, at.face)
    here = first.value
    if at.profile > 0.0:
        slope = first.by_roll / (mate.base * at.profile)
        gap += 0.5 * slope * slope * (gap + offset)
    for _ in range(2):
        turn = (gap + here - offset_at(mate, at.profile + turn, at.face).value) * mate.per_base
    return turn


@variant(line_of_action, DeviatedTooth)
def deviated_line_of_action(
    deviated_tooth: DeviatedTooth, mate: DeviatedTooth, pose: Pose, facing: Facing, face: float
) -> Nearest:
    """Nearest points of parallel involutes as for SpurTooth, but with the pair's own gap; nowhere for other flanks."""
    own_azimuth, mate_azimuth, sigma, offset = facing
    out = deviated_tooth.level + mate.level
    if not (is_level(deviated_tooth) and is_level(mate)):
        return Nearest(0.0, 0.0, NOWHERE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False, 0.0)
    apart = Facing(own_azimuth, mate_azimuth, sigma, offset + out)
    near = line_of_action(plain(deviated_tooth), plain(mate), pose, apart, face)
    how = NOWHERE if near.how == NOWHERE else CLOSED
    x, y = near.x - deviated_tooth.level * near.nx, near.y - deviated_tooth.level * near.ny
    return Nearest(
        near.gap, near.turn, how, near.profile, near.face, x, y, near.z, near.nx, near.ny, near.nz, near.at_end, 0.0
    )
