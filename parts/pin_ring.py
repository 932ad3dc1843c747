"""The solid of a pin ring: a round housing ring, its bore broken by half-holes for round pins."""

import math
from collections.abc import Iterator

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex
from OCP.Geom import Geom_Circle
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopoDS import TopoDS_Vertex

from tol3d.errors import GeometryError
from tol3d.parts.named_solid import NamedEdge, NamedSolid, extruded
from tol3d.parts.round_hole import circle_edge


def pin_ring(
    pins: int, pin_circle_radius: float, hole_radius: float, bore_radius: float, outer_radius: float, width: float
) -> NamedSolid:
    """A ring about z, its middle z = 0; the hole of pin 1 lies on +x.

    Faces: "pin k hole" and "land k", from pin k to the next, counter-clockwise; "rim"; "front" (+z) and "back".

    Args:
        pins: how many.
        pin_circle_radius: where the holes have their axes [mm].
        hole_radius: [mm].
        bore_radius: of the lands between the holes [mm].
        outer_radius: [mm].
        width: along z [mm].

    Raises:
        GeometryError: holes that miss the bore, meet each other or leave the ring.
    """
    if not abs(pin_circle_radius - hole_radius) < bore_radius < pin_circle_radius + hole_radius < outer_radius:
        raise GeometryError(
            f"a pin ring with its bore at {bore_radius:g} mm and its rim at {outer_radius:g} mm does not hold pins of "
            f"radius {hole_radius:g} mm at {pin_circle_radius:g} mm"
        )
    cosine = (bore_radius**2 + pin_circle_radius**2 - hole_radius**2) / (2 * bore_radius * pin_circle_radius)
    half = math.acos(cosine)
    if half >= math.pi / pins:
        raise GeometryError(f"{pins} pin holes of radius {hole_radius:g} mm meet at the bore of {bore_radius:g} mm")
    level = -width / 2
    rim = NamedEdge("rim", circle_edge((0.0, 0.0), 2 * outer_radius, level))
    hollow = list(_hollow(pins, pin_circle_radius, hole_radius, bore_radius, half, level))
    return extruded([rim], [hollow], width)


def _hollow(
    pins: int, circle: float, hole_radius: float, bore_radius: float, half: float, level: float
) -> Iterator[NamedEdge]:
    """Holes and lands, clockwise; `half` is the angle from a hole's axis to where its land begins [rad]."""
    pitch = 2 * math.pi / pins
    after = [_vertex(bore_radius, pitch * pin + half, level) for pin in range(pins)]
    before = [_vertex(bore_radius, pitch * pin - half, level) for pin in range(pins)]
    bore = _clockwise(0.0, 0.0, level, bore_radius)
    for pin in reversed(range(pins)):
        following = (pin + 1) % pins
        yield _arc(f"land {pin + 1}", bore, before[following], after[pin])
        place = circle * math.cos(pitch * pin), circle * math.sin(pitch * pin)
        yield _arc(f"pin {pin + 1} hole", _clockwise(*place, level, hole_radius), after[pin], before[pin])


def _arc(name: str, around: Geom_Circle, begin: TopoDS_Vertex, end: TopoDS_Vertex) -> NamedEdge:
    return NamedEdge(name, cq.Edge(BRepBuilderAPI_MakeEdge(around, begin, end).Edge()))


def _clockwise(x: float, y: float, level: float, radius: float) -> Geom_Circle:
    return Geom_Circle(gp_Ax2(gp_Pnt(x, y, level), gp_Dir(0.0, 0.0, -1.0)), radius)


def _vertex(radius: float, azimuth: float, level: float) -> TopoDS_Vertex:
    point = gp_Pnt(radius * math.cos(azimuth), radius * math.sin(azimuth), level)
    return BRepBuilderAPI_MakeVertex(point).Vertex()
