"""The solid of a gearbox's housing: a box open at its top or its front, with bores for shafts along z."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from tol3d.errors import GeometryError
from tol3d.parts.box import TOP_IS_Y, Box, Point, Side
from tol3d.parts.details import LEAST_WALL, Bore, Boss, Hole, Pin
from tol3d.parts.machining import (
    OVERSHOOT,
    refuse_depth,
    refuse_meeting,
    refuse_sizes,
    standing_on,
    tool,
    tools_of,
)
from tol3d.parts.named_boolean import cut, fused
from tol3d.parts.named_solid import NamedSolid

RIM: Final = "rim"
OPPOSITE: Final[Mapping[str, str]] = {"top": "bottom", "front": "back"}
"""The side of the floor, by the side that is open."""

END_WALLS: Final = ("front", "back")


def housing(
    corner: Point,
    size: Point,
    walls: float,
    floor: float,
    bores: Sequence[Bore] = (),
    holes: Sequence[Hole] = (),
    bosses: Sequence[Boss] = (),
    pins: Sequence[Pin] = (),
    opening: str = "top",
) -> NamedSolid:
    """A box for shafts along z, open at its top (+y) or its front (+z), where the flat rim is [mm].

    Faces: "rim" round the opening, "floor" opposite to it inside; outside the other five of "top" (+y), "bottom" (-y),
    "left" (-x), "right" (+x), "front" (+z), "back" (-z), inside the other four as "inside left" and so on; and those of
    bores, holes, bosses and pins (see tol3d.parts.details).

    Args:
        corner: its least x, y and z, bosses and pins aside.
        size: along x, y and z.
        walls: thickness of the four walls round the opening.
        floor: thickness of the floor.
        bores: through the end walls, "front" and "back", within what they bound of the inside.
        holes: in the "rim", clear of the opening; in another face within what its wall bounds of the inside. One in an
            end wall may lie in a boss, which it goes through as well.
        bosses: on the outside of the end walls; a bore lies in one of them or clear of it.
        pins: on the rim, clear of the opening.
        opening: the side that is open, "top" or "front".

    Raises:
        GeometryError: walls thicker than the box, a bore that leaves its wall, a detail that leaves its face or meets
            another.
    """
    if opening not in OPPOSITE:
        raise GeometryError(f"a housing opens at its top or its front, got {opening!r}")
    box = _OpenBox(corner, size, walls, floor, opening)
    standing = tools_of(bosses, lambda boss: _boss(box, boss))
    refuse_meeting(standing)
    cutting = tools_of((*bores, *holes), lambda detail: _bore_or_hole(box, bosses, detail))
    on_rim = tools_of(pins, lambda pin: _pin(box, pin))
    refuse_meeting([*cutting, *on_rim])
    whole = fused(box.outer.solid(), [made for _, made in (*standing, *on_rim)], "the housing")
    return cut(whole, [box.hollow, *(made for _, made in cutting)], "the housing")


@dataclass(frozen=True)
class _OpenBox:
    """A box with one side open. Arguments as of `housing`."""

    corner: Point
    size: Point
    walls: float
    floor: float
    opening: str

    def __post_init__(self) -> None:
        self.outer.refuse_flat("a housing")
        if not min(self.walls, self.floor) >= LEAST_WALL:
            raise GeometryError(f"walls of {self.walls:g} mm and a floor of {self.floor:g} mm leave the housing open")
        for axis in range(3):
            if not self.inner.high[axis] - self.inner.low[axis] >= LEAST_WALL:
                deep = axis == TOP_IS_Y[self.opening].axis
                what = f"a floor of {self.floor:g} mm leaves" if deep else f"walls of {self.walls:g} mm leave"
                whole = self.outer.high[axis] - self.outer.low[axis]
                raise GeometryError(f"{what} nothing inside a housing of {whole:g} mm along {'xyz'[axis]}")

    @property
    def outer(self) -> Box:
        """Its outside."""
        sides = {RIM if name == self.opening else name: side for name, side in TOP_IS_Y.items()}
        (x, y, z), (length, height, width) = self.corner, self.size
        return Box(self.corner, (x + length, y + height, z + width), sides)

    @property
    def inner(self) -> Box:
        """Its inside, up to the rim; its sides have the names of the outer ones."""
        return self._inside(0.0)

    @property
    def hollow(self) -> NamedSolid:
        """Solid that is taken away inside."""
        names = {
            "floor" if name == OPPOSITE[self.opening] else f"inside {name}": side for name, side in TOP_IS_Y.items()
        }
        inside = self._inside(OVERSHOOT)
        return Box(inside.low, inside.high, names).solid()

    def _inside(self, over: float) -> Box:
        """The inside, and so much over the rim [mm]."""
        taken = dict.fromkeys(TOP_IS_Y, self.walls) | {self.opening: -over, OPPOSITE[self.opening]: self.floor}
        low, high = list(self.outer.low), list(self.outer.high)
        for name, side in TOP_IS_Y.items():
            ends = high if side.sign > 0 else low
            ends[side.axis] -= side.sign * taken[name]
        return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]), self.outer.sides)

    def thickness(self, side: Side) -> float:
        """Thickness of the wall of a side, or of the whole box below the rim [mm]."""
        whole: float = self.outer.depth(side)
        between = abs(self.outer.level(side) - self.inner.level(side))
        return between if between > 0.0 else whole

    def refuse_over_opening(self, detail: Hole | Pin) -> None:
        """Raise unless a detail on the rim lies within it, clear of the opening."""
        self.outer.refuse_outside(detail.words, RIM, detail.at, detail.reach)
        across = self.outer.sides[RIM].across
        ends = [(self.inner.low[axis], self.inner.high[axis]) for axis in across]
        off = [max(low - at, at - high, 0.0) for at, (low, high) in zip(detail.at, ends, strict=True)]
        if not math.hypot(*off) - detail.diameter / 2 >= LEAST_WALL:
            reaches = " and ".join(
                f"from {low:g} mm to {high:g} mm along {'xyz'[axis]}"
                for axis, (low, high) in zip(across, ends, strict=True)
            )
            raise GeometryError(
                f"{detail.words} leaves the rim: its axis is {math.hypot(*off):g} mm from the opening, which reaches "
                f"{reaches}"
            )


def _refuse_no_end_wall(box: _OpenBox, detail: Bore | Boss) -> None:
    walls = [wall for wall in END_WALLS if wall != box.opening]
    if detail.wall not in walls:
        raise GeometryError(f"{detail.words}: expected the {' or the '.join(walls)}, a wall that shafts go through")


def _boss(box: _OpenBox, boss: Boss) -> NamedSolid:
    _refuse_no_end_wall(box, boss)
    return standing_on(box.outer, boss.wall, boss)


def _pin(box: _OpenBox, pin: Pin) -> NamedSolid:
    made = standing_on(box.outer, RIM, pin)
    box.refuse_over_opening(pin)
    return made


def _bore_or_hole(box: _OpenBox, bosses: Sequence[Boss], detail: Bore | Hole) -> NamedSolid:
    """Solid that a bore or a hole takes away, from its boss or its face inwards."""
    refuse_sizes(detail)
    if isinstance(detail, Bore):
        _refuse_no_end_wall(box, detail)
    face = detail.wall if isinstance(detail, Bore) else detail.face
    side = box.outer.side(face, detail.words)
    if isinstance(detail, Hole) and face == RIM:
        box.refuse_over_opening(detail)
    else:
        box.inner.refuse_outside(detail.words, face, detail.at, detail.reach)
    raised = sum(boss.height for boss in bosses if boss.wall == face and _lies_in(detail, boss))
    thick = raised + box.thickness(side)
    refuse_depth(detail, thick)
    end = thick + OVERSHOOT if isinstance(detail, Bore) or detail.depth is None else detail.depth
    return tool(detail, side, box.outer.level(side) + side.sign * raised, end)


def _lies_in(detail: Bore | Hole, boss: Boss) -> bool:
    """True if a bore or a hole goes through a boss of its wall.

    Raises:
        GeometryError: only a part of it does.
    """
    apart = math.dist(detail.at, boss.at)
    if apart >= (detail.diameter + boss.diameter) / 2 + LEAST_WALL:
        return False
    if not apart + detail.diameter / 2 <= boss.diameter / 2 - LEAST_WALL:
        raise GeometryError(f"{detail.words} lies neither in {boss.words} nor clear of it")
    return True
