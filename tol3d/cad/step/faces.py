"""Faces of a foreign STEP file as numbers: the output of the process that read it, checked.

Lengths are in mm, angles in rad, in the frame of the product that has the solid.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from tol3d.numerics.arrays import Array

LARGEST: Final = 1e9  # mm; a coordinate beyond it is damage

ROUNDING: Final = 1e-6  # of a direction's length
LARGEST_TURN: Final = 100.0  # rad
STEEPEST: Final = 1.57  # rad; of a cone, a flat one by nearly 1/1000

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Size = Annotated[float, Field(ge=0.0, le=LARGEST)]
Area = Annotated[float, Field(ge=0.0, le=LARGEST * LARGEST)]
Angle = Annotated[float, Field(ge=-LARGEST_TURN, le=LARGEST_TURN)]
Place = tuple[Number, Number, Number]


def _unit(direction: Place) -> Place:
    if abs(math.hypot(*direction) - 1.0) > ROUNDING:
        raise ValueError("Input should be a direction of length 1")
    return direction


Unit = Annotated[Place, AfterValidator(_unit)]
SurfaceKind = Literal["plane", "cylinder", "cone", "sphere", "torus", "free form"]

READ: Final = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


class Face(BaseModel):
    """A face: an elementary surface, or a free form.

    Args:
        id: its number in the file.
        kind: of its surface.
        at, axis, x, y: of the surface's own frame; none of a free form.
        turn: angles about the axis between which it lies, from x towards y; none of a free form.
        radius: of a cylinder or sphere; of a cone where its frame is, of a torus the larger one.
        half_angle: of a cone.
        minor_radius: of a torus.
        deviation: largest distance of a recognised spline from the surface that it is taken for.
        area: [mm²].
        centre: of its area.
        place, normal: a point of its surface, and the direction out of the material there.
        edges, outer: numbers of its edges, and of those of its outer outline.
    """

    model_config = READ

    id: int
    kind: SurfaceKind
    at: Place = (0.0, 0.0, 0.0)
    axis: Unit = (0.0, 0.0, 1.0)
    x: Unit = (1.0, 0.0, 0.0)
    y: Unit = (0.0, 1.0, 0.0)
    turn: tuple[Number, Number] | None = None
    radius: Size = 0.0
    half_angle: Annotated[float, Field(ge=-STEEPEST, le=STEEPEST)] = 0.0
    minor_radius: Size = 0.0
    deviation: Size = 0.0
    area: Area
    centre: Place
    place: Place
    normal: Place
    edges: tuple[int, ...]
    outer: tuple[int, ...]

    @property
    def is_hollow(self) -> bool:
        """True if the material of a round face lies outside: its normal points to the axis, or the centre."""
        towards = np.subtract(self.at, self.place)
        if self.kind == "torus":
            return bool(np.dot(self._tube() - np.array(self.place), self.normal) > 0.0)
        if self.kind != "sphere":
            towards = towards - np.array(self.axis) * np.dot(towards, self.axis)
        return bool(np.dot(towards, self.normal) > 0.0)

    def _tube(self) -> Array:
        """The nearest point of a torus's circle to its place (3,)."""
        off = np.subtract(self.place, self.at)
        flat = off - np.array(self.axis) * np.dot(off, self.axis)
        return np.asarray(self.at + self.radius * flat / max(float(np.linalg.norm(flat)), 1e-300))


class Edge(BaseModel):
    """An edge: its points, or a circle or ellipse by its numbers; "none" where a face shrinks to a point."""

    model_config = READ

    kind: Literal["line", "circle", "ellipse", "curve", "none"]
    points: tuple[Place, ...] = ()
    centre: Place = (0.0, 0.0, 0.0)
    x: Unit = (1.0, 0.0, 0.0)
    y: Unit = (0.0, 1.0, 0.0)
    radii: tuple[Size, Size] = (0.0, 0.0)
    ends: tuple[Angle, Angle] = (0.0, 0.0)

    def extremes(self, direction: Array) -> tuple[float, float]:
        """Lowest and highest coordinate along a direction (3,) of unit length [mm]."""
        if self.kind in ("circle", "ellipse"):
            return self._of_round(direction)
        values = np.array(self.points) @ direction
        return -_top(-values), _top(values)

    def _of_round(self, direction: Array) -> tuple[float, float]:
        middle = float(np.dot(self.centre, direction))
        along_x = self.radii[0] * float(np.dot(self.x, direction))
        along_y = self.radii[1] * float(np.dot(self.y, direction))
        angles = [*self.ends]
        top = float(np.arctan2(along_y, along_x))
        for angle in (top, top + np.pi):
            inside = self.ends[0] + (angle - self.ends[0]) % (2 * np.pi)
            if inside <= self.ends[1]:
                angles.append(inside)
        values = [middle + along_x * np.cos(angle) + along_y * np.sin(angle) for angle in angles]
        return float(min(values)), float(max(values))


def _top(values: Array) -> float:
    """The highest of a curve's samples, between them by the parabola through the three around it."""
    k = int(np.argmax(values))
    if not 0 < k < len(values) - 1:
        return float(values[k])
    before, here, after = values[k - 1 : k + 2].tolist()
    bend = before - 2 * here + after
    return float(here if bend >= 0.0 else here - (after - before) ** 2 / (8 * bend))


class Root(BaseModel):
    """A solid, or a shell beside one, by the number of its entity."""

    model_config = READ

    id: int
    solid: bool
    faces: tuple[Face, ...]
    edges: tuple[Edge, ...]

    @model_validator(mode="after")
    def _refuse_loose_ends(self) -> Self:
        known = range(len(self.edges))
        if any(number not in known for face in self.faces for number in (*face.edges, *face.outer)):
            raise ValueError("Input should name edges that are there")
        if any(not edge.points for edge in self.edges if edge.kind in ("line", "curve")):
            raise ValueError("Input should have points on every edge")
        return self


class Faces(BaseModel):
    """All of a file.

    Args:
        roots: its solids and shells.
        unread: numbers of faces that cannot be read, and why.
    """

    model_config = READ

    roots: tuple[Root, ...]
    unread: tuple[tuple[int, str], ...] = ()

    @property
    def by_id(self) -> Mapping[int, Face]:
        """Every face by its number."""
        return {face.id: face for root in self.roots for face in root.faces}


def extent(edges: Sequence[Edge], direction: Array) -> tuple[float, float]:
    """Lowest and highest coordinate of some edges along a direction (3,) of unit length [mm]; 0 for none."""
    found = [edge.extremes(direction) for edge in edges if edge.kind != "none"]
    return (min(low for low, _ in found), max(high for _, high in found)) if found else (0.0, 0.0)
