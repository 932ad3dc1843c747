"""Exported helical gears of one trial: triangles and B-spline faces touch where the exact method's pose has them."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cadquery as cq
import fcl
import numpy as np
import pytest
import trimesh
from gear_trials import model_of_scene
from gearing.test_helical_scenes import RING, TOLERANCES, text
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Trsf
from of_kind import of_kind
from scipy.linalg import expm, logm

from tol3d.cad.solids import display_mesh
from tol3d.gearing.presenting.gear_display import SWING, GearDisplay
from tol3d.gearing.shown.display import seated_build
from tol3d.gearing.shown.placed import DISPLAY_DEFLECTION, HELICAL_DEFLECTION
from tol3d.gears import InternalGear, InternalPair, SpurGear, SpurPair
from tol3d.numerics.arrays import Array
from tol3d.report import export_run
from tol3d.simulate import Overrides, run_scene
from tol3d.study.results.replaying import build_of
from tol3d.study.runs.run import Run

Numbers = Mapping[str, Any]

TRIAL = 1
FREE_TURN = "geometric:free turn"  # arcmin
NEAR = 0.5e-3  # mm; the chord errors of both meshes are 1.4e-3 mm, reached in the middle of their steps alone
OPENED = 5e-3  # mm along the normals, by which the driven gear is turned off contact
FLOAT32_NOISE = 8e-6  # mm; coordinates up to 64 mm in the file, two meshes


def surface(mesh: trimesh.Trimesh) -> fcl.CollisionObject:
    """All its triangles."""
    hierarchy = fcl.BVHModel()
    hierarchy.beginModel(len(mesh.vertices), len(mesh.faces))
    hierarchy.addSubModel(mesh.vertices, mesh.faces)
    hierarchy.endModel()
    return fcl.CollisionObject(hierarchy, fcl.Transform())


def swing_of(run: Run) -> Array:
    """Logarithm (4, 4) of the wheel's motion through the free turn of the trial, the pinion at rest."""
    first, *_, last = GearDisplay(seated_build(*build_of(run, TRIAL))).motion(SWING, 3).frames
    assert np.abs(last.poses["pinion"] - first.poses["pinion"]).max() < 1e-12
    return np.asarray(of_kind(np.ndarray, logm(last.poses["wheel"] @ np.linalg.inv(first.poses["wheel"]))).real)


def test_pages_have_helical_gears_with_a_tenth_of_the_triangles_of_files(tmp_path: Path) -> None:
    """Closed, and within some 20 µm of the solid: a fifth of a pixel where 100 mm fill a page."""
    (path := tmp_path / "pair.yaml").write_text(text(TOLERANCES))
    run = run_scene(path, out=tmp_path / "run", overrides=Overrides(trials=3, engine="analytic"))
    bodies = {
        own.name: own for world in GearDisplay(seated_build(*build_of(run, TRIAL))).worlds for own in world.bodies
    }
    for part in model_of_scene(path).gears:
        body = bodies[part.name]
        assert body.coarse is not None
        vertices, triangles = body.coarse()
        assert trimesh.Trimesh(vertices, triangles).is_watertight
        assert len(triangles) < 0.1 * len(body.surface()[1])
        assert display_mesh(part.gear, HELICAL_DEFLECTION).chord_error < 2 * HELICAL_DEFLECTION


@pytest.mark.slow
@pytest.mark.parametrize("changed", [{}, RING], ids=["external", "ring"])
def test_exported_gears_touch_on_one_side_and_turned_freely_on_the_other(changed: Numbers, tmp_path: Path) -> None:
    """A trial with every tolerance, by the exact engine: its STL files, and turned by shares of the free turn.

    Turned by all of it the other sides touch. Where meshes overlap FCL says 0, so that both contacts are also opened by
    a known gap.
    """
    (path := tmp_path / "pair.yaml").write_text(text(TOLERANCES, **changed))
    run = run_scene(path, out=tmp_path / "run", overrides=Overrides(trials=3, engine="exact"))
    driver, driven = (trimesh.load_mesh(own) for own in export_run(run, TRIAL, "stl", out=tmp_path).files)
    assert driver.is_watertight
    assert driven.is_watertight
    swing = swing_of(run)
    pair = model_of_scene(path).meshes[0].pair
    assert isinstance(pair, SpurPair | InternalPair)
    inside = isinstance(pair, InternalPair)
    arm, turn = pair.wheel.section_arm, math.sqrt((swing[:3, :3] ** 2).sum() / 2)
    assert 60 * math.degrees(turn) == pytest.approx(run.columns(FREE_TURN)[FREE_TURN][TRIAL], abs=1e-5)
    chord = sum(display_mesh(gear, DISPLAY_DEFLECTION).chord_error for gear in (pair.pinion, pair.wheel))
    assert 0.5e-3 < chord < 1.5e-3  # mm, of both
    still, play = surface(driver), arm * turn

    def apart(share: float) -> float:
        moved = surface(driven.copy().apply_transform(expm(share * swing)))
        return float(fcl.distance(still, moved, fcl.DistanceRequest(), fcl.DistanceResult()))

    assert apart(0.0) < NEAR
    assert apart(1.0) < NEAR
    for share in (OPENED / play, 1 - OPENED / play):
        off = apart(share) - OPENED  # chords of teeth lie in them, those of a ring in its spaces
        assert abs(off) < NEAR + FLOAT32_NOISE
        assert inside or off > -FLOAT32_NOISE
    assert play > 50 * chord
    assert apart(0.5) == pytest.approx(play / 2, abs=chord + FLOAT32_NOISE)


FEW = {"z1": 13, "z2": 19, "x1": 0, "x2": 0, "a": 16 / math.cos(math.radians(30.0))}
TOUCHING = 0.1e-3  # mm; a B-spline face follows its flank to 0.01e-3, and OCC stops its search that much earlier
SOLID = 0.02e-3  # mm; both faces, opened by a known gap
BENT = 0.05e-3  # mm; half way contacts have left the faces' ends by which they touched


@pytest.mark.slow
@pytest.mark.parametrize("changed", [FEW, RING], ids=["external", "ring"])
def test_flank_faces_of_a_step_file_touch_on_one_side_and_turned_freely_on_the_other(
    changed: Numbers, tmp_path: Path
) -> None:
    """Read back by OCC, and measured face to face by its own search: tilted, eccentric, warm gears, thinned teeth."""
    (path := tmp_path / "pair.yaml").write_text(text(TOLERANCES, **changed))
    run = run_scene(path, out=tmp_path / "run", overrides=Overrides(trials=3, engine="exact"))
    (file,) = export_run(run, TRIAL, "step", out=tmp_path).files
    pinion, wheel = cq.Assembly.importStep(str(file)).children
    swing, pair = swing_of(run), model_of_scene(path).meshes[0].pair
    assert isinstance(pair, SpurPair | InternalPair)
    first, second = flanks(pinion, pair.pinion, pair), flanks(wheel, pair.wheel, pair)
    assert len(first) >= 4
    assert len(second) >= 4
    still, play = cq.Compound.makeCompound(first), pair.wheel.section_arm * math.sqrt((swing[:3, :3] ** 2).sum() / 2)

    def apart(share: float) -> float:
        motion = gp_Trsf()
        motion.SetValues(*expm(share * swing)[:3].ravel().tolist())
        moved = cq.Compound.makeCompound([face.moved(cq.Location(motion)) for face in second])
        return float(BRepExtrema_DistShapeShape(still.wrapped, moved.wrapped).Value())

    assert apart(0.0) < TOUCHING
    assert apart(1.0) < TOUCHING
    for share in (OPENED / play, 1 - OPENED / play):
        assert apart(share) == pytest.approx(OPENED, abs=SOLID)
    assert apart(0.5) == pytest.approx(play / 2, abs=BENT)


def flanks(part: cq.Assembly, gear: SpurGear | InternalGear, pair: SpurPair | InternalPair) -> list[cq.Face]:
    """Faces from root to tip of the teeth at the line of centres, where they stand; all teeth would take hours."""
    assert isinstance(part.obj, cq.Shape)
    centre = pair.wheel_origin if gear is pair.wheel else np.zeros(3)
    found = []
    for face in part.obj.moved(part.loc).Faces():
        at, ends = face.Center(), [own.toTuple() for own in face.Vertices()]
        radii = [math.hypot(x - centre[0], y - centre[1]) for x, y, _ in ends]
        near = abs(at.x - pair.pinion.reference_radius) < 2.2 * gear.module and abs(at.y) < 3.4 * gear.module
        if near and face.geomType() == "BSPLINE" and max(radii) - min(radii) > 0.9 * gear.module:
            found.append(face)
    return found
