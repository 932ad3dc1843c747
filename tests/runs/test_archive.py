"""Contents of a run: the very bytes that ran, inside its own folder, so that any trial can be made again."""

from pathlib import Path

import numpy as np
import pytest
from of_kind import known
from places import SCENES

from tol3d import Overrides, RunError, Scene, SceneError, open_run, replay, run_scene
from tol3d.simulate import Execution, Watch
from tol3d.study.runs.writer import RunWriter

MEASURED = "n,e\n1,-30\n2,-25\n3,-21\n4,-35\n"
SCENE = """
scene: archived
parts:
  pinion: {kind: spur_gear, teeth: 28, module: 2.5 mm, face_width: 20 mm}
  wheel: {kind: spur_gear, teeth: 110, module: 2.5 mm, face_width: 20 mm}
tolerances:
  thickness: {kind: tooth_thickness, of: wheel, distribution: {kind: empirical, file: FILE, column: e, unit: um}}
moves: {pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 172.5 mm}}
measures: {normal backlash: {kind: normal_backlash, of: pair}}
"""
FEW = Overrides(trials=12, engine="analytic")


def written(folder: Path, file: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "scene.yaml").write_text(SCENE.replace("FILE", file), "utf-8")
    return folder / "scene.yaml"


def test_a_run_keeps_what_ran_though_scene_and_file_are_edited_meanwhile(tmp_path: Path) -> None:
    scene = written(tmp_path / "mine", "measured.csv")
    measured = scene.parent / "measured.csv"
    measured.write_text(MEASURED, "utf-8")
    as_it_was = scene.read_text("utf-8")

    def edit(stage: str) -> None:
        scene.write_text(as_it_was.replace("172.5", "172.6"), "utf-8")
        measured.write_text("n,e\n1,-90\n2,-80\n", "utf-8")

    run = run_scene(scene, overrides=FEW, out=tmp_path / "run", watch=Watch(activity=edit))
    assert run.scene_path.read_text("utf-8") == as_it_was
    assert run.files["measured.csv"].content == MEASURED.encode()
    column = run.columns("analytic:normal backlash")["analytic:normal backlash"]
    assert [replay(run, trial).analytic["normal backlash"] for trial in range(3)] == column[:3].tolist()
    # the pair has no play at 172.5 mm: what there is comes from the file: cos(20 deg) times 21 to 35 um ± 5.3 um
    assert 0.9396 * 15.7 < column.min() < column.max() < 0.9397 * 40.3


@pytest.mark.parametrize("named", ["../data.csv", "absolute", "../mine/inside.csv"])
def test_a_file_from_anywhere_is_kept_inside_the_run(named: str, tmp_path: Path) -> None:
    outside, inside = tmp_path / "data.csv", tmp_path / "mine" / "inside.csv"
    inside.parent.mkdir()
    for path in (outside, inside):
        path.write_text(MEASURED, "utf-8")
    scene = written(tmp_path / "mine", str(outside) if named == "absolute" else named)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()}
    run = run_scene(scene, overrides=FEW, out=tmp_path / "runs" / "run", trust_parts=True)
    assert {path: path.read_bytes() for path in before} == before
    assert {path.relative_to(run.path).parts[0] for path in run.path.rglob("*")} == {
        "SHA256SUMS",
        "contributors.csv",
        "scene.yaml",
        "summary.json",
        "trials",
        "files",
    }
    outside.unlink()
    inside.unlink()
    run = open_run(run.path)
    expected = run.columns("analytic:normal backlash")["analytic:normal backlash"][5]
    assert replay(run, 5).analytic["normal backlash"] == expected


def test_a_kept_file_that_was_changed_is_refused(tmp_path: Path) -> None:
    scene = written(tmp_path / "mine", "measured.csv")
    (scene.parent / "measured.csv").write_text(MEASURED, "utf-8")
    run = run_scene(scene, overrides=FEW, out=tmp_path / "run")
    run.scene_path.write_text("scene: another", "utf-8")
    with pytest.raises(RunError, match=r"scene\.yaml: was changed since the run was made"):
        replay(run, 0)
    (run.path / "scene.yaml").write_bytes(scene.read_bytes())
    next((run.path / "files").iterdir()).unlink()
    with pytest.raises(RunError, match=r"measured\.csv: cannot be read .*; the run is damaged"):
        replay(run, 0)


def test_a_run_replays_from_another_place(tmp_path: Path) -> None:
    scene = written(tmp_path / "mine", "measured.csv")
    (scene.parent / "measured.csv").write_text(MEASURED, "utf-8")
    run = run_scene(scene, overrides=FEW, out=tmp_path / "run")
    values = run.columns("analytic:normal backlash")["analytic:normal backlash"]
    moved = run.path.rename(tmp_path / "elsewhere")
    (scene.parent / "measured.csv").unlink()
    scene.unlink()
    assert len(set(values)) == FEW.trials  # any trial taken for another would be seen
    for run_there in (moved, open_run(moved)):
        again = [replay(run_there, trial).analytic["normal backlash"] for trial in range(len(values))]
        assert again == values.tolist()


def test_two_runs_into_one_folder_at_once_are_refused(tmp_path: Path) -> None:
    first = RunWriter(tmp_path / "run", {"scene": "1"}, {})
    with pytest.raises(RunError, match="another run is being written there"):
        RunWriter(tmp_path / "run", {"scene": "1"}, {})
    with pytest.raises(RunError, match="another run is being written there"):
        RunWriter(tmp_path / "run", {"scene": "2"}, {})
    first.close()
    RunWriter(tmp_path / "run", {"scene": "2"}, {}, force=True)


def test_a_run_that_failed_lets_go_of_its_folder_while_its_error_is_held(tmp_path: Path) -> None:
    def stop(trials: int) -> None:
        raise InterruptedError("in mid run")

    few = Overrides(trials=2 * 65_536, engine="analytic", witness=0)
    with pytest.raises(InterruptedError, match="in mid run") as held:
        run_scene(SCENES / "spur_pair.yaml", overrides=few, out=tmp_path / "run", watch=Watch(progress=stop))
    again = run_scene(SCENES / "spur_pair.yaml", overrides=few, out=tmp_path / "run", execution=Execution(resume=True))
    assert again.summary["trials"] == 2 * 65_536
    assert held.value.__traceback__ is not None


def test_blocks_of_another_study_are_thrown_away_by_force_only(tmp_path: Path) -> None:
    first = RunWriter(tmp_path / "run", {"scene": "1"}, {})
    first.write(0, {"a": np.arange(3.0)})
    del first
    again = RunWriter(tmp_path / "run", {"scene": "1"}, {})
    assert known(again.read(0))["a"].tolist() == [0.0, 1.0, 2.0]
    del again
    with pytest.raises(RunError, match="an interrupted run of another study is kept there"):
        RunWriter(tmp_path / "run", {"scene": "2"}, {})
    assert RunWriter(tmp_path / "run", {"scene": "2"}, {}, force=True).read(0) is None


# scenes made in Python ------------------------------------------------------------------------------


def made_in_python(**changes: object) -> Scene:
    gear = {"kind": "spur_gear", "module": "2.5 mm", "face_width": "20 mm"}
    law = {"kind": "normal", "lower": "-30 um", "upper": "-19 um"}
    fields: dict[str, object] = {
        "scene": "made in Python",
        "parts": {"pinion": {**gear, "teeth": 28}, "wheel": {**gear, "teeth": 110}},
        "tolerances": {"thickness": {"kind": "tooth_thickness", "of": "wheel", "distribution": law}},
        "moves": {"pair": {"kind": "mesh", "driver": "pinion", "driven": "wheel", "centre_distance": "172.55 mm"}},
        "measures": {"play": {"kind": "normal_backlash", "of": "pair"}},
    }
    return Scene.model_validate(fields | changes)


def test_a_scene_made_in_python_runs_and_replays(tmp_path: Path) -> None:
    run = run_scene(made_in_python(), overrides=FEW, out=tmp_path / "run")
    assert replay(run, 7).analytic["play"] == run.columns("analytic:play")["analytic:play"][7]
    again = run_scene(run.scene_path, overrides=FEW, out=tmp_path / "again")
    assert again.columns("analytic:play")["analytic:play"].tolist() == run.columns()["analytic:play"].tolist()


def test_a_scene_made_in_python_is_checked_like_one_from_a_file() -> None:
    scene = made_in_python(measures={"play": {"kind": "normal_backlash", "of": "pear"}})
    with pytest.raises(SceneError, match=r"expected the name of a mesh move, got 'pear'.*did you mean"):
        run_scene(scene, overrides=FEW)
