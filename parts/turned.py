"""Solids turned about an axis: a section's edges sweep the faces that bear their names."""

from collections.abc import Mapping, Sequence
from typing import Final

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeVertex
from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Ax1, gp_Dir, gp_Pln, gp_Pnt

from tol3d.errors import GeometryError
from tol3d.parts.named_solid import NamedEdge, NamedSolid, wire_of

AXIS: Final = "axis"
"""An edge on the axis, which sweeps no face."""

Z: Final = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
UPRIGHT: Final = gp_Pln(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, -1.0, 0.0))
"""The plane y = 0, in which sections about z lie."""

Corner = tuple[str, float, float]
"""The name of the edge that begins there, and its place: distance from the axis and z [mm]."""


def turned(outline: Sequence[NamedEdge], words: str, plane: gp_Pln = UPRIGHT, about: gp_Ax1 = Z) -> NamedSolid:
    """Sweep a section once round an axis.

    Args:
        outline: edges in order, sharing their vertices, counter-clockwise seen against the plane's normal; those on
            the axis are called "axis".
        words: what is made, for the message.
        plane: of the section; the axis lies in it.
        about: the axis.

    Raises:
        GeometryError: the outline makes no valid solid.
    """
    section = BRepBuilderAPI_MakeFace(plane, wire_of(outline), True)
    if not section.IsDone():
        raise GeometryError(f"the section of {words} does not close into one face")
    made = BRepPrimAPI_MakeRevol(section.Face(), about)
    solid = cq.Solid(made.Shape())
    if not solid.isValid():
        raise GeometryError(f"the section of {words} crosses itself: its solid is not valid")
    # the sweep itself is asked, for its history leaves out the flat ends
    swept = {named.name: cq.Face(made.Revol().Shape(named.edge.wrapped)) for named in outline if named.name != AXIS}
    outward = {face: face for face in solid.Faces()}
    return NamedSolid(solid, {name: outward[face] for name, face in swept.items()})


def section(corners: Sequence[Corner], through: Mapping[str, tuple[float, float]] | None = None) -> list[NamedEdge]:
    """Edges about z between corners in order, counter-clockwise seen from -y.

    Args:
        corners: of the section.
        through: of edges that are arcs of circles, a place on each of them; the others are straight.
    """
    points = [gp_Pnt(distance, 0.0, z) for _, distance, z in corners]
    vertices = [BRepBuilderAPI_MakeVertex(point).Vertex() for point in points]
    found = []
    for begin, (name, *_) in enumerate(corners):
        end = (begin + 1) % len(corners)
        ends = vertices[begin], vertices[end]
        if through is not None and name in through:
            distance, z = through[name]
            circle = GC_MakeArcOfCircle(points[begin], gp_Pnt(distance, 0.0, z), points[end]).Value()
            made = BRepBuilderAPI_MakeEdge(circle, *ends)
        else:
            made = BRepBuilderAPI_MakeEdge(*ends)
        found.append(NamedEdge(name, cq.Edge(made.Edge())))
    return found
