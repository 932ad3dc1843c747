"""Machined parts as shapes: what a scene writes, their display meshes, STEP, and solids whose faces lie elsewhere."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import cadquery as cq
import numpy as np
import pytest
import trimesh
from of_kind import of_kind
from places import SCENES

from tol3d import load_scene
from tol3d.cad.solids import BuiltShape, PosedShape, display_mesh, export_step
from tol3d.cad.solids.cad import solid_of
from tol3d.cad.solids.numbered_parts import Bracket, Cover, Housing
from tol3d.cad.solids.triangulation import triangulated
from tol3d.parts.bracket import bracket
from tol3d.parts.details import Bore, Boss, Hole, Slot, Spigot

PARTS = ("base", "housing", "cover", "block", "bracket")


@cache
def shapes() -> Mapping[str, BuiltShape]:
    parts: Any = load_scene(SCENES / "machined_parts.yaml").parts
    return {name: parts[name].builder.shape for name in PARTS}


def test_a_scene_s_dimensions_arrive_in_millimetres_and_radians() -> None:
    base: Any = shapes()["base"]
    assert (base.length, base.width, base.thickness) == (260.0, 140.0, 16.0)
    assert base.holes[2] == Hole("blind", (70.0, 45.0), 12.0, 9.0, "top")
    assert base.slots == (Slot("groove", (0.0, -55.0), 50.0, 10.0, pytest.approx(np.deg2rad(15)), 6.0, "top"),)
    housing = of_kind(Housing, shapes()["housing"])
    assert housing.corner == (-55.0, -40.0, -45.0)
    assert housing.size == (110.0, 70.0, 90.0)
    assert (housing.walls, housing.floor) == (10.0, 12.0)
    assert housing.bores[3] == Bore("far output", (22.0, 2.0), 26.0, "back")
    assert housing.bosses == (Boss("boss", (22.0, 2.0), 42.0, 6.0, "front"),)
    assert [hole.face for hole in housing.holes] == ["rim"] * 2 + ["bottom"] * 2
    assert [pin.name for pin in housing.pins] == ["dowel 1", "dowel 2"]
    assert housing.opening == "top"
    assert of_kind(Cover, shapes()["cover"]).spigot == Spigot(89.6, 69.6, 5.0)
    assert of_kind(Bracket, shapes()["bracket"]).fillet == 6.0
    assert [hole.face for hole in of_kind(Bracket, shapes()["bracket"]).holes][2] == "upright inside"


@pytest.mark.parametrize("name", PARTS)
def test_the_mesh_of_a_machined_part_is_closed_and_as_large_as_its_chord_error_allows(name: str) -> None:
    found = display_mesh(shapes()[name], 0.05)
    mesh = trimesh.Trimesh(found.vertices, found.triangles, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    solid = solid_of(shapes()[name]).solid
    assert abs(mesh.volume - solid.Volume()) <= found.chord_error * mesh.area
    box = solid.BoundingBox(1e-6)
    corners = [(box.xmin, box.ymin, box.zmin), (box.xmax, box.ymax, box.zmax)]
    assert mesh.bounds == pytest.approx(np.array(corners), abs=found.chord_error + 1e-6)


def test_a_solid_that_was_moved_is_triangulated_where_it_lies() -> None:
    """A face may keep its place apart from its shape: its nodes are in the frame of the shape."""
    part = bracket(60.0, 50.0, 30.0, 8.0, 5.0, [Hole("a", (40.0, 3.0), 6.0, None, "base inside")])
    turn = cq.Location(cq.Vector(5, -7, 11), cq.Vector(1, 2, 3), 77)
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    across = np.cross(np.eye(3), axis)  # rows: e_k x axis
    cos, sin = np.cos(np.deg2rad(77)), np.sin(np.deg2rad(77))
    rotation = cos * np.eye(3) + sin * across + (1 - cos) * np.outer(axis, axis)
    still, moved = triangulated(part, 0.1), triangulated(part.moved(turn), 0.1)
    expected = still.vertices @ rotation.T + [5.0, -7.0, 11.0]
    nearest = np.linalg.norm(expected[:, None] - moved.vertices[None], axis=2).min(axis=1)
    assert nearest.max() < 1e-5
    mesh = trimesh.Trimesh(moved.vertices, moved.triangles, process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(part.solid.Volume(), rel=1e-3)


def test_a_step_assembly_takes_machined_parts(tmp_path: Path) -> None:
    posed = [PosedShape(name, shape, np.eye(4)) for name, shape in shapes().items()]
    export_step(posed, tmp_path / "parts.step", ["#808080"] * len(posed))
    found = cq.Assembly.importStep(str(tmp_path / "parts.step")).objects
    for name, shape in shapes().items():
        again = of_kind(cq.Shape, found[name].obj)
        assert again.isValid()
        assert again.Volume() == pytest.approx(solid_of(shape).solid.Volume(), rel=1e-9)
