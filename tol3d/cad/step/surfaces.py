"""The surfaces of faces by the text alone: planes, cylinders, cones, spheres and tori by their numbers.

Spline surfaces that are planes or cylinders in truth are recognised by the geometry, not here.
"""

import math
from dataclasses import dataclass
from typing import Final, Literal

from tol3d.cad.step.part21 import Part21
from tol3d.cad.step.placement import Vector, length_unit, placement_of
from tol3d.cad.step.structure import Product
from tol3d.cad.step.units import Unit
from tol3d.cad.step.values import Enumeration

SurfaceKind = Literal["plane", "cylinder", "cone", "sphere", "torus", "other"]

KINDS: Final[dict[str, SurfaceKind]] = {
    "PLANE": "plane",
    "CYLINDRICAL_SURFACE": "cylinder",
    "CONICAL_SURFACE": "cone",
    "SPHERICAL_SURFACE": "sphere",
    "TOROIDAL_SURFACE": "torus",
}
SAME_PLACE: Final = 1e-4  # mm; files of inch parts have their numbers to about 1e-6 in
SAME_SLOPE: Final = 1e-6  # sine between directions that are the same


@dataclass(frozen=True)
class Surface:
    """The surface of a face.

    Args:
        kind: of the surface.
        at: a point of a plane, the centre of a sphere or torus, a point on the axis of others [mm].
        direction: the normal of a plane out of the material; the axis of others.
        radius: of a round one [mm], of a torus that of its tube, of a cone that at its placement; 0 of planes.
        same_sense: whether the face's normal is that of the surface: a pin rather than a hole.
        slant: of a cone, its half angle as the file writes it.
    """

    kind: SurfaceKind
    at: Vector = (0.0, 0.0, 0.0)
    direction: Vector = (0.0, 0.0, 1.0)
    radius: float = 0.0
    same_sense: bool = True
    slant: float = 0.0

    def is_coaxial_with(self, other: "Surface") -> bool:
        """True if two round surfaces have one axis, whichever way each points."""
        between = tuple(b - a for a, b in zip(self.at, other.at, strict=True))
        along = dot(between, self.direction)
        across = math.sqrt(sum((b - along * d) ** 2 for b, d in zip(between, self.direction, strict=True)))
        return aligned(self.direction, other.direction) != 0 and across < SAME_PLACE

    def is_one_with(self, other: "Surface") -> bool:
        """True if two faces lie on one surface, with the material on the same side."""
        if (self.kind, self.same_sense if self.radius else True) != (
            other.kind,
            other.same_sense if self.radius else True,
        ):
            return False
        if abs(self.radius - other.radius) > SAME_PLACE:
            return False
        between = tuple(b - a for a, b in zip(self.at, other.at, strict=True))
        if self.kind == "plane":
            return aligned(self.direction, other.direction) > 0 and abs(dot(between, self.direction)) < SAME_PLACE
        if self.kind == "cylinder":
            along = dot(between, self.direction)
            aside = math.sqrt(max(dot(between, between) - along * along, 0.0))
            return aligned(self.direction, other.direction) != 0 and aside < SAME_PLACE
        if self.kind == "cone" and (aligned(self.direction, other.direction) < 1 or self.slant != other.slant):
            return False
        return self.kind in ("cone", "sphere", "torus") and math.sqrt(dot(between, between)) < SAME_PLACE


def dot(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    """The scalar product."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def aligned(a: Vector, b: Vector) -> int:
    """1 if two directions are the same, -1 if they are opposite, else 0."""
    cosine = dot(a, b)
    if 1 - cosine * cosine > SAME_SLOPE * SAME_SLOPE:
        return 0
    return 1 if cosine > 0 else -1


def surface_of(file: Part21, face: int, unit: Unit) -> Surface:
    """The surface of an ADVANCED_FACE; `other` if it is none of the analytic ones."""
    record = file[face].needed("ADVANCED_FACE", "FACE_SURFACE")
    sense = record.argument(3)
    same = not (isinstance(sense, Enumeration) and sense.word in ("F", "FALSE"))
    instance = file[record.reference(2)]
    found = instance.record(*KINDS)
    if found is None:
        return Surface("other", same_sense=same)
    placement = placement_of(file, found.reference(1), unit)
    z = (placement[0][2], placement[1][2], placement[2][2])
    at = (placement[0][3], placement[1][3], placement[2][3])
    kind = KINDS[found.keyword]
    if kind == "plane":
        return Surface(kind, at, z if same else (-z[0], -z[1], -z[2]), same_sense=same)
    radius = found.number(3 if kind == "torus" else 2) * unit.factor
    return Surface(kind, at, z, radius, same, found.number(3) if kind == "cone" else 0.0)


def product_unit(file: Part21, product: Product) -> Unit | None:
    """The unit of lengths of a product's own representations, None if it has none."""
    for word in (each for each in file.ids if each.endswith("REPRESENTATION") and "SHAPE" in each):
        for instance in file.of(word):
            record = instance.record("REPRESENTATION") or instance.inherited("REPRESENTATION")
            listed = record.argument(1) if len(record) >= 3 else ()
            if isinstance(listed, tuple) and any(solid.id in listed for solid in product.solids):
                return length_unit(file, record.reference(2))
    return None


def merged(surfaces: list[Surface]) -> list[Surface]:
    """The surfaces without those that continue an earlier one: the halves of a hole, an interrupted plane."""
    found: list[Surface] = []
    for surface in surfaces:
        if not any(surface.is_one_with(other) for other in found):
            found.append(surface)
    return found
