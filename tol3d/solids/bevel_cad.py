"""What is read off the solid of a bevel gear: rays of its flanks, and the triangulations of all its faces."""

from collections.abc import Iterator, Sequence

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.TopAbs import TopAbs_REVERSED

from tol3d.gears import LEFT, RIGHT, BevelGear, Flank
from tol3d.parts.bevel_flank import sample_flank
from tol3d.parts.bevel_gear import build
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.spur_gear import SIDES
from tol3d.solids.door import Arrays
from tol3d.solids.triangulation import (
    DISPLAY_ANGLE,
    Curve,
    corners_of,
    edge_curve,
    largest_sagitta,
    mesh_of,
    nodes_of,
)

Array = NDArray[np.float64]

JOINED_XTOL = 1e-5  # mm; nodes of two faces on one edge agree to OCC's 1e-7, others lie much further apart


def sample_flanks(gear: BevelGear, steps: int) -> Arrays:
    """Rays of the flanks, cut to spheres at inner and outer cone distance; a step's sagitta is that at the heel."""
    part = build(gear)
    q = np.linspace(gear.form_q**1.5, gear.tip_q**1.5, steps + 1) ** (2 / 3)
    q[[0, -1]] = gear.form_q, gear.tip_q
    rays = {flank: sample_flank(part, 0, flank, q) for flank in (RIGHT, LEFT)}
    directions = np.stack([sample.directions for sample in rays.values()])
    involute = np.stack([gear.flank_directions(q, flank) for flank in rays])
    outer = gear.outer_cone_distance

    def heel(flank: Flank) -> Curve:
        return lambda places: outer * sample_flank(part, 0, flank, places).directions

    return {
        "parameter": q,
        "inner": gear.inner_cone_distance * directions,
        "outer": outer * directions,
        "normals": np.stack([sample.normals for sample in rays.values()]),
        "chord_error": np.array(max(largest_sagitta(heel(flank), q) for flank in rays)),
        "flank_error": np.array(outer * np.linalg.norm(directions - involute, axis=-1).max()),
    }


def tessellate(gear: BevelGear, deflection: float) -> Arrays:
    """OCC's triangulations of all faces, joined along the edges that they share."""
    part = build(gear)
    BRepMesh_IncrementalMesh(part.solid.wrapped, deflection, False, DISPLAY_ANGLE)
    points, triangles, faces, count = [], [], [], 0
    for name, face in part.faces.items():
        nodes, corners = _triangulation(face)
        points.append(nodes)
        triangles.append(corners + count)
        faces += [name] * len(nodes)
        count += len(nodes)
    vertices, joined = _joined(np.concatenate(points))
    return {
        "vertices": vertices,
        "triangles": joined[np.concatenate(triangles)],
        "side": _named_sides(faces, joined, len(vertices)),
        "chord_error": np.array(max(_edge_sagittas(part))),
    }


def _triangulation(face: cq.Face) -> tuple[Array, NDArray[np.int64]]:
    """Nodes (n, 3) [mm] and triangles (m, 3) of a face, turned out of the solid."""
    mesh, _ = mesh_of(face)
    corners = corners_of(mesh)
    return nodes_of(mesh), corners[:, ::-1] if face.wrapped.Orientation() == TopAbs_REVERSED else corners


def _joined(points: Array) -> tuple[Array, NDArray[np.int64]]:
    """Points without repetition, and the new number of each."""
    _, first, number = np.unique(
        np.round(points / JOINED_XTOL).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return points[first], number.ravel()


def _named_sides(faces: Sequence[str], joined: NDArray[np.int64], count: int) -> NDArray[np.int8]:
    """RIGHT, LEFT or 0 for each vertex: the flank or radial face that it lies on."""
    side = np.zeros(count, dtype=np.int8)
    for number, name in zip(joined.tolist(), faces, strict=True):
        words = name.split()
        for flank, word in SIDES.items():
            if word in words:
                side[number] = flank
    return side


def _edge_sagittas(part: NamedSolid) -> Iterator[float]:
    """Largest sagitta [mm] of each curved edge's own polygon."""
    face_of_edge = {edge: face for face in part.faces.values() for edge in face.Edges()}
    for edge, face in face_of_edge.items():
        if edge.geomType() != "LINE":
            mesh, place = mesh_of(face)
            polygon = BRep_Tool.PolygonOnTriangulation_s(edge.wrapped, mesh, place)
            parameters = np.array([polygon.Parameter(index) for index in range(1, polygon.NbNodes() + 1)])
            yield largest_sagitta(edge_curve(edge), parameters)
