"""Foreign STEP files read by Open CASCADE: run in a process of its own, never imported by the one that simulates.

What it hands over is data: a JSON file of the faces and their edges, and meshes as arrays. Every shape is taken by its
entity in the file, so each stands in the frame of its own product, and each face is known by its `#id`.
"""

import json
import math
import sys
from collections.abc import Iterator, Sequence, Set
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.GeomAbs import (
    GeomAbs_Circle,
    GeomAbs_Cone,
    GeomAbs_Cylinder,
    GeomAbs_Ellipse,
    GeomAbs_Line,
    GeomAbs_Plane,
    GeomAbs_Sphere,
    GeomAbs_Torus,
)
from OCP.gp import gp_Pnt, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_ShapeEnum, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape

from tol3d.cad.step.limits import limit_this_process
from tol3d.cad.step.recognised import recognised, turned

SAMPLES: Final = 129
"""Places on a curve that is neither a line, a circle nor an ellipse."""
GRID: Final = 17
"""Points of a spline in each direction, by which it is recognised."""
MOST_RECOGNISED: Final = 2000
"""Largest number of splines of a file that are checked, each of which takes milliseconds."""
DISPLAY_ANGLE: Final = 0.5
"""rad; coarsest turn between neighbouring facets."""
FULL_TURN: Final = 2.0 * math.pi
SINGULAR: Final = 1e-9
"""Of the largest normal, and mm: below it a direction is rounding, as at the tip of a cone."""

Numbers = list[float]


class UnreadError(Exception):
    """Open CASCADE cannot read the file; its text gives the reason."""


def main() -> None:
    """Read the file that the first argument's folder has, as its order says; see tol3d.cad.step.reading."""
    folder = Path(sys.argv[1])
    order = json.loads((folder / "order.json").read_text("utf-8"))
    limit_this_process(order["megabytes"], order["seconds"])
    try:
        found = Transferred(folder / "file.stp", order["ids"], order["solids"])
        answer = found.faces() if order["with_faces"] else {}
    except UnreadError as error:
        (folder / "answer.json").write_text(json.dumps({"refused": str(error)}), "utf-8")
        return
    (folder / "answer.json").write_text(json.dumps(answer, allow_nan=False), "utf-8")  # faces live if meshing dies
    np.savez(folder / "mesh.npz", allow_pickle=False, **found.mesh(order["deflection"]))


class Transferred:
    """A file that Open CASCADE has read.

    Args:
        path: the file.
        ids: of its entities, in the order of the file.
        solids: the `#id` of each solid, and those of its faces.
    """

    def __init__(self, path: Path, ids: Sequence[int], solids: Sequence[tuple[int, Sequence[int]]]) -> None:
        reader = STEPControl_Reader()
        Interface_Static.SetCVal_s("xstep.cascade.unit", "MM")
        if reader.ReadFile(str(path)) != IFSelect_RetDone:
            raise UnreadError("Open CASCADE cannot read it")
        session = reader.WS()
        model = session.Model()
        if model.NbEntities() != len(ids):
            raise UnreadError(f"Open CASCADE reads {model.NbEntities()} entities of {len(ids)}")
        reader.TransferRoots()
        self._reader = reader  # the session dies with it
        self._transfer = session.TransferReader()
        self._entities = [model.Value(number) for number in range(1, len(ids) + 1)]  # kept: known by their identity
        self._ids = {id(entity): ids[rank] for rank, entity in enumerate(self._entities)}
        self._solid_of = {face: solid for solid, faces in solids for face in faces}
        self._recognised = 0
        self._known, self._numbers = TopTools_IndexedMapOfShape(), list[int]()

    def faces(self) -> dict[str, Any]:
        """All faces of its solids and of loose shells, each once, and those that cannot be read, with the reason."""
        unread: list[tuple[int, str]] = []
        roots = [self._root(number, pieces, unread) for number, pieces in self._roots.items()]
        return {"roots": roots, "unread": unread}

    def mesh(self, deflection: float) -> dict[str, Any]:
        """Triangles of all solids and shells: nodes, corners, the face of each, and the error of each face.

        Faces that Open CASCADE cannot triangulate are `bare`.
        """
        nodes, corners, owners, off, bare, count = [], [], [], [], list[int](), 0
        for shape in (piece for pieces in self._roots.values() for piece in pieces):
            BRepMesh_IncrementalMesh(shape, deflection, False, DISPLAY_ANGLE)
            for face in self._own_faces(shape):
                if (triangles := triangles_of(face)) is None:
                    bare.append(self._id_of(face))
                    continue
                own_nodes, own_corners = triangles
                off.append([self._id_of(face), _chord_error(face, own_nodes, own_corners)])
                nodes.append(own_nodes)
                corners.append(own_corners + count)
                owners.append(np.full(len(own_corners), self._id_of(face), dtype=np.int64))
                count += len(own_nodes)
        return {
            "nodes": np.concatenate([np.zeros((0, 3)), *nodes]),
            "corners": np.concatenate([np.zeros((0, 3), dtype=np.int64), *corners]),
            "faces": np.concatenate([np.zeros(0, dtype=np.int64), *owners]),
            "off": np.array(off, dtype=np.float64).reshape(-1, 2),
            "bare": np.array(bare, dtype=np.int64),
        }

    def solids(self, wanted: Set[int]) -> list[TopoDS_Shape]:
        """Its solids with these numbers, each in one piece or several."""
        return [piece for number, pieces in self._roots.items() if number in wanted for piece in pieces]

    @cached_property
    def _roots(self) -> dict[int, list[TopoDS_Shape]]:
        """Solids by their `#id`, then shells and faces that are of none, each in the frame of its own product.

        Open CASCADE parts a solid of several closed shells, and makes shells of what it cannot close: the pieces of a
        solid are joined by the numbers of their faces.
        """
        whole = self._reader.OneShape()
        found: dict[int, list[TopoDS_Shape]] = {}
        seen: set[int] = set()
        for kind in (TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE):
            for placed in shapes_in(whole, kind):
                shape = placed.Located(TopLoc_Location())  # without where assemblies place it
                faces = {self._id_of(face) for face in self._own_faces(shape)}
                if not faces or faces <= seen:
                    continue
                seen |= faces
                owner = next((self._solid_of[face] for face in sorted(faces) if face in self._solid_of), min(faces))
                found.setdefault(owner, []).append(shape)
        return found

    def _id(self, shape: TopoDS_Shape) -> int:
        """The `#id` of the entity that a shape was made of; 0 of a face that Open CASCADE makes of none."""
        entity = self._transfer.EntityFromShapeResult(shape, -1)
        return self._ids.get(id(entity), 0)

    def _own_faces(self, shape: TopoDS_Shape) -> Iterator[TopoDS_Face]:
        """The faces of a shape that are in the file."""
        return (face for face in faces_of(shape) if self._id_of(face))

    def _root(self, number: int, pieces: Sequence[TopoDS_Shape], unread: list[tuple[int, str]]) -> dict[str, Any]:
        edges = TopTools_IndexedMapOfShape()
        for piece in pieces:
            TopExp.MapShapes_s(piece, TopAbs_EDGE, edges)
        faces = []
        for face in (face for piece in pieces for face in self._own_faces(piece)):
            try:
                made = self._face(face, edges)
                json.dumps(made, allow_nan=False)
                faces.append(made)
            except Exception as error:
                unread.append((self._id_of(face), f"Open CASCADE fails on it ({type(error).__name__})"))
        return {
            "id": number,
            "solid": number in self._solid_of.values(),
            "faces": faces,
            "edges": [edge_of(TopoDS.Edge_s(edges.FindKey(k))) for k in range(1, edges.Extent() + 1)],
        }

    def _id_of(self, face: TopoDS_Face) -> int:
        number = self._known.Add(face)  # the number that it has already, if any
        if number > len(self._numbers):
            self._numbers.append(self._id(face))
        return int(self._numbers[number - 1])

    def _face(self, face: TopoDS_Face, edges: TopTools_IndexedMapOfShape) -> dict[str, Any]:
        surface = BRepAdaptor_Surface(face)
        kind, numbers = self._surface(face, surface)
        first, last, low, high = BRepTools.UVBounds_s(face)
        properties = GProp_GProps()
        BRepGProp.SurfaceProperties_s(face, properties)
        place, normal = _middle(face, surface, (first, last, low, high))
        own, outer = TopTools_IndexedMapOfShape(), TopTools_IndexedMapOfShape()
        TopExp.MapShapes_s(face, TopAbs_EDGE, own)
        TopExp.MapShapes_s(BRepTools.OuterWire_s(face), TopAbs_EDGE, outer)
        return {
            "id": self._id_of(face),
            "kind": kind,
            **numbers,
            "area": abs(properties.Mass()),
            "centre": _xyz(properties.CentreOfMass()),
            "place": place,
            "normal": normal,
            "edges": [edges.FindIndex(own.FindKey(k)) - 1 for k in range(1, own.Extent() + 1)],
            "outer": [edges.FindIndex(outer.FindKey(k)) - 1 for k in range(1, outer.Extent() + 1)],
        }

    def _surface(self, face: TopoDS_Face, surface: BRepAdaptor_Surface) -> tuple[str, dict[str, Any]]:
        """Type of a face, and its numbers."""
        kind = surface.GetType()
        if kind == GeomAbs_Plane:
            return "plane", _placed(surface.Plane(), surface)
        if kind == GeomAbs_Cylinder:
            return "cylinder", {**_placed(surface.Cylinder(), surface), "radius": surface.Cylinder().Radius()}
        if kind == GeomAbs_Cone:
            cone = surface.Cone()
            numbers = {"radius": cone.RefRadius(), "half_angle": cone.SemiAngle()}
            return "cone", {**_placed(cone, surface), **numbers}
        if kind == GeomAbs_Sphere:
            return "sphere", {**_placed(surface.Sphere(), surface), "radius": surface.Sphere().Radius()}
        if kind == GeomAbs_Torus:
            torus = surface.Torus()
            numbers = {"radius": torus.MajorRadius(), "minor_radius": torus.MinorRadius()}
            return "torus", {**_placed(torus, surface), **numbers}
        return self._recognise(face, surface)

    def _recognise(self, face: TopoDS_Face, surface: BRepAdaptor_Surface) -> tuple[str, dict[str, Any]]:
        """The plane, cylinder, cone, sphere or torus that a spline or swept face is, if it is one."""
        self._recognised += 1
        if self._recognised > MOST_RECOGNISED:
            return "free form", {}
        points, normals = _grid(surface, BRepTools.UVBounds_s(face))
        sizes = np.linalg.norm(normals, axis=2)
        whole = sizes > SINGULAR * max(float(sizes.max()), 1e-300)
        found = recognised(points[whole], normals[whole] / sizes[whole][:, None])
        if found is None:
            return "free form", {}
        off = points[0, 0] - found.at
        x = off - off @ found.axis * found.axis
        if np.linalg.norm(x) < SINGULAR:
            x = np.cross(found.axis, np.eye(3)[int(np.argmin(np.abs(found.axis)))])
        x = x / np.linalg.norm(x)
        return found.kind, {
            "at": found.at.tolist(),
            "axis": found.axis.tolist(),
            "x": x.tolist(),
            "y": np.cross(found.axis, x).tolist(),
            "turn": [0.0, FULL_TURN] if found.kind == "plane" else [*turned(points, found.at, found.axis, x)],
            "radius": found.radius,
            "half_angle": found.half_angle,
            "minor_radius": found.minor_radius,
            "deviation": found.deviation,
        }


def _grid(surface: BRepAdaptor_Surface, bounds: Sequence[float]) -> tuple[Any, Any]:
    """Points [mm] of a surface within bounds of its parameters, and normals there, not of length 1 (GRID, GRID, 3)."""
    first, last, low, high = bounds
    found = []
    for u in np.linspace(first, last, GRID).tolist():
        for v in np.linspace(low, high, GRID).tolist():
            place, along, across = gp_Pnt(), gp_Vec(), gp_Vec()
            surface.D1(u, v, place, along, across)
            found.append([_xyz(place), _xyz(along.Crossed(across))])
    own = np.array(found).reshape(GRID, GRID, 2, 3)
    return own[:, :, 0], own[:, :, 1]


def shapes_in(shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> Iterator[TopoDS_Shape]:
    """Shapes of a kind in a shape, each once, turned as they stand in it."""
    found = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, kind, found)
    return (found.FindKey(number) for number in range(1, found.Extent() + 1))


def faces_of(shape: TopoDS_Shape) -> Iterator[TopoDS_Face]:
    """The faces of a shape, each once, turned as they stand in it."""
    return map(TopoDS.Face_s, shapes_in(shape, TopAbs_FACE))


def edge_of(edge: TopoDS_Edge) -> dict[str, Any]:
    """Type of an edge, and its numbers; one without a curve, as at the tip of a cone, is a point."""
    if BRep_Tool.Degenerated_s(edge):
        return {"kind": "none"}
    curve = BRepAdaptor_Curve(edge)
    first, last = curve.FirstParameter(), curve.LastParameter()
    kind = curve.GetType()
    if kind == GeomAbs_Line:
        return {"kind": "line", "points": [_xyz(curve.Value(first)), _xyz(curve.Value(last))]}
    if kind in (GeomAbs_Circle, GeomAbs_Ellipse):
        own = curve.Circle() if kind == GeomAbs_Circle else curve.Ellipse()
        radii = [own.Radius()] * 2 if kind == GeomAbs_Circle else [own.MajorRadius(), own.MinorRadius()]
        place = own.Position()
        return {
            "kind": "circle" if kind == GeomAbs_Circle else "ellipse",
            "centre": _xyz(own.Location()),
            "x": _xyz(place.XDirection()),
            "y": _xyz(place.YDirection()),
            "radii": radii,
            "ends": [first, last],
        }
    places = np.linspace(first, last, SAMPLES).tolist()
    return {"kind": "curve", "points": [_xyz(curve.Value(place)) for place in places]}


def triangles_of(face: TopoDS_Face) -> tuple[Any, Any] | None:
    """Nodes (n, 3) [mm] and triangles (m, 3), turned out of the solid, of a face; None if it is not triangulated."""
    location = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, location)
    if mesh is None:
        return None
    placed = location.Transformation()
    nodes = np.array([_xyz(mesh.Node(k).Transformed(placed)) for k in range(1, mesh.NbNodes() + 1)])
    corners = np.array([mesh.Triangle(k).Get() for k in range(1, mesh.NbTriangles() + 1)], dtype=np.int64) - 1
    return nodes, corners[:, ::-1] if face.Orientation() == TopAbs_REVERSED else corners


def _chord_error(face: TopoDS_Face, nodes: Any, corners: Any) -> float:
    """Largest distance of triangles from their face [mm], by their middles and those of their edges; 0 of a plane."""
    surface = BRepAdaptor_Surface(face)
    kind = surface.GetType()
    if kind == GeomAbs_Plane:
        return 0.0
    own = nodes[corners]
    middles = np.concatenate([own.mean(axis=1), *((own[:, k] + own[:, k - 1]) / 2 for k in range(3))])
    if kind in (GeomAbs_Cylinder, GeomAbs_Cone, GeomAbs_Sphere, GeomAbs_Torus):
        return float(np.abs(_off(kind, surface, middles)).max())
    lengths = np.linalg.norm(own - np.roll(own, 1, axis=1), axis=2)
    return float(lengths.max()) * math.sin(DISPLAY_ANGLE / 2) / 2  # a chord that turns by the coarsest angle


def _off(kind: Any, surface: BRepAdaptor_Surface, places: Any) -> Any:
    """Distances of places (n, 3) from a round surface [mm]."""
    if kind == GeomAbs_Sphere:
        sphere = surface.Sphere()
        return np.linalg.norm(places - np.array(_xyz(sphere.Location())), axis=1) - sphere.Radius()
    body = {GeomAbs_Cylinder: surface.Cylinder, GeomAbs_Cone: surface.Cone, GeomAbs_Torus: surface.Torus}[kind]()
    axis = np.array(_xyz(body.Axis().Direction()))
    off = places - np.array(_xyz(body.Location()))
    heights = off @ axis
    radii = np.linalg.norm(off - np.outer(heights, axis), axis=1)
    if kind == GeomAbs_Cylinder:
        return radii - body.Radius()
    if kind == GeomAbs_Cone:
        return (radii - body.RefRadius() - heights * math.tan(body.SemiAngle())) * math.cos(body.SemiAngle())
    return np.hypot(radii - body.MajorRadius(), heights) - body.MinorRadius()


def _middle(face: TopoDS_Face, surface: BRepAdaptor_Surface, bounds: Sequence[float]) -> tuple[Numbers, Numbers]:
    """The point of the face's surface in the middle of its parameters, and the normal there out of the material."""
    from_, to, low, high = bounds
    surface_normal = surface.DN((from_ + to) / 2, (low + high) / 2, 1, 0).Crossed(
        surface.DN((from_ + to) / 2, (low + high) / 2, 0, 1)
    )
    place = _xyz(surface.Value((from_ + to) / 2, (low + high) / 2))
    size = surface_normal.Magnitude()
    if size < 1e-12:
        return place, [0.0, 0.0, 0.0]
    sign = -1.0 if face.Orientation() == TopAbs_REVERSED else 1.0
    return place, [sign * own / size for own in _xyz(surface_normal)]


def _placed(own: Any, surface: BRepAdaptor_Surface | None) -> dict[str, Any]:
    """Placement of an elementary surface, its axis, and the angles about it between which the face lies."""
    position = own.Position()
    found: dict[str, Any] = {
        "at": _xyz(position.Location()),
        "axis": _xyz(position.Direction()),
        "x": _xyz(position.XDirection()),
        "y": _xyz(position.YDirection()),
    }
    if surface is not None:
        found["turn"] = [surface.FirstUParameter(), surface.LastUParameter()]
    return found


def _xyz(own: Any) -> Numbers:
    return [own.X(), own.Y(), own.Z()]


if __name__ == "__main__":
    main()
