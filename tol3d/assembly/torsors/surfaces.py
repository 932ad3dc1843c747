"""Surfaces of two features, at least one of them round: the nominal common normal, and changes along it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tol3d.assembly.model import Measured, Shape
from tol3d.assembly.model.moves import unfit_surfaces
from tol3d.assembly.torsors.columns import ROUNDING, without_rounding
from tol3d.assembly.torsors.terms import Ends
from tol3d.assembly.torsors.torsor import cross_matrix, height_at, perpendicular, shift_at, turn_about
from tol3d.assembly.torsors.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

PARALLEL = 1e-6
"""Sine of the angle of axes that count as nominally parallel."""
NEAR = 1.0
"""Nominally nearer than this [mm]: a distance is the length of its first-order vector, else linear."""
STEEP = 0.1
"""A cylinder whose axis makes less of a sine with a plane's normal stands on it: the sine is the length of a vector."""
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
    def surfaces(self) -> tuple[str, str]:
        """Kinds of surface of both features."""
        start, end = self.shapes
        return start.surface, end.surface

    @property
    def is_inside(self) -> bool:
        """True if one lies inside the other."""
        return any(shape.inner for shape in self.shapes)

    @property
    def parallel(self) -> bool:
        """True if two axes are parallel."""
        sine = np.linalg.norm(np.cross(self.world.axis(self.start), self.world.axis(self.end)))
        return self.surfaces == ("axis", "axis") and bool(sine < PARALLEL)

    @property
    def _feet(self) -> tuple[Array, Array]:
        """Feet of the common normal on centres, axes and planes (3,), (3,) [mm]."""
        start, end = self.world.origin(self.start), self.world.origin(self.end)
        own, other = self.world.axis(self.start), self.world.axis(self.end)
        apart = end - start
        match self.surfaces:
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
        if self.surfaces[0] == "plane":
            return self.world.axis(self.start)
        if self.surfaces[1] == "plane":
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
        if not words and self.is_inside and not self.parallel and self.surfaces == ("axis", "axis"):
            words = "expected axes that are nominally parallel, for one lies inside the other"
        if words:
            raise InputError(f"{self.start} and {self.end}: {words}")

    def touching(self) -> tuple[float, Array]:
        """The sum of the radii, or the difference of one inside the other: nominally [mm], how it varies (columns,)."""
        sizes = [shape.diameter or 0.0 for shape in self.shapes]
        varying = [self.world.size(name) for name in (self.start, self.end)]
        signs = (1.0, 1.0)
        if self.is_inside:
            signs = (1.0, -1.0) if self.shapes[0].inner else (-1.0, 1.0)
        nominal = sum(sign * size / 2 for sign, size in zip(signs, sizes, strict=True))
        return nominal, signs[0] * varying[0] / 2 + signs[1] * varying[1] / 2

    def gap(self) -> Array:
        """Least gap between the surfaces over the length that both have (columns,) [mm]; see `_nearest`.

        Raises:
            InputError: as `refuse_unfit`.
        """
        columns, (nominal, varying) = self.world.columns, self.touching()
        self.refuse_unfit()
        touching = varying + columns.constants(np.array([nominal]))[0]
        if set(self.surfaces) == {"plane", "axis"}:
            return np.asarray(self._extreme(self._over_plane(), is_largest=False) - self._lines(touching))
        distance = self._extreme(self._nearest(), is_largest=self.is_inside)
        return np.asarray(touching - distance if self.is_inside else distance - touching)

    def _nearest(self) -> list[tuple[Array, Array]]:
        """Points of both features, nominally, of which some pair is the nearest one, or of a pin the farthest one.

        Of parallel axes: at both ends of the length that both have, or of the stretch between the ends that face each
        other. Of axes that cross: where they are nearest; if that is near their ends or beyond, each end with the point
        of the other axis nearest to it too.
        """
        (own, other), feet = self.shapes, self._feet
        if self.surfaces != ("axis", "axis"):
            return [feet]
        start, end = self.world.origin(self.start), self.world.origin(self.end)
        a, b = self.world.axis(self.start), self.world.axis(self.end)
        halves = own.reach[0], other.reach[0]
        if self.parallel:
            ends = _common(float(a @ (end - start)), halves)
            return [(start + along * a, end + a * (along - a @ (end - start))) for along in ends]
        free = [abs(a @ (feet[0] - start)) - halves[0], abs(b @ (feet[1] - end)) - halves[1]]
        if max(free) * np.linalg.norm(np.cross(a, b)) < -NEAR:
            return [feet]
        found = [feet] if max(free) <= 0.0 else []
        for sign in (-1.0, 1.0):
            here, there = start + sign * halves[0] * a, end + sign * halves[1] * b
            found.append((here, end + b * np.clip(b @ (here - end), -halves[1], halves[1])))
            found.append((start + a * np.clip(a @ (there - start), -halves[0], halves[0]), there))
        lengths = [float(np.linalg.norm(second - first)) for first, second in found]
        return [pair for pair, length in zip(found, lengths, strict=True) if length < min(lengths) + NEAR]

    def _over_plane(self) -> list[tuple[Array, Array]]:
        """Points of an axis and a plane, in their order, at both ends of what of the axis is over the plane, if any."""
        is_first = self.surfaces[0] == "axis"
        line, plane = (self.start, self.end) if is_first else (self.end, self.start)
        shape, flat = (self.world.assembly.features[name].shape for name in (line, plane))
        axis, normal, sides = self.world.axis(line), self.world.axis(plane), self.world.frame(plane)[:3, :2]
        middle, slope = (self.world.origin(line) - self.world.origin(plane)) @ sides, axis @ sides
        ends = -shape.reach[0], shape.reach[0]
        pieces = [(middle[k], slope[k], flat.reach[k.start]) for k in flat.together]
        limits = [_within(float(m @ s), float(s @ s), float(m @ m) - reach * reach) for m, s, reach in pieces]
        low, high = max(ends[0], *(limit[0] for limit in limits)), min(ends[1], *(limit[1] for limit in limits))
        tops = [self.world.origin(line) + end * axis for end in ((low, high) if low <= high else ends)]
        feet = [top - normal * (normal @ (top - self.world.origin(plane))) for top in tops]
        return list(zip(tops, feet, strict=True) if is_first else zip(feet, tops, strict=True))

    def _lines(self, radius: Array) -> Array:
        """From a cylinder's axis to its lowest line over a plane (columns,) [mm]: the radius times a sine."""
        columns = self.world.columns
        normal, axis = (self.world.axis(name) for name in (self.start, self.end))
        turned = (self.world.placed(self.end) - self.world.placed(self.start))[3:]
        across, cosine = np.cross(normal, axis), float(normal @ axis)
        sine, size = float(np.linalg.norm(across)), float(radius[columns.constant])
        if sine < STEEP:  # it stands on the plane
            sides = perpendicular(normal)
            return size * columns.largest((sides @ turned + columns.constants(sides @ across))[None])
        return radius * sine + size * cosine / sine * (across @ turned)

    def _extreme(self, places: Sequence[tuple[Array, Array]], *, is_largest: bool) -> Array:
        """The least or largest of distances between points of both features (columns,) [mm], as they are displaced.

        Args:
            places: pairs of points nominally in the world.
            is_largest: which.
        """
        columns, rows, vectors = self.world.columns, list[Array](), list[Array]()
        sides = self._sides
        if len(sides) == 1 and len(places) > 1:  # of axes that cross, their ends too
            sides = np.eye(3)
        for first, second in places:
            apart = second - first
            moved = shift_at(second) @ self.world.placed(self.end) - shift_at(first) @ self.world.placed(self.start)
            length = float(np.linalg.norm(apart))
            if len(sides) and length < NEAR:
                vectors.append(sides @ moved + columns.constants(sides @ apart))
                continue
            normal = apart / length if len(sides) else self._normal
            rows.append(normal @ moved + columns.constants(np.array([normal @ apart]))[0])
        vectors = _distinct(vectors)
        if is_largest and not rows:
            return columns.largest(np.array(vectors))
        rows = _distinct([*rows, *(columns.largest(vector[None]) for vector in vectors)])
        if len(rows) == 1:
            return rows[0]
        made: Array = columns.made_by(Ends(np.array(rows), is_largest=is_largest))[0]
        return made

    @property
    def _sides(self) -> Array:
        """Directions (directions, 3) in which centres and axes are apart; none of a plane."""
        words = self.surfaces
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
        words = self.surfaces
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
        first, second = self.surfaces
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


def _common(middle: float, halves: tuple[float, float]) -> tuple[float, float]:
    """Ends of the length that two features have in common, from the middle of the first along it [mm].

    Or of the stretch between the ends that face each other.

    Args:
        middle: of the second one.
        halves: of their lengths.
    """
    low, high = sorted((max(-halves[0], middle - halves[1]), min(halves[0], middle + halves[1])))
    return low, high


def _within(linear: float, square: float, constant: float) -> tuple[float, float]:
    """Interval of t in which square t^2 + 2 linear t + constant <= 0: without ends for all t, (inf, -inf) for none."""
    spread = linear * linear - square * constant
    if square < NO_DISTANCE**2:
        return (-np.inf, np.inf) if constant <= 0.0 else (np.inf, -np.inf)
    if spread < 0.0:
        return np.inf, -np.inf
    return (-linear - spread**0.5) / square, (-linear + spread**0.5) / square


def _distinct(rows: Sequence[Array]) -> list[Array]:
    """Rows that differ by more than rounding."""
    kept: list[Array] = []
    for row in map(without_rounding, rows):
        if not any(np.abs(row - own).max() < ROUNDING for own in kept):
            kept.append(row)
    return kept


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
