"""Holes and slots cut into the faces of a box, pins stood on it: tools as named solids, and what they must keep to."""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import TypeVar

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec

from tol3d.errors import GeometryError
from tol3d.parts.box import Box, Side
from tol3d.parts.details import LEAST_WALL, Bore, Boss, Detail, DetailError, Hole, Pin, Place, Slot
from tol3d.parts.named_boolean import cut, fused
from tol3d.parts.named_solid import BACK, FRONT, NamedEdge, NamedSolid, extruded

OVERSHOOT = LEAST_WALL / 2  # mm; a tool ends so far outside the material that it opens

Direction = tuple[float, float, float]
Tool = tuple[Detail, NamedSolid]
"""A detail and its solid, which is cut away or added."""

Some = TypeVar("Some", bound=Detail)


def machined(
    box: Box, words: str, holes: Sequence[Hole] = (), slots: Sequence[Slot] = (), pins: Sequence[Pin] = ()
) -> NamedSolid:
    """A box with pins on its top, and holes and slots cut into it.

    Args:
        box: what is left of it keeps its faces' names.
        words: what is made, for messages.
        holes, slots, pins: each with a name of its own.

    Raises:
        GeometryError: a detail without size, one that leaves its face, two that meet, a name that two faces have.
    """
    standing = tools_of(pins, lambda pin: standing_on(box, "top", pin))
    cutting = tools_of((*holes, *slots), lambda detail: cutter(box, detail))
    refuse_meeting([*standing, *cutting])
    whole = fused(box.solid(), [tool for _, tool in standing], words)
    return cut(whole, [tool for _, tool in cutting], words)


def tools_of(details: Sequence[Some], made: Callable[[Some], NamedSolid]) -> list[Tool]:
    """The tools of details.

    Args:
        details: in their order.
        made: makes the solid of one, or raises a GeometryError.

    Raises:
        DetailError: one cannot be made.
    """
    tools: list[Tool] = []
    for detail in details:
        try:
            tools.append((detail, made(detail)))
        except GeometryError as error:
            raise DetailError(str(error), detail.name) from error
    return tools


def cutter(box: Box, detail: Hole | Slot) -> NamedSolid:
    """Solid that a hole or a slot takes away, from just outside its face inwards.

    Raises:
        GeometryError: it has no size, is deeper than the material or leaves its face.
    """
    side = box.side(detail.face, detail.words)
    whole = box.depth(side)
    refuse_sizes(detail)
    refuse_depth(detail, whole)
    box.refuse_outside(detail.words, detail.face, detail.at, detail.reach)
    end = whole + OVERSHOOT if detail.depth is None else detail.depth
    return tool(detail, side, box.level(side), end)


def tool(detail: Hole | Slot | Bore, side: Side, level: float, end: float) -> NamedSolid:
    """The solid of a hole, a slot or a bore from just above a level of its side down to `end` below it [mm]."""
    place = point(side, detail.at, level - side.sign * end)
    if not isinstance(detail, Slot):
        return cylinder(place, _outwards(side), detail.diameter, end + OVERSHOOT, detail.name, f"{detail.name} floor")
    return _slot(detail, side, place, end + OVERSHOOT)


def standing_on(box: Box, face: str, standing: Pin | Boss) -> NamedSolid:
    """The solid of a pin or a boss that stands on a side.

    Raises:
        GeometryError: it has no size or leaves its face.
    """
    side = box.side(face, standing.words)
    if not all(LEAST_WALL <= size < math.inf for size in (standing.diameter, standing.height)):
        raise GeometryError(f"{standing.words} is {standing.height:g} mm high: it has no size")
    box.refuse_outside(standing.words, face, standing.at, standing.reach)
    foot = point(side, standing.at, box.level(side))
    return cylinder(foot, _outwards(side), standing.diameter, standing.height, standing.name, f"{standing.name} foot")


def refuse_sizes(detail: Hole | Slot | Bore) -> None:
    """Raise unless a hole, a slot or a bore has a size."""
    width = detail.width if isinstance(detail, Slot) else detail.diameter
    deep = math.inf if isinstance(detail, Bore) or detail.depth is None else detail.depth
    if not (LEAST_WALL <= width < math.inf and deep >= LEAST_WALL):
        raise GeometryError(f"{detail.words} has no size: its width and its depth must be {LEAST_WALL:g} mm or more")
    if isinstance(detail, Slot) and detail.length < detail.width + LEAST_WALL:
        raise GeometryError(f"{detail.words} is no longer than wide: make it a hole")


def refuse_depth(detail: Hole | Slot | Bore, whole: float) -> None:
    """Raise unless a blind hole or slot leaves a floor in so much material [mm]."""
    if not isinstance(detail, Bore) and detail.depth is not None and not detail.depth <= whole - LEAST_WALL:
        raise GeometryError(
            f"{detail.words} is {detail.depth:g} mm deep in {whole:g} mm of material; leave its depth out to go through"
        )


def refuse_meeting(tools: Sequence[Tool]) -> None:
    """Raise where two details meet or leave no wall between them.

    Raises:
        DetailError: two do; it has the name of the later one.
    """
    boxes = [made.solid.BoundingBox() for _, made in tools]
    for one, other in combinations(range(len(tools)), 2):
        if not _apart(boxes[one], boxes[other]):
            (detail, first), (near, second) = tools[one], tools[other]
            between = BRepExtrema_DistShapeShape(first.solid.wrapped, second.solid.wrapped).Value()
            if between < LEAST_WALL:
                what = f"{detail.words} and {near.words} overlap, or leave no wall between them"
                raise DetailError(what, near.name)


def cylinder(start: Direction, along: Direction, diameter: float, length: float, side: str, base: str) -> NamedSolid:
    """A cylinder from its base at `start` on [mm]: its side and its base by name, its other end by the side's name."""
    made = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(*start), gp_Dir(*along)), diameter / 2, length)
    solid = cq.Solid(made.Solid())
    sweep = made.Cylinder()
    swept = {side: sweep.LateralFace(), base: sweep.BottomFace(), f"{side} end": sweep.TopFace()}
    outward = {face: face for face in solid.Faces()}
    return NamedSolid(solid, {name: outward[cq.Face(face)] for name, face in swept.items()})


def point(side: Side, at: Place, level: float) -> Direction:
    """A place on a side, at a level along its axis [mm]."""
    found = [level] * 3
    for axis, place in zip(side.across, at, strict=True):
        found[axis] = place
    return found[0], found[1], found[2]


def _apart(one: cq.BoundBox, other: cq.BoundBox) -> bool:
    """True if two bounding boxes leave a wall between them."""
    first = ((one.xmin, one.xmax), (one.ymin, one.ymax), (one.zmin, one.zmax))
    second = ((other.xmin, other.xmax), (other.ymin, other.ymax), (other.zmin, other.zmax))
    return any(max(a[0] - b[1], b[0] - a[1]) > LEAST_WALL for a, b in zip(first, second, strict=True))


def _outwards(side: Side) -> Direction:
    found = [0.0, 0.0, 0.0]
    found[side.axis] = float(side.sign)
    return found[0], found[1], found[2]


def _slot(slot: Slot, side: Side, bottom: Direction, height: float) -> NamedSolid:
    """Solid that a slot takes away, from its bottom on."""
    swept = extruded(list(_stadium(slot, -height / 2)), [], height)
    faces = {f"{slot.name} floor" if name == BACK else name: face for name, face in swept.faces.items()}
    del faces[FRONT]  # outside the material
    first, second = side.across
    along = [0.0, 0.0, 0.0]
    along[first], along[second] = math.cos(slot.turned), math.sin(slot.turned)
    lift, place = gp_Trsf(), gp_Trsf()
    lift.SetTranslation(gp_Vec(0.0, 0.0, height / 2))
    place.SetDisplacement(gp_Ax3(), gp_Ax3(gp_Pnt(*bottom), gp_Dir(*_outwards(side)), gp_Dir(*along)))
    location = cq.Location(place.Multiplied(lift))
    return NamedSolid(swept.solid, faces).moved(location)


def _stadium(slot: Slot, level: float) -> Iterator[NamedEdge]:
    """The outline of a slot about the z axis at a level [mm], along x, counter-clockwise."""
    half, radius = (slot.length - slot.width) / 2, slot.width / 2
    places = [(-half, -radius), (half, -radius), (half, radius), (-half, radius)]
    points = [gp_Pnt(x, y, level) for x, y in places]
    corners = [BRepBuilderAPI_MakeVertex(point).Vertex() for point in points]
    far, near = gp_Pnt(half + radius, 0.0, level), gp_Pnt(-half - radius, 0.0, level)
    end = GC_MakeArcOfCircle(points[1], far, points[2]).Value()
    start = GC_MakeArcOfCircle(points[3], near, points[0]).Value()
    sides = {
        "right wall": BRepBuilderAPI_MakeEdge(corners[0], corners[1]),
        "end": BRepBuilderAPI_MakeEdge(end, corners[1], corners[2]),
        "left wall": BRepBuilderAPI_MakeEdge(corners[2], corners[3]),
        "start": BRepBuilderAPI_MakeEdge(start, corners[3], corners[0]),
    }
    return (NamedEdge(f"{slot.name} {name}", cq.Edge(made.Edge())) for name, made in sides.items())
