"""Data read off a solid swept along z: its ruled faces, and one end with its rims as a closed mesh.

A solid that turns as it is swept, a helical gear's, has its mesh from its section swept straight, in turned layers.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.gp import gp_Pnt, gp_Vec
from OCP.TopAbs import TopAbs_REVERSED

from tol3d.cad.solids.lazy import Arrays
from tol3d.cad.solids.triangulation import DISPLAY_ANGLE, corners_of, edge_curve, largest_sagitta, mesh_of, nodes_of
from tol3d.numerics.arrays import Array
from tol3d.parts.named_solid import BACK, NamedSolid

VANISHING = 1e-6  # rad, |dS/du| over |d2S/du2|: the roll; nearer to the base circle the direction is the second's
LOOKED_AT = 2048  # steps along a face where its bend is looked at
STRAIGHT = 0.05  # of the mean share; least that a step gets


class RuledFace:
    """A face swept along z, seen as its profile over u, at mid-height; of a twisted one v is z."""

    def __init__(self, face: cq.Face) -> None:
        self._surface = BRepAdaptor_Surface(face.wrapped)
        self._middle = (self._surface.FirstVParameter() + self._surface.LastVParameter()) / 2
        self._outwards = -1.0 if face.wrapped.Orientation() == TopAbs_REVERSED else 1.0

    @property
    def ends(self) -> tuple[float, float]:
        """Its first and last parameter."""
        return self._surface.FirstUParameter(), self._surface.LastUParameter()

    def profile(self, u: Array) -> Array:
        """Points (n, 2) [mm] at those parameters."""
        points = (self._surface.Value(place, self._middle) for place in u.tolist())
        return np.array([(point.X(), point.Y()) for point in points])

    def normals(self, u: Array) -> Array:
        """Unit normals (n, 2) out of the solid: dS/du x dS/dv, turned as the face is.

        Where the parametrisation stands still (an involute at its base circle) the direction of
        dS/du is that of d2S/du2.
        """
        return np.array([self._normal(place) for place in u.tolist()])

    def places(self, u: Array, v: Array) -> Array:
        """Points (n, 3) [mm] at those parameters."""
        points = (self._surface.Value(*place) for place in zip(u.tolist(), v.tolist(), strict=True))
        return np.array([(point.X(), point.Y(), point.Z()) for point in points])

    def place_normals(self, u: Array, v: Array) -> Array:
        """Unit normals (n, 3) out of the solid there, as in `normals`."""
        each = (self._normal_at(*place) for place in zip(u.tolist(), v.tolist(), strict=True))
        return np.array([(normal.X(), normal.Y(), normal.Z()) for normal in each])

    def _normal(self, u: float) -> tuple[float, float]:
        normal = self._normal_at(u, self._middle)
        return normal.X(), normal.Y()

    def _normal_at(self, u: float, v: float) -> gp_Vec:
        point, along, across, bend = gp_Pnt(), gp_Vec(), gp_Vec(), gp_Vec()
        self._surface.D2(u, v, point, along, across, bend, gp_Vec(), gp_Vec())
        tangent = along if along.Magnitude() > VANISHING * bend.Magnitude() else bend
        return tangent.Crossed(across).Normalized().Multiplied(self._outwards)


def sample_faces(part: NamedSolid, faces: Sequence[str], steps: int) -> Arrays:
    """See tol3d.cad.solids.cad.sample_faces."""
    ruled = [RuledFace(part.faces[name]) for name in faces]
    parameters = [_evenly_bent(face, steps) for face in ruled]
    errors = (largest_sagitta(face.profile, u) for face, u in zip(ruled, parameters, strict=True))
    return {
        "parameter": np.stack(parameters),
        "points": np.stack([face.profile(u) for face, u in zip(ruled, parameters, strict=True)]),
        "normals": np.stack([face.normals(u) for face, u in zip(ruled, parameters, strict=True)]),
        "chord_error": np.array(max(errors)),
    }


def _evenly_bent(face: RuledFace, steps: int) -> Array:
    """Parameters (steps + 1,) from end to end of a face between which its profile leaves its chords by about as much.

    A step of length s and turn b leaves its chord by s b / 8: the root of s b is shared out. Where the profile is
    straight, at an inflection, a share of the whole keeps the steps finite.
    """
    u = np.linspace(*face.ends, LOOKED_AT + 1)
    points, normals = face.profile(u), face.normals(u)
    length = np.linalg.norm(np.diff(points, axis=0), axis=-1)
    turn = np.linalg.norm(np.diff(normals, axis=0), axis=-1)
    share = np.sqrt(length * turn)
    share += STRAIGHT * share.mean()
    passed = np.concatenate([[0.0], np.cumsum(share)])
    found = np.interp(np.linspace(0.0, passed[-1], steps + 1), passed, u)
    found[[0, -1]] = face.ends
    return np.asarray(found)


# display mesh ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rim:
    """The edge of the end below one face: numbers of its nodes, and its largest sagitta [mm]."""

    face: str
    nodes: NDArray[np.int64]
    chord_error: float


@dataclass(frozen=True, eq=False)
class SweptMesh:
    """OCC's triangulation of one end, and its rim swept to the other end.

    Args:
        vertices: (layers count, 3) [mm], from the lower end up.
        triangles: (m, 3).
        rims: below each face.
        count: vertices of an end.
        layers: ends of the steps along z, 2 of a straight sweep.
        twist_error: largest distance [mm] of the chords along z from their helices.
    """

    vertices: Array
    triangles: NDArray[np.int64]
    rims: Sequence[Rim]
    count: int
    layers: int = 2
    twist_error: float = 0.0

    def arrays(self, side: NDArray[np.int8]) -> Arrays:
        """Arrays of a DisplayMesh."""
        return {
            "vertices": self.vertices,
            "triangles": self.triangles,
            "side": side,
            "chord_error": np.array(max(rim.chord_error for rim in self.rims) + self.twist_error),
        }


def swept_mesh(part: NamedSolid, width: float, deflection: float, twist: float = 0.0) -> SweptMesh:
    """A closed mesh of a section swept from z = -width/2 to +width/2 [mm], turned by `twist` [rad/mm] on the way.

    OCC meshes faces of splines many times finer than asked for and slowly, though they are ruled along z
    and need nothing between their ends; swept from one end the mesh closes by construction. A twisted one has as many
    layers as keep the chords of its rim within the deflection [mm] of their helices.

    Args:
        part: the section swept straight.
        width, deflection, twist: see above.
    """
    nodes, triangles, rims = _triangulated_end(part, deflection)
    count = len(nodes)
    begin, end = _rim(triangles).T
    furthest = float(np.hypot(*nodes.T).max())
    steps = max(1, math.ceil(abs(twist) * width * math.sqrt(furthest / (8 * deflection))))
    heights = np.linspace(-width / 2, width / 2, steps + 1)
    vertices = np.concatenate([np.hstack([_turned(nodes, twist * z), np.full((count, 1), z)]) for z in heights])
    walls = np.concatenate(
        [np.stack(corners, axis=-1) + step * count for step in range(steps) for corners in _wall(begin, end, count)]
    )
    faces = np.concatenate([triangles[:, ::-1], triangles + steps * count, walls])
    twist_error = furthest * (twist * width / steps) ** 2 / 8
    return SweptMesh(vertices, faces, rims, count, steps + 1, twist_error)


def _turned(nodes: Array, angle: float) -> Array:
    """Points (n, 2) turned about the origin [rad]."""
    if angle == 0.0:
        return nodes
    cos, sin = math.cos(angle), math.sin(angle)
    return np.asarray(nodes @ np.array([[cos, sin], [-sin, cos]]))


def tessellate(part: NamedSolid, width: float, deflection: float) -> Arrays:
    """See tol3d.cad.solids.cad.tessellate; of a part that was swept."""
    mesh = swept_mesh(part, width, deflection)
    return mesh.arrays(np.zeros(2 * mesh.count, dtype=np.int8))


def _triangulated_end(part: NamedSolid, deflection: float) -> tuple[Array, NDArray[np.int64], list[Rim]]:
    """Nodes (n, 2) [mm], triangles (m, 3) counter-clockwise seen from +z, and rims of the face "back"."""
    back = part.faces[BACK]
    BRepMesh_IncrementalMesh(back.wrapped, deflection, False, DISPLAY_ANGLE)
    mesh, place = mesh_of(back)
    nodes, triangles = nodes_of(mesh)[:, :2], corners_of(mesh)
    face_of_edge = {edge: name for name, face in part.faces.items() if name != BACK for edge in face.Edges()}
    rims = []
    for edge in back.Edges():
        polygon = BRep_Tool.PolygonOnTriangulation_s(edge.wrapped, mesh, place)
        places = range(1, polygon.NbNodes() + 1)
        parameters = np.array([polygon.Parameter(index) for index in places])
        numbers = np.array([polygon.Node(index) for index in places]) - 1
        rims.append(Rim(face_of_edge[edge], numbers, largest_sagitta(edge_curve(edge), parameters)))
    return nodes, triangles, rims


def _rim(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Directed edges (k, 2) that belong to one triangle only."""
    edges = np.concatenate([triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    count = int(triangles.max()) + 1
    return edges[~np.isin(edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0])]


def _wall(begin: NDArray[np.int64], end: NDArray[np.int64], count: int) -> tuple[tuple[NDArray[np.int64], ...], ...]:
    return (begin, end, end + count), (begin, end + count, begin + count)
