"""What is read off CadQuery solids: flank samples, tessellation, STEP. Import it through tol3d.solids.door."""

import itertools
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.gp import gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location

from tol3d.errors import GeometryError, RunError
from tol3d.gears import LEFT, RIGHT, SpurGear
from tol3d.parts.named_solid import BACK, NamedSolid
from tol3d.parts.spur_gear import SIDES, build, flank_name
from tol3d.solids.door import Arrays
from tol3d.solids.posed_gear import PosedGear

Array = NDArray[np.float64]
Curve = Callable[[Array], Array]

SAGITTA_SAMPLES = 16  # places between two points where the distance to their chord is taken
SAGITTA_MARGIN = 1.01  # half a place off, an arc's maximum reads 0.4 % low, an involute's at its base circle 0.7 %
VANISHING = 1e-6  # rad, |dS/du| over |d2S/du2|: the roll; nearer to the base circle the direction is the second's
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
    """Arrays of DisplayMesh: OCC's triangulation of one end, and its rim swept to the other end.

    OCC meshes flank faces many times finer than asked for and slowly, though they are ruled along z
    and need nothing between their ends; swept from one end the mesh closes by construction.

    Raises:
        GeometryError: OCC could not triangulate the end.
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
    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(back.wrapped, place)
    if mesh is None:
        raise GeometryError(f"the end of the gear could not be triangulated at {deflection:g} mm")
    points = (mesh.Node(index) for index in range(1, mesh.NbNodes() + 1))
    nodes = np.array([(point.X(), point.Y()) for point in points])
    triangles = np.array([mesh.Triangle(index).Get() for index in range(1, mesh.NbTriangles() + 1)]) - 1
    face_of_edge = {edge: name for name, face in part.faces.items() if name != BACK for edge in face.Edges()}
    rims = []
    for edge in back.Edges():
        polygon = BRep_Tool.PolygonOnTriangulation_s(edge.wrapped, mesh, place)
        places = range(1, polygon.NbNodes() + 1)
        parameters = np.array([polygon.Parameter(index) for index in places])
        numbers = np.array([polygon.Node(index) for index in places]) - 1
        rims.append(_Rim(face_of_edge[edge], numbers, largest_sagitta(_curve(edge), parameters)))
    return nodes, triangles, rims


def _curve(edge: cq.Edge) -> Curve:
    adaptor = BRepAdaptor_Curve(edge.wrapped)

    def points_at(parameters: Array) -> Array:
        points = (adaptor.Value(place) for place in parameters.tolist())
        return np.array([(point.X(), point.Y()) for point in points])

    return points_at


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


# STEP -----------------------------------------------------------------------------------------------


def write_step(parts: Sequence[PosedGear], path: Path) -> None:
    """See tol3d.solids.export_step."""
    assembly = cq.Assembly(name=f"assembly: {path.stem}")  # no part is called so: their names hold no colon
    for part, colour in zip(parts, itertools.cycle(COLOURS), strict=False):
        place = _location(part.world_from_part)
        assembly.add(build(part.gear).solid, name=_part21(part.name), loc=place, color=cq.Color(colour))
    unfinished = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        assembly.export(str(unfinished), exportType="STEP")
        os.replace(unfinished, path)
    except OSError as error:
        raise RunError(f"{path}: the STEP file cannot be written ({error.strerror})") from error
    finally:
        unfinished.unlink(missing_ok=True)


def _part21(text: str) -> str:
    """Text in the ASCII escapes of ISO 10303-21, 6.4.3; CadQuery would hand OCC UTF-8 as if it were Latin-1."""
    return "".join(letter if letter.isascii() else _part21_letter(letter) for letter in text)


def _part21_letter(letter: str) -> str:
    if ord(letter) > 0xFFFF:
        return f"\\X4\\{ord(letter):08X}\\X0\\"
    return f"\\X2\\{ord(letter):04X}\\X0\\"


def _location(world_from_part: Array) -> cq.Location:
    transform = gp_Trsf()
    transform.SetValues(*world_from_part[:3].ravel().tolist())
    return cq.Location(transform)
