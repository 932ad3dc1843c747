"""The solid of a bracket: two legs that make an L, with holes in either and a fillet between them."""

import math
from collections.abc import Iterator, Sequence

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt, gp_Trsf

from tol3d.errors import GeometryError
from tol3d.parts.box import Box, Side
from tol3d.parts.details import LEAST_WALL, Hole
from tol3d.parts.machining import cutter, refuse_meeting, tools_of
from tol3d.parts.named_boolean import cut
from tol3d.parts.named_solid import NamedEdge, NamedSolid, extruded

FLAT = "base outside", "base inside"
UPRIGHT = "upright outside", "upright inside"


def bracket(
    length: float, height: float, width: float, thickness: float, fillet: float = 0.0, holes: Sequence[Hole] = ()
) -> NamedSolid:
    """A base that lies along x and an upright that rises along z, from the outer edge that they share [mm].

    The origin is the middle of that edge, which runs along y. Faces: "base outside" (z = 0), "base inside"
    (z = thickness), "base end" (x = length), "upright outside" (x = 0), "upright inside" (x = thickness), "upright end"
    (z = height), "front" (-y), "back" (+y), "fillet" if there is one, and those of the holes. Places are x and y on the
    base, y and z on the upright.

    Args:
        length: of the base, along x.
        height: of the upright, along z.
        width: along y.
        thickness: of both legs.
        fillet: radius between the inner faces; 0 leaves a sharp corner.
        holes: in the faces "base outside", "base inside", "upright outside" and "upright inside".

    Raises:
        GeometryError: legs without volume, a fillet that leaves them, a hole that leaves its leg or meets another.
    """
    reach = thickness + fillet
    if not min(width, thickness) >= LEAST_WALL or not 0.0 <= fillet < math.inf or 0.0 < fillet < LEAST_WALL:
        raise GeometryError(
            f"a bracket {width:g} mm wide, {thickness:g} mm thick, with a fillet of {fillet:g} mm has no volume or no "
            "such fillet"
        )
    if not min(length, height) - reach >= LEAST_WALL:
        raise GeometryError(
            f"the legs of a bracket, {length:g} mm and {height:g} mm long, do not reach beyond its thickness of "
            f"{thickness:g} mm and its fillet of {fillet:g} mm"
        )
    legs = _legs(length, height, width, thickness, reach)
    tools = tools_of(holes, lambda hole: cutter(_leg(legs, hole), hole))
    refuse_meeting(tools)
    turned = gp_Trsf()
    turned.SetDisplacement(gp_Ax3(), gp_Ax3(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, -1.0, 0.0), gp_Dir(1.0, 0.0, 0.0)))
    flat = extruded(list(_outline(length, height, width, thickness, fillet)), [], width)
    return cut(flat.moved(cq.Location(turned)), [tool for _, tool in tools], "the bracket")


def _legs(length: float, height: float, width: float, thickness: float, reach: float) -> tuple[Box, Box]:
    """Boxes of both legs, each clear of the other and of the fillet."""
    base = dict(zip(FLAT, (Side(2, -1), Side(2, 1)), strict=True))
    upright = dict(zip(UPRIGHT, (Side(0, -1), Side(0, 1)), strict=True))
    return (
        Box((reach, -width / 2, 0.0), (length, width / 2, thickness), base),
        Box((0.0, -width / 2, reach), (thickness, width / 2, height), upright),
    )


def _leg(legs: tuple[Box, Box], hole: Hole) -> Box:
    found = next((leg for leg in legs if hole.face in leg.sides), None)
    if found is None:
        raise GeometryError(f"{hole.words} is on the {hole.face!r}; expected one of {', '.join((*FLAT, *UPRIGHT))}")
    return found


def _outline(length: float, height: float, width: float, thickness: float, fillet: float) -> Iterator[NamedEdge]:
    """The L of x and z, counter-clockwise seen from the front."""
    inner = thickness + fillet
    corners = {
        "base outside": (0.0, 0.0),
        "base end": (length, 0.0),
        "base inside": (length, thickness),
        "fillet": (inner, thickness),
        "upright inside": (thickness, inner),
        "upright end": (thickness, height),
        "upright outside": (0.0, height),
    }
    if fillet == 0.0:
        del corners["fillet"]
    points = [gp_Pnt(x, z, -width / 2) for x, z in corners.values()]
    vertices = [BRepBuilderAPI_MakeVertex(point).Vertex() for point in points]
    for number, name in enumerate(corners):
        begin, end = number, (number + 1) % len(points)
        if name == "fillet":
            off = inner - fillet * math.sqrt(0.5)
            arc = GC_MakeArcOfCircle(points[begin], gp_Pnt(off, off, -width / 2), points[end]).Value()
            made = BRepBuilderAPI_MakeEdge(arc, vertices[begin], vertices[end])
        else:
            made = BRepBuilderAPI_MakeEdge(vertices[begin], vertices[end])
        yield NamedEdge(name, cq.Edge(made.Edge()))
