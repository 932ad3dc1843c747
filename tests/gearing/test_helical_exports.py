"""Exported helical gears of one trial: their triangles touch where the exact method's pose has them touch."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import fcl
import numpy as np
import pytest
import trimesh
from gear_trials import model_of_scene
from gearing.test_helical_scenes import RING, TOLERANCES, text
from of_kind import of_kind
from scipy.linalg import expm, logm

from tol3d.cad.solids import display_mesh
from tol3d.gearing.presenting.gear_display import SWING, GearDisplay
from tol3d.gearing.shown.display import seated_build
from tol3d.gearing.shown.placed import DISPLAY_DEFLECTION, HELICAL_DEFLECTION
from tol3d.gears import InternalPair, SpurPair
from tol3d.report import export_run
from tol3d.simulate import Overrides, run_scene
from tol3d.study.results.replaying import build_of

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
    first, *_, last = GearDisplay(seated_build(*build_of(run, TRIAL))).motion(SWING, 3).frames
    assert np.abs(last.poses["pinion"] - first.poses["pinion"]).max() < 1e-12
    swing = of_kind(np.ndarray, logm(last.poses["wheel"] @ np.linalg.inv(first.poses["wheel"]))).real
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
