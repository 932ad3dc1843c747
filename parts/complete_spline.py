"""Complete cubic splines as curves of OCC: through points, with given tangents at both ends."""

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import Geom_BSplineCurve
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array1OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from scipy.interpolate import make_interp_spline

Array = NDArray[np.float64]


def complete_spline(parameter: Array, points: Array, slopes: Array, level: float) -> Geom_BSplineCurve:
    """The spline in the plane z = level [mm] whose parameter is that of the points.

    Args:
        parameter: (n,), rising.
        points: (n, 2) [mm].
        slopes: (2, 2), dP/du at its first and its last point.
        level: [mm].
    """
    first, last = slopes
    spline = make_interp_spline(parameter, points, k=3, bc_type=([(1, first)], [(1, last)]))
    knots, multiplicities = np.unique(spline.t, return_counts=True)
    poles = TColgp_Array1OfPnt(1, len(spline.c))
    for index, (x, y) in enumerate(spline.c.tolist(), start=1):
        poles.SetValue(index, gp_Pnt(x, y, level))
    places, counts = TColStd_Array1OfReal(1, len(knots)), TColStd_Array1OfInteger(1, len(knots))
    for index, (knot, count) in enumerate(zip(knots.tolist(), multiplicities.tolist(), strict=True), start=1):
        places.SetValue(index, knot)
        counts.SetValue(index, count)
    return Geom_BSplineCurve(poles, places, counts, 3)
