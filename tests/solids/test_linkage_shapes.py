"""Parts of linkages as shapes: what scenes write of them, and their display meshes."""

import math
from typing import Any

import numpy as np
import pytest
import trimesh
from places import SCENES

from tol3d import load_scene
from tol3d.cad.solids import BuiltShape, display_mesh
from tol3d.cad.solids.cad import solid_of
from tol3d.cad.solids.numbered_parts import BallScrew, BallSocket, Nut, Rod, SphericalGear, ThrustRing

DEGREE = math.pi / 180
WRITTEN: dict[tuple[str, str], BuiltShape] = {
    ("spherical_drive", "rod 1"): Rod(260.0, 8.0, 16.0),
    ("spherical_drive", "nut 1"): Nut(32.0, 24.0, 16.0, 32.0, 24.0, 16.0),
    ("spherical_drive", "screw 1"): BallScrew(16.0, 300.0, (12.0, 20.0)),
    ("spherical_drive", "ring"): ThrustRing(
        112.0, 140.0, 14.0, 80.0, 24.0, 16.0, (("B", 120 * DEGREE), ("D", 60 * DEGREE))
    ),
    ("spherical_drive", "gear 1"): SphericalGear(25, 4.0, 20 * DEGREE, 95 * DEGREE, True, 0.05),
    ("spherical_drive", "gear 2"): SphericalGear(25, 4.0, 20 * DEGREE, 100 * DEGREE, False, 0.05, (20.0, 30.0)),
    ("stewart", "foot 1"): BallSocket(20.0, 19.0, 30.0, 20.0),
}
GEARS = ("gear 1", "gear 2")


@pytest.mark.parametrize(("scene", "part"), WRITTEN)
def test_a_scene_s_dimensions_arrive_in_millimetres_and_radians(scene: str, part: str) -> None:
    built: Any = load_scene(SCENES / f"{scene}.yaml").parts[part]
    found, written = vars(built.builder.shape), vars(WRITTEN[scene, part])
    assert list(found) == list(written)
    for field, value in written.items():
        if field == "ears":
            assert dict(found[field]) == pytest.approx(dict(value), rel=1e-15)
        elif value is None:
            assert found[field] is None
        else:
            assert found[field] == pytest.approx(value, rel=1e-15), field


def test_a_gear_is_thinned_by_what_is_stated() -> None:
    shape = SphericalGear(25, 4.0, 20 * DEGREE, 95 * DEGREE, True, 0.05)
    assert shape.section.tooth_thickness == pytest.approx(math.pi * 4 / 2 - 0.05, rel=1e-15)
    assert shape.section.reference_diameter == 100.0


@pytest.mark.parametrize(
    ("scene", "part"), [pytest.param(*own, marks=pytest.mark.slow) if own[1] in GEARS else own for own in WRITTEN]
)
def test_a_mesh_is_closed_and_as_large_as_its_chord_error_allows(scene: str, part: str) -> None:
    shape = WRITTEN[scene, part]
    found = display_mesh(shape, 0.05)
    mesh = trimesh.Trimesh(found.vertices, found.triangles, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert found.chord_error < 0.2
    solid = solid_of(shape).solid
    assert abs(mesh.volume - solid.Volume()) <= found.chord_error * mesh.area
    box = solid.BoundingBox(1e-6)
    corners = np.array([(box.xmin, box.ymin, box.zmin), (box.xmax, box.ymax, box.zmax)])
    assert mesh.bounds == pytest.approx(corners, abs=found.chord_error + 1e-6)
