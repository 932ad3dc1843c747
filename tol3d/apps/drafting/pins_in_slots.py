"""Pins of one part that stand in slots of another."""

from dataclasses import dataclass

from tol3d.apps.drafting.parts import DraftedPart
from tol3d.cad.step import FoundFeature, Slot


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


def pins_in_slots(part: DraftedPart, other: DraftedPart) -> list[PinInSlot]:
    """Pins of either part in slots of the other, as both stand."""
    found = []
    for slotted, pinned in ((part, other), (other, part)):
        here = slotted.pose[:3, :3].T
        for slot in slotted.features.part.machined.slots:
            for pin in pinned.features.part.features:
                if pin.kind != "pin" or pin.loose:
                    continue
                at = here @ (pinned.at(pin) - slotted.pose[:3, 3])
                if slot.holds(at, here @ pinned.along(pin.direction), pin.radius, pin.length):
                    found.append(PinInSlot(pinned, slotted, pin, slot))
    return found
