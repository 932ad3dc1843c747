"""Dask: a real scheduler and workers on this machine give the bits of one process, also when one of them is killed."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from of_kind import of_kind
from places import SPUR_PAIR
from toys.parabola import PARABOLA
from toys.registered import TOYS, known

from tol3d import InputError, Overrides, Run, run_scene
from tol3d.simulate import Watch
from tol3d.study.execution import pools as execution_module
from tol3d.study.execution.pools import Execution
from tol3d.study.results import task as block_module

pytest.importorskip("distributed")

BLOCK = 1000
STUDIES = {
    "exact": Overrides(trials=40 * BLOCK + 77, engine="exact", witness=0),
    "analytic": Overrides(trials=40 * BLOCK + 77, engine="analytic"),
    "fcl": Overrides(trials=4 * BLOCK + 77, engine="fcl"),
}


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(block_module, "BLOCK_TRIALS", BLOCK)


@contextmanager
def processes() -> Iterator[list[subprocess.Popen[bytes]]]:
    """Processes that end with this block, whatever happens in it."""
    started: list[subprocess.Popen[bytes]] = []
    try:
        yield started
    finally:
        for process in started:
            process.kill()
            process.wait()


def start(module: str, *arguments: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", f"distributed.cli.{module}", *arguments]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def wait_for(port: int) -> None:
    for _ in range(600):
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    raise TimeoutError(f"nobody listens at port {port}")


Cluster = tuple[str, list[subprocess.Popen[bytes]]]


@contextmanager
def scheduler_and_workers(folder: Path) -> Iterator[Cluster]:
    """A scheduler's address and its two workers, each one thread without a nanny that would start it anew."""
    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    with processes() as started:
        started.append(start("dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"))
        wait_for(port)
        for k in range(2):
            more = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1")
            started.append(start("dask_worker", address, *more, "--local-directory", str(folder / f"worker{k}")))
        wait_for_workers(address, 2)
        yield address, started[1:]


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    """One of a test's own, which may kill it."""
    with scheduler_and_workers(tmp_path) as own:
        yield own


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of one for all tests that leave it as it is; its workers find the toys."""
    with known(PARABOLA), scheduler_and_workers(tmp_path_factory.mktemp("dask")) as (found, _):
        yield found


def wait_for_workers(address: str, count: int) -> None:
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=60)


def assert_same_run(first: Run, second: Run) -> None:
    assert second.summary["measures"] == first.summary["measures"]
    assert second.summary.get("joint") == first.summary.get("joint")
    mine, its = first.columns(), second.columns()
    assert mine.keys() == its.keys()
    for name, values in mine.items():
        bits = values.view(np.int64) if values.dtype.kind == "f" else values
        assert np.array_equal(bits, its[name].view(bits.dtype) if bits.dtype.kind == "i" else its[name]), name


@pytest.mark.slow
def test_two_dask_workers_give_the_bits_of_one_process(address: str, tmp_path: Path) -> None:
    study = STUDIES["analytic"]
    alone = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "alone")
    spread = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "dask", execution=Execution(scheduler=address))
    assert spread.summary["timing"]["workers"] == 2
    assert_same_run(alone, spread)
    bare = Execution(scheduler=address, keep_trials=False)
    statistics = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "bare", execution=bare)
    assert statistics.summary["measures"] == alone.summary["measures"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("engine", "blocks"), [("exact", 6), pytest.param("chords", 1, marks=pytest.mark.slow)]
)  # whose pieces are a trial or two each
def test_dask_workers_run_a_mechanism_from_outside(engine: str, blocks: int, address: str, tmp_path: Path) -> None:
    scene, study = TOYS / "parabola" / "spring.yaml", Overrides(trials=blocks * BLOCK + 77, engine=engine)
    alone = run_scene(scene, overrides=study, out=tmp_path / "alone")
    spread = run_scene(scene, overrides=study, out=tmp_path / "dask", execution=Execution(scheduler=address))
    assert_same_run(alone, spread)


@pytest.mark.slow
@pytest.mark.parametrize("engine", STUDIES)
def test_one_worker_killed_in_mid_run_changes_no_bit(engine: str, cluster: Cluster, tmp_path: Path) -> None:
    address, workers = cluster
    study = STUDIES[engine]
    alone = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "alone")
    two = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "two", execution=Execution(workers=2))
    assert_same_run(alone, two)
    told: list[int] = []

    def kill_one(count: int) -> None:
        told.append(count)
        if sum(told) > of_kind(int, study.trials) / 4 and workers[0].poll() is None:
            os.kill(workers[0].pid, signal.SIGKILL)
            workers[0].wait()

    spread = run_scene(
        SPUR_PAIR,
        overrides=study,
        out=tmp_path / "dask",
        execution=Execution(scheduler=address),
        watch=Watch(progress=kill_one),
    )
    assert workers[0].returncode == -signal.SIGKILL
    assert workers[1].poll() is None
    assert_same_run(alone, spread)


@pytest.mark.slow
def test_a_run_whose_workers_are_all_lost_says_so_and_goes_on_later(
    cluster: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(execution_module, "ANSWER_S", 1.0)
    address, workers = cluster
    told: list[int] = []

    def kill_all(count: int) -> None:
        told.append(count)
        if len(told) == 10:
            for worker in workers:
                worker.kill()

    with pytest.raises(InputError, match=r"its workers are gone; finished blocks are kept.*the same command resumes"):
        run_scene(
            SPUR_PAIR,
            overrides=STUDIES["analytic"],
            out=tmp_path / "run",
            execution=Execution(scheduler=address),
            watch=Watch(progress=kill_all),
        )
    resumed = run_scene(
        SPUR_PAIR, overrides=STUDIES["analytic"], out=tmp_path / "run", execution=Execution(resume=True)
    )
    assert resumed.summary["timing"]["resumed_trials"] >= 9 * BLOCK


@pytest.mark.slow
def test_a_run_whose_scheduler_is_lost_goes_on_later(cluster: Cluster, tmp_path: Path) -> None:
    address, _ = cluster
    study = STUDIES["analytic"]
    alone = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "alone")
    scheduler = _scheduler_pid(address)
    told: list[int] = []

    def kill_scheduler(count: int) -> None:
        told.append(count)
        if len(told) == 10:
            os.kill(scheduler, signal.SIGKILL)

    with pytest.raises(InputError, match=r"the scheduler was lost .*the same command resumes the run"):
        run_scene(
            SPUR_PAIR,
            overrides=study,
            out=tmp_path / "run",
            execution=Execution(scheduler=address),
            watch=Watch(progress=kill_scheduler),
        )
    resumed = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "run", execution=Execution(resume=True))
    assert resumed.summary["timing"]["resumed_trials"] >= 9 * BLOCK
    assert_same_run(alone, resumed)


def _scheduler_pid(address: str) -> int:
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        return int(client.run_on_scheduler(os.getpid))


@pytest.mark.slow
def test_an_address_where_nobody_answers_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(execution_module, "ANSWER_S", 0.5)
    few = Overrides(trials=10, engine="analytic")
    for address, words in (
        (f"tcp://127.0.0.1:{free_port()}", "no Dask scheduler answered within"),
        ("nonsense://here", "no Dask scheduler answered within"),
    ):
        with pytest.raises(InputError, match=f"--scheduler {address}: {words}"):
            run_scene(SPUR_PAIR, overrides=few, out=tmp_path / "run", execution=Execution(scheduler=address))


@pytest.mark.slow
def test_a_scheduler_without_workers_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    port = free_port()
    with processes() as started:
        started.append(start("dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"))
        wait_for(port)
        monkeypatch.setattr(execution_module, "ANSWER_S", 2.0)
        with pytest.raises(InputError, match="it has no workers; start some with `dask worker"):
            run_scene(
                SPUR_PAIR,
                overrides=Overrides(trials=10, engine="analytic"),
                out=tmp_path / "run",
                execution=Execution(scheduler=f"tcp://127.0.0.1:{port}"),
            )
