"""The solid of a cover: a plate that lies on a rim with its seat, and a spigot that reaches into the opening."""

import math
from collections.abc import Sequence

from tol3d.errors import GeometryError
from tol3d.parts.box import TOP_IS_Z, Box
from tol3d.parts.details import LEAST_WALL, Hole, Slot, Spigot
from tol3d.parts.machining import cutter, refuse_meeting, tools_of
from tol3d.parts.named_boolean import cut, fused
from tol3d.parts.named_solid import NamedSolid

SEAT, TOP = "seat", "top"
SIDES = {SEAT if name == "bottom" else name: side for name, side in TOP_IS_Z.items()}
SPIGOT = {f"spigot {'end' if name == 'bottom' else name}": side for name, side in TOP_IS_Z.items()}


def cover(
    length: float,
    width: float,
    thickness: float,
    holes: Sequence[Hole] = (),
    spigot: Spigot | None = None,
    slots: Sequence[Slot] = (),
) -> NamedSolid:
    """A plate about the middle of its seat, z = 0, which is the origin; its spigot is below, at negative z [mm].

    Faces: "seat" (z = 0, round the spigot), "top" (z = thickness), "left" (-x), "right" (+x), "front" (-y), "back"
    (+y); "spigot end", "spigot left", "spigot right", "spigot front", "spigot back"; and those of its holes and
    slots.

    Args:
        length, width, thickness: along x, y and z.
        holes, slots: from the "top", each within the spigot, which it goes through as well, or clear of it.
        spigot: none if not given.

    Raises:
        GeometryError: a cover without volume, a spigot without size or that covers the seat, a hole or a slot
            that leaves it, meets another or the side of the spigot.
    """
    box = Box((-length / 2, -width / 2, 0.0), (length / 2, width / 2, thickness), SIDES)
    box.refuse_flat("a cover")
    register = None if spigot is None else _register(box, spigot)
    tools = tools_of((*holes, *slots), lambda detail: cutter(_depth(box, register, detail), detail))
    refuse_meeting(tools)
    whole = box.solid() if register is None else fused(box.solid(), [register.solid()], "the cover")
    return cut(whole, [tool for _, tool in tools], "the cover")


def _register(box: Box, spigot: Spigot) -> Box:
    """The box of a spigot."""
    (x, y), (across, along) = spigot.at, spigot.reach
    made = Box((x - across, y - along, -spigot.height), (x + across, y + along, 0.0), SPIGOT)
    made.refuse_flat("a spigot")
    box.refuse_outside(spigot.words, SEAT, spigot.at, spigot.reach)
    return made


def _depth(box: Box, register: Box | None, detail: Hole | Slot) -> Box:
    """The material that a hole or a slot goes into: the cover's, down to the end of the spigot if it is above it."""
    if detail.face != TOP:
        raise GeometryError(f"{detail.words} is on the {detail.face!r}; expected the top")
    if register is None:
        return box
    ends = [(register.low[axis], register.high[axis]) for axis in (0, 1)]
    inwards = [
        min(at - low, high - at) - half for at, half, (low, high) in zip(detail.at, detail.reach, ends, strict=True)
    ]
    if min(inwards) >= LEAST_WALL:
        return Box((*box.low[:2], register.low[2]), box.high, SIDES)
    # a hole past a corner of the spigot is clear of it by its radius, a slot by the rectangle around it
    round_ = detail.diameter / 2 if isinstance(detail, Hole) else 0.0
    reach = (0.0, 0.0) if isinstance(detail, Hole) else detail.reach
    off = [max(low - at, at - high, 0.0) for at, (low, high) in zip(detail.at, ends, strict=True)]
    beside = [max(gap - half, 0.0) for gap, half in zip(off, reach, strict=True)]
    if not math.hypot(*beside) >= round_ + LEAST_WALL:
        raise GeometryError(
            f"{detail.words} meets the side of the spigot, which reaches from {register.low[0]:g} mm to "
            f"{register.high[0]:g} mm along x and from {register.low[1]:g} mm to {register.high[1]:g} mm along y"
        )
    return box
