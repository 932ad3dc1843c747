"""The solid of an external spur gear: exact arcs and lines, flanks as splines over the roll angle."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import cadquery as cq
import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex
from OCP.Geom import Geom_BSplineCurve, Geom_Circle, Geom_Curve
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf
from OCP.TColgp import TColgp_Array1OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from OCP.TopoDS import TopoDS_Vertex
from scipy.interpolate import make_interp_spline

from tol3d.gears import LEFT, RIGHT, Flank, SpurGear
from tol3d.parts.named_solid import NamedEdge, NamedSolid, extruded

FLANK_ERROR = 1e-6  # mm; how far a spline flank may leave the involute, a tenth of the 0.01 um asked for
CUBIC_SPLINE_CONSTANT = 5 / 384  # of h^4 max|P''''|; complete cubic spline, Hall and Meyer, J. Approx. Theory 16, 1976
FEWEST_INTERVALS = 8
SHORTEST_EDGE = 1e-6  # mm; ten times OCC's point tolerance: what is shorter is left out
SIDES: dict[Flank, str] = {RIGHT: "right", LEFT: "left"}

Point = tuple[float, float]


def flank_name(tooth: int, flank: Flank) -> str:
    """Name of a flank's face: "tooth 0 right flank"."""
    return f"tooth {tooth} {SIDES[flank]} flank"


def build(gear: SpurGear) -> NamedSolid:
    """The gear as one valid solid in its own frame: z the axis, face centre z = 0, tooth 0 on +x.

    Faces: for tooth k (counted counter-clockwise) "tooth k tip" and, with right and left,
    "tooth k right flank", "... fillet" and, where the fillet begins below the base circle,
    "... radial"; "space k root" between teeth k and k+1, unless a full round leaves none;
    "bore" if there is one; "front" (+z) and "back". The u parameter of a flank's face is the roll
    angle [rad], and it leaves the involute by at most FLANK_ERROR.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    bore = [NamedEdge("bore", _hole(gear))] if gear.bore > 0.0 else []
    return extruded(list(_outline(gear)), bore, gear.face_width)


def flank_intervals(gear: SpurGear) -> int:
    """Spline intervals over a flank, uniform in roll, so that h^4 max|P''''| 5/384 <= FLANK_ERROR.

    With P = r_b e^(i beta) (1 - i sigma t) and beta = sigma (t - eta_b):
    |P''''| = r_b |3 + i sigma t|, largest at the tip.
    """
    fourth_derivative = gear.base_radius * math.hypot(3.0, gear.tip_roll)
    longest = (FLANK_ERROR / (CUBIC_SPLINE_CONSTANT * fourth_derivative)) ** 0.25
    return max(FEWEST_INTERVALS, math.ceil((gear.tip_roll - gear.form_roll) / longest))


# outline ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Side:
    """One side of tooth 0, from the root circle up: corners [mm] in the transverse plane, and its curves."""

    bottom: Point
    centre: Point
    top: Point
    start: Point
    tip: Point
    flank: Geom_Curve


def _side(gear: SpurGear, flank: Flank) -> _Side:
    ends = gear.flank_points(np.array([gear.form_roll, gear.tip_roll]), flank)
    (start_x, start_y), (tip_x, tip_y) = ends.tolist()
    start, top = (start_x, start_y), gear.fillet_top(flank)
    return _Side(
        bottom=gear.fillet_bottom(flank),
        centre=gear.fillet_centre(flank),
        top=top if math.dist(top, start) > SHORTEST_EDGE else start,
        start=start,
        tip=(tip_x, tip_y),
        flank=_flank_curve(gear, flank),
    )


def _flank_curve(gear: SpurGear, flank: Flank) -> Geom_Curve:
    """Complete cubic spline over the roll, in the plane z = -b/2.

    The end tangents P' = r_b t (cos beta, sin beta) are given, not guessed: fifteen times closer
    than with GeomAPI_Interpolate, which refuses the vanishing tangent at the base circle.
    """
    roll = np.linspace(gear.form_roll, gear.tip_roll, flank_intervals(gear) + 1)
    beta = flank * (roll[[0, -1]] - gear.base_half_angle)
    first, last = gear.base_radius * roll[[0, -1], None] * np.stack([np.cos(beta), np.sin(beta)], axis=-1)
    spline = make_interp_spline(roll, gear.flank_points(roll, flank), k=3, bc_type=([(1, first)], [(1, last)]))
    knots, multiplicities = np.unique(spline.t, return_counts=True)
    poles = TColgp_Array1OfPnt(1, len(spline.c))
    for index, (x, y) in enumerate(spline.c.tolist(), start=1):
        poles.SetValue(index, gp_Pnt(x, y, -gear.face_width / 2))
    places, counts = TColStd_Array1OfReal(1, len(knots)), TColStd_Array1OfInteger(1, len(knots))
    for index, (knot, count) in enumerate(zip(knots.tolist(), multiplicities.tolist(), strict=True), start=1):
        places.SetValue(index, knot)
        counts.SetValue(index, count)
    return Geom_BSplineCurve(poles, places, counts, 3)


def _outline(gear: SpurGear) -> Iterator[NamedEdge]:
    """The transverse section, counter-clockwise, beginning at the root below the right flank of tooth 0."""
    sides: dict[Flank, _Side] = {RIGHT: _side(gear, RIGHT), LEFT: _side(gear, LEFT)}
    teeth = [_Tooth(gear, number, sides) for number in range(gear.teeth)]
    full_round = gear.root_arc <= SHORTEST_EDGE
    if full_round:
        for tooth, following in zip(teeth, teeth[1:] + teeth[:1], strict=True):
            following.vertices[RIGHT, "bottom"] = tooth.vertices[LEFT, "bottom"]
    tip_circle, root_circle = (_circle(gear, (0.0, 0.0), radius) for radius in (gear.tip_radius, gear.root_radius))
    for number, (tooth, following) in enumerate(zip(teeth, teeth[1:] + teeth[:1], strict=True)):
        yield from tooth.rising()
        yield _arc(f"tooth {number} tip", tip_circle, tooth.vertices[RIGHT, "tip"], tooth.vertices[LEFT, "tip"])
        yield from tooth.falling()
        if not full_round:
            ends = tooth.vertices[LEFT, "bottom"], following.vertices[RIGHT, "bottom"]
            yield _arc(f"space {number} root", root_circle, *ends)


class _Tooth:
    """The edges of one tooth: those of tooth 0, turned; vertices are shared between its edges."""

    def __init__(self, gear: SpurGear, number: int, sides: dict[Flank, _Side]) -> None:
        self._gear, self._number, self._sides = gear, number, sides
        angle = gear.angular_pitch * number
        self._cos, self._sin = math.cos(angle), math.sin(angle)
        self._turn = gp_Trsf()
        self._turn.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), angle)
        self.vertices: dict[tuple[Flank, str], TopoDS_Vertex] = {}
        for flank, side in sides.items():
            for place in ("bottom", "top", "tip"):
                self.vertices[flank, place] = self._vertex(getattr(side, place))
            below = side.top != side.start
            self.vertices[flank, "start"] = self._vertex(side.start) if below else self.vertices[flank, "top"]

    def rising(self) -> Iterator[NamedEdge]:
        """Right side, from the root circle to the tip."""
        yield self._fillet(RIGHT, "bottom", "top")
        yield from self._radial(RIGHT, "top", "start")
        yield self._flank(RIGHT)

    def falling(self) -> Iterator[NamedEdge]:
        """Left side, from the tip to the root circle; its flank is walked against its roll."""
        upwards = self._flank(LEFT)
        yield NamedEdge(upwards.name, cq.Edge(upwards.edge.wrapped.Reversed()))
        yield from self._radial(LEFT, "start", "top")
        yield self._fillet(LEFT, "top", "bottom")

    def _fillet(self, flank: Flank, begin: str, end: str) -> NamedEdge:
        circle = _circle(self._gear, self._turned(self._sides[flank].centre), self._gear.fillet_radius, up=-1.0)
        ends = self.vertices[flank, begin], self.vertices[flank, end]
        return _arc(f"tooth {self._number} {SIDES[flank]} fillet", circle, *ends)

    def _radial(self, flank: Flank, begin: str, end: str) -> Iterator[NamedEdge]:
        if self._sides[flank].top != self._sides[flank].start:
            edge = BRepBuilderAPI_MakeEdge(self.vertices[flank, begin], self.vertices[flank, end]).Edge()
            yield NamedEdge(f"tooth {self._number} {SIDES[flank]} radial", cq.Edge(edge))

    def _flank(self, flank: Flank) -> NamedEdge:
        curve = self._sides[flank].flank.Transformed(self._turn)
        ends = self.vertices[flank, "start"], self.vertices[flank, "tip"]
        edge = BRepBuilderAPI_MakeEdge(curve, *ends, self._gear.form_roll, self._gear.tip_roll).Edge()
        return NamedEdge(flank_name(self._number, flank), cq.Edge(edge))

    def _turned(self, point: Point) -> Point:
        x, y = point
        return self._cos * x - self._sin * y, self._sin * x + self._cos * y

    def _vertex(self, point: Point) -> TopoDS_Vertex:
        return BRepBuilderAPI_MakeVertex(gp_Pnt(*self._turned(point), -self._gear.face_width / 2)).Vertex()


def _circle(gear: SpurGear, centre: Point, radius: float, up: float = 1.0) -> Geom_Circle:
    """A circle in the plane z = -b/2; seen from +z it runs counter-clockwise, or clockwise for up = -1."""
    return Geom_Circle(gp_Ax2(gp_Pnt(*centre, -gear.face_width / 2), gp_Dir(0.0, 0.0, up)), radius)


def _arc(name: str, circle: Geom_Circle, begin: TopoDS_Vertex, end: TopoDS_Vertex) -> NamedEdge:
    return NamedEdge(name, cq.Edge(BRepBuilderAPI_MakeEdge(circle, begin, end).Edge()))


def _hole(gear: SpurGear) -> cq.Edge:
    return cq.Edge(BRepBuilderAPI_MakeEdge(_circle(gear, (0.0, 0.0), gear.bore / 2, up=-1.0)).Edge())
