"""A fixture for a single part, from the datums of its drawing: pads on three planes, or a seat with pins."""

from collections import Counter
from collections.abc import Sequence
from typing import Final

import numpy as np

from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.features import Group
from tol3d.apps.drafting.parts import DraftedPart
from tol3d.apps.drafting.words import Names, direction, length, place, scalar
from tol3d.cad.step import FoundFeature
from tol3d.numerics.arrays import Array

PADS: Final = {3: ((-0.4, -0.4), (0.4, -0.4), (0.0, 0.4)), 2: ((-0.4, 0.0), (0.4, 0.0)), 1: ((0.0, 0.0),)}
"""Positions of pads, in extents of their face, by number of pads."""
LEANING: Final = 0.9  # cosine beyond which two normals are too near for pads of their own


def fixture(part: DraftedPart, names: Names) -> list[Entry]:
    """The fixture as a part, and the move that lays the part on it; without datums the part is fixed."""
    frame = datum_system(part)
    name = names.new("fixture", "fixture")
    move = names.new(f"{part.name} in the fixture", "in the fixture")
    held = names.new("fixture set up", "fixture set up")
    if len(frame) == 3 and all(own.kind == "plane" and not own.members[0].radius for own in frame):
        normals = [np.array(own.members[0].direction) for own in frame]
        pairs = ((0, 1), (0, 2), (1, 2))
        if all(abs(float(normals[a] @ normals[b])) < LEANING for a, b in pairs):
            return three_two_one(part, frame, name, move, held)
    made = seat_and_pins(part, frame, name, move, held)
    return made or [Entry("moves", scalar(move), [Wording((f"{{kind: fix, part: {scalar(part.name)}}}",), "guess")])]


def datum_system(part: DraftedPart) -> list[Group]:
    """The features of the datums that most tolerances name, of those that name most datums."""
    drawing = part.drawing
    if drawing is None:
        return []
    groups = {name: group for group in part.features.groups for name in group.names}
    systems: Counter[tuple[str, ...]] = Counter()
    for tolerance, _ in drawing.tolerances:
        letters = tuple(datum.letters for datum in tolerance.datums)
        if letters and all(drawing.datums.get(letter) in groups for letter in letters):  # a pattern is several
            systems[letters] += 1
    if not systems:
        return []
    best = max(systems, key=lambda own: (len(own), systems[own]))
    return [groups[drawing.datums[own]] for own in best]


def three_two_one(part: DraftedPart, frame: Sequence[Group], name: str, move: str, held: str) -> list[Entry]:
    """Six pads on three planes."""
    features, steps = [], []
    for group, count, step in zip(frame, (3, 2, 1), ("primary", "secondary", "tertiary"), strict=True):
        plane = group.members[0]
        steps.append(f"{step}:")
        for k, (x, y) in enumerate(pads(plane, count), 1):
            at = np.array(plane.at) + x * np.array(plane.x) + y * np.cross(plane.direction, plane.x)
            pad = f"{group.name}{k}"
            normal = direction([-own for own in plane.direction])
            features.append(
                f"  {scalar(pad)}: {{kind: point, at: {place(part_at(part, at))}, normal: {normal}}}  # guess"
            )
            steps.append(f"  - {{from: {part.of(group.name)}, to: {scalar(f'{name}.{pad}')}}}")
    body = Entry(
        "parts", scalar(name), [Wording(("kind: solid", "features:", *features), "guess: where its pads touch")]
    )
    lines = ("kind: three_two_one", f"part: {scalar(part.name)}", "points_on: fixture", *steps)
    fixed = Entry("moves", scalar(held), [Wording((f"{{kind: fix, part: {scalar(name)}}}",))])
    still = Wording((f"{{kind: fix, part: {scalar(part.name)}}}",), "guess", "the part is fixed as it stands")
    letters = " | ".join(own.name for own in frame)
    return [body, fixed, Entry("moves", scalar(move), [Wording(lines, f"guess: by its datums {letters}"), still])]


def part_at(part: DraftedPart, at: Sequence[float] | Array) -> Sequence[float]:
    """A point of a part in the world [mm]."""
    return [float(own) for own in part.pose[:3, :3] @ np.asarray(at) + part.pose[:3, 3]]


def pads(plane: FoundFeature, count: int) -> list[tuple[float, float]]:
    """Places of pads on a plane along its x and y [mm]; two lie along its longer side."""
    x, y = plane.extent
    turned = count == 2 and y > x
    return [(b * x, a * y) if turned else (a * x, b * y) for a, b in PADS[count]]


def seat_and_pins(part: DraftedPart, frame: Sequence[Group], name: str, move: str, held: str) -> list[Entry]:
    """A seat on a plane, expanding pins in holes and blades in slots: relations of a mate, which take what is left.

    A slot after a hole turns the part by its place, as no relation does: it holds nothing.
    """
    features, relations, holding = [], [], []
    for k, group in enumerate(frame):
        closes = group.kind == "slot" and all(own.kind != "cylinder" for own in frame[:k])
        holding += [group.name] if closes or group.kind in ("plane", "cylinder") else []
        own, target = group.members[0], f"for {group.name}"
        normal = part.along(own.direction)
        at = place(part_at(part, own.at))
        if closes or group.kind == "plane":
            sides = (
                f"radius: {length(own.radius)}"
                if own.radius
                else (
                    f"extent: [{length(own.extent[0])}, {length(own.extent[1])}], along: {direction(part.along(own.x))}"
                )
            )
            features.append(f"  {scalar(target)}: {{kind: plane, at: {at}, normal: {direction(-normal)}, {sides}}}")
            relations.append(f"  - {{kind: coincident, from: {part.of(group.name)}, to: {scalar(f'{name}.{target}')}}}")
        elif group.kind == "cylinder":
            features.append(
                f"  {scalar(target)}: {{kind: axis, at: {at}, axis: {direction(normal)}, length: {length(own.length)}}}"
            )
            relations.append(f"  - {{kind: coaxial, from: {part.of(group.name)}, to: {scalar(f'{name}.{target}')}}}")
    if not relations:
        return []
    body = Entry("parts", scalar(name), [Wording(("kind: solid", "features:", *features), "guess: its seat and pins")])
    fixed = Entry("moves", scalar(held), [Wording((f"{{kind: fix, part: {scalar(name)}}}",))])
    head = ("kind: mate", f"part: {scalar(part.name)}", "relations:")
    idle = [f"{own.name} is a {own.kind} and holds nothing here" for own in frame if own.name not in holding]
    words = "; ".join((f"guess: by its datums {' | '.join(holding)}", "pins without play", *idle))
    ways = [
        Wording((*head, *relations[:k]), words, "" if k == len(relations)
                else "what the last datum holds is left as drawn")
        for k in range(len(relations), 0, -1)
    ]  # fmt: skip
    still = Wording((f"{{kind: fix, part: {scalar(part.name)}}}",), "guess", "the part is fixed as it stands")
    return [body, fixed, Entry("moves", scalar(move), [*ways, still])]
