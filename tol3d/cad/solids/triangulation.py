"""OCC's own triangulations and curves as arrays, and the distance of a polygon from its curve."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.Poly import Poly_Triangulation
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location

from tol3d.errors import GeometryError
from tol3d.numerics.arrays import Array
from tol3d.parts.named_solid import NamedSolid

Curve = Callable[[Array], Array]

DISPLAY_ANGLE = 0.5  # rad; coarsest turn between neighbouring facets, so that small bores still look round
JOINED_XTOL = 1e-5  # mm; nodes of two faces on one edge agree to OCC's 1e-7, others lie much further apart
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
    """A face's triangulation and its location; the solid must be triangulated."""
    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face.wrapped, place)
    if mesh is None:
        raise GeometryError("a face of the solid could not be triangulated")
    return mesh, place


def nodes_of(mesh: Poly_Triangulation) -> Array:
    """Its nodes (n, 3) [mm], in its own frame."""
    points = (mesh.Node(index) for index in range(1, mesh.NbNodes() + 1))
    return np.array([(point.X(), point.Y(), point.Z()) for point in points])


def corners_of(mesh: Poly_Triangulation) -> NDArray[np.int64]:
    """Indices (triangles, 3) of the nodes of each triangle."""
    return np.array([mesh.Triangle(index).Get() for index in range(1, mesh.NbTriangles() + 1)]) - 1


def edge_curve(edge: cq.Edge) -> Curve:
    """Points (n, 3) [mm] of an edge at its parameters."""
    adaptor = BRepAdaptor_Curve(edge.wrapped)

    def points_at(parameters: Array) -> Array:
        points = (adaptor.Value(place) for place in parameters.tolist())
        return np.array([(point.X(), point.Y(), point.Z()) for point in points])

    return points_at


# whole solids ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Triangulation:
    """All faces of a solid as triangles that share their vertices.

    Args:
        vertices: (n, 3) [mm].
        triangles: (m, 3) vertex numbers, turned outwards.
        on_face: numbers of the vertices on each face, by its name; faces share those on their edges.
        of_face: numbers of the triangles of each face, by its name.
    """

    vertices: Array
    triangles: NDArray[np.int64]
    on_face: Mapping[str, NDArray[np.int64]]
    of_face: Mapping[str, NDArray[np.int64]]


def triangulated(part: NamedSolid, deflection: float) -> Triangulation:
    """OCC's triangulations of all faces, joined along the edges that they share."""
    BRepMesh_IncrementalMesh(part.solid.wrapped, deflection, False, DISPLAY_ANGLE)
    pieces = {name: _triangulation(face) for name, face in part.faces.items()}
    vertices, joined = _joined(np.concatenate([nodes for nodes, _ in pieces.values()]))
    triangles, on_face, of_face, first, count = [], {}, {}, 0, 0
    for name, (nodes, corners) in pieces.items():
        on_face[name] = joined[first : first + len(nodes)]
        whole = _with_area(on_face[name][corners])
        of_face[name] = np.arange(count, count + len(whole))
        triangles.append(whole)
        first, count = first + len(nodes), count + len(whole)
    return Triangulation(vertices, np.concatenate(triangles), on_face, of_face)


def _triangulation(face: cq.Face) -> tuple[Array, NDArray[np.int64]]:
    """Nodes (n, 3) [mm], where the face lies, and triangles (m, 3) of a face, turned out of the solid."""
    mesh, place = mesh_of(face)
    corners = corners_of(mesh)
    nodes = nodes_of(mesh)
    if not place.IsIdentity():
        matrix = place.Transformation()
        solid_from_face = np.array([[matrix.Value(row, column) for column in range(1, 5)] for row in range(1, 4)])
        nodes = nodes @ solid_from_face[:, :3].T + solid_from_face[:, 3]
    return nodes, corners[:, ::-1] if face.wrapped.Orientation() == TopAbs_REVERSED else corners


def _joined(points: Array) -> tuple[Array, NDArray[np.int64]]:
    """Points without repetition, and the new number of each."""
    _, first, number = np.unique(
        np.round(points / JOINED_XTOL).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return points[first], number.ravel()


def _with_area(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Triangles of three vertices; at the pole of a sphere two of them may be one."""
    a, b, c = triangles.T
    return np.asarray(triangles[(a != b) & (b != c) & (c != a)])


def edge_sagittas(part: NamedSolid) -> Iterator[float]:
    """Largest sagitta [mm] of each curved edge's own polygon."""
    face_of_edge = {edge: face for face in part.faces.values() for edge in face.Edges()}
    for edge, face in face_of_edge.items():
        if edge.geomType() != "LINE":
            mesh, place = mesh_of(face)
            polygon = BRep_Tool.PolygonOnTriangulation_s(edge.wrapped, mesh, place)
            parameters = np.array([polygon.Parameter(index) for index in range(1, polygon.NbNodes() + 1)])
            yield largest_sagitta(edge_curve(edge), parameters)
