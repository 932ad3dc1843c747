"""Slots of plain solids: two half rounds and the two walls between them; and pins of other parts that stand in them."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from tol3d.apps.drafting.parts import DraftedPart
from tol3d.cad.step import FoundFeature, StepPart
from tol3d.numerics.arrays import Array

SAME: Final = 1e-3  # mm; what models are drawn to
SQUARE: Final = 1e-6  # cosine
HALF_TURN: Final = 0.02  # rad; how far an end of a slot may turn from half round


@dataclass(frozen=True)
class Slot:
    """A slot.

    Args:
        walls: both, the material behind each.
        ends: the half rounds.
        axis: through its depth (3,).
    """

    walls: tuple[FoundFeature, FoundFeature]
    ends: tuple[FoundFeature, FoundFeature]
    axis: Array

    @property
    def width(self) -> float:
        """Distance of its walls [mm]."""
        return 2 * self.ends[0].radius

    def holds(self, at: Array, direction: Array, radius: float, length: float) -> bool:
        """True if a pin stands in it, in the frame of its part: on its middle plane, between both ends."""
        start, end = (np.array(own.at) for own in self.ends)
        along = end - start
        size = float(np.linalg.norm(along))
        along = along / size
        off = at - start
        depth = abs(float((at - (start + end) / 2) @ self.axis))
        return (
            abs(float(direction @ self.axis)) > 1.0 - SQUARE
            and abs(float(off @ np.cross(self.axis, along))) < SAME
            and -SAME < float(off @ along) < size + SAME
            and depth < (length + self.ends[0].length) / 2 - SAME
            and 2 * radius <= self.width + SAME
        )


@dataclass(frozen=True)
class PinInSlot:
    """A pin of one part in a slot of another."""

    pinned: DraftedPart
    slotted: DraftedPart
    pin: FoundFeature
    slot: Slot

    @property
    def play(self) -> float:
        """Width of the slot less the pin [mm]."""
        return self.slot.width - 2 * self.pin.radius

    def pair(self, part: DraftedPart) -> str:
        """A pair of a pattern that lays a part, with the slot selected."""
        walls = self.slotted.features.slot(self.slot.walls, self.slotted.features.kind_name("slot"))
        ends = [self.slotted.of(walls.name), self.pinned.of(self.pinned.features.name(self.pin))]
        start, end = ends if part is self.slotted else reversed(ends)
        return f"  - {{from: {start}, to: {end}}}"


def slots(part: StepPart) -> Iterator[Slot]:
    """Slots of a part, each by its ends and the walls between them."""
    known = [own for own in part.features if not own.loose]
    rounds = [own for own in known if own.kind == "fillet" and abs(own.turn - np.pi) < HALF_TURN]
    planes = [own for own in known if own.kind == "plane"]
    for first, second in combinations(rounds, 2):
        axis = np.array(first.direction)
        between = np.subtract(second.at, first.at)
        size = float(np.linalg.norm(between))
        parallel = abs(float(axis @ np.array(second.direction))) > 1.0 - SQUARE
        if not parallel or abs(first.radius - second.radius) > SAME or size < SAME or abs(between @ axis) > SAME:
            continue
        across, middle = np.cross(axis, between / size), (np.array(first.at) + np.array(second.at)) / 2
        sides = [wall(planes, middle + sign * first.radius * across, -sign * across) for sign in (-1.0, 1.0)]
        if sides[0] is not None and sides[1] is not None:
            yield Slot((sides[0], sides[1]), (first, second), axis)


def wall(planes: list[FoundFeature], at: Array, normal: Array) -> FoundFeature | None:
    """The flat face in whose middle a point lies, with this normal; None if there is none."""
    for own in planes:
        faces = float(np.array(own.direction) @ normal) > 1.0 - SQUARE
        if faces and float(np.linalg.norm(np.subtract(own.at, at))) < SAME:
            return own
    return None


def pins_in_slots(part: DraftedPart, other: DraftedPart) -> list[PinInSlot]:
    """Pins of either part in slots of the other, as both stand."""
    found = []
    for slotted, pinned in ((part, other), (other, part)):
        here = slotted.pose[:3, :3].T
        for slot in slots(slotted.features.part):
            for pin in pinned.features.part.features:
                if pin.kind != "pin" or pin.loose:
                    continue
                at = here @ (pinned.at(pin) - slotted.pose[:3, 3])
                if slot.holds(at, here @ pinned.along(pin.direction), pin.radius, pin.length):
                    found.append(PinInSlot(pinned, slotted, pin, slot))
    return found
