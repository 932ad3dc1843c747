"""Sizes and distances of a part's drawing in its file, as tolerances of a scene."""

import numpy as np

from tol3d.apps.drafting.drawn import Drawn
from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.features import Group
from tol3d.apps.drafting.words import comment, length, scalar
from tol3d.apps.drafting.zones import SQUARE
from tol3d.step import Dimension, FoundFeature, StepError


def sized(drawing: Drawn, dimension: Dimension) -> list[FoundFeature]:
    """The round features whose size a dimension is; none for other dimensions."""
    if not dimension.is_size or dimension.limits is None or dimension.role != "toleranced":
        return []
    try:
        found = drawing.features.of_faces(dimension.features[0].faces)
    except StepError:
        return []
    wanted = ("hole", "pin", "ball", "socket")
    return [own for own in found if own.kind in wanted] if "angle" not in dimension.kind else []


def take_size(drawing: Drawn, dimension: Dimension) -> None:
    """A size with limits of a used feature."""
    if dimension.limits is None or dimension.role != "toleranced" or "angle" in dimension.kind:
        return
    per = 2.0 if "radius" in dimension.kind else 1.0
    round_ones = sized(drawing, dimension)
    known = [own for own in map(drawing.features.named, round_ones) if own is not None]
    groups = list({id(group): group for group, _ in known}.values())
    if not round_ones and (slot := slot_of(drawing, dimension)) is not None:
        groups = [slot]
    for group in groups:
        if group.size is None or group.name in drawing.sizes:
            continue
        least, most = (per * own for own in dimension.limits)
        drawing.sizes[group.name] = size_entry(drawing, dimension, group, least - group.size, most - group.size)
    if round_ones and not groups:
        drawing.reasons[dimension.id] = "the size of what no tolerance of this scene is of"


def slot_of(drawing: Drawn, dimension: Dimension) -> Group | None:
    """The slot or tab whose width a dimension is."""
    faces = {face for each in dimension.features for face in each.faces}
    for group in drawing.features.groups:
        walls = [set(own.faces) for own in group.slot]
        if len(walls) == 2 and all(faces & own for own in walls) and faces <= walls[0] | walls[1]:
            return group
    return None


def size_entry(drawing: Drawn, dimension: Dimension, group: Group, lower: float, upper: float) -> Entry:
    """A size as an entry."""
    named = comment(dimension.name)
    remark = f"{comment(str(dimension))}{unit_of(dimension)}: {named + ', ' if named else ''}#{dimension.id}"
    envelope = enveloped(dimension, group)
    head = f"{{kind: size, of: {drawing.of(group.name)}"
    law = f"distribution: {{kind: {drawing.spread}, lower: {length(lower)}, upper: {length(upper)}}}}}"
    name = drawing.names.new(f"{group.name} size", "size", len(group.members))
    made = Entry(
        "tolerances", scalar(name), [Wording((f"{head}{envelope}, {law}",), remark)], dimension.id, str(dimension)
    )
    drawing.entries.append(made)
    return made


def enveloped(dimension: Dimension, group: Group) -> str:
    """The word of a file on whether limits of a size bound its form, as YAML; "" where it has none."""
    if group.kind not in ("cylinder", "slot"):
        return ""
    words = " ".join(dimension.notes).lower()
    return ", envelope: true" if "envelope" in words else ", envelope: false" if "independen" in words else ""


def take_distance(drawing: Drawn, dimension: Dimension) -> None:
    """A distance of two parallel faces with limits, of the one that nothing else locates."""
    if dimension.is_size or dimension.limits is None or dimension.role != "toleranced":
        return
    if "distance" not in dimension.kind or slot_of(drawing, dimension) is not None:
        return
    try:
        sides = [drawing.features.of_faces(each.faces) for each in dimension.features]
        if [len(own) for own in sides] != [1, 1] or {own[0].kind for own in sides} != {"plane"}:
            raise StepError("a distance of other features than two faces")
        first, second = sides[0][0], sides[1][0]
        if abs(abs(float(np.dot(first.direction, second.direction))) - 1.0) > SQUARE:
            raise StepError("a distance of faces that are not parallel")
        distance_entry(drawing, dimension, first, second)
    except StepError as error:
        drawing.reasons[dimension.id] = str(error)


def distance_entry(drawing: Drawn, dimension: Dimension, first: FoundFeature, second: FoundFeature) -> None:
    """A distance as an entry: it starts at the face that is a datum.

    Raises:
        StepError: both faces are located already.
    """
    letters = {name: letter for letter, name in drawing.datums.items()}
    known = [drawing.features.named(own) for own in (first, second)]
    names = [own[1] if own else "" for own in known]
    start, end = (second, first) if names[1] in letters and names[0] not in letters else (first, second)
    if (own := drawing.features.named(end)) is not None and (own[1] in drawing.located or own[1] in letters):
        raise StepError(f"{own[1]} is located by a tolerance already")
    begin, there = drawing.features.name(start), drawing.features.name(end)
    drawing.located[there] = dimension.id
    distance = abs(float(np.dot(np.subtract(end.at, start.at), start.direction)))
    assert dimension.limits is not None
    least, most = dimension.limits
    took = f"from datum {letters[begin]}" if begin in letters else f"from {begin}  # guess"
    remark = f"{comment(str(dimension))}{unit_of(dimension)}: #{dimension.id}, {took}"
    line = (
        f"{{kind: plus_minus, of: {drawing.of(there)}, datums: [{scalar(begin)}], distribution: "
        f"{{kind: {drawing.spread}, lower: {length(least - distance)}, upper: {length(most - distance)}}}}}"
    )
    name = scalar(drawing.names.new(dimension.name or f"distance {there}", "distance"))
    drawing.entries.append(Entry("tolerances", name, [Wording((line,), remark)], dimension.id, str(dimension)))


def unit_of(dimension: Dimension) -> str:
    """The unit in which the file has a dimension, where that is not mm."""
    measures = (dimension.nominal, dimension.least, dimension.most)
    unit = next((own.unit.name for own in measures if own is not None), "mm")
    return "" if unit == "mm" else f" {comment(unit)}"
