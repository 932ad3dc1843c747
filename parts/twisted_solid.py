"""A CAD solid swept along z while its outline turns: gears with screw teeth, whose faces are exact but for a spline.

A point (x, y) of the outline runs on a helix, (x cos(kappa z) - y sin(kappa z), x sin(kappa z) + y cos(kappa z), z).
Cosine and sine are complete cubic splines of z, so that every face is a tensor product of its edge and these two: along
the edge it is as exact as that, and neighbouring faces share their helices to the last bit. A sweep of OCC along an
auxiliary helix is 20 um off. Whole circles about the axis, a bore and a rim, are swept straight: to cylinders.
"""

import math
from collections.abc import Sequence
from itertools import chain
from typing import Final

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_Sewing,
    BRepBuilderAPI_Transform,
)
from OCP.BRepLib import BRepLib
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface, Geom_TrimmedCurve
from OCP.GeomConvert import GeomConvert
from OCP.gp import gp_Ax1, gp_Dir, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal
from OCP.TopAbs import TopAbs_SHELL
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Wire
from scipy.interpolate import BSpline, make_interp_spline

from tol3d.errors import GeometryError
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.parts.named_solid import BACK, FRONT, NamedEdge, NamedSolid, extruded, wire_of

Array = NDArray[np.float64]

TWIST_ERROR: Final = 1e-7  # mm; how far the splines of cosine and sine may leave a point of the outline's rim
CUBIC_SPLINE_CONSTANT: Final = 5 / 384  # of h^4 max|P''''|, as in tooth_edges
FEWEST_INTERVALS: Final = 4
SEWN_WITHIN: Final = 1e-6  # mm; faces share their edges to rounding
DEGREE: Final = 3


def swept(gear: CylindricalGear, outline: Sequence[NamedEdge], holes: Sequence[Sequence[NamedEdge]]) -> NamedSolid:
    """A gear's transverse section swept along its face: straight along z, that of a helical gear along its helices.

    Args:
        gear: whose section it is.
        outline, holes: as in named_solid.extruded.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    if gear.helix_angle:
        return twisted(outline, holes, gear.face_width, gear.twist)
    return extruded(outline, holes, gear.face_width)


def twisted(
    outline: Sequence[NamedEdge], holes: Sequence[Sequence[NamedEdge]], width: float, twist: float
) -> NamedSolid:
    """Sweep an outline along +z, from z = -width/2 to +width/2 [mm], while it turns by `twist` [rad/mm].

    It is as drawn in the middle, at z = 0. Names are those of the edges, and of the ends as in named_solid.extruded.

    Args:
        outline: edges in order, counter-clockwise seen from +z, in the plane z = -width/2; one alone is a circle about
            the axis.
        holes: edges of each hole, clockwise, in that plane, likewise.
        width: along z [mm].
        twist: positive turns the upper end counter-clockwise.

    Raises:
        GeometryError: no valid solid comes of it.
    """
    wires = [outline, *holes]
    turns = _turns(outline, width, twist)
    lower, upper = (_end(wires, width, twist, end) for end in (-0.5, 0.5))
    named = [(own.name, _swept_face(own, turns)) for own in chain(*(wire for wire in wires if len(wire) > 1))]
    named += [(wire[0].name, _cylinder(wire[0], width)) for wire in wires if len(wire) == 1]
    named += [(BACK, lower), (FRONT, upper)]
    sewing = BRepBuilderAPI_Sewing(SEWN_WITHIN)
    for _, face in named:
        sewing.Add(face)
    sewing.Perform()
    shells = TopExp_Explorer(sewing.SewedShape(), TopAbs_SHELL)
    if not shells.More() or sewing.NbFreeEdges():
        raise GeometryError("the faces of the twisted part do not close into one solid")
    made = BRepBuilderAPI_MakeSolid(TopoDS.Shell_s(shells.Current())).Solid()
    BRepLib.OrientClosedSolid_s(made)
    solid = cq.Solid(made)
    if not solid.isValid():
        raise GeometryError("the outline of the twisted part crosses itself: its solid is not valid")
    outward = {face: face for face in solid.Faces()}
    return NamedSolid(solid, {name: outward[cq.Face(sewing.ModifiedSubShape(face))] for name, face in named})


class _Turns:
    """Cosine, sine and height along the axis as one cubic spline: knots and its coefficients."""

    def __init__(self, width: float, twist: float, intervals: int) -> None:
        z = np.linspace(-width / 2, width / 2, intervals + 1)
        values = np.stack([np.cos(twist * z), np.sin(twist * z), z], axis=-1)
        first, last = (np.array([-twist * np.sin(twist * end), twist * np.cos(twist * end), 1.0]) for end in z[[0, -1]])
        spline: BSpline = make_interp_spline(z, values, k=DEGREE, bc_type=([(1, first)], [(1, last)]))
        self.cosines, self.sines, self.heights = spline.c.T.tolist()
        self.knots, self.counts = (own.tolist() for own in np.unique(spline.t, return_counts=True))


def _turns(outline: Sequence[NamedEdge], width: float, twist: float) -> _Turns:
    """As many intervals of z as keep the rim of the outline within TWIST_ERROR of its helix."""
    furthest = max(math.hypot(*edge.edge.endPoint().toTuple()[:2]) for edge in outline)
    fourth_derivative = furthest * twist**4
    longest = (TWIST_ERROR / (CUBIC_SPLINE_CONSTANT * fourth_derivative)) ** 0.25
    return _Turns(width, twist, max(FEWEST_INTERVALS, math.ceil(width / longest)))


def _curve(named: NamedEdge) -> Geom_BSplineCurve:
    """An edge of an outline as a spline with the same parameter, but for circles, which are rational ones."""
    first, last = BRep_Tool.Range_s(named.edge.wrapped)
    curve = BRep_Tool.Curve_s(named.edge.wrapped, 0.0, 0.0)
    return GeomConvert.CurveToBSplineCurve_s(Geom_TrimmedCurve(curve, first, last))


def _swept_face(named: NamedEdge, turns: _Turns) -> TopoDS_Face:
    """The face that an edge sweeps: u along it, v = z."""
    curve = _curve(named)
    count, heights = curve.NbPoles(), len(turns.heights)
    poles, weights = TColgp_Array2OfPnt(1, count, 1, heights), TColStd_Array2OfReal(1, count, 1, heights)
    for i in range(1, count + 1):
        pole, weight = curve.Pole(i), curve.Weight(i)
        x, y = pole.X(), pole.Y()
        for j, (cos, sin, z) in enumerate(zip(turns.cosines, turns.sines, turns.heights, strict=True), start=1):
            poles.SetValue(i, j, gp_Pnt(cos * x - sin * y, sin * x + cos * y, z))
            weights.SetValue(i, j, weight)
    along = [curve.Knot(k) for k in range(1, curve.NbKnots() + 1)]
    along_counts = [curve.Multiplicity(k) for k in range(1, curve.NbKnots() + 1)]
    surface = Geom_BSplineSurface(
        poles,
        weights,
        _reals(along),
        _reals(turns.knots),
        _integers(along_counts),
        _integers(turns.counts),
        curve.Degree(),
        DEGREE,
        False,
        False,
    )
    return BRepBuilderAPI_MakeFace(surface, SEWN_WITHIN).Face()


def _cylinder(named: NamedEdge, width: float) -> TopoDS_Face:
    """The face that a circle about the axis sweeps straight along z."""
    return TopoDS.Face_s(BRepPrimAPI_MakePrism(named.edge.wrapped, gp_Vec(0.0, 0.0, width)).Shape())


def _end(wires: Sequence[Sequence[NamedEdge]], width: float, twist: float, end: float) -> TopoDS_Face:
    """The plane end of a solid at z = end times its width, from the wires at its lower one."""
    turn, lift = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), twist * width * end)
    lift.SetTranslation(gp_Vec(0.0, 0.0, (end + 0.5) * width))
    turned = lift.Multiplied(turn)
    outline, *holes = (_moved(wire_of(wire), turned if len(wire) > 1 else lift) for wire in wires)
    plane = gp_Pln(gp_Pnt(0.0, 0.0, width * end), gp_Dir(0.0, 0.0, 1.0))
    face = BRepBuilderAPI_MakeFace(plane, outline, True)
    for hole in holes:
        face.Add(hole)
    if not face.IsDone():
        raise GeometryError("the outline of the part does not close into one face")
    return face.Face()


def _moved(wire: TopoDS_Wire, moved: gp_Trsf) -> TopoDS_Wire:
    return TopoDS.Wire_s(BRepBuilderAPI_Transform(wire, moved, True).Shape())


def _reals(values: Sequence[float]) -> TColStd_Array1OfReal:
    found = TColStd_Array1OfReal(1, len(values))
    for index, value in enumerate(values, start=1):
        found.SetValue(index, value)
    return found


def _integers(values: Sequence[int]) -> TColStd_Array1OfInteger:
    found = TColStd_Array1OfInteger(1, len(values))
    for index, value in enumerate(values, start=1):
        found.SetValue(index, int(value))
    return found
