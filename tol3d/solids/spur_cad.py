"""What is read off the solid of a spur gear, external or internal: flanks swept along z, one end with its rims."""

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

from tol3d.gears import LEFT, RIGHT, InternalGear, SpurGear
from tol3d.parts import internal_gear, spur_gear
from tol3d.parts.named_solid import BACK, NamedSolid
from tol3d.parts.tooth_edges import SIDES, flank_name, roll_span
from tol3d.solids.lazy import Arrays
from tol3d.solids.triangulation import DISPLAY_ANGLE, corners_of, edge_curve, largest_sagitta, mesh_of, nodes_of

Array = NDArray[np.float64]

MOST_TEETH = 500  # of a gear that is built whole for its strips: 15 s; each further one 0.03 s and 0.2 MB
VANISHING = 1e-6  # rad, |dS/du| over |d2S/du2|: the roll; nearer to the base circle the direction is the second's


# measuring strips -----------------------------------------------------------------------------------


def sample_flanks(gear: SpurGear | InternalGear, steps: int) -> Arrays:
    """See cad.sample_flanks."""
    part = build(gear) if gear.teeth <= MOST_TEETH else _build_tooth(gear)
    first, last = roll_span(gear)
    roll = np.linspace(first**1.5, last**1.5, steps + 1) ** (2 / 3)
    roll[[0, -1]] = first, last
    faces = {flank: _Ruled(part.faces[flank_name(0, flank)]) for flank in (RIGHT, LEFT)}
    profile = np.stack([face.profile(roll) for face in faces.values()])
    involute = np.stack([gear.flank_points(roll, flank) for flank in faces])
    normals = np.stack([face.normals(roll) for face in faces.values()])
    return {
        "parameter": roll,
        "inner": _at_height(profile, -gear.face_width / 2),
        "outer": _at_height(profile, gear.face_width / 2),
        "normals": _at_height(normals, 0.0),
        "chord_error": np.array(max(largest_sagitta(face.profile, roll) for face in faces.values())),
        "flank_error": np.array(np.hypot(*(profile - involute).T).max()),
    }


def build(gear: SpurGear | InternalGear) -> NamedSolid:
    """The whole gear."""
    return internal_gear.build(gear) if isinstance(gear, InternalGear) else spur_gear.build(gear)


def _build_tooth(gear: SpurGear | InternalGear) -> NamedSolid:
    return internal_gear.build_tooth(gear) if isinstance(gear, InternalGear) else spur_gear.build_tooth(gear)


def _at_height(plane: Array, z: float) -> Array:
    return np.concatenate([plane, np.full((*plane.shape[:-1], 1), z)], axis=-1)


class _Ruled:
    """A face swept along z, seen as its profile over u, at mid-height."""

    def __init__(self, face: cq.Face) -> None:
        self._surface = BRepAdaptor_Surface(face.wrapped)
        self._middle = (self._surface.FirstVParameter() + self._surface.LastVParameter()) / 2
        self._outwards = -1.0 if face.wrapped.Orientation() == TopAbs_REVERSED else 1.0

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

    def _normal(self, u: float) -> tuple[float, float]:
        point, along, across, bend = gp_Pnt(), gp_Vec(), gp_Vec(), gp_Vec()
        self._surface.D2(u, self._middle, point, along, across, bend, gp_Vec(), gp_Vec())
        tangent = along if along.Magnitude() > VANISHING * bend.Magnitude() else bend
        normal = tangent.Crossed(across).Normalized().Multiplied(self._outwards)
        return normal.X(), normal.Y()


# display mesh ---------------------------------------------------------------------------------------


def tessellate(gear: SpurGear | InternalGear, deflection: float) -> Arrays:
    """OCC's triangulation of one end, and its rim swept to the other end.

    OCC meshes flank faces many times finer than asked for and slowly, though they are ruled along z
    and need nothing between their ends; swept from one end the mesh closes by construction.
    """
    part = build(gear)
    nodes, triangles, rims = _triangulated_end(part, deflection)
    count = len(nodes)
    begin, end = _rim(triangles).T
    walls = np.concatenate([np.stack(corners, axis=-1) for corners in _wall(begin, end, count)])
    height = np.full((count, 1), gear.face_width / 2)
    return {
        "vertices": np.concatenate([np.hstack([nodes, -height]), np.hstack([nodes, height])]),
        "triangles": np.concatenate([triangles[:, ::-1], triangles + count, walls]),
        "side": np.tile(_sides(rims, count), 2),
        "chord_error": np.array(max(rim.chord_error for rim in rims)),
    }


@dataclass(frozen=True)
class _Rim:
    """The edge of the end below one face: numbers of its nodes, and its largest sagitta [mm]."""

    face: str
    nodes: NDArray[np.int64]
    chord_error: float


def _triangulated_end(part: NamedSolid, deflection: float) -> tuple[Array, NDArray[np.int64], list[_Rim]]:
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
        rims.append(_Rim(face_of_edge[edge], numbers, largest_sagitta(edge_curve(edge), parameters)))
    return nodes, triangles, rims


def _rim(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Directed edges (k, 2) that belong to one triangle only."""
    edges = np.concatenate([triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    count = int(triangles.max()) + 1
    return edges[~np.isin(edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0])]


def _wall(begin: NDArray[np.int64], end: NDArray[np.int64], count: int) -> tuple[tuple[NDArray[np.int64], ...], ...]:
    return (begin, end, end + count), (begin, end + count, begin + count)


def _sides(rims: Sequence[_Rim], count: int) -> NDArray[np.int8]:
    """RIGHT, LEFT or 0 for each node; where a full round joins two teeth its lowest point turns with neither."""
    touched = {flank: np.zeros(count, dtype=np.int8) for flank in (RIGHT, LEFT)}
    for rim in rims:
        words = rim.face.split()
        for flank, side in SIDES.items():
            if side in words:
                touched[flank][rim.nodes] = 1
    return touched[RIGHT] - touched[LEFT]
