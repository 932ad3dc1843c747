"""Measures of a drafted scene: what varies between its parts, or between features of a single one, ranked."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, islice
from typing import Final

import numpy as np

from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.features import Group
from tol3d.apps.drafting.parts import DraftedPart
from tol3d.apps.drafting.touching_faces import TOUCHING, Coaxial, Contacts, feature, size_of
from tol3d.apps.drafting.words import Names, across, direction, length, scalar, unquoted
from tol3d.cad.step import FoundFeature
from tol3d.numerics.arrays import Array

MOST_MEASURES: Final = 10
MOST_CANDIDATES: Final = 120  # whose deviations are compared
MOST_OF_A_KIND: Final = 12  # candidates of two products and one kind
MOST_OF_A_FEATURE: Final = 3  # distances to one feature
MOST_FEATURES: Final = 24  # of a single part, between which distances are taken
STILL: Final = 1e-6  # mm; a smaller standard deviation is rounding
MOST_WORDS: Final = 5  # of a key that tell the pair of features; the next one is the direction
DIGITS: Final = 2  # of a standard deviation that rank: more are those of the sample
PARALLEL: Final = 1e-6  # sine, cosine

Key = tuple[str, ...]


@dataclass(frozen=True)
class Candidate:
    """A measure that a scene may have.

    Args:
        entry: of the scene.
        key: what it is of, by which it is found in a scene that is drafted again.
        group: measures that say alike: the kind, and the products it is between.
        weight: of its group: the product of the areas of both parts [mm⁴]; on a single part more of holes and pins.
    """

    entry: Entry
    key: Key
    group: Key
    weight: float = 1.0


KINDS: Final = ("in", "on", "to", "apart")
"""Pins in holes, holes on holes, gaps, distances on one part: which matters first."""


def between(contacts: Contacts, names: Names, chosen: Sequence[Key] | None) -> Iterator[Candidate]:
    """Candidates between parts: pins in holes, holes on holes, and gaps to the nearest faces.

    Args:
        contacts: of the parts.
        names: of the scene.
        chosen: keys of those to make; None for all, MOST_OF_A_KIND of each kind.
    """
    counts: dict[Key, int] = {}
    for part, other, word, own, there in pairs(contacts):
        key = (word, part.name, other.name, str(own.faces), str(there.faces))
        group = (word, *sorted((product(part), product(other))))
        if chosen is None:
            counts[group] = counts.get(group, 0) + 1
            if counts[group] > MOST_OF_A_KIND or sum(counts.values()) > MOST_CANDIDATES:
                continue
        ways = across(there.direction) if word != "to" else [there.direction]
        for number, along in enumerate(ways):
            if chosen is None or (*key, str(number)) in chosen:
                entry = gap(part, other, word, own, there, along, names)
                yield Candidate(entry, (*key, str(number)), group, size_of(part) * size_of(other))


def pairs(contacts: Contacts) -> Iterator[tuple[DraftedPart, DraftedPart, str, FoundFeature, FoundFeature]]:
    """Pairs of features of two parts: the part that is held first, and the word of KINDS."""
    found: list[tuple[int, float, int, tuple[DraftedPart, DraftedPart, str, FoundFeature, FoundFeature]]] = []
    for k, part in enumerate(contacts.parts):
        for other in contacts.parts[:k]:
            for own in contacts.coaxial(part, other):
                found.append((KINDS.index(word_of(own)), 0.0, len(found), ordered(own)))
            near = math.sqrt(min(size_of(part), size_of(other)))
            for face in [own for own in contacts.facing(part, other) if TOUCHING < own.gap < near][:1]:
                found.append((KINDS.index("to"), face.gap, len(found), (part, other, "to", face.face, face.there)))
    for *_, pair in sorted(found, key=lambda each: each[:3]):
        yield pair


def word_of(own: Coaxial) -> str:
    """The word of KINDS for a coaxial pair."""
    return "on" if own.holes else "in"


def ordered(own: Coaxial) -> tuple[DraftedPart, DraftedPart, str, FoundFeature, FoundFeature]:
    """A coaxial pair, the pin before its hole, the smaller part before the larger."""
    swapped = own.own.hollow and not own.there.hollow
    if swapped:
        return own.other, own.part, word_of(own), own.there, own.own
    return own.part, own.other, word_of(own), own.own, own.there


def product(part: DraftedPart) -> str:
    """The product of a part, whichever use it is."""
    return f"{part.file_name} {part.features.part.body.product}"


def gap(
    part: DraftedPart,
    other: DraftedPart,
    word: str,
    own: FoundFeature,
    there: FoundFeature,
    along: Sequence[float],
    names: Names,
) -> Entry:
    """A gap as an entry."""
    nominal = float((part.at(own) - other.at(there)) @ other.along(along))
    words = f"{{kind: gap, from: {feature(other, there)}, to: {feature(part, own)}, along: {direction(along)}}}"
    remark = f"guess: nominally {length(nominal)}" if word == "to" else "guess: between the axes"
    name = names.new(f"{part.name} {word} {other.name}", "measure")
    return Entry("measures", scalar(name), [Wording((words,), remark)])


def apart(part: DraftedPart, names: Names, chosen: Sequence[Key] | None) -> Iterator[Candidate]:
    """Candidates on a single part: distances between its located features, along what lies between them."""
    located = [group for group in part.features.groups if group.name in part.drawing.located]
    datums = {*part.drawing.datums.values()}
    known = [*located, *(group for group in part.features.groups if group not in located and group.name in datums)]
    members = [(group, name, own) for group in known for name, own in zip(group.names, group.members, strict=True)]
    for (first, start, a), (second, end, b) in combinations(members[:MOST_FEATURES], 2):
        along = way_between(first, a, second, b)
        if along is None:
            continue
        key = ("apart", start, end)
        if chosen is not None and key not in chosen:
            continue
        nominal = float(np.subtract(b.at, a.at) @ along)
        words = f"{{kind: gap, from: {part.of(start)}, to: {part.of(end)}, along: {direction(along)}}}"
        name = names.new(f"{start} to {end}", "measure")
        entry = Entry("measures", scalar(name), [Wording((words,), f"guess: nominally {length(nominal)}")])
        weight = float(1 + (first.kind == "cylinder") + (second.kind == "cylinder"))
        yield Candidate(entry, key, ("apart", *sorted((first.name, second.name))), weight)


def way_between(first: Group, a: FoundFeature, second: Group, b: FoundFeature) -> Array | None:
    """Direction in which the distance of two features counts; None where they lie on or askew to each other."""
    flat, other = (first.kind in ("plane", "slot")), (second.kind in ("plane", "slot"))
    x, y = np.array(a.direction), np.array(b.direction)
    off = np.subtract(b.at, a.at)
    if flat and other:
        along = x if np.linalg.norm(np.cross(x, y)) < PARALLEL else None
    elif flat or other:
        normal, axis = (x, y) if flat else (y, x)
        square = {first.kind, second.kind} & {"sphere"} or abs(float(normal @ axis)) < PARALLEL
        along = normal if square else None
    else:
        parallel = np.linalg.norm(np.cross(x, y)) < PARALLEL
        across_axis = off - off @ x * x
        size = float(np.linalg.norm(across_axis))
        along = across_axis / size if parallel and size > TOUCHING else None
    if along is None or abs(float(off @ along)) < TOUCHING:
        return None
    return np.asarray(along if float(off @ along) > 0.0 else 0.0 - along)


def ranked(candidates: Sequence[Candidate], deviations: Mapping[str, float], most: int) -> tuple[Key, ...]:
    """Keys of the candidates that say most, in this order: of each group the one that varies most, by turns.

    Groups of larger parts come first; of both directions across one pair of axes the one that varies more is taken.

    Args:
        candidates: all.
        deviations: standard deviation of each measure that stands in the scene [mm], by its name.
        most: number of them.
    """
    varying = {own.key: float(f"{deviations.get(name_of(own.entry), 0.0):.{DIGITS}g}") for own in candidates}
    groups: dict[Key, dict[Key, Candidate]] = {}
    for own in sorted(candidates, key=lambda own: -varying[own.key]):
        if varying[own.key] > STILL:
            groups.setdefault(own.group, {}).setdefault(own.key[:MOST_WORDS], own)
    ordered_groups = sorted(groups, key=lambda group: (KINDS.index(group[0]), -max_weight(groups[group])))
    ordered_groups = list(varied(ordered_groups))
    queues = [[own.key for own in groups[group].values()] for group in ordered_groups]
    turns = (queue[k] for k in range(most) for queue in queues if k < len(queue))
    return tuple(islice(turns, most))


def varied(groups: Sequence[Key]) -> Iterator[Key]:
    """Groups, but of distances on one part no more than MOST_OF_A_FEATURE with one feature."""
    counts: dict[str, int] = {}
    for group in groups:
        word, *ends = group
        if word == "apart" and any(counts.get(end, 0) >= MOST_OF_A_FEATURE for end in ends):
            continue
        yield group
        counts |= {end: counts.get(end, 0) + 1 for end in ends}


def name_of(entry: Entry) -> str:
    """The name of an entry as it stands in results."""
    return unquoted(entry.name)


def max_weight(group: Mapping[Key, Candidate]) -> float:
    """Weight of a group."""
    return max(own.weight for own in group.values())
