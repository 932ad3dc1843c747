"""Moves of several parts from the faces that touch as they stand, and measures between them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.parts import DraftedPart
from tol3d.apps.drafting.words import Names, across, direction, length, number, scalar
from tol3d.assembly import Cone, cone_seat, unfit_cones
from tol3d.cad.step import FoundFeature
from tol3d.numerics.arrays import Array

TOUCHING: Final = 1e-3  # mm; what models are drawn to
PARALLEL: Final = 1e-6  # sine, cosine
MOST_GAPS: Final = 4  # of two parts
MOST_OFFSETS: Final = 4  # pairs of coaxial holes of two parts
THINNEST_BOLT: Final = 0.5  # of the hole; a thinner guess is none
ALONE: Final = "it touches no other part as it stands"
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


def facing(part: DraftedPart, other: DraftedPart) -> list[Faces]:
    """Faces of two parts that look at each other and overlap, the nearest first, then the largest."""
    found = []
    planes = [[own for own in each.features.part.features if own.kind == "plane" and not own.loose]
              for each in (part, other)]  # fmt: skip
    for there in planes[1]:
        normal, at = other.along(there.direction), other.at(there)
        for own in planes[0]:
            if float(part.along(own.direction) @ normal) > -1.0 + PARALLEL:
                continue
            gap = float((part.at(own) - at) @ normal)
            if gap < -TOUCHING:
                continue
            area = overlap(corners(part, own), corners(other, there), other.along(there.x), normal)
            if area > 0.0:
                found.append(Faces(part, other, own, there, gap, area))
    return sorted(found, key=lambda each: (round(each.gap, 3), -each.area))


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


def moves(parts: Sequence[DraftedPart], names: Names) -> Iterator[Entry]:
    """The first part fixed, each other one laid on the parts that it touches, or fixed if it touches none."""
    first = parts[0]
    yield Entry("moves", scalar(names.new(f"{first.name} fixed", "fixed")), [fixed(first)])
    placed, waiting = [first], list(parts[1:])
    while waiting:
        own = next((each for each in waiting if any(touches(each, other) for other in placed)), waiting[0])
        waiting.remove(own)
        others = [each for each in placed if touches(own, each)]
        yield from move(own, others, names)
        placed.append(own)


def touches(part: DraftedPart, other: DraftedPart) -> bool:
    """True if faces of two parts touch in their poses."""
    meets = any(own.gap < TOUCHING for own in facing(part, other))
    return meets or bool(coaxial(part, other)) or bool(seats(part, other))


def fixed(part: DraftedPart) -> Wording:
    """A part fixed in its pose."""
    return Wording((f"{{kind: fix, part: {scalar(part.name)}}}",), "guess")


def move(part: DraftedPart, others: Sequence[DraftedPart], names: Names) -> Iterator[Entry]:
    """The move of one part, by the faces and holes that touch."""
    relations: list[str] = []
    normals: list[Array] = []
    axes = [own for other in others for own in coaxial(part, other)]
    for seat in [own for other in others for own in seats(part, other)][:1]:
        normals.append(seat.axis)  # a face across it takes nothing, nor does what lies on its line
        axes = [axis for axis in axes if not same_line(axis, seat)]
        relations.append(
            f"  - {{kind: coincident, from: {feature(part, seat.own)}, to: {feature(seat.other, seat.there)}}}"
        )
    contacts = [own for other in others for own in facing(part, other) if own.gap < TOUCHING]
    for contact in sorted(contacts, key=lambda each: -each.area):
        normal = contact.other.along(contact.there.direction)
        if any(abs(float(normal @ known)) > 0.9 for known in normals):
            continue
        if normals and axes:
            break  # pins and bolts hold the rest
        normals.append(normal)
        moving, target = feature(part, contact.face), feature(contact.other, contact.there)
        relations.append(f"  - {{kind: coincident, from: {moving}, to: {target}}}")
    square = [axis for axis in axes if not normals or abs(float(axis.axis @ normals[0])) > 1.0 - PARALLEL]
    name = scalar(names.new(f"{part.name} placed", "placed"))
    if not relations and not square:
        yield Entry("moves", name, [Wording(fixed(part).lines, f"guess: {ALONE}")])
        return
    mated = [
        f"  - {{kind: coaxial, from: {feature(part, own.own)}, to: {feature(own.other, own.there)}}}"
        for own in square[:2]
    ]
    head = ("kind: mate", f"part: {scalar(part.name)}", "relations:")
    ways = []
    if square and relations and (pairs := [playing(own) for own in square]) and all(pairs):
        made = [own for own in pairs if own is not None]
        for pair in square:
            yield from unsized(pair, names)
        lines = ("kind: pattern", f"part: {scalar(part.name)}", "float: {kind: random}",
                 "relations:", *relations[:1], "pairs:", *made)  # fmt: skip
        ways.append(Wording(lines, "guess: faces that touch, with pins and bolts in their play"))
    both = [*relations, *mated]
    ways += [Wording((*head, *both[:k]), "guess: faces and axes that meet") for k in range(len(both), 0, -1)]
    yield Entry("moves", name, [*ways, fixed(part)])


def feature(part: DraftedPart, found_feature: FoundFeature) -> str:
    """A feature with its part, selected if it was not."""
    return part.of(part.features.name(found_feature))


def playing(own: Coaxial) -> str | None:
    """A pair of a pattern: a pin in a larger hole, or two holes with a bolt; None where there is no play."""
    words = f"from: {feature(own.part, own.own)}, to: {feature(own.other, own.there)}"
    if not own.holes:
        return f"  - {{{words}}}" if abs(own.own.radius - own.there.radius) > TOUCHING else None
    bolt = min(largest_bolt(part, each) for part, each in ((own.part, own.own), (own.other, own.there)))
    if bolt < THINNEST_BOLT * 2 * min(own.own.radius, own.there.radius):
        return None
    size = f"{number(round(bolt, 3))} mm"
    why = "guess: each hole at its smallest less its position"
    return f"  - {{{words}, bolt: {{diameter: {size}, distribution: {{kind: constant, value: 0 mm}}}}}}  # {why}"


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


def unsized(own: Coaxial, names: Names) -> Iterator[Entry]:
    """Sizes of holes and pins of which the file states none, without deviations: play is by sizes."""
    for part, each in ((own.part, own.own), (own.other, own.there)):
        known = part.features.named(each)
        if known is None or known[0].name in part.drawing.sizes:
            continue
        group = known[0]
        line = f"{{kind: size, of: {part.first_of(group.name)}, distribution: {{kind: constant, value: 0 mm}}}}"
        name = scalar(names.new(f"{group.name} size", "size", len(group.members)))
        entry = Entry("tolerances", name, [Wording((line,), "guess: the file states no limits")])
        part.drawing.sizes[group.name] = entry
        yield entry


def between(parts: Sequence[DraftedPart], names: Names) -> Iterator[Entry]:
    """Measures between parts: gaps of the nearest parallel faces, offsets of coaxial holes."""
    for k, part in enumerate(parts):
        for other in parts[:k]:
            yield from gaps(part, other, names)
            for own in coaxial(part, other)[:MOST_OFFSETS]:
                yield from offsets(own, names)


def gaps(part: DraftedPart, other: DraftedPart, names: Names) -> Iterator[Entry]:
    """Gaps between the nearest faces of two parts that do not touch, one of each direction first."""
    apart = [own for own in facing(part, other) if own.gap > TOUCHING]
    taken: list[FoundFeature] = []
    count = 0
    for own in apart:
        if count < MOST_GAPS and own.face not in taken and own.there not in taken:
            taken += [own.face, own.there]
            count += 1
            along = direction(own.there.direction)
            words = (
                f"{{kind: gap, from: {feature(own.other, own.there)}, to: {feature(own.part, own.face)}, "
                f"along: {along}}}"
            )
            name = names.new(f"gap {own.part.name} to {own.other.name} {count}", "gap")
            yield Entry("measures", scalar(name), [Wording((words,), f"guess: nominally {length(own.gap)}")])


def offsets(own: Coaxial, names: Names) -> Iterator[Entry]:
    """Offsets between the axes of a coaxial pair, along two directions across."""
    start, end = feature(own.other, own.there), feature(own.part, own.own)
    for along in across(own.there.direction):
        words = f"{{kind: gap, from: {start}, to: {end}, along: {direction(along)}}}"
        name = names.new(f"offset of {own.part.name} on {own.other.name}", "offset")
        yield Entry("measures", scalar(name), [Wording((words,), "guess")])
