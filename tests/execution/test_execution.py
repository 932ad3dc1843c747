"""Blocks handed out, folded and kept: in order, bounded, and the same whoever works."""

import math
import tempfile
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
from gear_trials import simulated
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from places import SPUR_PAIR

from tol3d import Overrides, RunError, run_scene
from tol3d.gearing.model import Model
from tol3d.statistics.estimates import Moments
from tol3d.study.execution.folding import Columns, Plan, Progress, run_blocks
from tol3d.study.execution.pools import CALLS_A_SLOT, Concurrency, Execution, InThisProcess, Ready, in_order, pool_of
from tol3d.study.results import task as block_module
from tol3d.study.results.task import Task
from tol3d.study.results.versions import installed_versions
from tol3d.study.runs.checkpoint import Checkpoint, CheckpointWarning

BLOCK = 2000


@dataclass(frozen=True)
class Draws:
    """Work whose values are a pure function of the trial."""

    concurrency: Concurrency

    def columns(self, first: int, count: int) -> Columns:
        return {"value": np.sin(np.arange(first, first + count) * 1.7)}

    def statistics(self, first: int, columns: Columns) -> Moments:
        return Moments.of(np.asarray(columns["value"], dtype=np.float64))

    def block(self, first: int, count: int, progress: Progress = lambda done: None) -> tuple[Columns, Moments]:
        columns = self.columns(first, count)
        return columns, self.statistics(first, columns)


@dataclass(frozen=True)
class Shelf:
    """Keeps blocks in memory."""

    blocks: dict[int, Columns] = field(default_factory=dict)
    pieces: dict[tuple[int, int], Columns] = field(default_factory=dict)

    def holds(self, index: int) -> bool:
        return index in self.blocks

    def read(self, index: int) -> Columns | None:
        return self.blocks.get(index)

    def write(self, index: int, columns: Columns) -> None:
        self.blocks[index] = columns

    def read_piece(self, index: int, first: int) -> Columns | None:
        return self.pieces.get((index, first))

    def write_piece(self, index: int, first: int, columns: Columns) -> None:
        self.pieces[index, first] = columns


@dataclass(frozen=True)
class Checkpoints:
    """Keeps statistics in memory."""

    kept: list[tuple[int, Moments]] = field(default_factory=list)

    def read(self) -> tuple[int, Moments] | None:
        return self.kept[-1] if self.kept else None

    def write(self, blocks: int, statistics: Moments) -> None:
        self.kept.append((blocks, statistics))


PLAN = Plan(trials=5321, block_trials=700, positions=2)
POOLS = {
    "alone": (1, Concurrency.THREADS),
    "three threads": (3, Concurrency.THREADS),
    "two processes": (2, Concurrency.PROCESSES),
}


def known_to(mean_se: float) -> Callable[[Moments], bool]:
    return lambda moments: moments.mean_se <= mean_se


@pytest.mark.parametrize("concurrency", Concurrency)
@pytest.mark.parametrize("pool", POOLS)
def test_a_study_gives_the_same_bits_and_stops_at_the_same_block_whoever_works(
    pool: str, concurrency: Concurrency
) -> None:
    blocks = [Draws(concurrency).block(block.first, block.count)[1] for block in PLAN.blocks()]
    folded = [blocks[0]]
    for moments in blocks[1:]:
        folded.append(folded[-1].merge(moments))
    for enough, end in ((0.0, 8), (folded[3].mean_se, 4)):
        shelf, checkpoints = Shelf(), Checkpoints()
        with pool_of(POOLS[pool][0], None, POOLS[pool][1]) as workers:
            outcome = run_blocks(Draws(concurrency), PLAN, workers, shelf, checkpoints, enough=known_to(enough))
        assert outcome.statistics == folded[end - 1]
        assert outcome.trials == min(700 * end, 5321)
        values = np.concatenate([shelf.blocks[index]["value"] for index in range(end)])
        assert np.array_equal(values, np.sin(np.arange(len(values)) * 1.7))


@pytest.mark.parametrize("concurrency", Concurrency)
def test_a_study_that_had_enough_when_it_was_stopped_runs_no_further(concurrency: Concurrency) -> None:
    shelf, checkpoints = Shelf(), Checkpoints()
    run_blocks(Draws(concurrency), replace(PLAN, trials=1400), InThisProcess(), shelf, checkpoints)
    two = Draws(concurrency).block(0, 700)[1].merge(Draws(concurrency).block(700, 700)[1])
    checkpoints.write(2, two)
    outcome = run_blocks(Draws(concurrency), PLAN, InThisProcess(), shelf, checkpoints, enough=known_to(two.mean_se))
    assert (outcome.statistics, outcome.trials, outcome.resumed_trials) == (two, 1400, 1400)
    assert sorted(shelf.blocks) == [0, 1]


def test_no_more_calls_are_taken_than_keep_the_workers_busy() -> None:
    taken = 0

    def calls() -> Iterator[tuple[int, Ready[int]]]:
        nonlocal taken
        for k in range(1000):
            taken = k + 1
            yield k, Ready(k * k)

    results = in_order(InThisProcess(slots=2), calls())
    for k, (tag, square) in enumerate(results):
        assert (tag, square) == (k, k * k)
        assert taken <= k + 2 * CALLS_A_SLOT


def test_a_call_that_fails_is_told_and_the_others_are_given_up() -> None:
    ran: list[int] = []
    failed = threading.Event()

    def work(k: int) -> int:
        ran.append(k)
        if k == 0:
            failed.set()
            raise ValueError("the first")
        failed.wait(5)
        return k

    with pytest.raises(ValueError, match="the first"), pool_of(2, None, Concurrency.THREADS) as pool:
        for _ in in_order(pool, ((k, pool.submit(work, k)) for k in range(1000))):
            pass
    assert max(ran) < 2 * CALLS_A_SLOT


# checkpoints --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Kept:
    moments: Moments
    arrays: tuple[NDArray[np.float64], ...]
    named: dict[int, Moments | None]
    scalar: np.float64
    word: str


@given(
    st.floats(allow_nan=False),
    st.lists(st.floats(allow_nan=False, width=64), min_size=1, max_size=4),
    st.integers(-(2**70), 2**70),
    st.text(max_size=5),
)
def test_a_checkpoint_keeps_every_bit(number: float, numbers: list[float], count: int, word: str) -> None:
    moments = Moments(count=count, mean=number, m2=-0.0, minimum=-math.inf)
    kept = Kept(moments, (np.array(numbers), np.empty((0, 3))), {3: moments, -1: None}, np.float64(number), word)
    with tempfile.TemporaryDirectory() as folder:
        checkpoint = Checkpoint(Path(folder) / "checkpoint", Kept)
        checkpoint.write(7, kept)
        blocks, again = checkpoint.read() or (0, None)
    assert blocks == 7
    assert again is not None
    assert (again.moments, again.named, again.word) == (moments, kept.named, word)
    assert math.copysign(1, again.moments.m2) == -1
    assert type(again.scalar) is np.float64
    assert again.scalar.tobytes() == kept.scalar.tobytes()
    for mine, its in zip(kept.arrays, again.arrays, strict=True):
        assert (mine.shape, mine.dtype, mine.tobytes()) == (its.shape, its.dtype, its.tobytes())


def test_a_checkpoint_knows_only_what_its_statistics_are_made_of(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint"
    with pytest.raises(TypeError, match="cannot keep a Plan"):
        Checkpoint(path, Moments).write(1, PLAN)  # type: ignore[arg-type]
    Checkpoint(path, Plan).write(1, PLAN)
    with pytest.warns(CheckpointWarning, match="of other statistics"):
        assert Checkpoint(path, Moments).read() is None


# studies ------------------------------------------------------------------------------------------


def test_a_study_until_an_error_is_reached_has_the_trials_that_it_needs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(block_module, "AUTO_BLOCK_TRIALS", BLOCK)
    text = SPUR_PAIR.read_text("utf-8")
    scene = tmp_path / "auto.yaml"
    line = next(line for line in text.splitlines() if line.startswith("study:"))
    scene.write_text(
        text.replace(line, "study: {trials: auto, until: {normal backlash: {mean: 0.1 um}}, engine: analytic}"), "utf-8"
    )
    alone = run_scene(scene, out=tmp_path / "alone")
    values = alone.columns("analytic:normal backlash")["analytic:normal backlash"]
    errors = [values[:n].std(ddof=1) / math.sqrt(n) for n in range(BLOCK, len(values) + 1, BLOCK)]
    assert alone.trials == len(values) == BLOCK * len(errors)
    assert [error <= 0.1 for error in errors] == [False] * (len(errors) - 1) + [True]
    spread = run_scene(scene, out=tmp_path / "spread", execution=Execution(workers=3))
    assert spread.summary["measures"] == alone.summary["measures"]
    names = [path.name for path in sorted((spread.path / "trials").glob("*.parquet"))]
    assert names == [f"block-{index:06d}.parquet" for index in range(len(errors))]
    assert len((spread.path / "trials" / "_SHA256SUMS").read_text().splitlines()) == len(errors)
    fixed = run_scene(scene, overrides=Overrides(trials=BLOCK), out=tmp_path / "fixed")
    assert fixed.trials == BLOCK


def test_threads_and_processes_give_the_bits_of_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(block_module, "BLOCK_TRIALS", 300)
    for engine in ("exact", "analytic", "fcl"):
        study = Overrides(trials=1000, engine=engine, witness=0)
        alone = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / f"{engine} alone")
        spread = run_scene(
            SPUR_PAIR, overrides=study, out=tmp_path / f"{engine} spread", execution=Execution(workers=2)
        )
        assert spread.summary["measures"] == alone.summary["measures"]
        mine, its = alone.columns(), spread.columns()
        assert mine.keys() == its.keys()
        assert all(mine[name].tobytes() == its[name].tobytes() for name in mine)


def test_a_worker_with_other_versions_is_refused(paper_model: Model) -> None:
    other = tuple((name, "0.0.1" if name == "numpy" else version) for name, version in installed_versions())
    task = Task(simulated(paper_model), None, {}, "other", True, other)
    with pytest.raises(RunError, match=r"a worker has numpy .* instead of 0\.0\.1: results could differ"):
        task.columns(0, 1)


def divided() -> float:
    """By zero: numpy warns."""
    return float(np.float64(1.0) / np.zeros(1)[0])


@pytest.mark.parametrize("pool", POOLS)
def test_a_warning_of_numpy_is_an_error_wherever_tests_run(pool: str) -> None:
    """In threads as in worker processes."""
    workers, concurrency = POOLS[pool]
    with pytest.raises(RuntimeWarning, match="divide by zero"), pool_of(workers, None, concurrency) as own:
        own.submit(divided).result()
