"""The solid of a crankshaft: round journals about z and eccentrics beside them."""

import math
from collections.abc import Sequence
from itertools import pairwise

from tol3d.errors import GeometryError
from tol3d.parts.machining import cylinder
from tol3d.parts.named_boolean import fused
from tol3d.parts.named_solid import BACK, FRONT, NamedSolid

Section = tuple[float, float, tuple[float, float]]
"""Diameter, length, and x and y of the axis [mm]."""


def crankshaft(sections: Sequence[Section], start: float) -> NamedSolid:
    """Cylinders along z, one on the other from z = start on.

    Faces: "section 1", "section 2" and so on, their sides, from the back; the ends "front" (+z) and "back"; what is
    seen of a section's ends is "section 1 front", "section 2 back" and so on.

    Args:
        sections: from the back on.
        start: [mm].

    Raises:
        GeometryError: a section without volume, or two that do not touch.
    """
    for number, (one, other) in enumerate(pairwise(sections), start=1):
        if math.dist(one[2], other[2]) >= (one[0] + other[0]) / 2:
            raise GeometryError(f"sections {number} and {number + 1} of a crankshaft do not touch")
    made, level = [], start
    for number, (diameter, length, at) in enumerate(sections, start=1):
        if min(diameter, length) <= 0.0:
            raise GeometryError(f"section {number} of a crankshaft, {diameter:g} mm by {length:g} mm, has no volume")
        name = f"section {number}"
        piece = cylinder((*at, level), (0.0, 0.0, 1.0), diameter, length, name, f"{name} back")
        faces = {_named(face, number, len(sections)): found for face, found in piece.faces.items()}
        made.append(NamedSolid(piece.solid, faces))
        level += length
    return fused(made[0], made[1:], "the crankshaft")


def _named(face: str, number: int, count: int) -> str:
    """Ends of the shaft have names of their own; machining.cylinder calls the far end of a side "side end"."""
    if face.endswith("end"):
        return FRONT if number == count else f"section {number} front"
    return BACK if face.endswith("back") and number == 1 else face
