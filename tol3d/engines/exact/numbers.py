"""What kernels know of gears, poses and feet: tuples of numbers, lengths in mm, angles in rad."""

from typing import NamedTuple


class Pose(NamedTuple):
    """Where one gear sees another: `target = matrix source + shift`, each gear's own centre the origin."""

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


class Foot(NamedTuple):
    """A point of one gear's flank, and its foot on the endless flank of the mate.

    Args:
        gap: signed distance [mm] from the foot, positive outside the mate's tooth.
        turn: by which the mate must turn for its flank to pass through the point [rad], of the gap's sign.
        profile, face: parameters of the foot on the mate [rad; mm].
        touching: profile parameter of the point itself on the mate's flank, once that has turned to it [rad].
        x, y, z: the point in the mate's frame [mm].
        nx, ny, nz: unit normal of the mate at the foot, out of its tooth.
        by_profile, by_face: derivatives of the gap by the point's parameters [mm/rad; 1],
        bend, twist, bow: and its second ones: profile twice, profile and face, face twice.
        nearness: one over the distance from the mate's apex [1/mm]; 0 for a cylinder.
        turn_per_gap: derivative of the turn by the gap [rad/mm].
    """

    gap: float
    turn: float
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
    turn_per_gap: float


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
        along: 1 where a shift along the axis counts, else 0.
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
