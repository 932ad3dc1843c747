"""Smallest distances of two gears' flanks at any poses: the search of brute_force.py, compiled, for thousands of poses.

Every flank near the mesh is searched over face and profile, ends included, by grids that zoom in on their lowest
point, one within the other; the distance of a point to the mate's flank is that of the two brute forces, written for
numbers instead of arrays. No line of action, no candidate list, no derivative.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit

from oracles.bevel_brute_force import BevelMesh, BevelNumbers
from oracles.brute_force import Mesh
from oracles.involute_gear import InvoluteGear
from tol3d.gears.flank import Flank

TEETH_EACH_SIDE = 2  # beyond the one nearest to the mesh: 5 pitches, a path of contact has 2
PROFILE_POINTS, PROFILE_ZOOMS = 13, 9  # two of twelve cells are kept: 6^8 times finer than 20 mm/12, 1e-6 mm
FACE_POINTS, FACE_ZOOMS = 9, 14  # 4^13 times finer than 100 mm/8, 2e-7 mm, times 2 mrad nothing
HALVINGS = 3  # of the roll in which a foot is searched, to 0.2 rad, before
NEWTON_STEPS = 4  # finish it: 0.1, 5e-3, 2e-5, 1e-10 rad, the last quite lost in the rounding
BEYOND = 0.1  # rad of roll that a foot may lie beyond an end of its flank before it is put there


Numbers = tuple[float, ...]
Vector = tuple[float, float, float]
Lowest = Callable[[Any, float, float], tuple[float, float]]


def zooming(function: Callable[[Any, float], float], points: int, zooms: int) -> Lowest:
    """The lowest value of `function(fixed, x)` between two ends, and where: by grids that zoom in on it."""

    @njit(nogil=True)
    def lowest(fixed: Any, low: float, high: float) -> tuple[float, float]:
        value, at = math.inf, low
        for _ in range(zooms):
            value, best = math.inf, 0
            for k in range(points):
                seen = function(fixed, low + (high - low) * k / (points - 1))
                if seen < value:
                    value, best = seen, k
            step = (high - low) / (points - 1)
            at = low + step * best
            low, high = low + step * max(best - 1, 0), low + step * min(best + 1, points - 1)
        return value, at

    return lowest


# spur -----------------------------------------------------------------------------------------------------------------
# a gear: base radius, half a tooth's angle on the base circle, tip radius, string at the tip, half the face, offset


@njit(nogil=True)
def spur_point(gear: Numbers, string: float, azimuth: float, flank: float) -> tuple[float, float]:
    """A flank's point (x, y): its radius is hypot(base, string), its tooth narrows by the involute function."""
    base, half, offset = gear[0], gear[1], gear[5]
    roll = string / base
    at = azimuth - flank * (half - roll + math.atan(roll))
    radius = math.hypot(base, string)
    # the string is the normal: it leaves the base circle at the point's azimuth less flank times its pressure angle
    along = at + flank * math.atan(roll)
    nx, ny = flank * math.sin(along), -flank * math.cos(along)
    return radius * math.cos(at) + offset * nx, radius * math.sin(at) + offset * ny


@njit(nogil=True)
def spur_distance(gear: Numbers, x: float, y: float, z: float, azimuth: float, flank: float) -> float:
    """See InvoluteGear.signed_distance; `offset` moves a flank and its edges along its normals."""
    base, half, tip, tip_string, half_face, offset = gear
    radius = max(math.hypot(x, y), base)
    string = math.sqrt(radius * radius - base * base)
    angle = math.atan2(y, x) - azimuth
    angle -= 2 * math.pi * np.rint(angle / (2 * math.pi))
    outside = base * (-flank * angle - half - math.atan(string / base)) + string
    foot = string - outside
    kept, kept_z = min(max(foot, 0.0), tip_string), min(max(z, -half_face), half_face)
    if kept_z == z and (kept == foot or (outside < offset and math.hypot(x, y) < tip)):
        return outside - offset
    ex, ey = spur_point(gear, kept, azimuth, flank)
    return math.sqrt((x - ex) ** 2 + (y - ey) ** 2 + (z - kept_z) ** 2)


@njit(nogil=True)
def _spur_at(fixed: Any, string: float) -> float:
    (own, mate, pose, own_azimuth, mate_azimuth, flank), z = fixed
    px, py = spur_point(own, string, own_azimuth, flank)
    x = pose[0, 0] * px + pose[0, 1] * py + pose[0, 2] * z + pose[0, 3]
    y = pose[1, 0] * px + pose[1, 1] * py + pose[1, 2] * z + pose[1, 3]
    return spur_distance(
        mate, x, y, pose[2, 0] * px + pose[2, 1] * py + pose[2, 2] * z + pose[2, 3], mate_azimuth, flank
    )


_over_string = zooming(_spur_at, PROFILE_POINTS, PROFILE_ZOOMS)


@njit(nogil=True)
def _spur_section(fixed: Any, z: float) -> float:
    return _over_string((fixed, z), 0.0, fixed[0][3])[0]


_spur_lowest = zooming(_spur_section, FACE_POINTS, FACE_ZOOMS)


@njit(nogil=True)
def _spur_pairs(
    own: Numbers,
    mate: Numbers,
    pose: np.ndarray,
    own_azimuth: np.ndarray,
    mate_azimuth: np.ndarray,
    flank: float,
    low: float,
    high: float,
    found: np.ndarray,
) -> None:
    for k in range(len(own_azimuth)):
        fixed = (own, mate, pose, own_azimuth[k], mate_azimuth[k], flank)
        found[k] = _spur_section(fixed, low) if low == high else _spur_lowest(fixed, low, high)[0]


def spur_distances(
    mesh: Mesh,
    driver_angle: np.ndarray,
    driven_angle: np.ndarray,
    flank: Flank,
    *,
    offsets: np.ndarray | None = None,
    section: float | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As brute_force.distances; `offsets` (n, 2) [mm] along the normals, `section` a height on the driver [mm]."""
    count = len(driver_angle)
    offsets = np.zeros((count, 2)) if offsets is None else offsets
    around = np.arange(-TEETH_EACH_SIDE, TEETH_EACH_SIDE + 1)
    teeth = np.round(-driver_angle / mesh.driver.pitch)[:, None] + around
    azimuth = driver_angle[:, None] + mesh.driver.pitch * (teeth - flank / 2)
    mates = np.round(
        (np.pi - azimuth * mesh.driver.teeth / mesh.driven.teeth - driven_angle[:, None]) / mesh.driven.pitch
    )
    poses = np.ascontiguousarray(mesh.driven_from_driver(driver_angle, driven_angle))
    own, mate = (_spur_numbers(gear, offsets[:, k]) for k, gear in enumerate((mesh.driver, mesh.driven)))
    found = np.empty(teeth.shape)
    for row, pose in enumerate(poses):
        low, high = (-own[row][4], own[row][4]) if section is None else (section, section)
        azimuths = mesh.driver.pitch * teeth[row], mesh.driven.pitch * mates[row]
        _spur_pairs(own[row], mate[row], pose, *azimuths, float(flank), float(low), float(high), found[row])
    return teeth, found, mates


def _spur_numbers(gear: InvoluteGear, offset: np.ndarray) -> list[Numbers]:
    base, tip = gear.base_radius, gear.tip_radius
    numbers = base, gear.half_angle(base), tip, np.sqrt(tip**2 - base**2), gear.face_width / 2
    rows = np.broadcast_arrays(*(np.ravel(number) for number in numbers), offset)
    return list(zip(*(row.tolist() for row in rows), strict=True))


# bevel ----------------------------------------------------------------------------------------------------------------
# a gear: sine and cosine of the base angle, flank's start on the base cone, rolls, cosine of tip angle, offset, face


@njit(nogil=True)
def bevel_line(gear: Numbers, roll: float, azimuth: float, flank: float) -> tuple[Vector, Vector]:
    """Direction of a flank's line and its normal out of the tooth; see bevel_brute_force.line."""
    sin, cos = gear[0], gear[1]
    about = azimuth + flank * (roll - gear[2])
    ca, sa = math.cos(about), math.sin(about)
    c, s = math.cos(roll * sin), math.sin(roll * sin)
    direction = (c * sin * ca + flank * s * sa, c * sin * sa - flank * s * ca, c * cos)
    outwards = (-s * sin * ca + flank * c * sa, -s * sin * sa - flank * c * ca, -s * cos)
    return direction, outwards


@njit(nogil=True)
def bevel_foot(gear: Numbers, x: float, y: float, z: float, azimuth: float, flank: float) -> float:
    """Roll of the line of the endless flank that is nearest: nothing of the point points upwards."""
    sin, cos = gear[0], gear[1]
    low, high = gear[3] - BEYOND, gear[4] + BEYOND
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        about = azimuth + flank * (middle - gear[2])
        up = (
            x * math.cos(about)
            + y * math.sin(about)
            - sin * (sin * (x * math.cos(about) + y * math.sin(about)) + cos * z)
        )
        if up > 0.0:
            low = middle
        else:
            high = middle
    roll = (low + high) / 2
    for _ in range(NEWTON_STEPS):
        about = azimuth + flank * (roll - gear[2])
        ca, sa = math.cos(about), math.sin(about)
        out = x * ca + y * sa
        up = out - sin * (sin * out + cos * z)
        bend = flank * cos * cos * (y * ca - x * sa)
        roll = min(max(roll - up / bend, low), high)
    return roll


@njit(nogil=True)
def bevel_distance(gear: Numbers, x: float, y: float, z: float, azimuth: float, flank: float) -> float:
    """See BevelNumbers.signed_distance."""
    roll = bevel_foot(gear, x, y, z, azimuth, flank)
    (dx, dy, dz), (ox, oy, oz) = bevel_line(gear, roll, azimuth, flank)
    along, outside = x * dx + y * dy + z * dz, x * ox + y * oy + z * oz - gear[6]
    kept = min(max(roll, gear[3]), gear[4])
    if gear[7] <= along <= gear[8]:
        below_tip = z > gear[5] * math.sqrt(x * x + y * y + z * z)
        if kept == roll or (outside < 0.0 and below_tip):
            return outside
    (dx, dy, dz), (ox, oy, oz) = bevel_line(gear, kept, azimuth, flank)
    far = min(max(x * dx + y * dy + z * dz, gear[7]), gear[8])
    ex, ey, ez = far * dx + gear[6] * ox - x, far * dy + gear[6] * oy - y, far * dz + gear[6] * oz - z
    return math.sqrt(ex * ex + ey * ey + ez * ez)


@njit(nogil=True)
def _bevel_at(fixed: Any, roll: float) -> float:
    (own, mate, pose, own_azimuth, mate_azimuth, flank), radius = fixed
    (dx, dy, dz), (ox, oy, oz) = bevel_line(own, roll, own_azimuth, flank)
    px, py, pz = radius * dx + own[6] * ox, radius * dy + own[6] * oy, radius * dz + own[6] * oz
    x = pose[0, 0] * px + pose[0, 1] * py + pose[0, 2] * pz + pose[0, 3]
    y = pose[1, 0] * px + pose[1, 1] * py + pose[1, 2] * pz + pose[1, 3]
    return bevel_distance(
        mate, x, y, pose[2, 0] * px + pose[2, 1] * py + pose[2, 2] * pz + pose[2, 3], mate_azimuth, flank
    )


_over_roll = zooming(_bevel_at, PROFILE_POINTS, PROFILE_ZOOMS)


@njit(nogil=True)
def _bevel_section(fixed: Any, radius: float) -> float:
    return _over_roll((fixed, radius), fixed[0][3], fixed[0][4])[0]


_bevel_lowest = zooming(_bevel_section, FACE_POINTS, FACE_ZOOMS)


@njit(nogil=True)
def _bevel_pairs(
    own: Numbers,
    mate: Numbers,
    pose: np.ndarray,
    own_azimuth: np.ndarray,
    mate_azimuth: np.ndarray,
    flank: float,
    found: np.ndarray,
) -> None:
    for k in range(len(own_azimuth)):
        fixed = (own, mate, pose, own_azimuth[k], mate_azimuth[k], flank)
        if own[7] == own[8]:
            found[k] = _bevel_section(fixed, own[7])
        else:
            found[k] = _bevel_lowest(fixed, own[7], own[8])[0]


def bevel_distances(
    mesh: BevelMesh, driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As bevel_brute_force.distances, of one build."""
    around = np.arange(-TEETH_EACH_SIDE, TEETH_EACH_SIDE + 1)
    teeth = np.round(-driver_angle / mesh.driver.pitch)[:, None] + around
    azimuth = driver_angle[:, None] + mesh.driver.pitch * (teeth - flank / 2)
    mates = np.round((-azimuth * mesh.driver.teeth / mesh.driven.teeth - driven_angle[:, None]) / mesh.driven.pitch)
    poses = np.ascontiguousarray(mesh.driven_from_driver(driver_angle, driven_angle))
    own, mate = (_bevel_numbers(gear) for gear in (mesh.driver, mesh.driven))
    found = np.empty(teeth.shape)
    for row, pose in enumerate(poses):
        _bevel_pairs(
            own, mate, pose, mesh.driver.pitch * teeth[row], mesh.driven.pitch * mates[row], float(flank), found[row]
        )
    return teeth, found, mates


def _bevel_numbers(gear: BevelNumbers) -> Numbers:
    base = gear.base_angle
    return tuple(
        float(number)
        for number in (
            math.sin(base),
            math.cos(base),
            gear.start,
            *gear.rolls,
            math.cos(gear.tip_angle),
            gear.offset,
            *gear.face,
        )
    )
