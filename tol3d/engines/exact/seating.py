"""A pair brought to contact and read, build by build: what the measures of a mesh are made of.

The driver is held. For a mate without eccentricity the turn that closes a gap is exact, so the working flanks touch
after one look at each candidate pair; an eccentric one moves aside a little as it turns, which is added to first
order: what is left is of the order of (eccentricity times turn)^2 over the flanks' radius, 1e-11 mm.
"""

import math
from typing import NamedTuple

import numpy as np

from tol3d.engines.exact.compiled import part
from tol3d.engines.exact.foot import section
from tol3d.engines.exact.nearest import AT_EDGE, BEYOND, QUICK_FALL, nearest
from tol3d.engines.exact.numbers import Pose

LOOKS = 8  # at the candidate pairs until they are at rest; the second one is needed only far from the start
CLOSE = 1e-6  # mm; a gap over its arm is exact to this much squared over a radius
ASIDE = 1e-5  # mm; by which a mate may move aside on the way to contact until it is looked at again
EDGE_SHARE = 0.02  # of a turn at an edge, gap over arm: the arm changes by less on the way to contact
DOUBT = 1e-6  # mm; what ends on both sides may bound a gap no lower than this below the others
FREE = 1e-6  # mm; a play above minus this is called free
SEATED, INTERFERING, WITHOUT_CONTACT, OUT_OF_RANGE = 0, 1, 2, 3
ALL_TEETH, DRIVER_TOOTH, DRIVEN_TOOTH = 0, 1, 2


class Build(NamedTuple):
    """One build of a mesh: its axes, apart from where they turn.

    Args:
        pose: driven shaft from driver shaft, both at rest.
        driver_x, driver_y, driven_x, driven_y: centres off the axes, in the gears' frames [mm].
        driver_turn, driven_turn: of the flanks out of their teeth [rad].
        offset: of both flanks along their normals, together [mm].
    """

    pose: Pose
    driver_x: float
    driver_y: float
    driven_x: float
    driven_y: float
    driver_turn: float
    driven_turn: float
    offset: float


class Side(NamedTuple):
    """One flank side of a mesh, looked at.

    Args:
        gap: the smallest of all pairs [mm]; inf where no faces overlap.
        turn: the smallest turn of the driven gear [rad] that closes a pair.
        settled: whether that turn is exact.
        known: whether no flank ends on both sides where it is needed.
        tooth: of the driver, whose pair that is.
        x, y, z, nx, ny, nz: the driver's point and the normal towards it, in the driven shaft's frame.
    """

    gap: float
    turn: float
    settled: bool
    known: bool
    tooth: int
    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float


@part
def turned(x, y, angle):
    """A vector across an axis, turned about it."""
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * x - sin * y, sin * x + cos * y


@part
def pose_at(build, driver_angle, driven_angle):
    """Where the driven gear's centre sees the driver's: their shafts' frames, shifted by both eccentricities."""
    p = build.pose
    ex, ey = turned(build.driver_x, build.driver_y, driver_angle)
    fx, fy = turned(build.driven_x, build.driven_y, driven_angle)
    x = p.xx * ex + p.xy * ey + p.x - fx
    y = p.yx * ex + p.yy * ey + p.y - fy
    z = p.zx * ex + p.zy * ey + p.z
    return Pose(p.xx, p.xy, p.xz, p.yx, p.yy, p.yz, p.zx, p.zy, p.zz, x, y, z)


@part
def first_tooth(pair, driver_angle, sigma, teeth):
    """The first candidate tooth of the driver, times sigma, and how many there are."""
    place = driver_angle / pair.driver_pitch
    if teeth == DRIVER_TOOTH:
        return -sigma * np.rint(place), 1
    if teeth == DRIVEN_TOOTH:
        above = 1.0 if sigma > 0.0 else 0.0
        return sigma * (above - np.rint(place + 0.5)), 1
    first = math.ceil((pair.lowest - sigma * driver_angle) / pair.driver_pitch)
    last = math.floor((pair.highest - sigma * driver_angle) / pair.driver_pitch)
    return float(first), int(last - first) + 1


@part
def aside(build, driven_angle, turn, near):
    """By how much more a gap [mm] opens as the driven gear's centre moves with its turn, along the normal there."""
    fx, fy = turned(build.driven_x, build.driven_y, driven_angle)
    half, sin = math.sin(turn / 2.0), math.sin(turn)
    dx, dy = -2.0 * half * half * fx - sin * fy, sin * fx - 2.0 * half * half * fy
    return -((near.nx - near.lean * near.x) * dx + (near.ny - near.lean * near.y) * dy)


@part
def look(driver, driven, pair, build, driver_angle, driven_angle, seen_at, sigma, teeth, in_section, per_turn):
    """The candidate pairs of one side.

    Args:
        driver, driven: the gears' teeth.
        pair: PairNumbers.
        build: Build.
        driver_angle, driven_angle: [rad].
        seen_at: the driver's angle [rad] that decides which teeth are looked at.
        sigma: side of the flanks.
        teeth: ALL_TEETH, or the one of a gear.
        in_section: whether only the section in the middle of the common face is looked at.
        per_turn: 1 to look along the face for the smallest turn, 0 for the smallest gap.
    """
    pose = pose_at(build, driver_angle, driven_angle)
    first, count = first_tooth(pair, seen_at, sigma, teeth)
    middle = section(driver, pair.section)
    own = middle if in_section else driver
    eccentricity = abs(build.driven_x) + abs(build.driven_y)
    gap, turn, edge_turn, doubtful, least = math.inf, math.inf, math.inf, math.inf, math.inf
    best_tooth = 0
    x, y, z, nx, ny, nz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for step in range(count):
        tooth = sigma * (first + step)
        mating = -tooth if sigma > 0.0 else -tooth - 1.0
        azimuth = driver_angle + pair.driver_pitch * tooth
        own_azimuth = azimuth - sigma * build.driver_turn
        mate_azimuth = driven_angle + pair.driven_pitch * mating - sigma * build.driven_turn
        start = pair.at_pitch - pair.per_azimuth * sigma * azimuth
        near = nearest(
            own, driven, pose, own_azimuth, mate_azimuth, sigma, build.offset, start, middle.low, per_turn, QUICK_FALL
        )
        if near.gap == math.inf:
            continue
        if near.how == BEYOND:
            doubtful = min(doubtful, near.gap)
            continue
        its_turn = near.turn
        if eccentricity > 0.0:
            arm = abs(near.ny * near.x - near.nx * near.y)
            for _ in range(2):
                its_turn = near.turn + aside(build, driven_angle, -sigma * its_turn, near) / arm
        gap, turn = min(gap, near.gap), min(turn, its_turn)
        if near.how == AT_EDGE and abs(near.gap) > CLOSE:
            edge_turn = min(edge_turn, its_turn - EDGE_SHARE * abs(its_turn))
        key = its_turn if per_turn > 0.0 else near.gap
        if key < least:
            least, best_tooth = key, int(tooth)
            x, y, z, nx, ny, nz = near.x, near.y, near.z, near.nx, near.ny, near.nz
    settled = edge_turn >= turn and eccentricity * abs(turn) < ASIDE
    return Side(gap, turn, settled, doubtful >= gap - DOUBT, best_tooth, x, y, z, nx, ny, nz)


@part
def closed(side, driver, driven, pair, build, driver_angle, driven_angle, sigma, teeth, in_section):
    """The driven gear's angle [rad] at which the first pair of a side touches, and that side as it was last looked at.

    Args:
        side: how it looks at `driven_angle`, seen along the face for the smallest turn.
    """
    for _ in range(LOOKS):
        if side.gap == math.inf or not side.known:
            break
        driven_angle -= sigma * side.turn
        if side.settled:
            break
        side = look(
            driver, driven, pair, build, driver_angle, driven_angle, driver_angle, sigma, teeth, in_section, 1.0
        )
    return driven_angle, side


@part
def driver_turn(driver, driven, pair, build, driver_angle, driven_angle, sigma, teeth, in_section):
    """The turn of the driver [rad], the driven gear held, until that side touches."""
    angle = driver_angle
    p = build.pose
    for _ in range(LOOKS):
        side = look(driver, driven, pair, build, angle, driven_angle, driver_angle, sigma, teeth, in_section, 0.0)
        if side.gap == math.inf or not side.known:
            return math.nan
        # the driver's point turns about the driver's axis, whose direction is the pose's last column
        fx, fy = turned(build.driven_x, build.driven_y, driven_angle)
        x, y, z = side.x + fx - p.x, side.y + fy - p.y, side.z - p.z
        rate = side.nx * (p.yz * z - p.zz * y) + side.ny * (p.zz * x - p.xz * z) + side.nz * (p.xz * y - p.yz * x)
        angle -= side.gap / rate
        if abs(side.gap) < CLOSE:
            break
    return angle - driver_angle
