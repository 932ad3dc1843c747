"""Interference of an external and an internal gear: the condition that fails, its numbers, and the remedy.

Conditions hold for the nominal teeth, with either flank in touch. Together they are exact for the outlines of both
gears: where none fails these overlap nowhere, at no position. Sources: DIN 3993 (1981) and J. R. Colbourne, The
Geometry of Involute Gears, Springer 1987, for tip, involute and trimming interference.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final, Literal

from tol3d.errors import GeometryError
from tol3d.gears.internal_mesh import InternalMesh

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
