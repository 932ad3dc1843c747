"""Moves of several parts from the faces that touch as they stand."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

import numpy as np

from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.in_slots import InSlot, in_slots
from tol3d.apps.drafting.parts import DraftedPart
from tol3d.apps.drafting.words import Names, comment, number, scalar
from tol3d.assembly import Cone, cone_seat, unfit_cones
from tol3d.cad.step import FoundFeature, Tab
from tol3d.numerics.arrays import Array

TOUCHING: Final = 1e-3  # mm; what models are drawn to
PARALLEL: Final = 1e-6  # sine, cosine
LARGEST_BOLT: Final = 3.0  # diameters of the smallest hole beside it
THINNEST_BOLT: Final = 0.5  # of the wider hole; one that is wider still clears a bolt's head and locates nothing
ALONE: Final = "no contact with another part"
FIRST: Final = "no contact with a part placed before"
BOLT_LESS: Final = 0.1  # of the hole, where no position says how much


@dataclass(frozen=True)
class Faces:
    """Two faces that look at each other.

    Args:
        part, other: their parts.
        face, there: of `part` and of `other`.
        gap: their distance [mm].
        area: on which they overlap [mm²].
    """

    part: DraftedPart
    other: DraftedPart
    face: FoundFeature
    there: FoundFeature
    gap: float
    area: float


@dataclass(frozen=True)
class Coaxial:
    """A pin in a hole, two holes in line, or a cone in a conical hole."""

    part: DraftedPart
    other: DraftedPart
    own: FoundFeature
    there: FoundFeature

    @property
    def holes(self) -> bool:
        """True if both are holes: a bolt goes through them."""
        return self.own.hollow and self.there.hollow

    @property
    def axis(self) -> Array:
        """Axis in the world (3,)."""
        return self.other.along(self.there.direction)


@dataclass(frozen=True)
class Pinned:
    """A pin of one part in a hole or slot of another, or a tab in a slot.

    Args:
        ends: the pin or a wall of the tab, then the hole or a wall of the slot, each with its part.
        words: both with their sizes.
    """

    ends: tuple[tuple[DraftedPart, FoundFeature], tuple[DraftedPart, FoundFeature]]
    words: str


def facing(part: DraftedPart, other: DraftedPart) -> list[Faces]:
    """Faces of two parts that look at each other and overlap, the nearest first, then the largest."""
    found = []
    (own_planes, normals, places), (planes, other_normals, other_places) = flat(part), flat(other)
    opposed = normals @ other_normals.T <= -1.0 + PARALLEL
    gaps = places @ other_normals.T - np.einsum("ij,ij->i", other_places, other_normals)
    for k, j in zip(*np.nonzero(opposed & (gaps >= -TOUCHING)), strict=True):
        own, there = own_planes[k], planes[j]
        area = overlap(corners(part, own), corners(other, there), other.along(there.x), other_normals[j])
        if area > 0.0:
            found.append(Faces(part, other, own, there, float(gaps[k, j]), area))
    return sorted(found, key=lambda each: (round(each.gap, 3), -each.area))


def flat(part: DraftedPart) -> tuple[list[FoundFeature], Array, Array]:
    """The flat faces of a part, their normals and middles in the world (n, 3)."""
    found = [own for own in part.features.part.features if own.kind == "plane" and not own.loose]
    normals = np.array([own.direction for own in found]).reshape(-1, 3) @ part.pose[:3, :3].T
    return found, normals, np.array([own.at for own in found]).reshape(-1, 3) @ part.pose[:3, :3].T + part.pose[:3, 3]


def corners(part: DraftedPart, plane: FoundFeature) -> Array:
    """Corners of the rectangle around a face, in the world (4, 3) [mm]."""
    x, y = part.along(plane.x), part.along(np.cross(plane.direction, plane.x).tolist())
    half = [own / 2 for own in plane.extent]
    return np.array([part.at(plane) + a * half[0] * x + b * half[1] * y for a in (-1, 1) for b in (-1, 1)])


def overlap(first: Array, second: Array, x: Array, normal: Array) -> float:
    """Area that two faces share, by the boxes around them along x [mm²]."""
    shared = 1.0
    for along in (x, np.cross(normal, x)):
        low = max(float((own @ along).min()) for own in (first, second))
        high = min(float((own @ along).max()) for own in (first, second))
        shared *= max(0.0, high - low - TOUCHING)
    return shared


def coaxial(part: DraftedPart, other: DraftedPart) -> list[Coaxial]:
    """Pins in holes, and holes in line, of two parts, the longest first."""
    kinds = ("hole", "pin")
    round_ones = [[own for own in each.features.part.features if own.kind in kinds and not own.loose]
                  for each in (part, other)]  # fmt: skip
    found = []
    for own in round_ones[0]:
        for there in round_ones[1]:
            axis = other.along(there.direction)
            off = part.at(own) - other.at(there)
            aside = float(np.linalg.norm(np.cross(off, axis)))
            turned = float(np.linalg.norm(np.cross(part.along(own.direction), axis)))
            apart = abs(float(off @ axis)) - (own.length + there.length) / 2
            if aside > TOUCHING or turned > PARALLEL or own.kind == there.kind == "pin":
                continue
            if own.hollow and there.hollow:
                fits = apart < TOUCHING + min(own.radius, there.radius)
            else:
                pin, hole = (there, own) if own.hollow else (own, there)
                fits = apart < -TOUCHING and pin.radius <= hole.radius + TOUCHING
            if fits:
                found.append(Coaxial(part, other, own, there))
    unique: list[Coaxial] = []
    for each in sorted(found, key=lambda own: (own.own.at, abs(own.own.radius - own.there.radius))):
        if not any(same_line(each, known) for known in unique):
            unique.append(each)
    return unique


def seats(part: DraftedPart, other: DraftedPart) -> list[Coaxial]:
    """Cones that lie in conical holes as both parts stand, the longest first."""
    cones = [[own for own in each.features.part.features if own.kind == "cone" and not own.loose]
             for each in (part, other)]  # fmt: skip
    found = []
    for own in cones[0]:
        for there in cones[1]:
            axis, off = other.along(there.direction), part.at(own) - other.at(there)
            turned = float(np.linalg.norm(np.cross(part.along(own.direction), axis)))
            if turned > PARALLEL or float(np.linalg.norm(np.cross(off, axis))) > TOUCHING:
                continue
            sign = float(np.sign(part.along(own.direction) @ axis))
            moving, target = cone_of(own), cone_of(there)
            seat = None if unfit_cones(moving, target, sign) else cone_seat(moving, target, sign)
            if seat is not None and abs(float(off @ axis) - seat.height) < TOUCHING:
                found.append(Coaxial(part, other, own, there))
    return sorted(found, key=lambda each: -min(each.own.length, each.there.length))


def cone_of(found_feature: FoundFeature) -> Cone:
    """A cone as the model has it."""
    return Cone(
        found_feature.length,
        inner=found_feature.outside,
        diameters=(2 * found_feature.radii[0], 2 * found_feature.radii[1]),
    )


def same_line(first: Coaxial, second: Coaxial) -> bool:
    """True if two pairs lie on one axis."""
    off = first.other.at(first.there) - second.other.at(second.there)
    return float(np.linalg.norm(np.cross(off, second.axis))) < TOUCHING and (
        float(np.linalg.norm(np.cross(first.axis, second.axis))) < PARALLEL
    )


@dataclass(frozen=True)
class Contacts:
    """Faces of parts that touch or look at each other in their poses, each pair of parts compared once.

    Args:
        parts: all of a scene.
    """

    parts: Sequence[DraftedPart]
    _known: dict[tuple[str, str, str], list[Any]] = field(default_factory=dict)

    def facing(self, part: DraftedPart, other: DraftedPart) -> list[Faces]:
        """See `facing`."""
        return self._once("facing", facing, part, other)

    def coaxial(self, part: DraftedPart, other: DraftedPart) -> list[Coaxial]:
        """See `coaxial`."""
        return self._once("coaxial", coaxial, part, other)

    def seats(self, part: DraftedPart, other: DraftedPart) -> list[Coaxial]:
        """See `seats`."""
        return self._once("seats", seats, part, other)

    def _once(
        self, word: str, find: Callable[[DraftedPart, DraftedPart], list[Any]], part: DraftedPart, other: DraftedPart
    ) -> list[Any]:
        key = word, part.name, other.name
        if key not in self._known:
            self._known[key] = find(part, other)
        return self._known[key]

    def slotted(self, part: DraftedPart, other: DraftedPart) -> list[InSlot]:
        """See `in_slots`."""
        faces = [(own.face, own.there, own.gap) for own in self.facing(part, other)]
        return self._once("slotted", lambda part, other: in_slots(part, other, faces), part, other)

    @property
    def pins(self) -> Iterator[Pinned]:
        """Pins in holes, pins and tabs in slots of all pairs of parts."""
        for k, part in enumerate(self.parts):
            for other in self.parts[:k]:
                for own in self.coaxial(part, other):
                    ends = (own.part, own.own), (own.other, own.there)
                    pin, hole = reversed(ends) if own.own.hollow else ends
                    if not own.holes:
                        yield Pinned((pin, hole), f"{sized(*pin)} in {sized(*hole)}")
                for slotted in self.slotted(part, other):
                    held = slotted.members[0]
                    tab = f"tab {number(slotted.width - slotted.play)} wide of {comment(slotted.holder.name)}"
                    words = tab if isinstance(slotted.own, Tab) else sized(slotted.holder, held)
                    words += f" in a slot {number(slotted.width)} wide of "
                    ends = (slotted.holder, held), (slotted.slotted, slotted.walls[0])
                    yield Pinned(ends, words + comment(slotted.slotted.name))

    def touch(self, part: DraftedPart, other: DraftedPart) -> bool:
        """True if faces of two parts touch in their poses."""
        meets = any(own.gap < TOUCHING for own in self.facing(part, other))
        return meets or bool(self.coaxial(part, other)) or bool(self.seats(part, other))

    @cached_property
    def neighbours(self) -> Mapping[str, int]:
        """Number of parts that each one touches."""
        counts = dict.fromkeys((part.name for part in self.parts), 0)
        for k, part in enumerate(self.parts):
            for other in self.parts[:k]:
                if self.touch(part, other):
                    counts[part.name] += 1
                    counts[other.name] += 1
        return counts

    @property
    def base(self) -> DraftedPart:
        """The part that holds the others: the largest with most contacts, the first of those that are alike."""
        return max(self.parts, key=lambda part: (1 + self.neighbours[part.name]) * size_of(part))

    def bolts(self, own: Coaxial) -> list[FoundFeature]:
        """Pins of third parts that stand in both holes of a pair."""
        found = []
        for part in self.parts:
            if part.name in (own.part.name, own.other.name):
                continue
            ends = self.coaxial(part, own.part), self.coaxial(part, own.other)
            pins = [{each.own.faces: each.own for each in end if same_line(each, own)} for end in ends]
            found += [pin for faces, pin in pins[0].items() if faces in pins[1] and not pin.hollow]
        return found


def sized(part: DraftedPart, own: FoundFeature) -> str:
    """A round feature with its part, in words."""
    named = part.features.named(own)
    return f"{comment(f'{part.name}.{named[1]}' if named else f'{own.kind} of {part.name}')} ⌀{number(2 * own.radius)}"


def size_of(part: DraftedPart) -> float:
    """Area of all faces of a part [mm²]."""
    return round(sum(own.area for own in part.features.part.features if not own.loose), 3)


def moves(contacts: Contacts, names: Names) -> Iterator[Entry]:
    """The base fixed, each other part laid on those that it touches, the largest first; fixed if it touches none."""
    base = contacts.base
    yield Entry("moves", scalar(names.new(f"{base.name} fixed", "fixed")), [fixed(base)])
    placed = [base]
    waiting = sorted((part for part in contacts.parts if part is not base), key=lambda part: -size_of(part))
    while waiting:
        own = next((each for each in waiting if any(contacts.touch(each, other) for other in placed)), waiting[0])
        waiting.remove(own)
        others = [each for each in placed if contacts.touch(own, each)]
        yield from move(own, others, contacts, names)
        placed.append(own)


def fixed(part: DraftedPart) -> Wording:
    """A part fixed in its pose."""
    return Wording((f"{{kind: fix, part: {scalar(part.name)}}}",), "guess")


def move(part: DraftedPart, others: Sequence[DraftedPart], contacts: Contacts, names: Names) -> Iterator[Entry]:
    """The move of one part, by the faces and holes that touch."""
    relations: list[str] = []
    normals: list[Array] = []
    axes = [own for other in others for own in contacts.coaxial(part, other)]
    for seat in [own for other in others for own in contacts.seats(part, other)][:1]:
        normals.append(seat.axis)  # a face across it takes nothing, nor does what lies on its line
        axes = [axis for axis in axes if not same_line(axis, seat)]
        relations.append(
            f"  - {{kind: coincident, from: {feature(part, seat.own)}, to: {feature(seat.other, seat.there)}}}"
        )
    touching = [own for other in others for own in contacts.facing(part, other) if own.gap < TOUCHING]
    seated_on = None
    for contact in sorted(touching, key=lambda each: -each.area):
        normal = contact.other.along(contact.there.direction)
        if any(abs(float(normal @ known)) > 0.9 for known in normals):
            continue
        if normals and axes:
            break  # pins and bolts hold the rest
        seated_on = seated_on or contact.other.name
        normals.append(normal)
        moving, target = feature(part, contact.face), feature(contact.other, contact.there)
        relations.append(f"  - {{kind: coincident, from: {moving}, to: {target}}}")
    # of what lies on one line a pin in a hole holds, of several in that of the part with the seat
    ranked = sorted(axes, key=lambda axis: (axis.holes, axis.other.name != seated_on))
    lines: list[Coaxial] = []
    for axis in ranked:
        if not any(same_line(axis, known) for known in lines):
            lines.append(axis)
    square = [axis for axis in lines if not normals or abs(float(axis.axis @ normals[0])) > 1.0 - PARALLEL]
    square = [axis for axis in square if is_bolted(axis, square)] or square
    in_slots = [own for other in others for own in contacts.slotted(part, other)] if relations else []
    name = scalar(names.new(f"{part.name} placed", "placed"))
    if not relations and not square:
        why = FIRST if contacts.neighbours[part.name] else ALONE
        yield Entry("moves", name, [Wording(fixed(part).lines, f"guess: {why}")])
        return
    mated = [
        f"  - {{kind: coaxial, from: {feature(part, own.own)}, to: {feature(own.other, own.there)}}}"
        for own in square[:2]
    ]
    head = ("kind: mate", f"part: {scalar(part.name)}", "relations:")
    ways = []
    pairs = [playing(own, contacts) for own in square] if relations else []
    if relations and all(pairs):
        made = [own for own in pairs if own is not None]
        for pair in square:
            yield from unsized(((pair.part, pair.own), (pair.other, pair.there)), names)
        for slotted in in_slots if all(own.play > TOUCHING for own in in_slots) else ():
            made.append(slotted.pair(part))
            slotted.slotted.features.plays(slotted.walls, slotted.play)
            slotted.holder.features.plays(slotted.members, slotted.play)
            yield from unsized(((slotted.holder, slotted.members[0]), (slotted.slotted, slotted.walls[0])), names)
        words = ("kind: pattern", f"part: {scalar(part.name)}", "float: {kind: random}",
                 "relations:", *relations[:1], "pairs:", *made)  # fmt: skip
        ways += [Wording(words, "guess: faces that touch, with pins and bolts in their play")] if made else []
    both = [*relations, *mated]
    ways += [Wording((*head, *both[:k]), "guess: faces and axes that meet") for k in range(len(both), 0, -1)]
    yield Entry("moves", name, [*ways, fixed(part)])


def is_bolted(own: Coaxial, others: Sequence[Coaxial]) -> bool:
    """False of holes in line that are far larger than others beside them: a bore for a shaft, not for a bolt."""
    smallest = min(min(each.own.radius, each.there.radius) for each in others)
    return not own.holes or min(own.own.radius, own.there.radius) <= LARGEST_BOLT * smallest


def feature(part: DraftedPart, found_feature: FoundFeature) -> str:
    """A feature with its part, selected if it was not."""
    return part.of(part.features.name(found_feature))


def playing(own: Coaxial, contacts: Contacts) -> str | None:
    """A pair of a pattern: a pin in a larger hole, or two holes with a bolt; None where there is no play."""
    words = f"from: {feature(own.part, own.own)}, to: {feature(own.other, own.there)}"
    if not own.holes:
        noted(own, 2 * abs(own.own.radius - own.there.radius))
        return f"  - {{{words}}}" if 2 * abs(own.own.radius - own.there.radius) > TOUCHING else None
    hole, wider = 2 * min(own.own.radius, own.there.radius), 2 * max(own.own.radius, own.there.radius)
    known = contacts.bolts(own)
    if known:
        bolt, why = 2 * max(pin.radius for pin in known), "that of the part in both holes"
    else:
        bolt = min(largest_bolt(part, each) for part, each in ((own.part, own.own), (own.other, own.there)))
        why = "guess: each hole at its smallest less its position"
    if bolt < THINNEST_BOLT * wider or hole - bolt <= TOUCHING:
        return None
    noted(own, hole - bolt)
    size = f"{number(round(bolt, 3))} mm"
    return f"  - {{{words}, bolt: {{diameter: {size}, distribution: {{kind: constant, value: 0 mm}}}}}}  # {why}"


def noted(own: Coaxial, play: float) -> None:
    """Note the play of a pair with both its features."""
    for part, member in ((own.part, own.own), (own.other, own.there)):
        part.features.plays([member], play)


def largest_bolt(part: DraftedPart, hole: FoundFeature) -> float:
    """The bolt that always goes through a hole [mm]: at MMC less its position (ASME Y14.5-2018, B.3)."""
    diameter = 2 * hole.radius
    drawing = part.drawing
    faces = {*hole.faces}
    zones = [
        each.magnitude.value
        for each, meaning in drawing.tolerances
        if each.kind == "position" and meaning.how != "left out" and each.magnitude and faces & {*each.feature.faces}
    ]
    sizes = [
        dimension.limits[0] for dimension in drawing.dimensions
        if dimension.limits and "diameter" in dimension.kind and faces & {*dimension.features[0].faces}
    ]  # fmt: skip
    least = min([diameter, *sizes])
    return least - max(zones) if zones else least * (1.0 - BOLT_LESS)


def unsized(ends: Sequence[tuple[DraftedPart, FoundFeature]], names: Names) -> Iterator[Entry]:
    """Sizes of holes, pins and slots of which the file states none, without deviations: play is by sizes."""
    for part, each in ends:
        known = part.features.named(each)
        slot = next((own for own in part.features.groups if own.slot and own.slot[0].faces == each.faces), None)
        group = slot if known is None or each.kind == "plane" else known[0]
        if group is None or group.name in part.drawing.sizes:
            continue
        line = f"{{kind: size, of: {part.first_of(group.name)}, distribution: {{kind: constant, value: 0 mm}}}}"
        name = scalar(names.new(f"{group.name} size", "size", len(group.members)))
        entry = Entry("tolerances", name, [Wording((line,), "guess: the file states no limits")])
        part.drawing.sizes[group.name] = entry
        yield entry
