"""A pair brought to contact and read, build by build: the basis of a mesh's measures.

The driver is held. For a mate without eccentricity the turn that closes a gap is exact, so the working flanks touch
after one evaluation of each candidate pair; an eccentric one moves aside a little as it turns, which is added to first
order: the rest is of the order of (eccentricity times turn)^2 over the flanks' radius, 1e-11 mm.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from tol3d.gearing.engines.exact.foot import first_face, flank_of, handed, leaning, opening, promise, section
from tol3d.gearing.engines.exact.nearest import QUICK_FALL, nearest
from tol3d.gearing.engines.exact.numbers import (
    ALIKE,
    AT_EDGE,
    BEYOND,
    CLOSED,
    Facing,
    Nearest,
    PairNumbers,
    Pose,
    turned,
)
from tol3d.numerics.compiled import part

LOOKS = 8  # evaluations of the candidate pairs until they rest; the second is needed only far from the start
CLOSE = 1e-6  # mm; a gap over its arm is exact to this much squared over a radius
ASIDE = 3e-5  # mm; sideways motion of a mate on the way to contact that needs another evaluation
ASIDE_ON_FACE = 4e-6  # mm; the same where the contact may change ends of a tapering face, whose arms differ by a tenth
EDGE_SHARE = 0.02  # of a turn at an edge, gap over arm: the arm changes by less on the way to contact
DOUBT = 1e-6  # mm; accuracy of a gap's lower bound by ends on both sides
SAME_PITCH = 1e-13  # relative; rounding
ALL_TEETH, DRIVER_TOOTH, DRIVEN_TOOTH = 0, 1, 2


class MeshBuild(NamedTuple):
    """A mesh in one trial, as kernels read it.

    Args:
        driver, driven: their teeth, grown.
        pair: which of them may meet.
        pose: driven shaft from driver shaft, both at rest.
        nominal: the same of the nominal pair.
        driver_x, driver_y, driven_x, driven_y: centres off the axes, in the gears' frames [mm].
        driver_turn: of the flanks out of their teeth [rad].
        driven_turn: the same, times the sense in which it opens.
        offset: of both flanks along their normals, together [mm].
        flanks: offsets of single flanks of both gears; 0 where all flanks of a gear are alike.
    """

    driver: Any
    driven: Any
    pair: PairNumbers
    pose: Pose
    nominal: Pose
    driver_x: float
    driver_y: float
    driven_x: float
    driven_y: float
    driver_turn: float
    driven_turn: float
    offset: float
    flanks: Any


class Turn(NamedTuple):
    """Positions of the gears of a build.

    Args:
        driver, driven: their angles [rad].
        x, y, z: the driver's centre in the driven shaft's frame [mm].
        fx, fy: the driven gear's centre there, which turns with it.
    """

    driver: float
    driven: float
    x: float
    y: float
    z: float
    fx: float
    fy: float


class Look(NamedTuple):
    """Evaluation of one side of a mesh.

    Args:
        sigma: side of the flanks.
        teeth: ALL_TEETH, or the one of a gear.
        in_section: True to evaluate only the section in the middle of the common face.
        per_turn: 1 to find the smallest turn along the face, 0 the smallest gap.
    """

    sigma: float
    teeth: int
    in_section: bool
    per_turn: float


class Side(NamedTuple):
    """One flank side of a mesh, looked at.

    Args:
        gap: the smallest of all pairs [mm]; inf where no faces overlap.
        turn: the smallest turn of the driven gear [rad] that closes a pair.
        settled: whether that turn is exact.
        known: whether no flank ends on both sides where it is needed.
        acts: of one tooth, whether its flank is in action there: nearest, and to touch, between both flanks' ends.
        tooth: of the driver, whose pair that is.
        x, y, z, nx, ny, nz: the driver's point and the normal towards it, in the driven shaft's frame.
    """

    gap: float
    turn: float
    settled: bool
    known: bool
    acts: bool
    tooth: int
    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float


@part
def standing(build: MeshBuild, driver: float, driven: float) -> Turn:
    """The gears of a build at their angles [rad]."""
    p = build.pose
    cos, sin = math.cos(driver), math.sin(driver)
    ex, ey = cos * build.driver_x - sin * build.driver_y, sin * build.driver_x + cos * build.driver_y
    cos, sin = math.cos(driven), math.sin(driven)
    fx, fy = cos * build.driven_x - sin * build.driven_y, sin * build.driven_x + cos * build.driven_y
    x = p.xx * ex + p.xy * ey + p.x
    y = p.yx * ex + p.yy * ey + p.y
    return Turn(driver, driven, x, y, p.zx * ex + p.zy * ey + p.z, fx, fy)


@part
def driven_on(at: Turn, angle: float) -> Turn:
    """The driven gear turned on [rad]."""
    fx, fy = turned(at.fx, at.fy, angle)
    return Turn(at.driver, at.driven + angle, at.x, at.y, at.z, fx, fy)


@part
def pose_at(build: MeshBuild, at: Turn) -> Pose:
    """Pose of the driver seen from the driven gear: their shafts' frames, from centre to centre."""
    p = build.pose
    return Pose(p.xx, p.xy, p.xz, p.yx, p.yy, p.yz, p.zx, p.zy, p.zz, at.x - at.fx, at.y - at.fy, at.z)


@part
def first_tooth(pair: PairNumbers, driver_angle: float, sigma: float, teeth: int) -> tuple[float, int]:
    """The first candidate tooth of the driver, times sigma, and how many there are."""
    place = driver_angle / pair.driver_pitch
    if teeth == DRIVER_TOOTH:
        return -sigma * np.rint(place), 1
    if teeth == DRIVEN_TOOTH:
        above = 1.0 if sigma > 0.0 else 0.0
        return sigma * (above - np.rint(place + 0.5)), 1
    per_pitch = 1.0 / pair.driver_pitch
    first = math.ceil((pair.lowest - sigma * driver_angle) * per_pitch)
    last = math.floor((pair.highest - sigma * driver_angle) * per_pitch)
    return float(first), int(last - first) + 1


@part
def middle_first(step: int, first: float, count: int, middle: float) -> float:
    """The candidates from the one in the middle of the path of contact on, which touches if any does."""
    start = min(max(np.rint(middle) - first, 0.0), count - 1.0)
    at = start + step
    return float(first + (at if at < count else at - count))


@part
def mating_tooth(driven: Any, tooth: float, sigma: float) -> float:
    """The driven gear's tooth that meets a driver's tooth."""
    if opening(driven) < 0.0:
        return tooth - 1.0 if sigma > 0.0 else tooth
    return -tooth if sigma > 0.0 else -tooth - 1.0


@part
def azimuths(build: MeshBuild, at: Turn, sigma: float, tooth: float) -> tuple[float, float]:
    """Azimuths [rad] of a tooth of the driver and of the driven's that it meets, their flanks' turns included."""
    mating = mating_tooth(build.driven, tooth, sigma)
    driver = at.driver + build.pair.driver_pitch * tooth - sigma * build.driver_turn
    return driver, at.driven + build.pair.driven_pitch * mating - sigma * build.driven_turn


@part
def start_on(build: MeshBuild, pose: Pose, sigma: float, own_azimuth: float) -> float:
    """The profile parameter of the driver's flank at which the pair is nearest, to first order.

    A flank with the radius of curvature r_1, moved by v along the profile against one with r_2, meets it r_1 v/(r_1 +
    r_2) further back. On involutes r_1 + r_2 is the length of the tangent of both base circles, on spherical ones
    tan q_1 + tan q_2 takes its place.
    """
    pair, rest, p = build.pair, build.nominal, build.pose
    profile = pair.at_pitch - pair.per_azimuth * sigma * own_azimuth
    mate = pair.in_all - profile
    moved = pair.by_x * (pose.x - rest.x) + sigma * pair.by_y * (pose.y - rest.y) + pair.by_z * (pose.z - rest.z)
    # the driver's shaft against the nominal one: products of its axes with the nominal ones
    tilt_x = p.zx * rest.yx + p.zy * rest.yy + p.zz * rest.yz
    tilt_y = p.xx * rest.zx + p.xy * rest.zy + p.xz * rest.zz
    return (
        profile
        - moved * (1.0 - 0.5 * pair.along * mate * mate)
        - pair.by_tilt_x * tilt_x
        - sigma * pair.by_tilt_y * tilt_y
    )


@part
def pair_nearest(
    build: MeshBuild,
    at: Turn,
    sigma: float,
    tooth: float,
    pose: Pose,
    own: Any,
    face: float,
    per_turn: float,
    last_fall: float,
) -> Nearest:
    """The nearest points of a tooth pair.

    Args:
        build, at: the build, and the positions of its gears.
        sigma, tooth: side, and tooth of the driver.
        pose: as pose_at gives it.
        own: what is looked at of the driver's teeth; the search begins at `face` [mm] on it, from its middle.
        per_turn, last_fall: as in nearest.lowest.
    """
    own_azimuth, mate_azimuth = azimuths(build, at, sigma, tooth)
    start = start_on(build, pose, sigma, own_azimuth)
    lean = leaning(own, handed(own, sigma))
    if lean != 0.0:
        start -= lean * face
    return nearest(
        flank_of(own, build.flanks, 0, tooth, sigma),
        flank_of(build.driven, build.flanks, 1, mating_tooth(build.driven, tooth, sigma), sigma),
        pose,
        Facing(own_azimuth, mate_azimuth, handed(own, sigma), build.offset),
        start,
        face,
        per_turn,
        last_fall,
    )


@part
def aside(at: Turn, turn: float, near: Nearest) -> float:
    """Additional opening of a gap [mm] by the motion of the driven gear's centre with its turn, along the normal."""
    fx, fy = turned(at.fx, at.fy, turn)
    return -((near.nx - near.lean * near.x) * (fx - at.fx) + (near.ny - near.lean * near.y) * (fy - at.fy))


@part
def seen(build: MeshBuild, at: Turn, seen_at: float, look: Look) -> Side:
    """The candidate pairs of one side.

    Args:
        build: what is built.
        at: where the gears stand.
        seen_at: the driver's angle [rad] that selects the teeth.
        look: side and place.
    """
    pair, sigma = build.pair, look.sigma
    sense = sigma * opening(build.driven)
    pose = pose_at(build, at)
    first, count = first_tooth(pair, seen_at, sigma, look.teeth)
    middle = section(build.driver, pair.section)
    own = middle if look.in_section else build.driver
    pitch = build.driver.base * pair.driver_pitch
    one_base_pitch = abs(build.driven.base * pair.driven_pitch - pitch) < SAME_PITCH * pitch
    eccentricity = abs(at.fx) + abs(at.fy)
    gap, turn, edge_turn, doubtful, least = math.inf, math.inf, math.inf, math.inf, math.inf
    best_tooth, acts = 0, True
    x, y, z, nx, ny, nz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    side = handed(own, sigma)
    face = first_face(own, build.driven, pose, side, middle.low)
    in_middle = (0.5 * (pair.lowest + pair.highest) - sigma * at.driver) / pair.driver_pitch
    first_order = math.inf
    for step in range(count):
        tooth = sigma * middle_first(step, first, count, in_middle)
        order = math.inf
        if one_base_pitch and leaning(own, side) != 0.0:
            start = start_on(build, pose, sigma, azimuths(build, at, sigma, tooth)[0])
            order, leeway = promise(own, build.driven, pose, side, start, abs(gap) if gap < math.inf else 0.0)
            if order > first_order + leeway:
                continue
        near = pair_nearest(build, at, sigma, tooth, pose, own, face, look.per_turn, QUICK_FALL)
        if near.gap == math.inf:
            continue
        if look.teeth != ALL_TEETH:
            # a gap is read as the flanks stand, one that is closed where they come to touch
            touches = near.how == CLOSED or near.how == ALIKE
            acts = not near.at_end and near.how != BEYOND and (touches or look.per_turn == 0.0)
        if near.how == BEYOND:
            doubtful = min(doubtful, near.gap)
            continue
        first_order = min(first_order, order)
        its_turn = near.turn
        if eccentricity > 0.0:
            arm = abs(near.ny * near.x - near.nx * near.y)
            for _ in range(2):
                its_turn = near.turn + aside(at, -sense * its_turn, near) / arm
        gap, turn = min(gap, near.gap), min(turn, its_turn)
        if near.how == AT_EDGE and abs(near.gap) > CLOSE:
            edge_turn = min(edge_turn, its_turn - EDGE_SHARE * abs(its_turn))
        key = its_turn if look.per_turn > 0.0 else near.gap
        if key < least:
            least, best_tooth = key, int(tooth)
            x, y, z, nx, ny, nz = near.x + at.fx, near.y + at.fy, near.z, near.nx, near.ny, near.nz
        if near.how == ALIKE and one_base_pitch:
            break
    most = ASIDE if look.in_section or pair.along == 0.0 else ASIDE_ON_FACE
    settled = edge_turn >= turn and eccentricity * abs(turn) < most
    return Side(gap, turn, settled, doubtful >= gap - DOUBT, acts, best_tooth, x, y, z, nx, ny, nz)


@part
def closed(side: Side, build: MeshBuild, at: Turn, look: Look) -> tuple[Turn, Side]:
    """Turn of the driven gear to the first contact of a side, with the side's last evaluation.

    Args:
        side: its evaluation at `at`, for the smallest turn along the face.
        build, at, look: as in `seen`.
    """
    for _ in range(LOOKS):
        if side.gap == math.inf or not side.known:
            break
        at = driven_on(at, -look.sigma * opening(build.driven) * side.turn)
        if side.settled:
            break
        side = seen(build, at, at.driver, look)
    return at, side


@part
def driver_turn(build: MeshBuild, at: Turn, look: Look) -> float:
    """The turn of the driver [rad], the driven gear held, until a side touches; NaN where it is unknown."""
    angle, p = at.driver, build.pose
    for _ in range(LOOKS):
        now = standing(build, angle, at.driven)
        side = seen(build, now, at.driver, look)
        if side.gap == math.inf or not side.known or not side.acts:
            return math.nan
        # the driver's point turns about the driver's axis, whose direction is the pose's last column
        x, y, z = side.x - p.x, side.y - p.y, side.z - p.z
        rate = side.nx * (p.yz * z - p.zz * y) + side.ny * (p.zz * x - p.xz * z) + side.nz * (p.xz * y - p.yz * x)
        angle -= side.gap / rate
        if abs(side.gap) < CLOSE:
            break
    return angle - at.driver
