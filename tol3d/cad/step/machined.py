"""Features that several surfaces of a part make: counterbored and countersunk holes, slots, tabs, patterns of holes.

Found by the numbers of the surfaces alone, so a part of any program has them. Threads are none: files have cylinders.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Final, Literal

import numpy as np

from tol3d.cad.step.found_features import FoundFeature
from tol3d.cad.step.hole_layout import Layout, layouts
from tol3d.numerics.arrays import Array

SAME: Final = 1e-3  # mm; what models are drawn to
SQUARE: Final = 1e-6  # cosine
HALF_TURN: Final = 0.02  # rad; how far an end of a slot may turn from half round
LEAST_SINK: Final = 1.3  # times the hole; a cone that widens less is a chamfer of its edge
THINNEST: Final = 0.5  # of a slot's width; a thinner pin in it is not located by it
MOST_HOLES: Final = 2000  # of a part, beyond which they are not compared with each other
MOST_PLANES: Final = 400  # the same of flat faces


@dataclass(frozen=True)
class Stepped:
    """A hole whose mouth is wider: a counterbore, of which a cylinder ends in a flat face, or a countersink, a cone.

    Args:
        kind: "counterbore" or "countersink".
        hole: the narrow cylinder.
        mouth: the wide cylinder or the cone.
        out: direction in which it opens (3,).
    """

    kind: Literal["counterbore", "countersink"]
    hole: FoundFeature
    mouth: FoundFeature
    out: Array

    @property
    def diameter(self) -> float:
        """Diameter of the mouth where it opens [mm]."""
        return 2.0 * self.mouth.radius

    @property
    def depth(self) -> float:
        """Depth of the mouth [mm]."""
        return self.mouth.length

    @property
    def angle(self) -> float:
        """Whole angle of a countersink [rad]; 0 of a counterbore."""
        return 2.0 * self.mouth.half_angle

    @property
    def members(self) -> tuple[FoundFeature, ...]:
        """Its surfaces."""
        return self.hole, self.mouth

    @property
    def words(self) -> str:
        """The feature with its numbers [mm]."""
        depth = f"{math.degrees(self.angle):.6g}°" if self.angle else f"{self.depth:.6g}"
        return f"{self.kind} ⌀{self.diameter:.6g} × {depth} of a hole ⌀{2 * self.hole.radius:.6g}"


@dataclass(frozen=True)
class Slot:
    """Walls that face each other: between two half rounds, from one to an open end, or on a flat end or bottom.

    Args:
        walls: both, the material behind each.
        ends: two half rounds, or one; or the flat face from which the walls rise.
        middle: between the axes of both rounds, else between its end and the nearer end of a wall (3,) [mm].
        axis: through its depth (3,).
        along: its length (3,).
        width: distance of its walls [mm].
        length: over its ends; of an open slot from its end to the nearer end of a wall [mm].
        depth: along its axis [mm].
    """

    walls: tuple[FoundFeature, FoundFeature]
    ends: tuple[FoundFeature, ...]
    middle: Array
    axis: Array
    along: Array
    width: float
    length: float
    depth: float

    @property
    def members(self) -> tuple[FoundFeature, ...]:
        """Its surfaces."""
        return *self.walls, *self.ends

    @property
    def words(self) -> str:
        """The feature with its numbers [mm]."""
        bottom = self.ends[0].kind == "plane" and abs(float(np.dot(self.ends[0].direction, self.along))) < SQUARE
        of = ", open at one end" if len(self.ends) == 1 and not bottom else ""
        word = "groove" if bottom else "slot"
        return f"{word} {self.width:.6g} wide, {self.length:.6g} long, {self.depth:.6g} deep{of}"

    def holds(self, at: Array, direction: Array, radius: float, length: float) -> bool:
        """True if a pin stands in it, in the frame of its part: on its middle plane, between its ends."""
        rounds = sum(own.kind == "fillet" for own in self.ends)
        free, off = self.length - rounds * self.width / 2, at - self.middle
        return (
            THINNEST * self.width < 2 * radius < self.width + SAME
            and abs(float(direction @ self.axis)) > 1.0 - SQUARE
            and abs(float(off @ np.cross(self.axis, self.along))) < SAME
            and abs(float(off @ self.along)) < free / 2 + SAME
            and abs(float(off @ self.axis)) < (length + self.depth) / 2 - SAME
        )


@dataclass(frozen=True)
class Tab:
    """A tab: two opposite walls that face away from each other and rise from one flat face.

    Args:
        walls: both.
        base: the face from which they rise.
        width: distance of the walls [mm].
        length: of a wall along the base [mm].
        height: of the walls over the base [mm].
    """

    walls: tuple[FoundFeature, FoundFeature]
    base: FoundFeature
    width: float
    length: float
    height: float

    @property
    def members(self) -> tuple[FoundFeature, ...]:
        """Its surfaces."""
        return self.walls

    @property
    def words(self) -> str:
        """The feature with its numbers [mm]."""
        return f"tab {self.width:.6g} wide, {self.length:.6g} long, {self.height:.6g} high"

    def plays_between(self, gap: float, other: float) -> bool:
        """True if it is midway between walls at these distances from its own [mm] that locate it with play."""
        return abs(gap - other) < SAME < gap and self.width > THINNEST * (self.width + gap + other)


@dataclass(frozen=True)
class HolePattern:
    """Equal holes in a row, a grid or on a circle.

    Args:
        holes: in the order of the row, of the grid's rows, or around the circle.
        layout: their places.
        at: the middle of their places, in the frame of the part (3,) [mm].
        axis: of the holes (3,).
    """

    holes: tuple[FoundFeature, ...]
    layout: Layout
    at: Array
    axis: Array

    @property
    def members(self) -> tuple[FoundFeature, ...]:
        """Its holes."""
        return self.holes

    @property
    def words(self) -> str:
        """The pattern with its numbers [mm]."""
        apart = " and ".join(f"{own:.6g}" for own in self.layout.pitches)
        angles = "equal" if self.layout.equal else "unequal"
        where = {
            "row": f"in a row, {apart} apart",
            "grid": f"in a grid of {' × '.join(map(str, self.layout.counts))}, {apart} apart",
            "circle": f"on a circle ⌀{self.layout.diameter:.6g}, at {angles} angles",
        }[self.layout.kind]
        return f"{len(self.holes)} holes ⌀{2 * self.holes[0].radius:.6g} {where}"


MadeOfSeveral = Stepped | Slot | Tab | HolePattern


@dataclass(frozen=True)
class Machined:
    """The features of a part that several surfaces make.

    Args:
        features: of its surfaces.
        along: lowest and highest coordinate of a feature's faces along a direction (3,) [mm].
    """

    features: Sequence[FoundFeature]
    along: Callable[[FoundFeature, Array], tuple[float, float]]

    @cached_property
    def _reaches(self) -> dict[tuple[tuple[int, ...], bytes], tuple[float, float]]:
        return {}

    def _reach(self, own: FoundFeature, along: Array) -> tuple[float, float]:
        """Lowest and highest coordinate of a feature, asked once: many faces have few directions."""
        key = own.faces, (np.round(along, 12) + 0.0).tobytes()
        if key not in self._reaches:
            self._reaches[key] = self.along(own, along)
        return self._reaches[key]

    def _of(self, *kinds: str) -> list[FoundFeature]:
        return [own for own in self.features if own.kind in kinds and not own.loose]

    @cached_property
    def stepped(self) -> tuple[Stepped, ...]:
        """Counterbored and countersunk holes; a wide part between two narrow ones is a groove, and none."""
        holes, found = self._of("hole"), list[Stepped]()
        if len(holes) > MOST_HOLES:
            return ()
        for mouth in (*holes, *(cone for cone in self._of("cone") if cone.outside)):
            ends = [own for own in (_stepped(hole, mouth) for hole in _coaxial(holes, mouth)) if own is not None]
            found += ends if len(ends) == 1 else ()
        return tuple(found)

    @cached_property
    def slots(self) -> tuple[Slot, ...]:
        """Slots, each by its walls and one or two ends; those with a flat one are longer than wide."""
        planes, rounds = self._of("plane"), self._rounds
        if len(planes) > MOST_PLANES:
            return ()
        closed = list(_slots(rounds, planes))
        ended = {own.faces for slot in closed for own in slot.ends}
        half_open = [slot for own in rounds if own.faces not in ended for slot in self._opening(own, planes)]
        return *closed, *half_open, *self._grooves(planes)

    def _opening(self, end: FoundFeature, planes: Sequence[FoundFeature]) -> Iterator[Slot]:
        """The slot from a half round to where its two walls end; none if they end unlike."""
        centre, axis = np.array(end.at), np.array(end.direction)
        normals, places = _normals(planes), np.array([own.at for own in planes]).reshape(-1, 3)
        tangent = np.abs(np.einsum("ij,ij->i", centre - places, normals) - end.radius) < SAME
        walls = [planes[k] for k in np.flatnonzero(tangent & (np.abs(normals @ axis) < SQUARE)).tolist()]
        for first, second in combinations(walls, 2):
            along = np.cross(axis, first.direction)
            start = float(centre @ along)
            reaches = [self._reach(own, along) for own in (first, second)]
            lengths = [own - start for own in np.transpose(reaches).ravel().tolist()]  # both lows, both highs
            if not _opposed(first, second) or not _overlapping(first, end, self._reach, axis):
                continue
            for sign, near, far in ((1.0, lengths[:2], lengths[2:]), (-1.0, lengths[2:], lengths[:2])):
                free, longest = (pick(sign * own for own in far) for pick in (min, max))
                if max(map(abs, near)) < SAME < free and not self._closed(planes, first, end, sign * along, longest):
                    middle, sizes = centre + sign * free / 2 * along, (2 * end.radius, free + end.radius, end.length)
                    yield Slot((first, second), (end,), middle, axis, along, *sizes)

    def _closed(
        self, planes: Sequence[FoundFeature], wall: FoundFeature, end: FoundFeature, out: Array, length: float
    ) -> bool:
        """True if a flat face looks at an end of a slot, or a half round stands there, before its walls end."""
        foot, sides = float(np.dot(end.at, out)), (np.array(wall.direction), np.cross(out, wall.direction))
        looking = [planes[k] for k in np.flatnonzero(_normals(planes) @ out < -1.0 + SQUARE).tolist()]
        return any(
            SAME < float(np.dot(own.at, out)) - foot < length + SAME
            and all(_overlapping(own, end, self._reach, across) for across in sides)
            for own in (*looking, *self._rounds)
        )

    @cached_property
    def _rounds(self) -> list[FoundFeature]:
        """Hollow half rounds, such as ends of slots."""
        return [own for own in self._of("fillet") if abs(own.turn - np.pi) < HALF_TURN]

    def _grooves(self, planes: Sequence[FoundFeature]) -> Iterator[Slot]:
        """Slots and grooves whose walls rise from a flat face between them, each pair of walls once."""
        known: set[tuple[tuple[int, ...], ...]] = set()
        normals = _normals(planes)
        for floor in sorted(planes, key=lambda own: -own.area):
            up, foot = np.array(floor.direction), float(np.dot(floor.at, floor.direction))
            walls = []
            for k in np.flatnonzero(np.abs(normals @ up) < SQUARE).tolist():
                low, high = self._reach(planes[k], up)
                edge = self._reach(floor, normals[k])[0]
                if abs(low - foot) < SAME < high - low and abs(float(np.dot(planes[k].at, normals[k])) - edge) < SAME:
                    walls.append((planes[k], high - low))
            pairs = [(a, b) for a, b in combinations(walls, 2) if _opposed(a[0], b[0])]
            if len(pairs) != 1:  # two make a pocket
                continue
            (first, height), (second, other) = pairs[0]
            width = float(np.subtract(second.at, first.at) @ np.array(first.direction))
            axis, high = np.cross(up, first.direction), min(height, other)
            middle, (low, end) = np.array(floor.at) + high / 2 * up, self._reach(floor, axis)
            across, along = sorted(((end - low, axis), (high, up)), key=lambda own: own[0])
            pair = first.faces, second.faces
            if (
                pair not in known
                and along[0] > width > SAME
                and not self._closed(planes, first, floor, up, max(height, other))
            ):
                known.add(pair)
                yield Slot((first, second), (floor,), middle, across[1], along[1], width, along[0], across[0])

    @cached_property
    def tabs(self) -> tuple[Tab, ...]:
        """Tabs; of two pairs of walls around one boss the narrower."""
        planes, found = self._of("plane"), list[Tab]()
        if len(planes) > MOST_PLANES:
            return ()
        for base in planes:
            own = sorted(self._rising(planes, base), key=lambda tab: (tab.width, tab.length))
            for tab in own:
                if not any(np.linalg.norm(_middle(tab) - _middle(known)) < SAME for known in found):
                    found.append(tab)
        return tuple(found)

    def _rising(self, planes: Sequence[FoundFeature], base: FoundFeature) -> Iterator[Tab]:
        """Pairs of walls that rise from a flat face, which goes on beyond both."""
        up, walls = np.array(base.direction), list[tuple[FoundFeature, float]]()
        foot, normals = float(np.dot(base.at, up)), np.array([own.direction for own in planes])
        for k in np.flatnonzero(np.abs(normals @ up) < SQUARE).tolist():
            wall, normal = planes[k], normals[k]
            low, high = self._reach(wall, up)
            if abs(low - foot) > SAME or high - low < SAME:
                continue
            if float(np.dot(wall.at, normal)) < self._reach(base, normal)[1] - SAME:
                walls.append((wall, high - low))
        for (first, height), (second, other) in combinations(walls, 2):
            normal, between = np.array(first.direction), np.subtract(second.at, first.at)
            width = -float(between @ normal)
            if (
                _opposed(first, second)
                and width > SAME
                and np.linalg.norm(between + width * normal) < SAME > abs(height - other)
            ):
                low, high = self._reach(first, np.cross(up, normal))
                yield Tab((first, second), base, width, high - low, height)

    @cached_property
    def patterns(self) -> tuple[HolePattern, ...]:
        """Patterns of holes that are equal in diameter, length, height and mouth; mouths of counterbores are none."""
        mouths = {own.mouth.faces for own in self.stepped}
        words = {own.hole.faces: (own.kind, own.diameter, own.depth) for own in self.stepped}
        groups: list[list[FoundFeature]] = []
        holes = [own for own in self._of("hole") if own.faces not in mouths]
        for hole in holes if len(holes) <= MOST_HOLES else ():
            group = next((own for own in groups if _alike(own[0], hole, words)), None)
            if group is None:
                groups.append([hole])
            else:
                group.append(hole)
        return tuple(pattern for group in groups if len(group) > 2 for pattern in self._laid_out(group))

    def _laid_out(self, holes: Sequence[FoundFeature]) -> Iterator[HolePattern]:
        """The patterns that equal holes make."""
        axis, x = np.array(holes[0].direction), np.array(holes[0].x)
        y = np.cross(axis, x)
        places = np.array([[np.dot(own.at, x), np.dot(own.at, y)] for own in holes])
        height = float(np.dot(holes[0].at, axis))
        round_ones = [own for own in self._of("hole", "pin", "cone") if _parallel(own, holes[0]) and own not in holes]
        middles = np.array([[np.dot(own.at, x), np.dot(own.at, y)] for own in round_ones]).reshape(-1, 2)
        for order, layout in layouts(places, middles, SAME):
            a, b = layout.middle
            yield HolePattern(tuple(holes[k] for k in order), layout, a * x + b * y + height * axis, axis)

    @cached_property
    def all(self) -> tuple[MadeOfSeveral, ...]:
        """All of them."""
        return *self.stepped, *self.slots, *self.tabs, *self.patterns


def _parallel(first: FoundFeature, second: FoundFeature) -> bool:
    return float(np.linalg.norm(np.cross(first.direction, second.direction))) < SQUARE


def _alike(
    first: FoundFeature, second: FoundFeature, mouths: Mapping[tuple[int, ...], tuple[str, float, float]]
) -> bool:
    """True if two holes are equal, parallel and at one height."""
    kind, *sizes = mouths.get(first.faces, ("", 0.0, 0.0))
    other, *others = mouths.get(second.faces, ("", 0.0, 0.0))
    height = abs(float(np.subtract(second.at, first.at) @ np.array(first.direction)))
    sizes, others = [first.radius, first.length, *sizes], [second.radius, second.length, *others]
    equal = all(abs(a - b) < SAME for a, b in zip(sizes, others, strict=True))
    return kind == other and equal and height < SAME and _parallel(first, second)


def _coaxial(holes: Sequence[FoundFeature], mouth: FoundFeature) -> Iterator[FoundFeature]:
    """Other holes on the axis of one, or of a cone."""
    at, axis = np.array(mouth.at), np.array(mouth.direction)
    off = np.array([own.at for own in holes]).reshape(-1, 3) - at
    aside = np.linalg.norm(np.cross(off, axis), axis=1) < SAME
    for k in np.flatnonzero(aside).tolist():
        if holes[k] is not mouth and _parallel(holes[k], mouth):
            yield holes[k]


def _stepped(hole: FoundFeature, mouth: FoundFeature) -> Stepped | None:
    """A coaxial hole with a wider mouth, if both meet and the mouth opens away from the hole."""
    axis = np.array(hole.direction)
    off = float(np.subtract(mouth.at, hole.at) @ axis)
    if abs(abs(off) - (hole.length + mouth.length) / 2) > SAME:
        return None
    out = axis if off > 0.0 else -axis
    if mouth.kind == "hole":
        return Stepped("counterbore", hole, mouth, out) if mouth.radius > hole.radius + SAME else None
    start, end = mouth.radii if float(out @ np.array(mouth.direction)) > 0.0 else reversed(mouth.radii)
    if abs(start - hole.radius) > SAME or end < LEAST_SINK * hole.radius:
        return None
    return Stepped("countersink", hole, mouth, out)


def _normals(planes: Sequence[FoundFeature]) -> Array:
    """Normals of flat faces (n, 3)."""
    return np.array([own.direction for own in planes]).reshape(-1, 3)


def _opposed(first: FoundFeature, second: FoundFeature) -> bool:
    """True if two flat faces have opposite normals."""
    return float(np.dot(first.direction, second.direction)) < -1.0 + SQUARE


def _overlapping(
    first: FoundFeature, second: FoundFeature, reach: Callable[[FoundFeature, Array], tuple[float, float]], along: Array
) -> bool:
    """True if two features share some of a direction."""
    (low, high), (start, end) = reach(first, along), reach(second, along)
    return min(high, end) - max(low, start) > SAME


def _slots(rounds: Sequence[FoundFeature], planes: Sequence[FoundFeature]) -> Iterator[Slot]:
    """Slots between two half rounds."""
    for first, second in combinations(rounds, 2):
        axis = np.array(first.direction)
        between = np.subtract(second.at, first.at)
        size = float(np.linalg.norm(between))
        parallel = abs(float(axis @ np.array(second.direction))) > 1.0 - SQUARE
        if not parallel or abs(first.radius - second.radius) > SAME or size < SAME or abs(between @ axis) > SAME:
            continue
        along, width = between / size, 2 * first.radius
        across, middle = np.cross(axis, along), (np.array(first.at) + np.array(second.at)) / 2
        sides = [_wall(planes, middle + sign * first.radius * across, -sign * across) for sign in (-1.0, 1.0)]
        if sides[0] is not None and sides[1] is not None:
            ends, sizes = (first, second), (width, size + width, first.length)
            yield Slot((sides[0], sides[1]), ends, middle, axis, along, *sizes)


def _wall(planes: Sequence[FoundFeature], at: Array, normal: Array) -> FoundFeature | None:
    """The flat face in whose middle a point lies, with this normal; None if there is none."""
    for own in planes:
        faces = float(np.array(own.direction) @ normal) > 1.0 - SQUARE
        if faces and float(np.linalg.norm(np.subtract(own.at, at))) < SAME:
            return own
    return None


def _middle(tab: Tab) -> Array:
    return np.asarray((np.array(tab.walls[0].at) + np.array(tab.walls[1].at)) / 2)
