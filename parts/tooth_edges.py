"""Edges that teeth of spur gears are made of, external or internal, in the plane z = -b/2."""

import math
from typing import Final

import cadquery as cq
import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex
from OCP.Geom import Geom_Circle, Geom_Curve
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf
from OCP.TopoDS import TopoDS_Vertex

from tol3d.gears import LEFT, RIGHT, Flank
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.parts.complete_spline import complete_spline
from tol3d.parts.named_solid import NamedEdge

FLANK_ERROR: Final = 1e-6  # mm; how far a spline flank may leave the involute, a tenth of the 0.01 um asked for
CUBIC_SPLINE_CONSTANT = 5 / 384  # of h^4 max|P''''|; complete cubic spline, Hall and Meyer, J. Approx. Theory 16, 1976
FEWEST_INTERVALS = 8
SHORTEST_EDGE: Final = 1e-6  # mm; ten times OCC's point tolerance: what is shorter is left out
SIDES: dict[Flank, str] = {RIGHT: "right", LEFT: "left"}

Point = tuple[float, float]


def flank_name(tooth: int, flank: Flank) -> str:
    """Name of a flank's face: "tooth 0 right flank"."""
    return f"tooth {tooth} {SIDES[flank]} flank"


def roll_span(gear: CylindricalGear) -> tuple[float, float]:
    """Smaller and larger end of the involute, as rolls [rad]: form circle and tip, inside tip and form circle."""
    first, last = sorted((gear.form_roll, gear.tip_roll))
    return first, last


def flank_intervals(gear: CylindricalGear) -> int:
    """Spline intervals over a flank, uniform in roll, so that h^4 max|P''''| 5/384 <= FLANK_ERROR.

    With P = r_b e^(i beta) (1 - i sigma t) and beta = sigma (t - eta_b):
    |P''''| = r_b |3 + i sigma t|, largest at the larger end: the tip, or the root of an internal gear.
    """
    first, last = roll_span(gear)
    fourth_derivative = gear.base_radius * math.hypot(3.0, last)
    longest = math.sqrt(math.sqrt(FLANK_ERROR / (CUBIC_SPLINE_CONSTANT * fourth_derivative)))
    return max(FEWEST_INTERVALS, math.ceil((last - first) / longest))


def flank_curve(gear: CylindricalGear, flank: Flank) -> Geom_Curve:
    """Complete cubic spline over the roll, in the plane z = -b/2.

    The end tangents P' = r_b t (cos beta, sin beta) are given, not guessed: fifteen times closer
    than with GeomAPI_Interpolate, which refuses the vanishing tangent at the base circle.
    """
    roll = np.linspace(*roll_span(gear), flank_intervals(gear) + 1)
    beta = gear.iso_sign * flank * (roll[[0, -1]] - gear.iso_sign * gear.base_half_angle)
    first, last = gear.base_radius * roll[[0, -1], None] * np.stack([np.cos(beta), np.sin(beta)], axis=-1)
    points = gear.flank_points(roll, flank)
    return complete_spline(roll, points, np.stack([first, last]), -gear.face_width / 2)


def flank_edge(
    gear: CylindricalGear, number: int, flank: Flank, curve: Geom_Curve, ends: tuple[TopoDS_Vertex, TopoDS_Vertex]
) -> NamedEdge:
    """The curve of tooth 0 on tooth `number`, between corners at its smaller and larger roll."""
    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), gear.angular_pitch * number)
    edge = BRepBuilderAPI_MakeEdge(curve.Transformed(turn), *ends, *roll_span(gear)).Edge()
    return NamedEdge(flank_name(number, flank), cq.Edge(edge))


def turned(gear: CylindricalGear, number: int, point: Point) -> Point:
    """A point of tooth 0 on tooth `number`."""
    angle = gear.angular_pitch * number
    (x, y), cos, sin = point, math.cos(angle), math.sin(angle)
    return cos * x - sin * y, sin * x + cos * y


def vertex(gear: CylindricalGear, point: Point) -> TopoDS_Vertex:
    """A corner of the section, in the plane z = -b/2."""
    return BRepBuilderAPI_MakeVertex(gp_Pnt(*point, -gear.face_width / 2)).Vertex()


def circle(gear: CylindricalGear, centre: Point, radius: float, up: float = 1.0) -> Geom_Circle:
    """A circle in the plane z = -b/2; seen from +z it runs counter-clockwise, or clockwise for up = -1."""
    return Geom_Circle(gp_Ax2(gp_Pnt(*centre, -gear.face_width / 2), gp_Dir(0.0, 0.0, up)), radius)


def arc(name: str, circle: Geom_Circle, begin: TopoDS_Vertex, end: TopoDS_Vertex) -> NamedEdge:
    """A part of a circle, along it."""
    return NamedEdge(name, cq.Edge(BRepBuilderAPI_MakeEdge(circle, begin, end).Edge()))
