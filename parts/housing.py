"""The solid of a gearbox's housing: a box open at its top, with bores in its end walls and holes in its rim."""

import math
from collections.abc import Sequence

from tol3d.errors import GeometryError
from tol3d.parts.box import LEAST_WALL, TOP_IS_Y, Box, Point
from tol3d.parts.details import Bore, Boss, Hole
from tol3d.parts.machining import OVERSHOOT, Tool, cutter, refuse_meeting, refuse_sizes, standing_on, tool
from tol3d.parts.named_boolean import cut, fused
from tol3d.parts.named_solid import NamedSolid

RIM, BOTTOM = "rim", "bottom"
OUTSIDE = {RIM if name == "top" else name: side for name, side in TOP_IS_Y.items()}
INSIDE = {"floor" if name == BOTTOM else f"inside {name}": side for name, side in TOP_IS_Y.items()}


def housing(
    corner: Point,
    size: Point,
    walls: float,
    floor: float,
    bores: Sequence[Bore] = (),
    holes: Sequence[Hole] = (),
    bosses: Sequence[Boss] = (),
) -> NamedSolid:
    """A box for shafts along z: four walls on a floor, open towards +y, where the flat rim is [mm].

    Faces: "rim" (+y), "bottom" (-y), "left" (-x), "right" (+x), "front" (+z), "back" (-z), all outside; "floor",
    "inside left", "inside right", "inside front", "inside back"; and those of bores, holes and bosses (see
    tol3d.parts.details).

    Args:
        corner: its least x, y and z, bosses aside.
        size: along x, y and z.
        walls: thickness of the four walls.
        floor: thickness of the floor.
        bores: through the end walls, "front" and "back", within what they bound of the inside.
        holes: in the "rim" (places x and z), clear of the opening; in the "bottom" below the inside.
        bosses: on the outside of the end walls; a bore lies in one of them or clear of it.

    Raises:
        GeometryError: walls thicker than the box, a bore that leaves its wall, a detail that leaves its face or meets
            another.
    """
    outer = Box(corner, _sum(corner, size), OUTSIDE)
    outer.refuse_flat("a housing")
    inner = _inside(outer, walls, floor)
    standing = [(boss.words, standing_on(outer, boss.wall, boss)) for boss in bosses]
    refuse_meeting(standing)
    cutting: list[Tool] = [(bore.words, _bore(outer, inner, bosses, bore)) for bore in bores]
    cutting += [(hole.words, _hole(outer, inner, hole)) for hole in holes]
    refuse_meeting(cutting)
    whole = fused(outer.solid(), [made for _, made in standing], "the housing")
    opened = Box(inner.low, (inner.high[0], inner.high[1] + OVERSHOOT, inner.high[2]), INSIDE)
    return cut(whole, [opened.solid(), *(made for _, made in cutting)], "the housing")


def _sum(corner: Point, size: Point) -> Point:
    return corner[0] + size[0], corner[1] + size[1], corner[2] + size[2]


def _inside(outer: Box, walls: float, floor: float) -> Box:
    """The hollow, up to the rim."""
    if not min(walls, floor) >= LEAST_WALL:
        raise GeometryError(f"walls of {walls:g} mm and a floor of {floor:g} mm leave the housing open")
    low, high = outer.low, outer.high
    for axis, taken in enumerate((2 * walls, floor, 2 * walls)):
        whole = high[axis] - low[axis]
        if not whole - taken >= LEAST_WALL:
            what = f"a floor of {floor:g} mm leaves" if axis == 1 else f"walls of {walls:g} mm leave"
            raise GeometryError(f"{what} nothing inside a housing of {whole:g} mm along {'xyz'[axis]}")
    return Box((low[0] + walls, low[1] + floor, low[2] + walls), (high[0] - walls, high[1], high[2] - walls), OUTSIDE)


def _bore(outer: Box, inner: Box, bosses: Sequence[Boss], bore: Bore) -> NamedSolid:
    refuse_sizes(bore)
    if bore.wall not in ("front", "back"):
        raise GeometryError(f"{bore.words}: expected the front or the back, the walls that shafts go through")
    inner.refuse_outside(bore.words, bore.wall, bore.at, bore.reach)
    side = outer.sides[bore.wall]
    thick = abs(outer.level(side) - inner.level(side))
    raised = sum(boss.height for boss in bosses if boss.wall == bore.wall and _lies_in(bore, boss))
    return tool(bore, side, outer.level(side) + side.sign * raised, raised + thick + OVERSHOOT)


def _lies_in(bore: Bore, boss: Boss) -> bool:
    """Whether a bore goes through a boss of its wall.

    Raises:
        GeometryError: it does by a part of it only.
    """
    apart = math.dist(bore.at, boss.at)
    if apart >= (bore.diameter + boss.diameter) / 2 + LEAST_WALL:
        return False
    if not apart + bore.diameter / 2 <= boss.diameter / 2 - LEAST_WALL:
        raise GeometryError(f"{bore.words} lies neither in {boss.words} nor clear of it")
    return True


def _hole(outer: Box, inner: Box, hole: Hole) -> NamedSolid:
    if hole.face == BOTTOM:
        below = Box((inner.low[0], outer.low[1], inner.low[2]), (inner.high[0], inner.low[1], inner.high[2]), OUTSIDE)
        return cutter(below, hole)
    if hole.face != RIM:
        raise GeometryError(f"{hole.words} is on the {hole.face!r}; expected the rim or the bottom")
    made = cutter(outer, hole)
    off = [
        max(inner.low[axis] - place, place - inner.high[axis], 0.0)
        for axis, place in zip(outer.sides[RIM].across, hole.at, strict=True)
    ]
    if not math.hypot(*off) - hole.diameter / 2 >= LEAST_WALL:
        raise GeometryError(
            f"{hole.words} leaves the rim: its axis is {math.hypot(*off):g} mm from the opening, which reaches from "
            f"{_room(inner, 0)} along x and from {_room(inner, 2)} along z"
        )
    return made


def _room(inner: Box, axis: int) -> str:
    return f"{inner.low[axis]:g} mm to {inner.high[axis]:g} mm"
