"""OCC's own triangulations and curves as arrays, and how far a polygon leaves its curve."""

from collections.abc import Callable

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.Poly import Poly_Triangulation
from OCP.TopLoc import TopLoc_Location

from tol3d.errors import GeometryError

Array = NDArray[np.float64]
Curve = Callable[[Array], Array]

DISPLAY_ANGLE = 0.5  # rad; coarsest turn between neighbouring facets, so that small bores still look round
SAGITTA_SAMPLES = 16  # places between two points where the distance to their chord is taken
SAGITTA_MARGIN = 1.01  # half a place off, an arc's maximum reads 0.4 % low, an involute's at its base circle 0.7 %


def largest_sagitta(curve: Curve, parameters: Array) -> float:
    """Largest distance [mm] between a curve and its polyline through those parameters, not below the truth."""
    inner = np.arange(1, SAGITTA_SAMPLES) / SAGITTA_SAMPLES
    begin, end = curve(parameters[:-1]), curve(parameters[1:])
    places = parameters[:-1, None] + np.diff(parameters)[:, None] * inner
    off = curve(places.ravel()).reshape(*places.shape, begin.shape[1]) - begin[:, None]
    chord = ((end - begin) / np.linalg.norm(end - begin, axis=1, keepdims=True))[:, None]
    distance = np.linalg.norm(off - (off * chord).sum(axis=-1, keepdims=True) * chord, axis=-1)
    return float(distance.max()) * SAGITTA_MARGIN


def mesh_of(face: cq.Face) -> tuple[Poly_Triangulation, TopLoc_Location]:
    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face.wrapped, place)
    if mesh is None:
        raise GeometryError("a face of the gear could not be triangulated")
    return mesh, place


def nodes_of(mesh: Poly_Triangulation) -> Array:
    points = (mesh.Node(index) for index in range(1, mesh.NbNodes() + 1))
    return np.array([(point.X(), point.Y(), point.Z()) for point in points])


def corners_of(mesh: Poly_Triangulation) -> NDArray[np.int64]:
    return np.array([mesh.Triangle(index).Get() for index in range(1, mesh.NbTriangles() + 1)]) - 1


def edge_curve(edge: cq.Edge) -> Curve:
    """Points (n, 3) [mm] of an edge at its parameters."""
    adaptor = BRepAdaptor_Curve(edge.wrapped)

    def points_at(parameters: Array) -> Array:
        points = (adaptor.Value(place) for place in parameters.tolist())
        return np.array([(point.X(), point.Y(), point.Z()) for point in points])

    return points_at
