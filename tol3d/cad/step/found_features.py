"""Features found on the faces of a foreign part: each is a set of faces that lie on one surface.

Holes that are cut in halves are one hole, and coplanar faces with one normal are one plane, interrupted. Faces that lie
loose beside a solid and repeat one of its faces belong to its feature.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final, Literal

import numpy as np

from tol3d.cad.step.faces import Edge, Face, Faces, Root, extent
from tol3d.numerics.arrays import Array

SAME_PLACE: Final = 1e-5
"""mm; surfaces that lie apart by less are one, for files are written to about 1e-7 of a part's size."""
SAME_SLOPE: Final = 1e-6
"""Sine between directions that are the same."""
HELD: Final = math.pi + 0.02
"""rad; a cylinder that turns further holds a pin across, one that turns less is a rounded edge."""
DECIMALS: Final = 10
"""Decimals of lengths in mm: rounding noise of a file's 15 digits is cut off, and no more."""
COSINE_DECIMALS: Final = 13
ALONG: Final = 0.9
"""Cosine to the part's x beyond which a normal counts as along it; as in the frames of features by numbers."""

Triple = tuple[float, float, float]

FeatureKind = Literal[
    "plane", "hole", "pin", "fillet", "round", "cone", "ball", "socket", "torus", "free form", "unread"
]  # fmt: skip


@dataclass(frozen=True)
class FoundFeature:
    """A feature of a part, in the frame of its product [mm].

    Args:
        faces: their numbers in the file, of the solid; of loose faces if it is loose.
        kind: a fillet is a hollow cylinder that turns by half a turn or less, a round its opposite.
        at: the middle: of a plane of the rectangle (or circle) around it, of a round feature of its axis.
        direction: the normal out of the material of a plane; else the axis, towards +x, +y or +z.
        x: of a plane, the direction of the first of its extents.
        extent: of a plane, of the rectangle around it; of a round one its length along the axis, and 0.
        radius: of a round one, of a flat one whose outline is a circle; of a cone the larger, of a torus that of the
            circle in its tube; 0 of others.
        minor_radius: of a torus's tube; of a cone, the smaller one.
        half_angle: of a cone [rad].
        turn: its angle about its axis [rad].
        area: [mm²].
        loose: whether it lies beside the solid.
        repeated: numbers of loose faces that lie on it.
        names: of its faces in the file.
        colour: of its faces, "#RRGGBB"; "" if the file states none, or several.
        on: a point of it.
        radii: of a cone, at the start and at the end of its axis.
        outside: of a cone, whether the material lies outside.
        deviation: largest distance of splines from the surface that they are taken for [mm].
    """

    faces: tuple[int, ...]
    kind: FeatureKind
    at: Triple
    direction: Triple
    x: Triple
    extent: tuple[float, float] = (0.0, 0.0)
    radius: float = 0.0
    minor_radius: float = 0.0
    half_angle: float = 0.0
    turn: float = 2.0 * math.pi
    area: float = 0.0
    loose: bool = False
    repeated: tuple[int, ...] = ()
    names: tuple[str, ...] = ()
    colour: str = ""
    on: Triple = (0.0, 0.0, 0.0)
    radii: tuple[float, float] = (0.0, 0.0)
    outside: bool = False
    deviation: float = 0.0

    @property
    def length(self) -> float:
        """Length along its axis [mm]."""
        return self.extent[0]

    @property
    def hollow(self) -> bool:
        """True if the material lies outside."""
        return self.outside or self.kind in ("hole", "fillet", "socket")

    def axis_distance(self, point: Array) -> float:
        """Distance of a point (3,) from the axis between its ends, or from the centre of a ball [mm]."""
        off = point - np.array(self.at)
        along = float(np.clip(off @ np.array(self.direction), -self.length / 2, self.length / 2))
        return float(np.linalg.norm(off - along * np.array(self.direction)))


@dataclass(frozen=True)
class Shell:
    """A solid, or loose faces, with the meaning of their numbers.

    Args:
        faces: by their numbers in the file.
        edges: of each face.
        outer: the edges of each face's outer outline.
        loose: numbers of faces that are of no solid.
    """

    faces: Mapping[int, Face]
    edges: Mapping[int, Sequence[Edge]]
    outer: Mapping[int, Sequence[Edge]]
    loose: frozenset[int] = field(default=frozenset())

    @classmethod
    def of(cls, roots: Sequence[Root]) -> "Shell":
        """Some solids and shells as one."""
        return cls(
            {face.id: face for root in roots for face in root.faces},
            {face.id: [root.edges[k] for k in face.edges] for root in roots for face in root.faces},
            {face.id: [root.edges[k] for k in face.outer] for root in roots for face in root.faces},
            frozenset(face.id for root in roots if not root.solid for face in root.faces),
        )

    def along(self, ids: Sequence[int], direction: Array) -> tuple[float, float]:
        """Lowest and highest coordinate of some faces along a direction (3,) [mm]."""
        edges = [edge for number in ids for edge in self.edges[number]]
        if all(edge.kind == "none" for edge in edges):  # a whole sphere
            radius = self.faces[ids[0]].radius
            middle = float(np.dot(self.faces[ids[0]].at, direction))
            return middle - radius, middle + radius
        return extent(edges, direction)

    @cached_property
    def features(self) -> tuple[FoundFeature, ...]:
        """Features found, in the order of the file; loose faces that repeat none of the solid's last."""
        own = [number for number in self.faces if number not in self.loose]
        found = [self.made_of(ids) for ids in self._grouped(own)]
        extra: list[int] = []
        repeats: dict[int, list[int]] = {}
        for number in sorted(self.loose):
            k = next((k for k, feature in enumerate(found) if self._repeats(number, feature)), None)
            (extra if k is None else repeats.setdefault(k, [])).append(number)
        found = [replace(own, repeated=tuple(repeats.get(k, ()))) for k, own in enumerate(found)]
        return (*found, *(replace(self.made_of(ids), loose=True) for ids in self._grouped(extra)))

    def _repeats(self, number: int, feature: FoundFeature) -> bool:
        """True if a loose face lies on a feature of the solid."""
        face = self.faces[number]
        for other in feature.faces:
            own = self.faces[other]
            if own.kind != face.kind:
                continue
            if face.kind == "free form":
                return bool(np.linalg.norm(np.subtract(face.centre, own.centre)) < SAME_PLACE)
            if _same_surface(face, own, turned=True) and self._meet(number, other):
                return True
        return False

    def _meet(self, number: int, other: int) -> bool:
        """True if the boxes of two faces overlap."""
        for direction in np.eye(3):
            low, high = self.along((number,), direction)
            other_low, other_high = self.along((other,), direction)
            if low > other_high + SAME_PLACE or other_low > high + SAME_PLACE:
                return False
        return True

    def _grouped(self, numbers: Sequence[int]) -> Iterator[list[int]]:
        """Faces that are one feature, by their numbers in the order of the file."""
        groups: dict[tuple[str, bool, int], list[list[int]]] = {}
        all_groups: list[list[int]] = []
        for number in sorted(numbers):
            face = self.faces[number]
            if face.kind == "free form":
                all_groups.append([number])
                continue
            key = round(_scalar(face) / SAME_PLACE / 4)
            words = face.kind, face.kind != "plane" and face.is_hollow
            near = (group for k in (key - 1, key, key + 1) for group in groups.get((*words, k), ()))
            fitting = next((group for group in near if _same_surface(self.faces[group[0]], face, turned=False)), None)
            if fitting is None:
                fitting = []
                all_groups.append(fitting)
                groups.setdefault((*words, key), []).append(fitting)
            fitting.append(number)
        for group in all_groups:
            yield from self._touching(group) if self.faces[group[0]].kind in ("cylinder", "cone") else [group]

    def _touching(self, group: Sequence[int]) -> Iterator[list[int]]:
        """Coaxial faces, those together that lie beside each other along the axis without a gap."""
        axis = np.array(self.faces[group[0]].axis)
        ends = sorted((*self.along((number,), axis), number) for number in group)
        own: list[int] = []
        reached = -math.inf
        for low, high, number in ends:
            if own and low > reached + SAME_PLACE:
                yield sorted(own)
                own = []
            own.append(number)
            reached = max(reached, high)
        yield sorted(own)

    def made_of(self, ids: Sequence[int], along: Triple | None = None) -> FoundFeature:
        """The feature that faces on one surface are.

        Args:
            ids: their numbers; the first gives the surface.
            along: direction of x on a plane, as near as may be; the part's x, or y where the normal is x, if None.
        """
        face = self.faces[ids[0]]
        area = math.fsum(self.faces[number].area for number in ids)
        makers: Mapping[str, Callable[[Sequence[int]], FoundFeature]] = {
            "cylinder": self._cylinder, "cone": self._cone, "sphere": self._sphere, "torus": self._torus,
        }  # fmt: skip
        if face.kind == "plane":
            found = self._plane(ids, along)
        elif face.kind in makers:
            found = makers[face.kind](ids)
        else:
            found = FoundFeature(
                tuple(ids), "free form", lengths_of(face.centre), cosines_of(face.normal), (1.0, 0.0, 0.0)
            )
        deviation = max(self.faces[number].deviation for number in ids)
        return replace(found, area=round(area, DECIMALS), loose=ids[0] in self.loose, deviation=deviation)

    def is_one(self, ids: Sequence[int]) -> bool:
        """True if faces lie on one surface."""
        first = self.faces[ids[0]]
        return all(_same_surface(first, self.faces[own], turned=False) for own in ids[1:])

    def _plane(self, ids: Sequence[int], along: Triple | None) -> FoundFeature:
        face = self.faces[ids[0]]
        normal = np.array(cosines_of(_normal(face)))
        x = _x_of(normal, along)
        y = np.cross(normal, x)
        height = float(np.dot(face.at, normal))
        outline = self.outer[ids[0]]
        kinds = {edge.kind for edge in outline}
        if len(ids) == 1 and kinds == {"circle"} and _one_circle(outline):
            radius = round(outline[0].radii[0], DECIMALS)
            sides = 2 * radius, 2 * radius
            return FoundFeature(
                tuple(ids), "plane", lengths_of(outline[0].centre), cosines_of(normal), cosines_of(x), sides, radius
            )
        (left, right), (low, high) = self.along(ids, x), self.along(ids, y)
        at = (left + right) / 2 * x + (low + high) / 2 * y + height * normal
        sides = round(right - left, DECIMALS), round(high - low, DECIMALS)
        return FoundFeature(tuple(ids), "plane", lengths_of(at), cosines_of(normal), cosines_of(x), sides)

    def _axis(self, ids: Sequence[int]) -> tuple[Array, Array, float]:
        """Middle (3,), direction (3,) towards +x, +y or +z, and length of a round feature."""
        face = self.faces[ids[0]]
        axis = np.array(cosines_of(face.axis))
        sizes = np.abs(axis)
        if axis[int(np.argmax(sizes > sizes.max() - SAME_SLOPE))] < 0.0:  # the first of those that are as long
            axis = 0.0 - axis
        low, high = self.along(ids, axis)
        at = np.array(face.at)
        at = at + ((low + high) / 2 - at @ axis) * axis
        return at, axis, high - low

    def _cylinder(self, ids: Sequence[int]) -> FoundFeature:
        face = self.faces[ids[0]]
        at, axis, length = self._axis(ids)
        turn = self._turn(ids)
        kinds: tuple[FeatureKind, FeatureKind] = ("hole", "pin") if turn > HELD else ("fillet", "round")
        kind = kinds[0] if face.is_hollow else kinds[1]
        return FoundFeature(
            tuple(ids),
            kind,
            lengths_of(at),
            cosines_of(axis),
            cosines_of(_x_of(axis, None)),
            (round(length, DECIMALS), 0.0),
            round(face.radius, DECIMALS),
            turn=turn,
        )

    def _turn(self, ids: Sequence[int]) -> float:
        """Angle about their axis that faces cover together [rad]."""
        first = self.faces[ids[0]]
        spans: list[tuple[float, float]] = []
        for number in ids:
            face = self.faces[number]
            assert face.turn is not None
            start = math.atan2(np.dot(face.x, first.y), np.dot(face.x, first.x))
            sign = 1.0 if np.dot(np.cross(face.x, face.y), np.cross(first.x, first.y)) > 0.0 else -1.0
            low, high = sorted(start + sign * angle for angle in face.turn)
            low, high = low % (2 * math.pi), low % (2 * math.pi) + (high - low)
            spans += [(low, high), (low - 2 * math.pi, high - 2 * math.pi)]
        covered, reached = 0.0, 0.0
        for low, high in sorted(spans):
            low, high = max(low, reached), min(high, 2 * math.pi)
            covered += max(0.0, high - low)
            reached = max(reached, high)
        return covered

    def _cone(self, ids: Sequence[int]) -> FoundFeature:
        face = self.faces[ids[0]]
        at, axis, length = self._axis(ids)
        slope = math.tan(face.half_angle) * (1.0 if np.dot(face.axis, axis) > 0.0 else -1.0)
        middle = face.radius + slope * float((at - np.array(face.at)) @ axis)
        ends = abs(middle - slope * length / 2), abs(middle + slope * length / 2)
        small, large = sorted(ends)
        return FoundFeature(
            tuple(ids),
            "cone",
            lengths_of(at),
            cosines_of(axis),
            cosines_of(_x_of(axis, None)),
            (round(length, DECIMALS), 0.0),
            round(large, DECIMALS),
            round(small, DECIMALS),
            abs(face.half_angle),
            self._turn(ids),
            radii=(round(ends[0], DECIMALS), round(ends[1], DECIMALS)),
            outside=face.is_hollow,
        )

    def _sphere(self, ids: Sequence[int]) -> FoundFeature:
        face = self.faces[ids[0]]
        kind: FeatureKind = "socket" if face.is_hollow else "ball"
        ends = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
        return FoundFeature(tuple(ids), kind, lengths_of(face.at), *ends, radius=round(face.radius, DECIMALS))

    def _torus(self, ids: Sequence[int]) -> FoundFeature:
        face = self.faces[ids[0]]
        _, axis, _ = self._axis(ids)
        return FoundFeature(
            tuple(ids), "torus", lengths_of(face.at), cosines_of(axis), cosines_of(_x_of(axis, None)),
            radius=round(face.radius, DECIMALS), minor_radius=round(face.minor_radius, DECIMALS),
        )  # fmt: skip


def shell_of(faces: Faces, roots: Sequence[int]) -> Shell:
    """Some solids and shells of a file as one part."""
    return Shell.of([root for root in faces.roots if root.id in roots])


def by_place(found: Sequence[FoundFeature]) -> list[FoundFeature]:
    """Features by x, then y, then z, where places that differ by rounding of a file are one."""

    def ordered(some: list[FoundFeature], axis: int) -> Iterator[FoundFeature]:
        if axis == 3 or len(some) < 2:
            yield from some
            return
        level: list[FoundFeature] = []
        for own in sorted(some, key=lambda each: each.at[axis]):
            if level and own.at[axis] - level[-1].at[axis] > SAME_PLACE:
                yield from ordered(level, axis + 1)
                level = []
            level.append(own)
        yield from ordered(level, axis + 1)

    return list(ordered(list(found), 0))


def _normal(face: Face) -> Array:
    """Normal of a flat face, out of the material (3,)."""
    axis = np.array(face.axis)
    return axis if float(axis @ np.array(face.normal)) > 0.0 else 0.0 - axis


def _scalar(face: Face) -> float:
    """A number by which faces of one surface are found among many [mm]."""
    if face.kind == "plane":
        return float(np.dot(face.at, _normal(face)))
    return face.minor_radius if face.kind == "torus" else 0.0 if face.kind == "cone" else face.radius


def _same_surface(first: Face, second: Face, *, turned: bool) -> bool:
    """True if two faces lie on one surface.

    Args:
        first, second: both.
        turned: True if the material may lie on the other side.
    """
    if first.kind != second.kind or first.kind == "free form":
        return False
    off = np.subtract(second.at, first.at)
    axis = np.array(first.axis)
    near = SAME_PLACE + first.deviation + second.deviation
    if first.kind == "sphere":
        same = float(np.linalg.norm(off)) < near and abs(first.radius - second.radius) < near
        return same and (turned or first.is_hollow == second.is_hollow)
    steepest = SAME_SLOPE + (first.deviation + second.deviation) / max(math.sqrt(min(first.area, second.area)), near)
    if float(np.linalg.norm(np.cross(axis, second.axis))) > steepest:
        return False
    if first.kind == "plane":
        same = abs(float(off @ axis)) < near
        return same and (turned or float(_normal(first) @ _normal(second)) > 0.0)
    across = float(np.linalg.norm(off - off @ axis * axis))
    if across > near or (not turned and first.is_hollow != second.is_hollow):
        return False
    if first.kind == "cylinder":
        return abs(first.radius - second.radius) < near
    if first.kind == "torus":
        sizes = abs(first.radius - second.radius), abs(first.minor_radius - second.minor_radius), abs(float(off @ axis))
        return max(sizes) < near
    way = 1.0 if float(axis @ np.array(second.axis)) > 0.0 else -1.0
    slope, other = math.tan(first.half_angle), way * math.tan(second.half_angle)
    if abs(slope - other) > steepest:
        return False
    return abs(first.radius + slope * float(off @ axis) - second.radius) < near


def _one_circle(edges: Sequence[Edge]) -> bool:
    """True if arcs are of one circle."""
    first = edges[0]
    return all(
        abs(edge.radii[0] - first.radii[0]) < SAME_PLACE
        and float(np.linalg.norm(np.subtract(edge.centre, first.centre))) < SAME_PLACE
        for edge in edges
    )


def _x_of(z: Array, along: Triple | None) -> Array:
    """Across z, as near as may be to a direction; by default to the part's x, or its y."""
    wish = np.array(along) if along is not None else np.eye(3)[0] if abs(z[0]) < ALONG else np.eye(3)[1]
    across = wish - (wish @ z) * z
    return np.asarray(across / np.linalg.norm(across))


def lengths_of(place: Sequence[float] | Array) -> Triple:
    """A place without rounding noise and minus zeros."""
    x, y, z = (round(float(own), DECIMALS) + 0.0 for own in place)
    return x, y, z


def cosines_of(direction: Sequence[float] | Array) -> Triple:
    """A direction without rounding noise and minus zeros."""
    x, y, z = (round(float(own), COSINE_DECIMALS) + 0.0 for own in direction)
    return x, y, z
