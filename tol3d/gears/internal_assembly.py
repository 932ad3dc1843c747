"""Interference of an external and an internal gear: the condition that fails, its numbers, and the remedy.

Conditions hold for the nominal teeth, with either flank in touch. Together they are exact for the outlines of both
gears: where none fails these overlap nowhere, at no position. Sources: DIN 3993 (1981) and J. R. Colbourne, The
Geometry of Involute Gears, Springer 1987, for tip, involute and trimming interference.

Assembly of a gear into an internal one, along the line of centres or only along the axes.

As it moves outwards from the middle of the ring no point of it may meet a tooth at its own height off the line of
centres. Source of the condition: J. R. Colbourne, The Geometry of Involute Gears, Springer 1987, who looks at the tips
of the teeth; here the whole outlines are checked, at several phases. Sections of helical gears are those of one pair at
other phases: all of them have to pass at once.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final, Literal

import numpy as np

from tol3d.errors import GeometryError
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.internal_mesh import InternalMesh, tooth_half_angle
from tol3d.numerics.arrays import Array

LEAST_GAP: Final = 1e-9  # mm; corners that miss by less touch
LOWEST_ADDENDUM: Final = 0.2  # factor; where even such teeth interfere no advice is given
STEPS: Final = 40  # halvings of an addendum: far finer than the four digits that are printed


Who = Literal["inner", "internal", "both"]


def interferes(mesh: InternalMesh) -> bool:
    """True if any condition fails."""
    ring, inner = mesh.ring, mesh.inner
    return bool(
        mesh.clearance_at_ring_root <= 0.0
        or mesh.clearance_at_inner_root <= 0.0
        or mesh.inner_roll(ring.tip_roll) < inner.form_roll
        or mesh.ring_roll(inner.tip_roll) > ring.form_roll
        or mesh.trimming_gap < LEAST_GAP
        or mesh.ring_fillet_gap < 0.0
        or mesh.inner_fillet_gap < 0.0
    )


def interference(mesh: InternalMesh) -> str:
    """The first condition that fails, or nothing.

    >>> from tol3d.gears import InternalGear, SpurGear
    >>> alpha = math.radians(20)
    >>> planet, ring = SpurGear(27, 1.0, alpha, 10.0), InternalGear(79, 1.0, alpha, 10.0)
    >>> interference(InternalMesh(ring, planet, 26.0))
    ''
    """
    return next(_failures(mesh), "")


def _failures(mesh: InternalMesh) -> Iterator[str]:
    yield from _tips(mesh)
    yield from _involutes(mesh)
    yield from _trimming(mesh)
    yield from _fillets(mesh)


def _tips(mesh: InternalMesh) -> Iterator[str]:
    """Tip circles within the mate's root circle."""
    names: tuple[tuple[float, Who, Who], ...] = (
        (mesh.clearance_at_ring_root, "inner", "internal"),
        (mesh.clearance_at_inner_root, "internal", "inner"),
    )
    for clearance, tip, root in names:
        if clearance <= 0.0:
            yield (
                f"tip interference at centre distance {mesh.centre_distance:g} mm: the tip circle of the {tip} gear "
                f"and the root of the {root} gear interfere by {-clearance:.4f} mm; close the "
                f"centre distance or deepen the {root} gear's dedendum{_advice(mesh, tip)}"
            )


def _involutes(mesh: InternalMesh) -> Iterator[str]:
    """The path of contact on both involutes."""
    ring, inner = mesh.ring, mesh.inner
    start = mesh.inner_roll(ring.tip_roll)
    if start < inner.form_roll:
        where = f"at {2 * inner.base_radius * math.hypot(1.0, start):.4f} mm" if start > 0 else "below its base circle"
        yield (
            f"involute interference: the internal gear's tip would touch the inner gear {where}, but its involute "
            f"begins at {2 * inner.form_radius:.4f} mm; give the inner gear a smaller root_fillet or more "
            f"profile_shift{_advice(mesh, 'internal')}"
        )
    end = mesh.ring_roll(inner.tip_roll)
    if end > ring.form_roll:
        yield (
            f"involute interference: the inner gear's tip would touch the internal gear at "
            f"{2 * ring.base_radius * math.hypot(1.0, end):.4f} mm, but its involute ends at "
            f"{2 * ring.form_radius:.4f} mm; give the internal gear a smaller root_fillet or more dedendum"
            f"{_advice(mesh, 'inner')}"
        )


def _trimming(mesh: InternalMesh) -> Iterator[str]:
    """Tip corners away from the path of contact."""
    gap = mesh.trimming_gap
    if gap < LEAST_GAP:
        yield (
            f"trimming interference: where the tip circles cross, {math.degrees(mesh.tip_crossing):.2f} deg off the "
            f"line of centres, tip corners overlap by {-gap:.4f} mm: a tooth difference of "
            f"{mesh.ring.teeth - mesh.inner.teeth} is too small for these addenda{_advice(mesh, 'both')}"
        )


def _fillets(mesh: InternalMesh) -> Iterator[str]:
    """Tip corners in the mate's fillets."""
    names: tuple[tuple[float, Who, Who], ...] = (
        (mesh.ring_fillet_gap, "inner", "internal"),
        (mesh.inner_fillet_gap, "internal", "inner"),
    )
    for gap, tip, root in names:
        if gap < 0.0:
            yield (
                f"tip interference: the {tip} gear's tip corner overlaps the root fillet of the {root} gear by "
                f"{-gap:.4f} mm; give the {root} gear another root_fillet or more dedendum{_advice(mesh, tip)}"
            )


def _advice(mesh: InternalMesh, who: Who) -> str:
    """The largest addendum of one gear or both with which no condition fails, as text; nothing where there is none."""
    low, high = LOWEST_ADDENDUM, max(mesh.ring.addendum, mesh.inner.addendum)
    try:
        if interferes(_lowered(mesh, who, low)):
            return ""
        for _ in range(STEPS):
            middle = (low + high) / 2
            low, high = (low, middle) if interferes(_lowered(mesh, who, middle)) else (middle, high)
    except GeometryError:
        return ""
    whose = "addenda" if who == "both" else f"an addendum of the {who} gear"
    return f"; expected {whose} of at most {math.floor(low * 1e4) / 1e4:.4f}"


def _lowered(mesh: InternalMesh, who: Who, most: float) -> InternalMesh:
    """The same with addenda of at most that."""
    ring, inner = mesh.ring, mesh.inner
    if who != "inner":
        ring = replace(ring, addendum=min(ring.addendum, most))
    if who != "internal":
        inner = replace(inner, addendum=min(inner.addendum, most))
    return replace(mesh, ring=ring, inner=inner)


PHASES: Final = 4  # from a tooth to a space on the line of centres; what lies beyond is the mirror image
SIDE_POINTS: Final = 24  # of one side of a tooth: chords leave it by a few um of a module of 1 mm
TOUCHING: Final = 1e-3  # modules; outlines that come closer count as free: chords, and flanks that slide on each other


def radially_assembled(mesh: InternalMesh) -> bool:
    """True if the inner gear can be assembled along the line of centres, in the middle of its backlash."""
    if mesh.inner.tip_radius > mesh.ring.tip_radius:
        return False
    if not mesh.inner.helix_angle:
        return any(_passes(mesh, phase / PHASES / 2) for phase in range(PHASES + 1))
    half = [_passes(mesh, phase / PHASES / 2) for phase in range(PHASES + 1)]
    around = half + half[-2:0:-1]  # the phases of a pitch, the second half mirrored
    face = min(mesh.inner.face_width, mesh.ring.face_width)
    taken = math.ceil(abs(mesh.inner.twist) * face / mesh.inner.angular_pitch * len(around))
    return any(all((around * 2)[first : first + min(taken + 1, len(around))]) for first in range(len(around)))


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
