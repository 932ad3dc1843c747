"""The drawing of one part in the file, as it grows while its tolerances and dimensions are read.

The zone of a frame of the file as a scene has it.

Sizes and distances of a part's drawing in its file, as tolerances of a scene.
"""

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.features import Features, Group
from tol3d.apps.drafting.words import Names, comment, direction, length, scalar
from tol3d.cad.step import MATERIAL, ORIENTATIONS, Dimension, FoundFeature, Meanings, StepError, StepText, Tolerance
from tol3d.numerics.arrays import Array


@dataclass
class Drawn:
    """Drawing of one part in the file, as far as it is said: entries of a scene.

    Args:
        text: of the file.
        meanings: of all its tolerances.
        part: the name of the part in the scene.
        features: of the part.
        names: those of the scene.
        spread: the kind of distribution of sizes and dimensions, as the law of zones.
        reasons: why tolerances and dimensions are left out, beyond their meaning; grows.
        entries: tolerances and measures; grows.
        datums: the feature of each letter; grows.
        located: the tolerance or dimension that locates each group of features; grows.
        sizes: the entry of the size of each group; grows.
        frames: the datums of that, as they are written, and how many there are; grows.
        doubled: losses of tolerances of a feature that another one locates; grows.
    """

    text: StepText
    meanings: Meanings
    part: str
    features: Features
    names: Names
    spread: str = "normal"
    reasons: dict[int, str] = field(default_factory=dict)
    entries: list[Entry] = field(default_factory=list)
    datums: dict[str, str] = field(default_factory=dict)
    located: dict[str, int] = field(default_factory=dict)
    sizes: dict[str, Entry] = field(default_factory=dict)
    doubled: dict[int, str] = field(default_factory=dict)
    frames: dict[str, tuple[tuple[tuple[str, str], ...], int]] = field(default_factory=dict)

    def of(self, feature: str) -> str:
        """A feature with its part, as YAML."""
        return scalar(f"{self.part}.{feature}")


SMALLEST_ZONE: Final = 1e-6  # mm; a zone of 0 at MMC is written so
SQUARE: Final = 1e-6  # cosine between directions that are square
FORMS: Final = frozenset(("flatness", "straightness", "roundness", "cylindricity"))
PROJECTED: Final = frozenset(("position", *ORIENTATIONS))


def zone(meanings: Meanings, tolerance: Tolerance, kind: str, group: Group) -> str:
    """The zone of a tolerance as YAML.

    Raises:
        StepError: the file does not say in which direction it limits.
    """
    assert tolerance.magnitude is not None
    size = length(max(tolerance.magnitude.value, SMALLEST_ZONE))
    projected = ""
    if tolerance.projected is not None and group.kind == "cylinder" and kind in PROJECTED:
        projected = f", projected: {length(tolerance.projected.length.value)}"
    if kind == "straightness" and tolerance.zone != "width":
        return f"{{diameter: {size}}}"
    if group.kind in ("plane", "slot") or kind in ("circular_run_out", "total_run_out", "profile", *FORMS):
        outward = f", outward: {length(tolerance.unequal.value)}" if tolerance.unequal and kind == "profile" else ""
        return f"{{width: {size}{outward}}}"
    if tolerance.zone != "width" or kind == "coaxiality" or group.kind == "sphere":
        return f"{{diameter: {size}{projected}}}"
    return f"{{width: {size}, along: {direction(limited(meanings, tolerance, group))}{projected}}}"


def piece(tolerance: Tolerance, kind: str) -> str:
    """The piece of a feature over which a form holds, as YAML; "" where it is of the whole."""
    if tolerance.per_unit is None or kind not in FORMS:
        return ""
    own = tolerance.per_unit
    if kind != "flatness" or own.area == "circular":
        return f", per: {length(own.size.value)}"
    sides = (own.size, own.second or own.size)
    return f", per: [{', '.join(length(side.value) for side in sides)}]"


def limited(meanings: Meanings, tolerance: Tolerance, group: Group) -> Array:
    """The one direction in which a width limits an axis: across the last flat datum that lies along it.

    Raises:
        StepError: no datum says it.
    """
    found = meanings.limited(tolerance, group.members[0].direction)
    if found is None:
        raise StepError("a width of an axis, in a direction that the file does not say")
    return np.array(found)


def modifier_of(tolerance: Tolerance) -> str:
    """The material modifier of a tolerance as a scene has it; "" where it has none."""
    words = [modifier for modifier in tolerance.modifiers if modifier in MATERIAL]
    return "" if not words else "lmc" if "least" in words[0] else "mmc"


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
        least, most = (per * limit for limit in dimension.limits)
        drawing.sizes[group.name] = size_entry(drawing, dimension, group, least - group.size, most - group.size)
    if round_ones and not groups:
        drawing.reasons[dimension.id] = "the size of what no tolerance of this scene is of"


def slot_of(drawing: Drawn, dimension: Dimension) -> Group | None:
    """The slot or tab whose width a dimension is."""
    faces = {face for feature in dimension.features for face in feature.faces}
    for group in drawing.features.groups:
        walls = [set(own.faces) for own in group.slot]
        if len(walls) == 2 and all(faces & wall for wall in walls) and faces <= walls[0] | walls[1]:
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
        sides = [drawing.features.of_faces(feature.faces) for feature in dimension.features]
        if [len(side) for side in sides] != [1, 1] or {side[0].kind for side in sides} != {"plane"}:
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
    unit = next((measure.unit.name for measure in measures if measure is not None), "mm")
    return "" if unit == "mm" else f" {comment(unit)}"
