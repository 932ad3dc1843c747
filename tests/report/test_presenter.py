"""A system that is no gear is shown and exported by its presenter alone: boxes whose sizes and places are known."""

import os
import pickle
import sys
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import trimesh
from matplotlib.image import imread
from rendering import renders
from report.box_presenter import COLOURS, GROWTH, PLACES, PRESENTER, SIDES

from tol3d import Overrides, Run, run_scene
from tol3d.errors import InputError
from tol3d.gearing.presenting import PRESENTER as GEARS
from tol3d.report import export_run, part_meshes, picture, view_run
from tol3d.report.body import World
from tol3d.report.presenter import View, presenter_of
from tol3d.study.runs.summary.kinds import SummaryKinds

BOXES = "report.box_presenter"
CUBES = {"small": (GROWTH * SIDES["small"]) ** 3, "large": SIDES["large"] ** 3}  # mm^3


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """Any run: what is shown of it is its presenter's choice."""
    overrides = Overrides(trials=4, engine="exact", witness=0)
    return run_scene("spur_pair", overrides=overrides, out=tmp_path_factory.mktemp("boxes") / "run")


def test_bodies_stand_where_their_poses_put_them_and_are_as_large_as_they_grew(run: Run) -> None:
    meshes = part_meshes(PRESENTER.display(run, 3, magnify=1.0))
    for name, mesh in meshes.items():
        assert mesh.volume == pytest.approx(CUBES[name])
        assert mesh.bounds.mean(axis=0) == pytest.approx(PLACES[name])


@pytest.mark.parametrize("fmt", ["stl", "ply", "glb"])
def test_a_world_is_one_file_of_all_its_bodies(run: Run, tmp_path: Path, fmt: str) -> None:
    exported = export_run(run, 3, fmt, out=tmp_path, presenter=BOXES)
    assert exported.notes == ("a note",)
    assert [path.name for path in exported.files] == [f"trial-3.{fmt}"]
    if fmt == "glb":
        scene = trimesh.load_scene(exported.files[0])
        held = {name: scene.geometry[name].copy().apply_transform(scene.graph[name][0]) for name in SIDES}
        for name, mesh in held.items():
            assert mesh.volume * 1e9 == pytest.approx(CUBES[name], rel=1e-5)  # metres, in single precision
            assert mesh.bounds.mean(axis=0) * 1e3 == pytest.approx(PLACES[name], abs=1e-4)
    else:
        assert trimesh.load_mesh(exported.files[0]).volume == pytest.approx(sum(CUBES.values()), rel=1e-5)


def test_worlds_of_single_bodies_are_told_apart_by_their_names(run: Run, tmp_path: Path) -> None:
    names = {fmt: [p.name for p in export_run(run, "mean", fmt, out=tmp_path, presenter=BOXES).files] for fmt in
             ("stl", "glb", "step")}  # fmt: skip
    assert names["stl"] == ["mean-small.stl", "mean-large.stl"]
    assert names["glb"] == ["mean-small.glb", "mean-large.glb"]
    assert names["step"] == ["mean-small.step", "mean-large.step"]


@pytest.mark.slow
def test_further_pictures_are_drawn_beside_the_histogram(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))  # the process that draws imports the presenter
    with picture.drawing(BOXES) as draw:
        draw(run.summary, tmp_path / "histogram.png")
    assert {path.name for path in tmp_path.iterdir()} == {"histogram.png", "boxes_ all.png"}
    assert imread(tmp_path / "boxes_ all.png").shape[1] == 2 * 4  # two inches, as many pixels an inch as trials


@pytest.mark.slow
@renders
def test_the_window_of_a_system_without_panels_shows_its_bodies_named(run: Run, tmp_path: Path) -> None:
    assert view_run(run, 3, screenshot=tmp_path / "boxes.png", presenter=BOXES) == ("a note", "all is shown")
    pixels = np.round(255 * imread(tmp_path / "boxes.png")[..., :3])
    for colour in COLOURS.values():  # labels are flat, each in its body's colour
        wanted = np.array([*bytes.fromhex(colour[1:])])
        assert (np.abs(pixels - wanted).max(axis=2) < 3).sum() > 500


def test_a_close_up_that_is_not_there_is_refused_by_the_presenter(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no teeth"):
        view_run(run, 3, screenshot=tmp_path / "none.png", close_up="teeth", presenter=BOXES)


def test_a_build_without_bodies_is_refused_and_nothing_is_written(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Empty:
        label, notes, worlds = "trial-3", (), (World("empty", ()),)

        def view(self, close_up: str | None) -> View:
            return View()

    monkeypatch.setattr(type(PRESENTER), "display", lambda *_, **__: Empty())
    words = r"^trial-3: there is nothing to show in 3D: its presenter gives no bodies$"
    with pytest.raises(InputError, match=words):
        view_run(run, 3, screenshot=tmp_path / "empty.png", presenter=BOXES)
    with pytest.raises(InputError, match=words):
        export_run(run, 3, "glb", out=tmp_path, presenter=BOXES)
    assert list(tmp_path.iterdir()) == []


def test_measures_without_keys_of_their_own_are_shown_by_their_mechanisms_presenter() -> None:
    """Two mechanisms together, each by its own presenter."""
    both = SummaryKinds(plain=(("first", BOXES), ("second", "")))
    both = pickle.loads(pickle.dumps(both | SummaryKinds(plain=(("third", BOXES),))))
    found = {
        kind: own.presenter for own in both.every_measure for kind in get_args(own.model_fields["kind"].annotation)
    }
    assert found == {"first": BOXES, "third": BOXES, "second": ""}


def test_a_run_whose_mechanism_and_measures_name_no_presenter_has_no_further_pictures_and_says_why_nothing_is_shown(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert presenter_of(run.found) is GEARS
    for measure in run.found.measures.values():
        monkeypatch.setattr(type(measure), "presenter", "")
    monkeypatch.setattr(type(run.found), "presenters", {})
    assert picture.system_files(run.found) == {}
    with pytest.raises(InputError, match="nothing to show in 3D: the mechanism 'gearing' has no presenter; its histo"):
        export_run(run, 0, "stl", out=tmp_path)
