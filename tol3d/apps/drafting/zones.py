"""The zone of a frame of the file as a scene has it."""

from typing import Final

import numpy as np

from tol3d.apps.drafting.features import Group
from tol3d.apps.drafting.words import direction, length
from tol3d.numerics.arrays import Array
from tol3d.step import MATERIAL, ORIENTATIONS, Meanings, StepError, Tolerance

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
    return f", per: [{', '.join(length(each.value) for each in sides)}]"


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
    words = [own for own in tolerance.modifiers if own in MATERIAL]
    return "" if not words else "lmc" if "least" in words[0] else "mmc"
