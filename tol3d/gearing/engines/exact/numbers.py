"""Gears, poses and feet in kernels: tuples of numbers, lengths in mm, angles in rad."""

import math
from typing import NamedTuple

from tol3d.numerics.compiled import part

CLOSED, AT_EDGE, BEYOND, ALIKE, NOWHERE = 0, 1, 2, 3, 4


class Pose(NamedTuple):
    """Pose of one gear seen from another: `target = matrix source + shift`, each gear's own centre the origin."""

    xx: float
    xy: float
    xz: float
    yx: float
    yy: float
    yz: float
    zx: float
    zy: float
    zz: float
    x: float
    y: float
    z: float


class Facing(NamedTuple):
    """Two flanks that face each other.

    Args:
        own_azimuth, mate_azimuth: of the middle of the teeth [rad], their flanks' turns included.
        sigma: side of the flanks, the same for both.
        offset: of both flanks along their normals, together [mm].
    """

    own_azimuth: float
    mate_azimuth: float
    sigma: float
    offset: float


class Foot(NamedTuple):
    """A point of one gear's flank, and its foot on the endless flank of the mate.

    Args:
        gap: signed distance [mm] from the foot, positive outside the mate's tooth.
        profile, face: parameters of the foot on the mate [rad; mm].
        touching: profile parameter of the foot once the mate's flank has turned to the point [rad].
        x, y, z: the point in the mate's frame [mm].
        nx, ny, nz: unit normal of the mate at the foot, out of its tooth.
        by_profile, by_face: derivatives of the gap by the point's parameters [mm/rad; 1],
        bend, twist, bow: and its second ones: profile twice, profile and face, face twice.
        nearness: one over the distance from the mate's apex [1/mm]; 0 for a cylinder.
    """

    gap: float
    profile: float
    face: float
    touching: float
    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float
    by_profile: float
    by_face: float
    bend: float
    twist: float
    bow: float
    nearness: float


class Nearest(NamedTuple):
    """The nearest points of two flanks, in the mate's frame.

    Args:
        gap: [mm], inf where the faces do not overlap.
        turn: by which the mate must turn to close it [rad], of the gap's sign.
        how: ALIKE, the turn is exact, and the same for all pairs of one base pitch; CLOSED, the turn is exact; AT_EDGE,
            it is so to first order, for an edge comes to touch; BEYOND, gap and turn are no more than bounds, for both
            flanks end; NOWHERE, nothing is known.
        profile, face: where on `own`.
        x, y, z: the point of `own` [mm].
        nx, ny, nz: unit vector from the mate to it.
        at_end: whether either flank ends there, at its tip edge or where its profile begins: it is not in action.
        lean: sine [1/mm], over the distance from the apex, of the angle between that and the mate's normal once it
            has turned to the point: 0 for a cylinder.
    """

    gap: float
    turn: float
    how: int
    profile: float
    face: float
    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float
    at_end: bool
    lean: float


class Start(NamedTuple):
    """Place at which the search for the nearest points of two flanks begins.

    Args:
        profile, face: of own flank.
        mate_profile, mate_face: of its foot on the mate.
        known: True if both flanks reach there, and it is the lowest of all such places to about the last step.
    """

    profile: float
    face: float
    mate_profile: float
    mate_face: float
    known: bool


class PairNumbers(NamedTuple):
    """Which teeth may meet, and where.

    Args:
        at_pitch: profile parameter [rad] of the driver's flank whose tooth stands on the line of centres.
        per_azimuth: by which the parameter falls as the tooth's azimuth grows on the flank's side.
        lowest, highest: azimuths [rad] of the driver's teeth, times sigma, between which they may touch.
        driver_pitch, driven_pitch: [rad], from tooth to tooth.
        driven_start, ratio: the driven gear turns to `driven_start - driver / ratio` for a space on the driver's tooth.
        section: where on the driver's face the middle of the common face lies, from 0 to 1.
        reach: shift of the axes [mm], tilts counted at the ends of the face, up to which `lowest` and `highest` hold.
        lever: [mm], what a tilt is counted with.
        along: 1 where a shift along the axis counts and the face tapers, else 0.
        in_all: the profile parameters [rad] of a touching pair together, of a bevel pair; 0 for a spur pair.
        by_x, by_y, by_z: by which the driver's parameter falls at first order as its centre moves, in the driven
            shaft's frame [rad/mm]; on the left flank the second has the other sign.
        by_tilt_x, by_tilt_y: the same for turns of the driver's shaft about x and y there.
    """

    at_pitch: float
    per_azimuth: float
    lowest: float
    highest: float
    driver_pitch: float
    driven_pitch: float
    driven_start: float
    ratio: float
    section: float
    reach: float
    lever: float
    along: float
    in_all: float
    by_x: float
    by_y: float
    by_z: float
    by_tilt_x: float
    by_tilt_y: float


SMALL = 0.02  # rad; below it the series are exact to 1e-15 of themselves


@part
def sine(angle: float) -> float:
    """sin(angle)."""
    if abs(angle) > SMALL:
        return math.sin(angle)
    square = angle * angle
    return angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)))


@part
def arcsine(value: float) -> float:
    """Its inverse."""
    if abs(value) > SMALL:
        return math.asin(value)
    square = value * value
    return value * (1.0 + square * (1.0 / 6.0 + square * (0.075 + square * (15.0 / 336.0 + square * (105.0 / 3456.0)))))


@part
def turned(x: float, y: float, angle: float) -> tuple[float, float]:
    """A vector across an axis, turned about it by less than a right angle."""
    sin = sine(angle)
    cos = math.sqrt(1.0 - sin * sin)
    return cos * x - sin * y, sin * x + cos * y
