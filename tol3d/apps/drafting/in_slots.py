"""Pins and tabs of one part that stand in slots of another."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tol3d.apps.drafting.parts import DraftedPart
from tol3d.cad.step import FoundFeature, Tab

Facing = Sequence[tuple[FoundFeature, FoundFeature, float]]
"""Flat faces of two parts that look at each other, of the first and of the second, with their distance [mm]."""


@dataclass(frozen=True)
class InSlot:
    """A pin or a tab of one part between two walls of another.

    Args:
        holder: the part with the pin or tab.
        slotted: the part with the walls.
        own: the pin or tab.
        walls: of the slot, pocket or window.
        width: distance of the walls [mm].
    """

    holder: DraftedPart
    slotted: DraftedPart
    own: FoundFeature | Tab
    walls: tuple[FoundFeature, FoundFeature]
    width: float

    @property
    def play(self) -> float:
        """Width of the slot less that of the pin or tab [mm]."""
        return self.width - (self.own.width if isinstance(self.own, Tab) else 2 * self.own.radius)

    @property
    def members(self) -> tuple[FoundFeature, ...]:
        """The pin, or the walls of the tab."""
        return self.own.walls if isinstance(self.own, Tab) else (self.own,)

    def pair(self, part: DraftedPart) -> str:
        """A pair of a pattern that lays a part, with the slot and the tab selected."""
        walls = self.slotted.features.slot(self.walls, self.slotted.features.kind_name("slot"))
        features = self.holder.features
        tab = features.slot(self.own.walls, features.kind_name("tab")).name if isinstance(self.own, Tab) else ""
        ends = [self.slotted.of(walls.name), self.holder.of(tab or features.name(self.members[0]))]
        start, end = ends if part is self.slotted else reversed(ends)
        return f"  - {{from: {start}, to: {end}}}"


def in_slots(part: DraftedPart, other: DraftedPart, facing: Facing) -> list[InSlot]:
    """Pins and tabs of either part in slots of the other, as both stand; each wall of one tab alone, the narrowest.

    Args:
        part, other: both.
        facing: flat faces of `part` and of `other`, the nearest first.
    """
    pins = [own for slotted, holder in ((part, other), (other, part)) for own in _pins(slotted, holder)]
    turned = [(there, own, gap) for own, there, gap in facing]
    tabs, used = list[InSlot](), set[tuple[str, tuple[int, ...]]]()
    for own in sorted((*_tabs(part, other, facing), *_tabs(other, part, turned)), key=lambda own: own.width):
        walls = {(own.slotted.name, wall.faces) for wall in own.walls} | {
            (own.holder.name, wall.faces) for wall in own.members
        }
        if not walls & used:
            tabs.append(own)
            used |= walls
    return pins + tabs


def _pins(slotted: DraftedPart, holder: DraftedPart) -> Iterator[InSlot]:
    here = slotted.pose[:3, :3].T
    for slot in slotted.features.part.machined.slots:
        for pin in holder.features.part.features:
            if pin.kind != "pin" or pin.loose:
                continue
            at = here @ (holder.at(pin) - slotted.pose[:3, 3])
            if slot.holds(at, here @ holder.along(pin.direction), pin.radius, pin.length):
                yield InSlot(holder, slotted, pin, slot.walls, slot.width)


def _tabs(slotted: DraftedPart, holder: DraftedPart, facing: Facing) -> Iterator[InSlot]:
    """Tabs midway between two walls and with play; flat faces of the slotted part and of the other."""
    for tab in holder.features.part.machined.tabs if facing else ():
        first, second = ([(own, gap) for own, face, gap in facing if face.faces == side.faces] for side in tab.walls)
        between = [(a, b, gap) for a, gap in first for b, other in second if tab.plays_between(gap, other)]
        for wall, opposite, gap in between[:1]:
            yield InSlot(holder, slotted, tab, (wall, opposite), tab.width + 2 * gap)
