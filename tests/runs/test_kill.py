"""A run that is killed, interrupted, damaged or out of disk goes on to the same bits."""

import errno
import json
import os
import random
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from fixtures import Command
from places import SPUR_PAIR
from scene_texts import written

from tol3d import InputError, Overrides, Run, RunError, open_run, replay, run_scene
from tol3d.simulate import Watch
from tol3d.study.execution.pools import Execution
from tol3d.study.results import task as block_module
from tol3d.study.runs.checkpoint import Checkpoint, CheckpointWarning
from tol3d.study.runs.run import DamageWarning
from tol3d.study.runs.worst import worst_trial
from tol3d.study.tallies.tally import Tally

BLOCK = 2000
ANALYTIC = Overrides(trials=10 * BLOCK, engine="analytic")
STATISTICS_ONLY = Execution(keep_trials=False)
RESUME = Execution(resume=True)

HANGS = 300  # s; a guard against waiting for ever, no claim

# `tol3d` with small blocks and frequent checkpoints, each block made to last 20 ms, so that kills fall everywhere;
# it sends itself a signal before it puts a file in its place for the so-manieth time, if it was told to
SMALL_BLOCKS = f"""
import os, sys, time
from tol3d import cli
from tol3d.study.execution import folding
from tol3d.study.results import task
task.BLOCK_TRIALS = {BLOCK}
folding.KEEP_EVERY = 0.0
made = task.columns_of
task.columns_of = lambda *arguments: (time.sleep(0.02), made(*arguments))[1]
told, at = (int(word) for word in sys.argv[1:3])
real, calls = os.replace, iter(range(10**9))
def replace(*arguments):
    if next(calls) == at:
        os.kill(os.getpid(), told)
    real(*arguments)
os.replace = replace
sys.argv = ["tol3d", *sys.argv[3:]]
cli.main()
"""


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(block_module, "BLOCK_TRIALS", BLOCK)


def command(out: Path, *more: str, told: signal.Signals = signal.SIGKILL, at: int = -1) -> list[str]:
    """`tol3d run` as above; `told` at the file of number `at`, from 0 on, or never."""
    words = ["run", str(SPUR_PAIR), "--out", str(out), *more]
    return [sys.executable, "-c", SMALL_BLOCKS, str(int(told)), str(at), *words]


def ended(*arguments: str) -> subprocess.CompletedProcess[str]:
    """A command that has ended, however."""
    return subprocess.run(arguments, capture_output=True, text=True, timeout=HANGS)


def kept_blocks(out: Path) -> int:
    """Number of blocks that an interrupted run has kept: as files, or else in its statistics."""
    partial = out.with_name(out.name + ".partial")
    files = len(list((partial / "trials").glob("*.parquet")))
    counted = Checkpoint(partial / "checkpoint", Tally).read()
    return max(files, counted[0] if counted else 0)


def assert_same_run(first: Run, second: Run) -> None:
    """Columns and statistics, to the last bit; JSON keeps every bit of a double."""
    assert second.summary["measures"] == first.summary["measures"]
    assert second.summary.get("joint") == first.summary.get("joint")
    assert second.summary["status"] == first.summary["status"]
    assert second.trials == first.trials
    assert second.keeps_trials == first.keeps_trials
    if first.keeps_trials:
        mine, its = first.columns(), second.columns()
        assert mine.keys() == its.keys()
        assert all(np.array_equal(mine[name].view("u1"), its[name].view("u1")) for name in mine if name != "status")
        assert np.array_equal(mine.get("status", 0), its.get("status", 0))


def killed_by_the_clock_and_resumed(out: Path, kills: int, seed: int, *more: str) -> Run:
    """A run that was killed `kills` times at random moments after its first trials, and resumed each time."""
    moments = random.Random(seed)
    done = 0
    for _ in range(10 * kills):
        process = subprocess.Popen(command(out, *more), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        try:
            process.wait(moments.uniform(0.0, 1.8))
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait(HANGS)
            done += 1
        else:
            assert process.returncode == 0, process.stderr and process.stderr.read()
            shutil.rmtree(out)  # it had ended: from the start again
        if done == kills:
            break
    assert done == kills
    assert ended(*command(out, *more)).returncode == 0
    return open_run(out)


def killed_while_writing_and_resumed(out: Path, kills: int, seed: int, *more: str) -> Run:
    """A run that was killed `kills` times before it put some file in its place, and resumed each time."""
    moments = random.Random(seed)
    kept = [0]
    for _ in range(kills):
        # four files are written before the first block, and of each block two: 13 files in at most five blocks
        killed = ended(*command(out, *more, at=moments.randrange(6, 13)))
        assert killed.returncode == -signal.SIGKILL, killed.stderr
        assert not out.exists()
        kept.append(kept_blocks(out))
        assert kept[-2] < kept[-1] < BLOCKS  # each went on from what the one before had left, and left some to do
    whole = ended(*command(out, *more))
    assert whole.returncode == 0, whole.stderr
    resumed = open_run(out)
    assert resumed.summary["timing"]["resumed_trials"] == kept[-1] * BLOCK
    return resumed


BLOCKS = 26
KINDS = {
    "exact": ("--engine", "exact", "--witness", "0", "--trials", str(25 * BLOCK + 77), "--workers", "2"),
    "exact, statistics only": (
        *("--engine", "exact", "--witness", "0", "--trials", str(25 * BLOCK + 77), "--workers", "2", "--no-trials"),
    ),
    "analytic": ("--engine", "analytic", "--trials", str(25 * BLOCK + 77), "--workers", "2"),
    "fcl": ("--engine", "fcl", "--trials", str(2 * BLOCK + 77), "--workers", "1"),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_killed_at_twenty_moments_a_run_ends_with_the_same_bits(kind: str, tmp_path: Path) -> None:
    subprocess.run(command(tmp_path / "whole", *KINDS[kind]), check=True, capture_output=True, timeout=HANGS)
    resumed = killed_by_the_clock_and_resumed(tmp_path / "killed", 20, 20, *KINDS[kind])
    assert_same_run(open_run(tmp_path / "whole"), resumed)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["killed", "whole"]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["exact", "exact, statistics only"])
@pytest.mark.usefixtures("small_blocks")
def test_killed_at_two_files_a_run_ends_with_the_same_bits(kind: str, tol3d: Command, tmp_path: Path) -> None:
    more = (*KINDS[kind], "--no-picture")
    assert tol3d("run", str(SPUR_PAIR), "--out", str(tmp_path / "whole"), *more)[0] == 0
    resumed = killed_while_writing_and_resumed(tmp_path / "killed", 2, 3, *more)
    assert_same_run(open_run(tmp_path / "whole"), resumed)


@pytest.mark.slow
def test_ctrl_c_tells_the_command_that_goes_on(tmp_path: Path) -> None:
    out = tmp_path / "run"
    stopped = ended(*command(out, *KINDS["analytic"], told=signal.SIGINT, at=12))
    assert stopped.returncode == 130, stopped.stderr
    told = stopped.stderr
    line = told.splitlines()[-1]
    assert line == f"tol3d run {SPUR_PAIR} --out {out} {' '.join(KINDS['analytic'])} --resume"
    assert "Traceback" not in told
    assert 0 < kept_blocks(out) < BLOCKS
    subprocess.run([*command(out), *line.split()[5:]], check=True, capture_output=True, timeout=HANGS)
    assert 0 < open_run(out).summary["timing"]["resumed_trials"] < 25 * BLOCK


# resume -------------------------------------------------------------------------------------------


def cut(out: Path, trials: int, overrides: Overrides = ANALYTIC, execution: Execution = Execution()) -> None:  # noqa: B008
    """Interrupt a run after some trials."""
    told: list[int] = []

    def stop(count: int) -> None:
        told.append(count)
        if sum(told) >= trials:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_scene(SPUR_PAIR, overrides=overrides, out=out, execution=execution, watch=Watch(progress=stop))


@pytest.mark.usefixtures("small_blocks")
def test_statistics_without_trials_are_those_with_them(tmp_path: Path) -> None:
    kept = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "kept")
    bare = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "bare", execution=STATISTICS_ONLY)
    assert bare.summary["measures"] == kept.summary["measures"]
    files = ["SHA256SUMS", "contributors.csv", "correlations.csv", "scene.yaml", "summary.json"]
    assert sorted(path.name for path in bare.path.iterdir()) == files
    expected = kept.columns("analytic:normal backlash")["analytic:normal backlash"][4321]
    assert replay(open_run(bare.path), 4321).analytic["normal backlash"] == expected
    for asked in (bare.columns, lambda: worst_trial(bare)):
        with pytest.raises(RunError, match="kept its statistics only"):
            asked()


@pytest.mark.usefixtures("small_blocks")
def test_statistics_go_on_from_their_checkpoint(tmp_path: Path) -> None:
    whole = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "whole", execution=STATISTICS_ONLY)
    cut(tmp_path / "run", 5 * BLOCK, execution=STATISTICS_ONLY)
    resumed = run_scene(
        SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run", execution=Execution(keep_trials=False, resume=True)
    )
    assert resumed.summary["timing"]["resumed_trials"] == 4 * BLOCK  # progress is told before a block counts
    assert_same_run(whole, resumed)


@pytest.mark.usefixtures("small_blocks")
def test_a_damaged_checkpoint_is_told_of_and_not_used(tmp_path: Path) -> None:
    whole = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "whole", execution=STATISTICS_ONLY)
    cut(tmp_path / "run", 5 * BLOCK, execution=STATISTICS_ONLY)
    checkpoint = tmp_path / "run.partial" / "checkpoint"
    content = bytearray(checkpoint.read_bytes())
    content[len(content) // 2] ^= 1
    checkpoint.write_bytes(content)
    with pytest.warns(CheckpointWarning, match="checkpoint: damaged"):
        resumed = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run", execution=STATISTICS_ONLY)
    assert resumed.summary["timing"]["resumed_trials"] == 0
    assert_same_run(whole, resumed)


def truncated(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-100])


def altered(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


DAMAGES: dict[str, Callable[[Path], None]] = {"truncated": truncated, "altered": altered, "missing": Path.unlink}


@pytest.mark.usefixtures("small_blocks")
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_block_of_a_finished_run_is_refused_and_mended(damage: str, tmp_path: Path) -> None:
    whole = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "whole")
    shutil.copytree(whole.path, tmp_path / "run")
    DAMAGES[damage](tmp_path / "run" / "trials" / "block-000003.parquet")
    with pytest.raises(RunError, match=r"block-000003\.parquet: damaged .*`tol3d run` with --resume makes it again"):
        open_run(tmp_path / "run").columns("analytic:normal backlash")
    with pytest.warns(DamageWarning, match=r"block-000003\.parquet: damaged .*; it is made again"):
        mended = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run", execution=RESUME)
    assert mended.summary["timing"]["resumed_trials"] == 9 * BLOCK
    assert_same_run(whole, mended)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run", "whole"]


@pytest.mark.usefixtures("small_blocks")
def test_resuming_a_whole_run_leaves_it_as_it_is(tmp_path: Path) -> None:
    run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run")
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")}
    run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run", execution=RESUME)
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")} == before


@pytest.mark.usefixtures("small_blocks")
def test_a_block_damaged_behind_the_checkpoint_is_made_again(tmp_path: Path) -> None:
    whole = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "whole")
    cut(tmp_path / "run", 5 * BLOCK)
    altered(tmp_path / "run.partial" / "trials" / "block-000001.parquet")
    with pytest.warns(DamageWarning, match=r"block-000001\.parquet"):
        resumed = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run", execution=RESUME)
    assert_same_run(whole, resumed)


@pytest.mark.usefixtures("small_blocks")
def test_resume_needs_something_to_go_on_with(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"run: nothing to resume, neither a run nor run\.partial is there"):
        run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run", execution=RESUME)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("small_blocks")
def test_resume_of_something_else_says_what_differs_and_leaves_it(tmp_path: Path) -> None:
    cut(tmp_path / "run", 3 * BLOCK)
    before = sorted(tmp_path.rglob("*"))
    other = written(SPUR_PAIR.read_text("utf-8").replace("172.5 mm", "172.51 mm"), tmp_path)
    seeded = Overrides(trials=ANALYTIC.trials, engine="analytic", seed=5)
    for scene, study, execution, words in (
        (SPUR_PAIR, seeded, RESUME, "study: seed 1 there, 5 now"),
        (other, ANALYTIC, RESUME, "the scene's text"),
        (SPUR_PAIR, ANALYTIC, Execution(keep_trials=False, resume=True), "blocks: kept True there, False now"),
    ):
        with pytest.raises(RunError, match=words):
            run_scene(scene, overrides=study, out=tmp_path / "run", execution=execution)
    other.unlink()
    assert sorted(tmp_path.rglob("*")) == before
    run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run", execution=RESUME)
    with pytest.raises(RunError, match=r"this is a finished run of something else .*study: seed 1 there, 5 now"):
        run_scene(SPUR_PAIR, overrides=seeded, out=tmp_path / "run", execution=RESUME)


@pytest.mark.usefixtures("small_blocks")
def test_a_kill_before_anything_was_kept_is_in_nobody_s_way(tmp_path: Path) -> None:
    (tmp_path / "run.partial").mkdir()
    for name in ("lock", "fingerprint.json.writing"):
        (tmp_path / "run.partial" / name).touch()
    assert run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run").trials == ANALYTIC.trials


# a full disk --------------------------------------------------------------------------------------


@pytest.fixture
def tiny_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 1.5 MB, on which five blocks of these studies have room."""
    place = tmp_path / "disk"
    place.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1500k", "none", str(place)], capture_output=True)
    if mounted.returncode != 0:
        pytest.skip("nothing may be mounted here")
    yield place
    subprocess.run(["umount", str(place)], check=True)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("mount") is None, reason="no mount")
def test_a_full_disk_is_told_and_loses_nothing(tiny_disk: Path, tmp_path: Path) -> None:
    study = ("--engine", "analytic", "--trials", str(10 * BLOCK), "--workers", "2")
    subprocess.run(command(tmp_path / "whole", *study), check=True, capture_output=True, timeout=HANGS)
    told = subprocess.run(command(tiny_disk / "run", *study), capture_output=True, text=True, timeout=HANGS)
    assert told.returncode == 2, told.stderr
    kept = list((tiny_disk / "run.partial" / "trials").glob("*.parquet"))
    words = f"no space left on the disk: {len(kept) * BLOCK} of {10 * BLOCK} trials are kept in {tiny_disk}/run.partial"
    assert f"{words}; make room, then the same command resumes" in told.stderr
    assert 1 <= len(kept) < 10
    before = {path: path.read_bytes() for path in kept}
    subprocess.run(["mount", "-o", "remount,size=20m", str(tiny_disk)], check=True)
    subprocess.run(command(tiny_disk / "run", *study), check=True, capture_output=True, timeout=HANGS)
    finished = open_run(tiny_disk / "run")
    assert finished.summary["timing"]["resumed_trials"] >= len(kept) * BLOCK
    assert all((finished.path / "trials" / path.name).read_bytes() == content for path, content in before.items())
    assert_same_run(open_run(tmp_path / "whole"), finished)


def refusal(call: Callable[[], object]) -> str | None:
    """Message with which a call is refused; None if it is not."""
    try:
        call()
    except RunError as error:
        return str(error)
    return None


@pytest.mark.usefixtures("small_blocks")
def test_every_write_may_find_the_disk_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "whole")
    real, calls = os.fsync, iter(range(10**6))

    def full_at(number: int) -> None:
        def fsync(descriptor: int) -> None:
            if next(calls) >= number:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            real(descriptor)

        monkeypatch.setattr(os, "fsync", fsync)

    refused = 0
    for number in range(3, 10**6, 3):  # the first three are written before the study begins
        calls = iter(range(10**6))
        full_at(number)
        told = refusal(lambda: run_scene(SPUR_PAIR, overrides=ANALYTIC, out=tmp_path / "run"))
        if told is None:
            break
        refused += 1
        kept = len(list((tmp_path / "run.partial" / "trials").glob("*.parquet")))
        assert f"no space left on the disk: {kept * BLOCK} of {10 * BLOCK} trials are kept" in told
        assert not list(tmp_path.rglob("*.writing"))
    assert refused >= 3
    assert_same_run(whole, open_run(tmp_path / "run"))


def test_a_summary_keeps_every_bit() -> None:
    # what assert_same_run rests on
    values = np.random.default_rng(1).normal(size=1000) * 1e-7
    assert json.loads(json.dumps(values.tolist())) == values.tolist()
