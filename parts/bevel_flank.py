"""Flanks of a bevel gear's solid: splines over q, ruled from the apex; and the same flanks read back."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface, Geom_Curve, Geom_Surface
from OCP.Geom2d import Geom2d_BSplineCurve, Geom2d_Curve
from OCP.gp import gp_Pnt, gp_Pnt2d, gp_Vec
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array1OfPnt2d, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from OCP.TopAbs import TopAbs_REVERSED
from scipy.interpolate import BSpline, make_interp_spline

from tol3d.gears import BevelGear, Flank
from tol3d.parts.bevel_cones import ENDS, End, EndCone
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.tooth_edges import CUBIC_SPLINE_CONSTANT, FEWEST_INTERVALS, flank_name

FLANK_ERROR = 1e-7  # mm; how far a spline flank may leave the involute, a hundredth of the 0.01 um asked for
VANISHING = 1e-6  # rad, |dS/du| over |d2S/du2|: nearer to the base cone the direction is the second's

Array = NDArray[np.float64]


def flank_intervals(gear: BevelGear) -> int:
    """Spline intervals over a flank, uniform in q, so that h^4 max|R g''''| 5/384 <= FLANK_ERROR.

    g is the direction. Off the axis it is the sum of two turning pointers, of length (1 - s)/2 and rate 1/s + 1, and
    (1 + s)/2 and 1/s - 1, s = sin(beta); fourth derivatives thus have the length of
    a e^(iq) - b e^(-iq) with a = (1 - s)(1/s + 1)^4/2, b = (1 + s)(1/s - 1)^4/2, largest at the tip; along the axis
    cos(beta) cos(q).
    """
    sin = math.sin(gear.base_angle)
    a, b = (1 - sin) * (1 / sin + 1) ** 4 / 2, (1 + sin) * (1 / sin - 1) ** 4 / 2
    around = math.sqrt(a * a + b * b - 2 * a * b * math.cos(2 * gear.tip_q))
    derivative = _longest(gear) * math.hypot(around, math.cos(gear.base_angle))
    longest = math.sqrt(math.sqrt(FLANK_ERROR / (CUBIC_SPLINE_CONSTANT * derivative)))
    return max(int(FEWEST_INTERVALS), math.ceil((gear.tip_q - gear.form_q) / longest))


def _longest(gear: BevelGear) -> float:
    """Distance [mm] from the apex of the flank's farthest corner, on the back cone."""
    lean = max(abs(gear.tip_angle - gear.pitch_angle), abs(gear.root_angle - gear.pitch_angle))
    return gear.outer_cone_distance / math.cos(lean)


@dataclass(frozen=True, eq=False)
class FlankSplines:
    """Complete cubic splines over q for a flank of tooth 0, all with the same knots.

    Args:
        direction: unit vectors from the apex, 3 columns.
        ends: of toe and heel, 6 columns: point [mm], then its distance from the apex [mm], azimuth, and v there.
    """

    direction: BSpline
    ends: Mapping[End, BSpline]


def flank_splines(gear: BevelGear, flank: Flank) -> FlankSplines:
    """The splines of one flank of tooth 0."""
    q = np.linspace(gear.form_q, gear.tip_q, flank_intervals(gear) + 1)
    direction = gear.flank_directions(q, flank)
    # dg/dq = sin q (e_r - sin(beta) t)/sin(beta): up the flank, in the tangent's meridian
    sin, cos = math.sin(gear.base_angle), math.cos(gear.base_angle)
    tangent = gear.flank_start(flank) + flank * q / sin
    up = np.stack([cos * np.cos(tangent), cos * np.sin(tangent), np.full_like(q, -sin)], axis=-1)
    slope = np.sin(q)[:, None] * up * cos / sin
    ends = {end: _end_curve(EndCone(gear, end), direction, slope) for end in ENDS}
    return FlankSplines(
        direction=_complete_spline(q, direction, slope),
        ends={end: _complete_spline(q, *curve) for end, curve in ends.items()},
    )


def _complete_spline(q: Array, values: Array, slopes: Array) -> BSpline:
    return make_interp_spline(q, values, k=3, bc_type=([(1, slopes[0])], [(1, slopes[-1])]))


def _end_curve(cone: EndCone, direction: Array, slope: Array) -> tuple[Array, Array]:
    """Points where the directions g meet front or back cone, six columns as in FlankSplines, and their slopes.

    With f = g . (pitch line of its own meridian), the point is g R/f, and v = R (g . line across it)/f.
    """
    sin, cos = math.sin(cone.gear.pitch_angle), math.cos(cone.gear.pitch_angle)
    (x, y, z), (dx, dy, dz) = direction.T, slope.T
    radius = np.hypot(x, y)
    d_radius = (x * dx + y * dy) / radius
    along, d_along = z * cos + radius * sin, dz * cos + d_radius * sin
    across, d_across = radius * cos - z * sin, d_radius * cos - dz * sin
    reach, d_reach = cone.distance / along, -cone.distance * d_along / along**2
    values = [*(direction.T * reach), reach, np.arctan2(y, x), across * reach]
    slopes = [
        *(slope.T * reach + direction.T * d_reach),
        d_reach,
        (x * dy - y * dx) / radius**2,
        d_across * reach + across * d_reach,
    ]
    return np.stack(values, axis=-1), np.stack(slopes, axis=-1)


def _knots(spline: BSpline) -> tuple[TColStd_Array1OfReal, TColStd_Array1OfInteger]:
    places, multiplicities = np.unique(spline.t, return_counts=True)
    knots, counts = TColStd_Array1OfReal(1, len(places)), TColStd_Array1OfInteger(1, len(places))
    for index, (place, count) in enumerate(zip(places.tolist(), multiplicities.tolist(), strict=True), start=1):
        knots.SetValue(index, place)
        counts.SetValue(index, count)
    return knots, counts


def _turned(points: Array, angle: float) -> Array:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.asarray(points @ np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]), dtype=np.float64)


def curve(spline: BSpline, angle: float) -> Geom_Curve:
    """The spline's first three columns, turned about the axis."""
    points = _turned(spline.c[:, :3], angle)
    poles = TColgp_Array1OfPnt(1, len(points))
    for index, point in enumerate(points.tolist(), start=1):
        poles.SetValue(index, gp_Pnt(*point))
    return Geom_BSplineCurve(poles, *_knots(spline), 3)


def trace(spline: BSpline, u: Array, v: Array) -> Geom2d_Curve:
    """The same spline on a surface, by its coefficients in u and v."""
    poles = TColgp_Array1OfPnt2d(1, len(u))
    for index, place in enumerate(zip(u.tolist(), v.tolist(), strict=True), start=1):
        poles.SetValue(index, gp_Pnt2d(*place))
    return Geom2d_BSplineCurve(poles, *_knots(spline), 3)


def greville(spline: BSpline) -> Array:
    """Coefficients of q itself in that spline: means of three knots."""
    return np.asarray((spline.t[1:-3] + spline.t[2:-2] + spline.t[3:-1]) / 3, dtype=np.float64)


def ruled(spline: BSpline, angle: float, reaches: Sequence[float]) -> Geom_Surface:
    """v times the direction at u, turned about the axis."""
    points = _turned(spline.c, angle)
    poles = TColgp_Array2OfPnt(1, len(points), 1, 2)
    ends, twice = TColStd_Array1OfReal(1, 2), TColStd_Array1OfInteger(1, 2)
    for column, reach in enumerate(reaches, start=1):
        ends.SetValue(column, reach)
        twice.SetValue(column, 2)
        for row, point in enumerate((points * reach).tolist(), start=1):
            poles.SetValue(row, column, gp_Pnt(*point))
    knots, counts = _knots(spline)
    return Geom_BSplineSurface(poles, knots, ends, counts, twice, 3, 1)


@dataclass(frozen=True, eq=False)
class FlankSample:
    """Rays of a flank's face: unit vectors from the apex, and normals out of the tooth, each (n, 3)."""

    directions: Array
    normals: Array


def sample_flank(part: NamedSolid, tooth: int, flank: Flank, q: Array) -> FlankSample:
    """Directions and normals of the named flank's own face at in-plane angles q [rad], form_q <= q <= tip_q.

    The face is ruled from the apex, so a ray stands for its whole length: the flank between two cone distances is
    those distances times the direction. Where the parametrisation stands still (q = 0, on the base cone) the
    direction of dS/dq is that of d2S/dq2.
    """
    face = part.faces[flank_name(tooth, flank)].wrapped
    surface = BRepAdaptor_Surface(face)
    reach = surface.FirstVParameter()
    turned = -1.0 if face.Orientation() == TopAbs_REVERSED else 1.0
    directions, normals = [], []
    for place in q.tolist():
        point, along, across, bend = gp_Pnt(), gp_Vec(), gp_Vec(), gp_Vec()
        surface.D2(place, reach, point, along, across, bend, gp_Vec(), gp_Vec())
        tangent = along if along.Magnitude() > VANISHING * bend.Magnitude() else bend
        ray, normal = gp_Vec(point.XYZ()).Normalized(), tangent.Crossed(across).Normalized().Multiplied(turned)
        directions.append((ray.X(), ray.Y(), ray.Z()))
        normals.append((normal.X(), normal.Y(), normal.Z()))
    return FlankSample(np.array(directions), np.array(normals))
