"""The shape of a named feature by its faces: a plane, a slot or tab, holes, pins, cones, balls, or a mixture."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from tol3d.cad.step.feature import NamedFeature
from tol3d.cad.step.structure import Structure
from tol3d.cad.step.surfaces import Surface, SurfaceKind, aligned, merged

ShapeKind = Literal[
    "plane",
    "planes",
    "slot",
    "cylinder",
    "cylinders",
    "cone",
    "cones",
    "sphere",
    "spheres",
    "round",
    "mixed",
    "nothing",
]

WORDS: Mapping[ShapeKind, str] = {
    "plane": "a plane",
    "planes": "several planes",
    "slot": "a slot or tab",
    "cylinder": "a hole or pin",
    "cylinders": "holes or pins",
    "cone": "a cone",
    "cones": "cones",
    "sphere": "a ball or socket",
    "spheres": "balls or sockets",
    "round": "a torus, a free form or sizes that differ",
    "mixed": "surfaces of several kinds",
    "nothing": "no faces",
}


@dataclass(frozen=True)
class Shape:
    """Shape of a feature.

    Args:
        kind: of all its surfaces together.
        surfaces: each once: the halves of a hole are one, and so are coplanar faces.
        loose: True if faces beside the solid were left out of it.
    """

    kind: ShapeKind
    surfaces: tuple[Surface, ...] = ()
    loose: bool = False

    def of_kinds(self, *kinds: SurfaceKind) -> list[Surface]:
        """Its surfaces of some kinds."""
        return [surface for surface in self.surfaces if surface.kind in kinds]

    @property
    def is_bored(self) -> bool:
        """True of holes or pins of several sizes with flat faces square to them: counterbores and their seats."""
        axes = self.of_kinds("cylinder")
        seats = self.of_kinds("plane")
        square = all(any(aligned(seat.direction, axis.direction) for axis in axes) for seat in seats)
        return bool(axes) and square and len(axes) + len(seats) == len(self.surfaces)

    @property
    def words(self) -> str:
        """Shape in words, with the number of surfaces."""
        if self.kind in ("planes", "cylinders", "cones", "spheres"):
            return f"{len(self.surfaces)} {WORDS[self.kind].removeprefix('several ')}"
        return WORDS[self.kind]


def shape_of(feature: NamedFeature, surfaces: Mapping[int, Surface], structure: Structure) -> Shape:
    """The shape of a feature, of the faces of solids if it names any."""
    loose = {face for product in structure.products.values() for face in product.loose_faces}
    solid = [face for face in feature.faces if face not in loose]
    found = merged([surfaces[face] for face in solid or feature.faces if face in surfaces])
    return Shape(kind_of(found), tuple(found), bool(solid) and len(solid) < len(feature.faces))


def kind_of(surfaces: list[Surface]) -> ShapeKind:
    """Kind of several surfaces together, each given once."""
    if not surfaces:
        return "nothing"
    kinds = {surface.kind for surface in surfaces}
    first = surfaces[0]
    if kinds == {"plane"}:
        if len(surfaces) == 2 and aligned(first.direction, surfaces[1].direction) < 0:
            return "slot"
        return "plane" if len(surfaces) == 1 else "planes"
    same_size = all(
        abs(surface.radius - first.radius) < 1e-4
        and (surface.same_sense, surface.slant) == (first.same_sense, first.slant)
        for surface in surfaces
    )  # mm, as SAME_PLACE
    if kinds == {"cylinder"} and same_size:
        return "cylinder" if len(surfaces) == 1 else "cylinders"
    if kinds == {"cone"} and same_size:
        return "cone" if len(surfaces) == 1 else "cones"
    if kinds == {"sphere"} and same_size:
        return "sphere" if len(surfaces) == 1 else "spheres"
    return "round" if len(kinds) == 1 else "mixed"
