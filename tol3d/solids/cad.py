"""What is read off CadQuery solids: flank samples, tessellation, STEP. Import it through tol3d.solids.door."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.gp import gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tol3d.errors import GeometryError, RunError
from tol3d.gears import LEFT, RIGHT, Flank, SpurGear
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.spur_gear import build, flank_name
from tol3d.solids.door import Arrays, Posed

Array = NDArray[np.float64]
Curve = Callable[[Array], Array]

SAGITTA_SAMPLES = 16  # places between two points where the distance to their chord is taken
SAGITTA_MARGIN = 1 / (1 - 1 / SAGITTA_SAMPLES**2)  # an arc's maximum may lie half a place beside a sample
VANISHING = 1e-2  # mm/rad of first over second derivative [rad]; nearer to the base circle take the second
SAME_NODE = 1e-7  # mm; OCC's point tolerance: nodes of neighbouring faces closer than this are one
DISPLAY_ANGLE = 0.5  # rad; coarsest turn between neighbouring facets, so that small bores still look round
COLOURS = ("steelblue", "darkorange", "seagreen", "goldenrod", "slategray", "indianred")


# measuring strips -----------------------------------------------------------------------------------


def sample_flanks(gear: SpurGear, steps: int) -> Arrays:
    """Arrays of FlankStrips, read off the faces "tooth 0 right flank" and "tooth 0 left flank".

    Returns:
        roll (steps + 1,), profile and normals (2, steps + 1, 2) for RIGHT and LEFT, chord_error, flank_error.
    """
    part = build(gear)
    roll = np.linspace(gear.form_roll**1.5, gear.tip_roll**1.5, steps + 1) ** (2 / 3)
    roll[[0, -1]] = gear.form_roll, gear.tip_roll
    faces = {flank: _Ruled(part.faces[flank_name(0, flank)]) for flank in (RIGHT, LEFT)}
    profile = np.stack([face.profile(roll) for face in faces.values()])
    involute = np.stack([gear.flank_points(roll, flank) for flank in faces])
    return {
        "roll": roll,
        "profile": profile,
        "normals": np.stack([face.normals(roll) for face in faces.values()]),
        "chord_error": np.array(max(largest_sagitta(face.profile, roll) for face in faces.values())),
        "flank_error": np.array(np.hypot(*(profile - involute).T).max()),
    }


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


def largest_sagitta(curve: Curve, parameters: Array) -> float:
    """Largest distance [mm] between a plane curve and its polyline through those parameters, not below the truth."""
    inner = np.arange(1, SAGITTA_SAMPLES) / SAGITTA_SAMPLES
    begin, end = curve(parameters[:-1]), curve(parameters[1:])
    places = parameters[:-1, None] + np.diff(parameters)[:, None] * inner
    off = curve(places.ravel()).reshape(*places.shape, 2) - begin[:, None]
    chord = (end - begin) / np.linalg.norm(end - begin, axis=1, keepdims=True)
    distance = np.abs(off[..., 0] * chord[:, None, 1] - off[..., 1] * chord[:, None, 0])
    return float(distance.max()) * SAGITTA_MARGIN


# display mesh ---------------------------------------------------------------------------------------


def tessellate(gear: SpurGear, deflection: float) -> Arrays:
    """Arrays of DisplayMesh: OCC's triangulation of every face, with the nodes that faces share made one.

    Raises:
        GeometryError: the triangles do not close (OCC left a face out).
    """
    part = build(gear)
    BRepMesh_IncrementalMesh(part.solid.wrapped, deflection, False, DISPLAY_ANGLE, True)
    nodes, triangles, sides, chord_error, count = [], [], [], 0.0, 0
    for name, face in part.faces.items():
        mesh = BRep_Tool.Triangulation_s(face.wrapped, TopLoc_Location())
        if mesh is None:
            raise GeometryError(f"the face {name!r} could not be triangulated at {deflection:g} mm")
        corners = np.array([mesh.Triangle(index).Get() for index in range(1, mesh.NbTriangles() + 1)]) - 1
        points = (mesh.Node(index) for index in range(1, mesh.NbNodes() + 1))
        if face.wrapped.Orientation() == TopAbs_REVERSED:
            corners = corners[:, ::-1]
        triangles.append(corners + count)
        nodes.append(np.array([(point.X(), point.Y(), point.Z()) for point in points]))
        sides.append(np.full(len(nodes[-1]), _side(name), dtype=np.int8))
        count += len(nodes[-1])
        if face.geomType() != "PLANE":
            u = np.array([mesh.UVNode(index).X() for index in range(1, mesh.NbNodes() + 1)])
            chord_error = max(chord_error, _spanned_sagitta(face, u[corners]))
    return _joined(np.concatenate(nodes), np.concatenate(triangles), np.concatenate(sides)) | {
        "chord_error": np.array(chord_error)
    }


def _side(name: str) -> int:
    if name.startswith("tooth"):
        words = name.split()
        return RIGHT if "right" in words else LEFT if "left" in words else 0
    return 0


def _spanned_sagitta(face: cq.Face, u: Array) -> float:
    """Bound on the distance between a face swept along z and its triangles, whose corners have those u (m, 3).

    Seen along z a triangle lies within the chord of its outermost u, hence within that chord's sagitta.
    """
    spans = np.unique(np.stack([u.min(axis=1), u.max(axis=1)], axis=-1).round(9), axis=0)
    profile = _Ruled(face).profile
    return max(largest_sagitta(profile, span) for span in spans[spans[:, 1] > spans[:, 0]])


def _joined(nodes: Array, triangles: NDArray[np.int64], sides: NDArray[np.int8]) -> Arrays:
    pairs = cKDTree(nodes).query_pairs(SAME_NODE, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(nodes), len(nodes)))
    count, joint = connected_components(graph, directed=False)
    vertices = np.empty((count, 3))
    vertices[joint[::-1]] = nodes[::-1]
    touched: dict[Flank, NDArray[np.bool_]] = {}
    for flank in (RIGHT, LEFT):
        touched[flank] = np.zeros(count, dtype=bool)
        touched[flank][joint[sides == flank]] = True
    # a full round joins two teeth at its lowest point, which then turns with neither
    side = touched[RIGHT].astype(np.int8) - touched[LEFT].astype(np.int8)
    corners = joint[triangles].astype(np.int64)
    proper = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    _refuse_open(corners[proper], count)
    return {"vertices": vertices, "triangles": corners[proper], "side": side}


def _refuse_open(triangles: NDArray[np.int64], count: int) -> None:
    edges = np.concatenate([triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    forwards, backwards = (np.sort(edges[:, a] * count + edges[:, b]) for a, b in ((0, 1), (1, 0)))
    if not np.array_equal(forwards, backwards) or len(np.unique(forwards)) != len(forwards):
        raise GeometryError("the display mesh does not close; try another deflection")


# STEP -----------------------------------------------------------------------------------------------


def write_step(parts: Sequence[Posed], path: Path) -> None:
    """See tol3d.solids.export_step."""
    assembly = cq.Assembly(name=path.stem)
    solids: dict[SpurGear, NamedSolid] = {}
    for index, part in enumerate(parts):
        solid = solids.setdefault(part.gear, solids.get(part.gear) or build(part.gear))
        colour = cq.Color(COLOURS[index % len(COLOURS)])
        assembly.add(solid.solid, name=part.name, loc=_location(part.world_from_part), color=colour)
    unfinished = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        assembly.export(str(unfinished), exportType="STEP")
        os.replace(unfinished, path)
    except OSError as error:
        raise RunError(f"{path}: the STEP file cannot be written ({error.strerror})") from error
    finally:
        unfinished.unlink(missing_ok=True)


def _location(world_from_part: Array) -> cq.Location:
    transform = gp_Trsf()
    transform.SetValues(*world_from_part[:3].ravel().tolist())
    return cq.Location(transform)
