"""From Python, as a notebook user expects: each function by what it must give, and docs/python.md as it stands."""

import json
import math
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fcl
import numpy as np
import pytest
import trimesh
from fixtures import Command
from places import ROOT

import tol3d
from tol3d.gearing.shown.placed import DISPLAY_DEFLECTION
from tol3d.scene.bundled import bundled_scenes
from tol3d.simulate import TemporaryRunWarning
from tol3d.study.runs.frame import MissingPackageError
from tol3d.study.runs.run import SUMMARY, Run

FEW = tol3d.Overrides(trials=60, witness=0)


@pytest.fixture(scope="module")
def spur(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return tol3d.run_scene("spur_pair", overrides=FEW, out=tmp_path_factory.mktemp("runs") / "spur")


# scenes and runs ----------------------------------------------------------------------------------------------


def test_a_scene_is_found_by_its_name_as_the_command_line_finds_it() -> None:
    by_path = tol3d.load_scene(ROOT / "scenes" / "spur_pair.yaml")
    assert tol3d.load_scene("spur_pair").text == by_path.text
    with pytest.raises(tol3d.SceneError, match=r'spur_pear: no such file, .* did you mean "spur_pair"\?'):
        tol3d.run_scene("spur_pear")


@pytest.mark.parametrize("kind", [str, Path])
def test_a_run_opens_by_its_folder(spur: Run, kind: type) -> None:
    again = tol3d.open_run(kind(spur.path))
    assert again.path == spur.path
    assert again.summary == spur.summary


def test_a_run_shows_where_it_is_and_not_its_whole_summary(spur: Run) -> None:
    shown = repr(spur)
    assert str(spur.path) in shown
    assert "spur pair at the drive end, 60 trials, seed 1, engine exact" in shown
    assert len(shown) < 300 + len(str(spur.path))


def test_a_temporary_run_says_where_it_is_and_stays(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.warns(TemporaryRunWarning) as told:
        run = tol3d.run_scene("spur_pair", overrides=FEW)
    assert str(run.path) in str(told[0].message)
    assert run.path.is_relative_to(tmp_path)
    assert told[0].filename == __file__  # where the user left `out` away
    assert (run.path / SUMMARY).exists()


def test_a_run_with_a_folder_of_its_own_is_not_told_of(tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    tol3d.run_scene("spur_pair", overrides=FEW, out=tmp_path / "run")
    assert [own for own in recwarn if own.category is TemporaryRunWarning] == []


# frames -------------------------------------------------------------------------------------------------------


def test_a_frame_holds_every_trial_under_the_columns_names(spur: Run) -> None:
    frame, columns = spur.frame(), spur.columns()
    assert list(frame.columns) == list(columns)
    assert frame.index.name == "trial"
    assert list(frame.index) == list(range(60))
    for name, values in columns.items():
        assert np.array_equal(frame[name].to_numpy(), values)
    assert list(spur.frame("status").columns) == ["status"]


def test_a_curve_has_a_column_a_position_or_none(tmp_path: Path) -> None:
    run = tol3d.run_scene("every_field", overrides=FEW, out=tmp_path / "run")
    name = "geometric:normal backlash curve"
    curve, split = run.columns(name)[name], run.frame(name)
    # eight steps of a turn of the driver, its end one more
    assert list(split.columns) == [f"{name}:{45 * k} deg" for k in range(9)]
    assert np.array_equal(split.to_numpy(), curve)
    dropped = run.frame(curves="drop")
    assert set(run.frame().columns) - set(dropped.columns) == {
        f"{method}:normal backlash curve:{45 * k} deg" for method in ("analytic", "geometric") for k in range(9)
    }
    with pytest.raises(tol3d.InputError, match="split"):
        run.frame(curves="flat")  # type: ignore[arg-type]


SHORT = ("spur_pair", "three_stage_train", "door")


@pytest.mark.parametrize(
    "scene", [own if own in SHORT else pytest.param(own, marks=pytest.mark.slow) for own in bundled_scenes()]
)
def test_every_bundled_scene_has_a_frame(scene: str, tmp_path: Path) -> None:
    """Each value of each column once: as many columns as values a trial."""
    overrides = tol3d.Overrides(trials=8, engine="analytic")
    run = tol3d.run_scene(scene, overrides=overrides, out=tmp_path / "run")
    values = sum(column[0].size for column in run.columns().values())
    frame = run.frame()
    assert frame.shape == (8, values)
    assert frame.columns.is_unique


def test_without_pandas_the_error_names_the_command(spur: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)  # as if it were not installed
    with pytest.raises(MissingPackageError, match="pip install pandas"):
        spur.frame()


# the worst trial ----------------------------------------------------------------------------------------------


def test_the_worst_of_a_measure_is_the_trial_nearest_to_its_limit(spur: Run) -> None:
    values = spur.columns("geometric:normal backlash")["geometric:normal backlash"]
    assert spur.worst("normal backlash") == np.argmin(values)  # it has a lower limit only
    angles = spur.columns("geometric:lost motion")["geometric:lost motion"]
    assert spur.worst("lost motion") == np.argmin(angles)  # a backlash without limits: the smallest
    with pytest.raises(tol3d.RunError, match="there are: normal backlash, lost motion"):
        spur.worst("backlash")


@pytest.mark.slow
def test_a_jam_is_the_worst_and_can_be_looked_at(tmp_path: Path) -> None:
    """Both gears touch on both flanks of a tooth: where the working ones are brought to touch, the others overlap."""
    gear = {"kind": "spur_gear", "module": "2 mm", "face_width": "10 mm"}
    law = {"kind": "normal", "lower": "-40 um", "upper": "50 um"}
    scene = tol3d.Scene.model_validate(
        {
            "scene": "tight",
            "parts": {"pinion": {**gear, "teeth": 20}, "wheel": {**gear, "teeth": 30}},
            "tolerances": {"distance": {"kind": "centre_distance", "of": "pair", "distribution": law}},
            "moves": {"pair": {"kind": "mesh", "driver": "pinion", "driven": "wheel", "centre_distance": "50 mm"}},
            "measures": {"play": {"kind": "normal_backlash", "of": "pair"}},
            "study": {"trials": 100},
        }
    )
    run = tol3d.run_scene(scene, out=tmp_path / "run")
    worst = run.worst("play")
    assert worst == np.argmin(run.frame()["distance [um]"])
    again = tol3d.replay(run, worst)
    assert again.geometric["play"] < -10  # um
    assert distance(again.meshes["pinion"], again.meshes["wheel"]) == 0.0


# replays ------------------------------------------------------------------------------------------------------


def distance(first: trimesh.Trimesh, second: trimesh.Trimesh) -> float:
    """Distance of two triangle meshes [mm], by FCL in double precision."""

    def shape(mesh: trimesh.Trimesh) -> fcl.CollisionObject:
        model = fcl.BVHModel()
        model.beginModel(len(mesh.vertices), len(mesh.faces))
        model.addSubModel(mesh.vertices, mesh.faces)
        model.endModel()
        return fcl.CollisionObject(model, fcl.Transform())

    return float(fcl.distance(shape(first), shape(second), fcl.DistanceRequest(), fcl.DistanceResult()))


@pytest.mark.slow
def test_the_parts_of_a_replay_touch_and_leave_its_backlash(spur: Run) -> None:
    """The wheel's mesh touches the pinion's; turned back by half its free turn it is half the backlash away, twice.

    Facets lie within the deflection of their flanks, one at each of two contacts.
    """
    again = tol3d.replay(spur, spur.worst("normal backlash"))
    assert distance(again.meshes["pinion"], again.meshes["wheel"]) < 2 * DISPLAY_DEFLECTION
    free = again.geometric["lost motion"] / 60 * math.pi / 180
    gap = again.geometric["normal backlash"] / 1000
    found = []
    for turn in (-free / 2, free / 2):
        wheel = again.meshes["wheel"].copy()
        pose = again.poses["wheel"]
        about = np.eye(4)
        about[:2, :2] = [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
        wheel.apply_transform(pose @ about @ np.linalg.inv(pose))
        found.append(distance(again.meshes["pinion"], wheel))
    # one way into the free turn, the other way into the pinion's flank; the wheel turns about its own teeth's centre
    # here, 1e-5 of the radius from its axis, which takes sin(turn) * 20 um
    assert max(found) == pytest.approx(gap / 2, abs=2 * DISPLAY_DEFLECTION)
    assert min(found) == 0.0


def test_poses_are_where_the_deviations_put_the_parts(spur: Run) -> None:
    """A gear's centre: its axis moved by centre distance and half the clearance, and its own offset turned with it."""
    trial = 17
    again, row = tol3d.replay(spur, trial), spur.frame().iloc[trial]
    pinion, wheel = again.poses["pinion"], again.poses["wheel"]
    for name, pose in (("pinion", pinion), ("wheel", wheel)):
        offset = np.array([row[f"{name} eccentricity.{axis} [um]"] for axis in "xy"]) / 1000
        if name == "pinion":
            offset += np.array([row[f"reducer run-out.{axis} [um]"] for axis in "xy"]) / 1000
        axis = pose[:2, 3] - pose[:2, :2] @ offset
        away = 172.5 + (row["centre distance [um]"] + row["bearing clearance [um]"] / 2) / 1000
        assert axis == pytest.approx([0.0 if name == "pinion" else away, 0.0], abs=1e-9)
        assert pose[:3, :3] @ pose[:3, :3].T == pytest.approx(np.eye(3), abs=1e-12)
    turned = math.degrees(math.atan2(pinion[1, 0], pinion[0, 0])) % 360
    assert turned == pytest.approx(row["position:gear pair [deg]"] % 360, abs=1e-9)


@pytest.mark.slow
def test_a_train_shows_its_shafts_and_arms_in_one_world(tmp_path: Path) -> None:
    run = tol3d.run_scene("robot_shoulder", overrides=FEW, out=tmp_path / "run")
    again = tol3d.replay(run, 3)
    assert {"pinion", "wheel", "bevel driver", "bevel driven", "spline shaft", "arm"} <= set(again.poses)
    assert again.poses.keys() == again.meshes.keys()
    assert all(mesh.is_watertight for mesh in again.meshes.values())


def test_what_a_replay_was_asked_for_is_that_trial(spur: Run) -> None:
    again = tol3d.replay(spur.path, np.int64(5))  # type: ignore[arg-type]  # as numpy's argmin gives it
    column = "geometric:normal backlash"
    assert again.geometric["normal backlash"] == spur.columns(column)[column][5]
    assert "trial 5" in repr(again)
    for wrong in ("worst", 5.0, None, 60, -1):
        with pytest.raises(tol3d.InputError, match="trial"):
            tol3d.replay(spur, wrong)  # type: ignore[arg-type]


# what the commands show ---------------------------------------------------------------------------------------


def test_python_shows_what_the_command_shows(tol3d_command: Command, spur: Run, tmp_path: Path) -> None:
    for found, arguments in (
        (tol3d.check_scene("spur_pair"), ("check", "spur_pair")),
        (tol3d.compare_runs([spur, str(spur.path)]), ("compare", str(spur.path), str(spur.path))),
    ):
        code, out, _ = tol3d_command(
            *arguments, *(["--out", str(tmp_path / "c.png")] if "compare" in arguments else [])
        )
        assert code == 0
        words = {word for word in str(found).split() if set(word) != {"─"}}  # rules are as wide as the terminal
        assert len(words) > 30
        assert words <= set(out.split())


@pytest.mark.slow
def test_pictures_and_files_lie_where_they_say(spur: Run, tmp_path: Path) -> None:
    compared = tol3d.compare_runs([spur], out=tmp_path / "compared.png")
    seen = tol3d.view_trial(spur, 17, out=tmp_path / "seen.png")
    for picture in (compared.picture, seen):
        assert picture is not None
        assert picture.path is not None
        assert picture._repr_png_() == picture.path.read_bytes()
        assert picture.path.read_bytes().startswith(b"\x89PNG")
    exported = tol3d.export_trial(str(spur.path), 17, format="stl", out=tmp_path / "parts")
    assert {path.name for path in exported.files} == {"trial-17-pinion.stl", "trial-17-wheel.stl"}
    assert all(path.stat().st_size > 0 for path in exported.files)


@pytest.mark.slow
def test_shims_from_python_are_those_of_the_command(tol3d_command: Command) -> None:
    found = tol3d.find_shims("bevel_pair", "24 um", overrides=tol3d.Overrides(trials=200))
    code, out, _ = tol3d_command("shim", "bevel_pair", "--target-min", "24 um", "--trials", "200")
    assert code == 0
    assert found.tolerances in out
    assert found.plan.chosen.thickness == pytest.approx(0.048, abs=0.002)  # the paper's


@pytest.fixture
def tol3d_command(tol3d: Command) -> Command:  # the fixture of conftest.py, whose name the module has here
    return tol3d


# importing ----------------------------------------------------------------------------------------------------


def test_importing_loads_nothing_heavy() -> None:
    heavy = ("numpy", "numba", "cadquery", "OCP", "pyvista", "vtkmodules", "trimesh", "pandas", "matplotlib", "fcl")
    code = f"import sys, tol3d; dir(tol3d); print([name for name in {heavy!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_public_name_is_there() -> None:
    assert len(tol3d.__all__) <= 20
    for name in (*tol3d.__all__, *tol3d._HOMES):
        assert getattr(tol3d, name).__doc__
    assert set(tol3d.__all__) <= set(dir(tol3d))


# docs/python.md -----------------------------------------------------------------------------------------------


def code_blocks(text: str) -> Iterator[str]:
    yield from re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


@pytest.mark.slow
def test_the_page_runs_as_it_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every block in its order, in one notebook; it names every public function."""
    text = (ROOT / "docs" / "python.md").read_text("utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    names: dict[str, Any] = {}
    for block in code_blocks(text):
        exec(block, names)
    assert all(f"tol3d.{name}" in text for name in tol3d.__all__)
    mean = names["pair"].summary["measures"]["backlash"]["geometric"]["mean"]
    # sigma of each is 20/6 um, of the sum cos 20 deg of it times sqrt 2: four standard errors of 1000 trials
    assert mean == pytest.approx(80 * math.cos(math.radians(20)), abs=4 * 4.43 / math.sqrt(1000))
    assert json.loads((tmp_path / "runs" / "spur_pair" / SUMMARY).read_text("utf-8"))["trials"] == 2000
