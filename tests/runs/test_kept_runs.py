"""Kept parts of a run count only if they are this run's own and unchanged."""

from pathlib import Path

import numpy as np
import pytest
from places import SPUR_PAIR

from tol3d import Overrides, RunError, open_run, replay, run_scene
from tol3d.simulate import Watch
from tol3d.study.execution.pools import Execution
from tol3d.study.results import task as block_module
from tol3d.study.runs.block_files import BlockFiles, block_name
from tol3d.study.runs.run import DamageWarning

BLOCK = 1000
STUDY = Overrides(trials=8 * BLOCK, engine="analytic")
STATISTICS_ONLY = Execution(keep_trials=False)
LIST = "_SHA256SUMS"


def cut(out: Path, blocks: int, execution: Execution) -> None:
    """Interrupt the study after so many blocks."""
    told: list[int] = []

    def stop(count: int) -> None:
        told.append(count)
        if len(told) >= blocks:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_scene(SPUR_PAIR, overrides=STUDY, out=out, execution=execution, watch=Watch(progress=stop))


def test_a_checkpoint_of_other_blocks_is_not_gone_on_from(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Four blocks of 1000 trials taken for four of 500 would be counted twice over."""
    monkeypatch.setattr(block_module, "BLOCK_TRIALS", BLOCK)
    cut(tmp_path / "run", 5, STATISTICS_ONLY)
    assert (tmp_path / "run.partial" / "checkpoint").exists()
    monkeypatch.setattr(block_module, "BLOCK_TRIALS", BLOCK // 2)
    found = run_scene(SPUR_PAIR, overrides=STUDY, out=tmp_path / "run", execution=STATISTICS_ONLY)
    fresh = run_scene(SPUR_PAIR, overrides=STUDY, out=tmp_path / "fresh", execution=STATISTICS_ONLY)
    assert found.summary["measures"]["normal backlash"]["analytic"]["count"] == STUDY.trials
    assert found.summary["measures"] == fresh.summary["measures"]


def test_a_run_that_keeps_its_trials_keeps_all_of_them_where_one_without_was_cut(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(block_module, "BLOCK_TRIALS", BLOCK)
    cut(tmp_path / "run", 5, STATISTICS_ONLY)
    kept = run_scene(SPUR_PAIR, overrides=STUDY, out=tmp_path / "run")
    values = open_run(kept.path).columns("analytic:normal backlash")["analytic:normal backlash"]
    assert len(values) == STUDY.trials
    assert kept.summary["measures"]["normal backlash"]["analytic"]["mean"] == pytest.approx(values.mean(), rel=1e-12)


def with_measured_thickness(folder: Path) -> Path:
    """The spur pair, its wheel as thick as a file says."""
    text = SPUR_PAIR.read_text("utf-8")
    old = "{kind: normal, lower: -32 um, upper: -21 um}"
    assert text.count(old) == 1
    law = "{kind: empirical, file: measured.csv, column: s, unit: um}"
    (folder / "scene.yaml").write_text(text.replace(old, law), "utf-8")
    (folder / "measured.csv").write_text("s\n-30\n-25\n-21\n-35\n", "utf-8")
    return folder / "scene.yaml"


def test_a_kept_table_of_measured_values_that_was_changed_is_refused(tmp_path: Path) -> None:
    """As many bytes, other values: a replay of it would be another trial."""
    run = run_scene(
        with_measured_thickness(tmp_path), overrides=Overrides(trials=10, engine="analytic"), out=tmp_path / "run"
    )
    replay(run.path, 3)
    (kept,) = (run.path / "files").iterdir()
    kept.write_text(kept.read_text("utf-8").replace("-30", "-90"), "utf-8")
    with pytest.raises(RunError, match=r"measured.*was changed since the run was made"):
        replay(run.path, 3)


def test_a_run_of_other_measured_values_is_another_study(tmp_path: Path) -> None:
    """The scene's text is the same; what it draws from is not."""
    scene, few = with_measured_thickness(tmp_path), Overrides(trials=10, engine="analytic")
    run = run_scene(scene, overrides=few, out=tmp_path / "run")
    thickness = run.columns()["wheel tooth thickness [um]"]
    (table,) = tmp_path.glob("*.csv")
    table.write_text(table.read_text("utf-8").replace("-30", "-90"), "utf-8")
    with pytest.raises(RunError, match=rf"run: holds another study \(files: {table.name} .* there, .* now\)"):
        run_scene(scene, overrides=few, out=tmp_path / "run")
    assert np.array_equal(open_run(tmp_path / "run").columns()["wheel tooth thickness [um]"], thickness)


def test_a_block_without_a_line_in_the_list_is_refused_and_mended(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Nobody knows what such a block should be; here it is one that was exchanged for another of the run."""
    monkeypatch.setattr(block_module, "BLOCK_TRIALS", BLOCK)
    run = run_scene(SPUR_PAIR, overrides=STUDY, out=tmp_path / "run")
    before = run.columns()
    blocks = run.path / "trials"
    lines = (blocks / LIST).read_text("utf-8").splitlines(keepends=True)
    (blocks / LIST).write_text("".join(line for line in lines if "block-000003" not in line), "utf-8")
    (blocks / "block-000003.parquet").write_bytes((blocks / "block-000005.parquet").read_bytes())
    with pytest.raises(RunError):
        open_run(run.path).columns()
    with pytest.warns(DamageWarning):
        mended = run_scene(SPUR_PAIR, overrides=STUDY, out=tmp_path / "run", execution=Execution(resume=True))
    assert mended.summary["timing"]["resumed_trials"] == 7 * BLOCK
    after = mended.columns()
    assert all(np.array_equal(before[name], after[name]) for name in before)


def test_a_file_of_a_block_without_a_line_is_none_of_the_run(tmp_path: Path) -> None:
    """A kill leaves one that nobody vouches for: it is not counted, not read and not held to be whole."""
    files = BlockFiles(tmp_path)
    for index in range(3):
        files.write(block_name(index), {"a": np.arange(4.0) + index})
    lines = (tmp_path / LIST).read_text("utf-8").splitlines(keepends=True)
    (tmp_path / LIST).write_text("".join(line for line in lines if block_name(1) not in line), "utf-8")
    again = BlockFiles(tmp_path)
    assert [block_name(index) in again for index in range(3)] == [True, False, True]
    for asked in (again.read, again.verify):
        with pytest.raises(RunError, match="its SHA-256 is another"):
            asked(block_name(1))
    assert again.read(block_name(2))["a"].tolist() == [2.0, 3.0, 4.0, 5.0]
