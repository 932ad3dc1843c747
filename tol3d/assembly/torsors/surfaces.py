"""Surfaces of two features, at least one of them round: the nominal common normal, and changes along it."""

from dataclasses import dataclass

import numpy as np

from tol3d.assembly.model import Axis, Measured, Plane, Point, RoundPlane, Shape
from tol3d.assembly.model.moves import is_inner, unfit_surfaces
from tol3d.assembly.torsors.columns import without_rounding
from tol3d.assembly.torsors.terms import Ends
from tol3d.assembly.torsors.torsor import cross_matrix, height_at, perpendicular, shift_at, turn_about
from tol3d.assembly.torsors.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

PARALLEL = 1e-6
"""Sine of the angle of axes that count as nominally parallel."""
NEAR = 1.0
"""Nominally nearer than this [mm]: a distance is the length of its first-order vector, else linear."""
NO_DISTANCE = 1e-9
"""Centres or axes nearer than that [mm] have no direction from one to the other."""


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Two surfaces and their common normal, nominally in the world.

    Args:
        world: in which they are.
        start, end: the features.
    """

    world: World
    start: str
    end: str

    @property
    def shapes(self) -> tuple[Shape, Shape]:
        """Shapes of both features."""
        features = self.world.assembly.features
        return features[self.start].shape, features[self.end].shape

    @property
    def is_inside(self) -> bool:
        """True if one lies inside the other."""
        return any(is_inner(shape) for shape in self.shapes)

    @property
    def parallel(self) -> bool:
        """True if two axes are parallel."""
        sine = np.linalg.norm(np.cross(self.world.axis(self.start), self.world.axis(self.end)))
        return all(isinstance(shape, Axis) for shape in self.shapes) and bool(sine < PARALLEL)

    @property
    def _feet(self) -> tuple[Array, Array]:
        """Feet of the common normal on centres, axes and planes (3,), (3,) [mm]."""
        start, end = self.world.origin(self.start), self.world.origin(self.end)
        own, other = self.world.axis(self.start), self.world.axis(self.end)
        apart = end - start
        match tuple(map(_word, self.shapes)):
            case "plane", _:
                return end - own * (own @ apart), end
            case _, "plane":
                return start, start + other * (other @ apart)
            case "axis", "axis" if not self.parallel:
                along = np.linalg.lstsq(np.column_stack([own, -other]), apart, rcond=None)[0]
                return start + along[0] * own, end + along[1] * other
            case "axis", _:
                return start + own * (own @ apart), end
            case _, "axis":
                return start, end - other * (other @ apart)
        return start, end

    @property
    def _normal(self) -> Array:
        """From the first to the second (3,)."""
        if isinstance(self.shapes[0], Plane | RoundPlane):
            return self.world.axis(self.start)
        if isinstance(self.shapes[1], Plane | RoundPlane):
            return -self.world.axis(self.end)
        start, end = self._feet
        return np.asarray((end - start) / np.linalg.norm(end - start))

    def checked(self) -> tuple[Array, float, Array]:
        """The normal (3,), the distance of centres, axes and planes along it [mm], and its place (3,).

        Raises:
            InputError: there is none.
        """
        self.refuse_unfit()
        start, end = self._feet
        if len(self._sides) and np.linalg.norm(end - start) <= NO_DISTANCE:
            raise InputError(f"{self.start} and {self.end} lie in each other's middle, which has no direction")
        return self._normal, float(self._normal @ (end - start)), end

    def refuse_unfit(self) -> None:
        """Refuse surfaces that have no common normal.

        Raises:
            InputError: such surfaces.
        """
        words = unfit_surfaces(*self.shapes)
        if not words and self.is_inside and not self.parallel and all(isinstance(own, Axis) for own in self.shapes):
            words = "expected axes that are nominally parallel, for one lies inside the other"
        if words:
            raise InputError(f"{self.start} and {self.end}: {words}")

    def touching(self) -> tuple[float, Array]:
        """The sum of the radii, or the difference of one inside the other: nominally [mm], how it varies (columns,)."""
        features = self.world.assembly.features
        sizes = [getattr(features[name].shape, "diameter", None) or 0.0 for name in (self.start, self.end)]
        varying = [self.world.size(name) for name in (self.start, self.end)]
        signs = (1.0, 1.0)
        if self.is_inside:
            signs = (1.0, -1.0) if is_inner(self.shapes[0]) else (-1.0, 1.0)
        nominal = sum(sign * size / 2 for sign, size in zip(signs, sizes, strict=True))
        return nominal, signs[0] * varying[0] / 2 + signs[1] * varying[1] / 2

    def gap(self) -> Array:
        """Gap between the surfaces (columns,) [mm]; between nearly coincident middles, by the length of their vector.

        Raises:
            InputError: as `checked`.
        """
        columns, (nominal, varying) = self.world.columns, self.touching()
        sides = self._sides
        feet = self._feet
        apart = feet[1] - feet[0]
        moved = shift_at(feet[1]) @ self.world.placed(self.end) - shift_at(feet[0]) @ self.world.placed(self.start)
        if len(sides) and np.linalg.norm(apart) < NEAR:
            self.refuse_unfit()
            distance = columns.largest((sides @ moved + columns.constants(sides @ apart))[None])
        else:
            normal, length, _ = self.checked()
            distance = normal @ moved + columns.constants(np.array([length]))[0]
        sign = -1.0 if self.is_inside else 1.0
        return np.asarray(sign * (distance - varying - columns.constants(np.array([nominal]))[0]))

    @property
    def _sides(self) -> Array:
        """Directions (directions, 3) in which centres and axes are apart; none of a plane."""
        words = tuple(map(_word, self.shapes))
        own, other = self.world.axis(self.start), self.world.axis(self.end)
        if "plane" in words:
            return np.zeros((0, 3))
        if words == ("axis", "axis") and not self.parallel:
            across = np.cross(own, other)
            return across[None] / np.linalg.norm(across)
        if "axis" in words:
            return perpendicular(own if words[0] == "axis" else other)
        return np.eye(3)

    def hinge(self) -> tuple[Array, float] | None:
        """The axis of the tilt of a body that lies along a line, as a turn (1, 6), and its nominal sine."""
        words = tuple(map(_word, self.shapes))
        if words == ("plane", "axis") or words == ("axis", "plane") or self.parallel:
            normal, _, _ = self.checked()
            if words == ("axis", "plane"):
                lying = self.world.axis(self.start)
                return turn_about(np.cross(normal, lying)[None]), float(lying @ normal)
            lying = self.world.axis(self.end)
            return turn_about(np.cross(lying, normal)[None]), float(lying @ normal)
        return None

    def turning_normal(self) -> tuple[Array, Array]:
        """The normal from the first to the second (3,), and how it varies (3, columns)."""
        normal, distance, _ = self.checked()
        start, end = self.world.placed(self.start), self.world.placed(self.end)
        first, second = map(_word, self.shapes)
        if first == "plane":
            return normal, -cross_matrix(normal) @ start[3:]
        if second == "plane":
            return normal, -cross_matrix(normal) @ end[3:]
        feet = self._feet
        apart = shift_at(feet[1]) @ end - shift_at(feet[0]) @ start
        varying = (apart - np.outer(normal, normal @ apart)) / distance
        axes = [self.world.axis(name) for name in (self.start, self.end)]
        if (first, second) == ("axis", "axis") and not self.parallel:
            # square to both axes as they turn
            asked = np.array([normal, *axes])
            turns = [normal @ cross_matrix(own) @ torsor[3:] for own, torsor in zip(axes, (start, end), strict=True)]
            return normal, np.linalg.solve(asked, np.array([np.zeros_like(turns[0]), *turns]))
        for word, axis, torsor in zip((first, second), axes, (start, end), strict=True):
            if word == "axis":  # square to the axis as it turns; of two the first counts
                turned = normal @ cross_matrix(axis) @ torsor[3:]
                return normal, varying + np.outer(axis, turned - axis @ varying)
        return normal, varying


def _word(shape: Shape) -> str:
    match shape:
        case Point():
            return "point"
        case Axis():
            return "axis"
        case Plane() | RoundPlane():
            return "plane"


def clearance(measured: Measured, world: World) -> Array:
    """A row (columns,) [mm]: the least of lengths that change as the points of each pair move along its normal.

    The pairs follow from nominal geometry. Rolling of faces on each other, and points that slide past ends, are of
    second order.
    """
    if measured.facing is None:
        raise ValueError(f"clearance of {', '.join(measured.parts)}: it is not known where they are nearest")
    start, end = measured.parts
    facing = measured.facing
    here, there = _in_world(facing.starts, start, world), _in_world(facing.ends, end, world)
    normals = world.turned(facing.normals, start)
    rows = world.columns.zeros(len(here))
    for row, point, other, normal, length in zip(rows, here, there, normals, facing.lengths, strict=True):
        row += height_at(other, normal)[0] @ world.parts[end] - height_at(point, normal)[0] @ world.parts[start]
        row[world.columns.constant] += length
    rows = without_rounding(rows)
    least: Array = rows[0] if len(rows) == 1 else world.columns.made_by(Ends(rows, is_largest=False))[0]
    return least


def _in_world(points: Array, part: str, world: World) -> Array:
    """Points (pairs, 3) of a part, nominally in the world [mm]."""
    pose = world.assembly.part[part].pose
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3])
