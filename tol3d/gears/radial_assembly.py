"""Assembly of a gear into an internal one, along the line of centres or only along the axes.

As it moves outwards from the middle of the ring no point of it may meet a tooth at its own height off the line of
centres. Source of the condition: J. R. Colbourne, The Geometry of Involute Gears, Springer 1987, who looks at the tips
of the teeth; here the whole outlines are checked, at several phases.
"""

import math
from typing import Final

import numpy as np

from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.internal_mesh import InternalMesh, tooth_half_angle
from tol3d.numerics.arrays import Array

PHASES: Final = 4  # from a tooth to a space on the line of centres; what lies beyond is the mirror image
SIDE_POINTS: Final = 24  # of one side of a tooth: chords leave it by a few um of a module of 1 mm
TOUCHING: Final = 1e-3  # modules; outlines that come closer count as free: chords, and flanks that slide on each other


def radially_assembled(mesh: InternalMesh) -> bool:
    """True if the inner gear can be assembled along the line of centres, in the middle of its backlash."""
    if mesh.inner.tip_radius > mesh.ring.tip_radius:
        return False
    return any(_passes(mesh, phase / PHASES / 2) for phase in range(PHASES + 1))


def _passes(mesh: InternalMesh, phase: float) -> bool:
    """True if it passes at a phase, in pitches, of the inner gear's tooth off the line of centres."""
    inner = _right_half(mesh.inner, phase, mesh.centre_distance)
    ring = _right_half(mesh.ring, phase + 0.5, 0.0)
    reach = mesh.inner.tip_radius
    near = [part for part in ring if np.abs(part[:, 1]).min() < reach]
    least = -TOUCHING * mesh.inner.module
    return all(_ahead(points, near) > least for points in inner) and all(
        _behind(points, inner) > least for points in near
    )


def _right_half(gear: CylindricalGear, phase: float, x: float) -> list[Array]:
    """Outlines (n, 2) [mm] of its teeth on the side of the mesh, tooth by tooth: root, flank, tip, flank, root."""
    radius = np.linspace(gear.root_radius, gear.tip_radius, SIDE_POINTS)
    half = tooth_half_angle(gear, radius)
    radius, azimuth = np.concatenate([radius, radius[::-1]]), np.concatenate([-half, half[::-1]])
    quarter = gear.teeth // 4 + 1
    places = (np.arange(-quarter, quarter + 1) + phase) * gear.angular_pitch
    at = [azimuth + place for place in places if abs(place) < math.pi / 2]
    return [np.stack([x + radius * np.cos(angle), radius * np.sin(angle)], axis=1) for angle in at]


def _ahead(points: Array, teeth: list[Array]) -> float:
    """Distance [mm] of points from the nearest tooth to their right, at their own heights; negative: beyond."""
    return min(
        (float((_crossings(points, tooth, np.inf).min(axis=1) - points[:, 0]).min()) for tooth in teeth),
        default=math.inf,
    )


def _behind(points: Array, teeth: list[Array]) -> float:
    """Distance [mm] of points from the farthest tooth to their left, at their own heights."""
    return min(
        (float((points[:, 0] - _crossings(points, tooth, -np.inf).max(axis=1)).min()) for tooth in teeth),
        default=math.inf,
    )


def _crossings(points: Array, outline: Array, otherwise: float) -> Array:
    """Crossings of an outline's pieces with the heights of points, (points, pieces) [mm]."""
    (x0, y0), (x1, y1) = outline[:-1].T, outline[1:].T
    share = (points[:, 1, None] - y0) / np.where(y1 == y0, np.nan, y1 - y0)
    return np.where((share >= 0.0) & (share <= 1.0), x0 + share * (x1 - x0), otherwise)
