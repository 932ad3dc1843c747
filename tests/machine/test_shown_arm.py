"""An arm as it is shown and exported: links by their solids or sticks, and trains behind the joints that they turn."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cadquery as cq
import numpy as np
import pytest
import trimesh
from machine.arm_by_hand import AXES, POSES, TOOL, arm_scene, errors, tool_by_hand
from machine.housed import Array
from of_kind import of_kind
from scene_texts import edited

from tol3d.cad.solids.cad import solid_of
from tol3d.gearing.machine.presenting import PRESENTER
from tol3d.report.body import World
from tol3d.report.export import export_run
from tol3d.report.html.view_model import ViewModel
from tol3d.simulate import Overrides, run_scene
from tol3d.study.runs.run import Run

LINK_2 = "  link 2:\n    kind: solid\n"
BUILDER = """    builder:
      kind: cast_link
      proximal: {diameter: 90 mm, height: 80 mm}
      distal: {at: [400 mm, 20 mm, 30 mm], axis: [0, -0.6, 0.8], diameter: 90 mm, depth: 60 mm}
      wall: 4 mm
"""
PLAYS = "".join(f"\n  play {k}: {{kind: lost_motion, of: drive {k}}}" for k in (1, 2, 3))
TRIAL = 1


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("arm")
    scene = folder / "arm.yaml"
    scene.write_text(edited(arm_scene(measures=errors() + PLAYS), (LINK_2, LINK_2 + BUILDER)), "utf-8")
    return run_scene(scene, overrides=Overrides(trials=3), out=folder / "run")


@pytest.fixture(scope="module")
def worlds(run: Run) -> Mapping[str, World]:
    return {world.name: world for world in PRESENTER.display(run, TRIAL, magnify=1.0).worlds}


def poses_in(path: Path) -> dict[str, tuple[Array, cq.Shape]]:
    """Poses (4, 4) of the parts in a STEP file, and their solids in their own frames, as OCCT reads them."""
    found = {}
    for name, part in cq.Assembly.importStep(str(path)).objects.items():
        if part.obj is not None:
            transform = part.loc.wrapped.Transformation()
            rows = [[transform.Value(row, column) for column in range(1, 5)] for row in range(1, 4)]
            found[name] = np.array([*rows, [0.0, 0.0, 0.0, 1.0]]), of_kind(cq.Shape, part.obj)
    return found


@pytest.mark.parametrize("pose", POSES)
def test_a_step_file_has_the_links_where_the_build_has_them(
    pose: str, run: Run, worlds: Mapping[str, World], tmp_path_factory: pytest.TempPathFactory
) -> None:
    out = tmp_path_factory.mktemp("step")
    files = {path.name: path for path in export_run(run, TRIAL, "step", out=out).files}
    found = poses_in(files[f"trial-{TRIAL}-{pose}.step"])
    assert set(found) == {"base (stick)", "link 1 (stick)", "link 2", "link 3 (stick)"}
    for body in worlds[pose].bodies:
        assert body.posed is not None
        posed = body.posed()
        read, solid = found[posed.name]
        assert np.abs(read - posed.world_from_part).max() < 1e-9
        assert solid.isValid()
        # where skew cylinders meet there are splines, which OCCT integrates anew: 2e-7
        assert solid.Volume() == pytest.approx(solid_of(posed.shape).solid.Volume(), rel=1e-6)
    # with its play: the tool of link 3 is off by the errors that the run has
    nominal = tool_by_hand(AXES, TOOL, np.radians(POSES[pose]).tolist())
    tool = found["link 3 (stick)"][0] @ [*np.subtract(TOOL, AXES[-1][0]), 1.0]
    columns = [run.columns(f"geometric:{c} {pose}")[f"geometric:{c} {pose}"][TRIAL] for c in "xyz"]  # um
    assert 1e3 * (tool[:3] - nominal) == pytest.approx(np.array(columns), abs=1e-6)
    assert max(map(abs, columns)) > 10.0


def test_a_stick_goes_through_the_features_of_its_link(worlds: Mapping[str, World]) -> None:
    (stick,) = (body for body in worlds["home"].bodies if body.name == "link 1")
    assert stick.posed is not None
    posed = stick.posed()
    solid = solid_of(posed.shape).solid
    for name, place in worlds["home"].points.items():
        if name.startswith("link 1."):
            own = np.linalg.inv(posed.world_from_part) @ [*place, 1.0]
            assert solid.isInside(cq.Vector(*own[:3].tolist()), 1e-6)


@pytest.mark.parametrize("pose", POSES)
def test_trains_stand_behind_their_joints_with_their_outputs_on_the_axes(
    pose: str, worlds: Mapping[str, World]
) -> None:
    world = worlds[pose]
    assert list(world.within) == ["drive 1", "drive 2", "drive 3"]
    hosts = ("base", "link 1", "link 2")
    for k, bodies in enumerate(world.within.values()):
        axis = world.features[f"{hosts[k]}.bore"].frame
        seen = [body.mesh[0] @ axis[:3, :3] - axis[:3, 3] @ axis[:3, :3] for body in bodies]
        assert max(own[:, 2].max() for own in seen) == pytest.approx(-10.0, abs=1e-6)  # half of the bore's length
        pinion, wheel = (np.ptp(own, axis=0) / 2 + own.min(axis=0) for own in seen)
        assert np.linalg.norm(wheel[:2]) < 0.2  # by how teeth lie
        assert np.linalg.norm(pinion[:2]) == pytest.approx(38.0, abs=0.2)  # their centre distance


def test_what_stands_within_is_shown_and_not_in_files(run: Run, worlds: Mapping[str, World], tmp_path: Path) -> None:
    model = ViewModel(wanted="home")
    display = PRESENTER.display(run, TRIAL, magnify=1.0)
    model.add("trial", [(1.0, display, "")])
    shown = {part.name: part.part for part in model.parts}
    assert shown["drive 2: pinion 2"] == shown["drive 2: wheel 2"] == "drive 2"
    drives = [
        mesh
        for part, mesh in zip(model.parts, model.builds[0].states[0].meshes, strict=True)
        if part.part[:5] == "drive"
    ]
    assert len(set(drives)) == 2  # three drives alike: a pinion and a wheel
    files = {path.name: path for path in export_run(run, TRIAL, "glb", out=tmp_path).files}
    scene: Any = trimesh.load(files[f"trial-{TRIAL}-home.glb"])
    assert set(scene.geometry) == {body.name for body in worlds["home"].bodies}
    assert f"trial-{TRIAL}-stage_2.glb" in files
