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
_Corners = dict[tuple[Flank, str], TopoDS_Vertex]


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


def build_tooth(gear: SpurGear) -> NamedSolid:
    """Tooth 0 alone, cut off along the chord between its fillets' ends: its faces are those of `build` to the last bit.

    For gears of so many teeth that all of them would take minutes and gigabytes. The face beneath it is "cut".

    Raises:
        GeometryError: no valid solid comes of it.
    """
    sides: dict[Flank, _Side] = {RIGHT: _side(gear, RIGHT), LEFT: _side(gear, LEFT)}
    corners = _corners(gear, 0, sides)
    tooth = _Tooth(gear, 0, sides, corners)
    tip = _arc("tooth 0 tip", _circle(gear, (0.0, 0.0), gear.tip_radius), corners[RIGHT, "tip"], corners[LEFT, "tip"])
    chord = BRepBuilderAPI_MakeEdge(corners[LEFT, "bottom"], corners[RIGHT, "bottom"]).Edge()
    outline = [*tooth.rising(), tip, *tooth.falling(), NamedEdge("cut", cq.Edge(chord))]
    return extruded(outline, [], gear.face_width)


def flank_intervals(gear: SpurGear) -> int:
    """Spline intervals over a flank, uniform in roll, so that h^4 max|P''''| 5/384 <= FLANK_ERROR.

    With P = r_b e^(i beta) (1 - i sigma t) and beta = sigma (t - eta_b):
    |P''''| = r_b |3 + i sigma t|, largest at the tip.
    """
    fourth_derivative = gear.base_radius * math.hypot(3.0, gear.tip_roll)
    longest = math.sqrt(math.sqrt(FLANK_ERROR / (CUBIC_SPLINE_CONSTANT * fourth_derivative)))
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

    @property
    def radial(self) -> bool:
        """Whether a radial line leads from the fillet to the involute."""
        return math.dist(self.top, self.start) > SHORTEST_EDGE


def _side(gear: SpurGear, flank: Flank) -> _Side:
    ends = gear.flank_points(np.array([gear.form_roll, gear.tip_roll]), flank)
    (start_x, start_y), (tip_x, tip_y) = ends.tolist()
    return _Side(
        bottom=gear.fillet_bottom(flank),
        centre=gear.fillet_centre(flank),
        top=gear.fillet_top(flank),
        start=(start_x, start_y),
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
    corners = [_corners(gear, number, sides) for number in range(gear.teeth)]
    full_round = gear.root_arc <= SHORTEST_EDGE
    if full_round:
        before = corners[-1:] + corners[:-1]
        corners = [own | {(RIGHT, "bottom"): last[LEFT, "bottom"]} for own, last in zip(corners, before, strict=True)]
    tip_circle, root_circle = (_circle(gear, (0.0, 0.0), radius) for radius in (gear.tip_radius, gear.root_radius))
    for number, (own, following) in enumerate(zip(corners, corners[1:] + corners[:1], strict=True)):
        tooth = _Tooth(gear, number, sides, own)
        yield from tooth.rising()
        yield _arc(f"tooth {number} tip", tip_circle, own[RIGHT, "tip"], own[LEFT, "tip"])
        yield from tooth.falling()
        if not full_round:
            yield _arc(f"space {number} root", root_circle, own[LEFT, "bottom"], following[RIGHT, "bottom"])


def _corners(gear: SpurGear, number: int, sides: dict[Flank, _Side]) -> _Corners:
    """Vertices of a tooth by flank and place: bottom, top (of the fillet), start and tip (of the flank)."""
    corners = {}
    for flank, side in sides.items():
        for place in ("bottom", "start", "tip"):
            corners[flank, place] = _vertex(gear, _turned(gear, number, getattr(side, place)))
        corners[flank, "top"] = (
            _vertex(gear, _turned(gear, number, side.top)) if side.radial else corners[flank, "start"]
        )
    return corners


@dataclass(frozen=True)
class _Tooth:
    """The edges of one tooth: those of tooth 0, turned."""

    gear: SpurGear
    number: int
    sides: dict[Flank, _Side]
    corners: _Corners

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
        centre = _turned(self.gear, self.number, self.sides[flank].centre)
        circle = _circle(self.gear, centre, self.gear.fillet_radius, up=-1.0)
        name = f"tooth {self.number} {SIDES[flank]} fillet"
        return _arc(name, circle, self.corners[flank, begin], self.corners[flank, end])

    def _radial(self, flank: Flank, begin: str, end: str) -> Iterator[NamedEdge]:
        if self.sides[flank].radial:
            edge = BRepBuilderAPI_MakeEdge(self.corners[flank, begin], self.corners[flank, end]).Edge()
            yield NamedEdge(f"tooth {self.number} {SIDES[flank]} radial", cq.Edge(edge))

    def _flank(self, flank: Flank) -> NamedEdge:
        turn = gp_Trsf()
        turn.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), self.gear.angular_pitch * self.number)
        curve = self.sides[flank].flank.Transformed(turn)
        ends = self.corners[flank, "start"], self.corners[flank, "tip"]
        edge = BRepBuilderAPI_MakeEdge(curve, *ends, self.gear.form_roll, self.gear.tip_roll).Edge()
        return NamedEdge(flank_name(self.number, flank), cq.Edge(edge))


def _turned(gear: SpurGear, number: int, point: Point) -> Point:
    angle = gear.angular_pitch * number
    (x, y), cos, sin = point, math.cos(angle), math.sin(angle)
    return cos * x - sin * y, sin * x + cos * y


def _vertex(gear: SpurGear, point: Point) -> TopoDS_Vertex:
    return BRepBuilderAPI_MakeVertex(gp_Pnt(*point, -gear.face_width / 2)).Vertex()


def _circle(gear: SpurGear, centre: Point, radius: float, up: float = 1.0) -> Geom_Circle:
    """A circle in the plane z = -b/2; seen from +z it runs counter-clockwise, or clockwise for up = -1."""
    return Geom_Circle(gp_Ax2(gp_Pnt(*centre, -gear.face_width / 2), gp_Dir(0.0, 0.0, up)), radius)


def _arc(name: str, circle: Geom_Circle, begin: TopoDS_Vertex, end: TopoDS_Vertex) -> NamedEdge:
    return NamedEdge(name, cq.Edge(BRepBuilderAPI_MakeEdge(circle, begin, end).Edge()))


def _hole(gear: SpurGear) -> cq.Edge:
    return cq.Edge(BRepBuilderAPI_MakeEdge(_circle(gear, (0.0, 0.0), gear.bore / 2, up=-1.0)).Edge())
