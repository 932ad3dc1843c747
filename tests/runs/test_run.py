"""The run as a whole: same bits whatever the workers, replay, resume, failures kept as data."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from places import SCENES, SPUR_PAIR

from tol3d import InputError, Overrides, Run, RunError, load_scene, open_run, replay, run_scene
from tol3d.simulate import Watch
from tol3d.study.execution import folding
from tol3d.study.execution.pools import Execution
from tol3d.study.results import task as block_module
from tol3d.study.runs.run import DamageWarning
from tol3d.study.runs.worst import worst_trial


def assert_same_bits(first: dict[str, np.ndarray], second: dict[str, np.ndarray], rows: slice = slice(None)) -> None:
    assert first.keys() == second.keys()
    for name in first:
        mine, its = first[name][rows], second[name]
        assert mine.dtype.kind == its.dtype.kind
        if mine.dtype.kind == "f":
            assert np.array_equal(mine.view(np.int64), its.view(np.int64)), name
        else:
            assert np.array_equal(mine, its), name


@pytest.fixture(scope="module")
def spur_run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run_scene(SPUR_PAIR, overrides=Overrides(trials=300), out=tmp_path_factory.mktemp("runs") / "spur")


def test_two_workers_give_the_same_bits_as_one(spur_run: Run, tmp_path: Path) -> None:
    other = run_scene(SPUR_PAIR, overrides=Overrides(trials=300), out=tmp_path / "two", execution=Execution(workers=2))
    assert_same_bits(spur_run.columns(), other.columns())
    for name, measure in spur_run.summary["measures"].items():
        assert other.summary["measures"][name] == measure


def test_more_trials_leave_the_first_ones_as_they_were(spur_run: Run, tmp_path: Path) -> None:
    fewer = run_scene(SPUR_PAIR, overrides=Overrides(trials=120), out=tmp_path / "fewer")
    assert_same_bits(spur_run.columns(), fewer.columns(), slice(120))


def test_a_replayed_trial_has_the_run_s_bits(spur_run: Run) -> None:
    columns = spur_run.columns()
    for trial in (0, 17, 299):
        again = replay(spur_run, trial)
        assert again.status == columns["status"][trial]
        for name in ("normal backlash", "lost motion"):
            assert again.geometric[name] == columns[f"geometric:{name}"][trial]
            assert again.analytic[name] == columns[f"analytic:{name}"][trial]


def test_replay_of_a_trial_that_is_not_there_is_refused(spur_run: Run) -> None:
    with pytest.raises(InputError, match="expected 0 to 299"):
        replay(spur_run, 300)


def test_adding_a_contributor_leaves_the_others_draws_as_they_were(spur_run: Run, tmp_path: Path) -> None:
    text = SPUR_PAIR.read_text("utf-8")
    added = "tolerances:\n  another one: {kind: axial_shift, of: wheel, distribution: {kind: constant, value: 5 um}}\n"
    scene = tmp_path / "more.yaml"
    scene.write_text(text.replace("tolerances:\n", added, 1), "utf-8")
    columns = run_scene(scene, overrides=Overrides(trials=50), out=tmp_path / "more").columns()
    before = spur_run.columns()
    for name in before:
        if not name.startswith(("analytic:", "geometric:", "contact:", "status")):
            assert np.array_equal(before[name][:50], columns[name]), name


def test_the_worst_trial_is_the_one_nearest_to_the_limit(spur_run: Run) -> None:
    assert worst_trial(spur_run) == int(np.argmin(spur_run.columns()["geometric:normal backlash"]))


def test_summary_agrees_with_the_columns(spur_run: Run) -> None:
    columns, summary = spur_run.columns(), json.loads((spur_run.path / "summary.json").read_text("utf-8"))
    for name, measure in summary["measures"].items():
        for method in ("analytic", "geometric"):
            values = columns[f"{method}:{name}"]
            assert measure[method]["mean"] == pytest.approx(values.mean(), rel=1e-12)
            assert measure[method]["sigma"] == pytest.approx(values.std(ddof=1), rel=1e-10)
            assert measure[method]["sample_min"] == values.min()
            # the grid's quantile lies in the bin of the order statistic
            bound = 2 * measure[method]["quantile_error"]
            assert measure[method]["p50"] == pytest.approx(np.sort(values)[149], abs=bound)
        difference = columns[f"geometric:{name}"] - columns[f"analytic:{name}"]
        assert measure["agreement"]["max_abs_difference"] == pytest.approx(np.abs(difference).max(), rel=1e-12)


def test_a_run_keeps_the_scene_and_its_study(spur_run: Run) -> None:
    assert (spur_run.path / "scene.yaml").read_text("utf-8") == SPUR_PAIR.read_text("utf-8")
    assert spur_run.summary["study"]["trials"] == 300
    assert spur_run.summary["files"].keys() == {"scene.yaml"}
    assert len(spur_run.summary["files"]["scene.yaml"]) == 64


def test_an_analytic_run_needs_no_geometry(tmp_path: Path) -> None:
    run = run_scene(SPUR_PAIR, overrides=Overrides(trials=1000, engine="analytic"), out=tmp_path / "analytic")
    assert not [name for name in run.column_names if name.startswith("geometric:")]
    assert "geometric" not in run.summary["measures"]["normal backlash"]


def test_an_older_run_is_replaced_and_anything_else_is_left_alone(tmp_path: Path) -> None:
    study = Overrides(trials=20, engine="analytic")
    folder = tmp_path / "run"
    run_scene(SPUR_PAIR, overrides=study, out=folder)
    assert run_scene(SPUR_PAIR, overrides=study, out=folder).trials == 20
    other = tmp_path / "mine"
    other.mkdir()
    (other / "thesis.txt").write_text("precious")
    with pytest.raises(RunError, match="not a tol3d run"):
        run_scene(SPUR_PAIR, overrides=study, out=other)
    assert (other / "thesis.txt").read_text() == "precious"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine", "run"]


def test_a_folder_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    with pytest.raises(RunError, match="cannot be written"):
        run_scene(SPUR_PAIR, overrides=Overrides(trials=5, engine="analytic"), out=blocked / "run")


def test_trials_that_interfere_keep_their_row_and_their_status(tmp_path: Path) -> None:
    scene = tmp_path / "tight.yaml"
    # +-60 um about a mean build with 2 um of play: about half of the builds cannot be put together
    text = SPUR_PAIR.read_text("utf-8").replace("centre_distance: 172.5 mm", "centre_distance: 172.425 mm")
    scene.write_text(text.replace("lower: -20 um, upper: 20 um", "lower: -60 um, upper: 60 um"), "utf-8")
    run = run_scene(scene, overrides=Overrides(trials=200), out=tmp_path / "tight")
    columns = run.columns()
    failed = columns["status"] == "interferes"
    assert 20 < failed.sum() < 180
    assert np.array_equal(columns["geometric:normal backlash"] < -1e-3, failed)  # a nanometre less than free is free
    # what the closed form calls an overlap by more than the mesh error has that status, and only that
    analytic = columns["analytic:normal backlash"]
    assert failed[analytic < -0.15].all()
    assert not failed[analytic > 0.15].any()
    summary = run.summary["measures"]["normal backlash"]["geometric"]
    assert summary["count"] == (~failed).sum()
    assert summary["failed_ppm"] == pytest.approx(1e6 * failed.mean())
    assert run.summary["status"] == {
        "ok": int((~failed).sum()),
        "interferes": int(failed.sum()),
        "no contact": 0,
        "out of range": 0,
    }


def test_a_killed_run_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(block_module, "BLOCK_TRIALS", 500)
    study = Overrides(trials=3000, engine="analytic")
    whole = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "whole")
    done = 0

    def stop_in_the_middle(count: int) -> None:
        nonlocal done
        done += count
        if done > 1200:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "cut", watch=Watch(progress=stop_in_the_middle))
    kept = sorted((tmp_path / "cut.partial" / "trials").glob("*.parquet"))
    assert len(kept) == 3
    before = [path.stat().st_mtime_ns for path in kept]
    kept[1].write_bytes(kept[1].read_bytes()[:-100])  # a damaged block is made again
    with pytest.warns(DamageWarning, match=r"block-000001\.parquet: damaged .*; it is made again"):
        resumed = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "cut")
    assert_same_bits(whole.columns(), resumed.columns())
    assert resumed.summary["measures"] == whole.summary["measures"]
    assert resumed.summary["timing"]["resumed_trials"] == 1000
    after = sorted((tmp_path / "cut" / "trials").glob("*.parquet"))
    assert after[0].stat().st_mtime_ns == before[0]  # a whole block is not
    assert not (tmp_path / "cut.partial").exists()


@pytest.mark.slow
def test_pieces_of_an_unfinished_block_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(folding, "KEEP_EVERY", 0.0)
    study = Overrides(trials=2000, engine="fcl")
    whole = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "whole")
    seen: list[int] = []

    def stop_in_the_middle(count: int) -> None:
        seen.append(count)
        if sum(seen) > 1000:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "cut", watch=Watch(progress=stop_in_the_middle))
    kept = list((tmp_path / "cut.partial" / "pieces").glob("*.parquet"))
    assert len(kept) == 3  # of 256 trials each; the fourth was told of before it was kept
    told: list[int] = []
    resumed = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "cut", watch=Watch(progress=told.append))
    assert told[:3] == [256, 256, 256]
    assert sum(told) == 2000
    assert_same_bits(whole.columns(), resumed.columns())
    assert sorted(path.name for path in (tmp_path / "cut").iterdir()) == [
        "SHA256SUMS",
        "contributors.csv",
        "correlations.csv",
        "scene.yaml",
        "summary.json",
        "trials",
    ]


def test_a_damaged_block_of_a_run_is_named(tmp_path: Path) -> None:
    run = run_scene(SPUR_PAIR, overrides=Overrides(trials=20, engine="analytic"), out=tmp_path / "run")
    block = tmp_path / "run" / "trials" / "block-000000.parquet"
    block.write_bytes(block.read_bytes()[:-50])
    with pytest.raises(RunError, match=r"block-000000\.parquet: damaged"):
        run.columns()


def test_a_partial_of_another_study_is_not_used(tmp_path: Path) -> None:
    folder = tmp_path / "run.partial" / "trials"
    folder.mkdir(parents=True)
    (folder.parent / "fingerprint.json").write_text("{}")
    (folder / "block-000000.parquet").write_text("of another study")
    run = run_scene(SPUR_PAIR, overrides=Overrides(trials=20, engine="analytic"), out=tmp_path / "run")
    assert run.trials == 20


def test_a_kill_leaves_no_run_behind(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tol3d.cli", "run", str(SPUR_PAIR), "--trials", "200000", "--workers", "1"]
    process = subprocess.Popen([*command, "--out", str(tmp_path / "run")], stderr=subprocess.DEVNULL)
    for _ in range(600):
        if (tmp_path / "run.partial").exists():
            break
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not (tmp_path / "run").exists()
    with pytest.raises(RunError, match="was not finished"):
        open_run(tmp_path / "run.partial")


def test_a_curve_is_out_of_limits_where_any_position_is(tmp_path: Path) -> None:
    text = SPUR_PAIR.read_text("utf-8")
    curve = "lost curve: {kind: normal_backlash, of: gear pair, over: turn, take: curve, positions: 8, "
    measures = f"measures:\n  {curve}lower_limit: 45 um, upper_limit: 70 um}}\n"
    scene = tmp_path / "curve.yaml"
    scene.write_text(text.replace("measures:\n", measures, 1), "utf-8")
    run = run_scene(scene, overrides=Overrides(trials=400, engine="analytic"), out=tmp_path / "curve")
    curves = run.columns("analytic:lost curve")["analytic:lost curve"]
    assert curves.shape == (400, 9)  # eight steps, and the end of the turn
    own = run.summary["measures"]["lost curve"]["curve"]["analytic"]
    assert own["below_limit_ppm"] == pytest.approx(1e6 * (curves < 45).any(axis=1).mean())
    assert own["above_limit_ppm"] == pytest.approx(1e6 * (curves > 70).any(axis=1).mean())
    assert own["mean"] == pytest.approx(curves.mean(axis=0))


def test_draws_below_zero_of_a_clearance_are_kept_and_counted(tmp_path: Path) -> None:
    # N(16, 14/3) um falls below 0 with 3.0e-4: of 20 000 expect 6.1, and between 1 and 16 but for one in 1e4 seeds
    run = run_scene(SPUR_PAIR, overrides=Overrides(trials=20_000, engine="analytic"), out=tmp_path / "run")
    below = int((run.columns("bearing clearance [um]")["bearing clearance [um]"] < 0).sum())
    assert 1 <= below <= 16
    (warning,) = run.summary["warnings"]
    assert warning.startswith(f"bearing clearance: {below} of 20000 draws are below zero")


def test_damaged_runs_are_refused_by_name(spur_run: Run, tmp_path: Path) -> None:
    with pytest.raises(RunError, match="expected a run's folder"):
        open_run(tmp_path)
    with pytest.raises(RunError, match=rf'did you mean "{spur_run.path.name}"'):
        open_run(spur_run.path.with_name(f"{spur_run.path.name}s"))
    with pytest.raises(RunError, match=r"tol3d run .*spur_pair\.yaml makes one"):
        open_run(SPUR_PAIR)
    (tmp_path / "summary.json").write_text("[1, 2")
    with pytest.raises(RunError, match="cannot be read"):
        open_run(tmp_path)
    with pytest.raises(RunError, match="no column"):
        spur_run.columns("geometric:nothing")


def test_a_scene_with_other_tolerances_is_simulated_with_them() -> None:
    """A run keeps the present content of a scene, not what its file said before."""
    scene = load_scene(SCENES / "spur_pair.yaml")
    wider = {**scene.tolerances, "centre distance": scene.tolerances["wheel tooth thickness"]}
    before, after = (
        run_scene(s, overrides=Overrides(trials=50)) for s in (scene, scene.model_copy(update={"tolerances": wider}))
    )
    # a second thickness of -32 ... -21 um in the place of the centre distance: 26.5 cos 20 um more backlash
    shift = after.summary["measures"]["normal backlash"]["mean_build"]["geometric"]
    shift -= before.summary["measures"]["normal backlash"]["mean_build"]["geometric"]
    assert shift == pytest.approx(26.5 * math.cos(math.radians(20)), abs=0.01)
