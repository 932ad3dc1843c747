"""Execution of calls: in this process, in threads, in other processes, or on a Dask cluster.

All take calls and return pending results; `in_order` keeps a bounded number of them under way. Only this module
imports joblib and Dask.
"""

import gc
import importlib
import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from typing import Any, Protocol, TypeVar

from tol3d.errors import InputError, RunError

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)
Tag = TypeVar("Tag")

CALLS_A_SLOT = 3  # under way for each worker, so that none waits while results come back in order
ANSWER_S = 10.0  # s; a scheduler that lives answers within this, and so does a first worker
SHORT_STUDY = 20_000  # contacts (trials x positions); about 8 s of them on one core, where others take 2 s to start
IDLE_S = 60  # s; after which idle processes end
SAFE_PATH = "PYTHONSAFEPATH"  # where it is set, a Python that starts takes no module from the folder it starts in
TRACKERS = ("joblib.externals.loky.backend.resource_tracker", "multiprocessing.resource_tracker")  # started by loky


@dataclass(frozen=True)
class Execution:
    """Execution options of a study; its results do not depend on them.

    Args:
        workers: threads or processes, as the engine needs.
        scheduler: address of a Dask scheduler whose workers run it instead.
        keep_trials: False keeps statistics only; any trial can still be replayed.
        resume: continue an interrupted run, which must exist.
    """

    workers: int = 1
    scheduler: str | None = None
    keep_trials: bool = True
    resume: bool = False


ONE_WORKER = Execution()


class Concurrency(Enum):
    """Scheduling of an engine's trials on one machine.

    THREADS: whole blocks, for an engine that releases the GIL and computes a block in a second.
    PROCESSES: pieces of blocks, for one that does not.
    """

    THREADS = "threads"
    PROCESSES = "processes"


class Pending(Protocol[T_co]):
    """A call's result to be."""

    def result(self) -> T_co:
        """Wait for it; raises what the call raised."""
        ...

    def cancel(self) -> Any:
        """Cancel the call, which is not wanted any more."""
        ...


class Pool(Protocol):
    """Takes calls. Left by an exception, it gives up those under way."""

    @property
    def slots(self) -> int:
        """Number of calls that run at once."""
        ...

    @property
    def shares_memory(self) -> bool:
        """True if calls share this process's memory, and results cost nothing to bring back."""
        ...

    def submit(self, function: Callable[..., T], *arguments: Any) -> Pending[T]:
        """Hand out a call."""
        ...


@dataclass(frozen=True)
class Ready(Pending[T]):
    """Result that needed no call."""

    value: T

    def result(self) -> T:
        return self.value

    def cancel(self) -> None:
        """See Pending."""


@dataclass(frozen=True)
class _Later(Pending[T]):
    """A call that runs when its result is asked for."""

    function: Callable[..., T]
    arguments: tuple[Any, ...]

    def result(self) -> T:
        return self.function(*self.arguments)

    def cancel(self) -> None:
        pass


@dataclass(frozen=True)
class InThisProcess:
    """Runs each call when its result is asked for."""

    slots: int = 1
    shares_memory: bool = True

    def submit(self, function: Callable[..., T], *arguments: Any) -> Pending[T]:
        """See Pool."""
        return _Later(function, arguments)


@dataclass(frozen=True)
class OnExecutor:
    """Runs calls on an executor of threads or processes."""

    executor: Any
    slots: int
    shares_memory: bool

    def submit(self, function: Callable[..., T], *arguments: Any) -> Pending[T]:
        """See Pool."""
        pending: Pending[T] = self.executor.submit(function, *arguments)
        return pending


@dataclass(frozen=True)
class OnCluster:
    """Runs calls on the workers of a Dask cluster; a worker that dies has its calls run by another."""

    client: Any
    address: str
    slots: int
    shares_memory: bool = False

    def submit(self, function: Callable[..., T], *arguments: Any) -> Pending[T]:
        """See Pool."""
        return _ByAWorker(self.client, self.address, self.client.submit(function, *arguments, pure=False))


@dataclass(frozen=True)
class _ByAWorker(Pending[T]):
    """A call on a cluster.

    Raises:
        RunError: by `result`, if the cluster has had no worker for a while.
    """

    client: Any
    address: str
    future: Any

    def result(self) -> T:
        patience = ANSWER_S / 2
        while True:
            try:
                found: T = self.future.result(timeout=patience)  # a result that is ready can be lost with its worker
                return found
            except TimeoutError:
                if self.future.status == "error":  # the call's own
                    raise
            if not self.client.nthreads():
                self._await_a_worker()
            patience *= 2  # a large result over a slow network

    def cancel(self) -> None:
        self.future.cancel()

    def _await_a_worker(self) -> None:
        try:
            self.client.wait_for_workers(1, timeout=ANSWER_S)
        except TimeoutError:
            raise RunError(
                f"--scheduler {self.address}: its workers are gone; finished blocks are kept: start others with "
                f"`dask worker {self.address}`, and the same command resumes the run"
            ) from None


@contextmanager
def pool_of(workers: int, scheduler: str | None, concurrency: Concurrency) -> Iterator[Pool]:
    """Workers as they are asked for; within it, losing them raises a RunError.

    Args:
        workers: threads or processes on this machine; 1 stays in this thread.
        scheduler: address of a Dask scheduler, whose workers run the calls instead.
        concurrency: threads or processes.
    """
    try:
        if scheduler is not None:
            with _cluster(scheduler) as pool:
                yield pool
        elif workers == 1:
            yield InThisProcess()
        elif concurrency is Concurrency.THREADS:
            with _threads(workers) as pool:
                yield pool
        else:
            with _processes(workers) as pool:
                yield pool
    except BrokenExecutor as error:
        raise RunError(
            f"a worker process ended by itself, perhaps for lack of memory ({type(error).__name__}); finished "
            "blocks are kept: the same command resumes the run, with fewer --workers if need be"
        ) from None


@contextmanager
def _threads(workers: int) -> Iterator[Pool]:
    executor = ThreadPoolExecutor(workers)
    try:
        yield OnExecutor(executor, workers, shares_memory=True)
    finally:
        executor.shutdown(cancel_futures=True)


@contextmanager
def _processes(workers: int) -> Iterator[Pool]:
    loky = importlib.import_module("joblib.externals.loky")  # nobody else should wait for it to load
    _start_trackers()
    executor = loky.get_reusable_executor(max_workers=workers, timeout=IDLE_S, env={SAFE_PATH: "1"})
    try:
        yield OnExecutor(executor, workers, shares_memory=False)
    except BaseException:
        executor.shutdown(kill_workers=True)
        raise


def _start_trackers() -> None:
    """Start the processes beside loky's workers: they have no environment but this process's own."""
    before = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = "1"
    try:
        for tracker in TRACKERS[: 1 if os.name == "nt" else None]:  # Windows has loky's own only
            importlib.import_module(tracker).ensure_running()
    finally:
        if before is None:
            del os.environ[SAFE_PATH]
        else:
            os.environ[SAFE_PATH] = before


@contextmanager
def _cluster(address: str) -> Iterator[Pool]:
    """The workers of a Dask cluster.

    Raises:
        InputError: Dask is not installed, nobody answers at the address, or there are no workers.
    """
    try:
        distributed = importlib.import_module("distributed")  # optional, and nobody else should wait for it to load
    except ImportError:
        raise InputError("--scheduler needs Dask: pip install 'tol3d[dask]'") from None
    client = _client(distributed, address)
    try:
        yield OnCluster(client, address, _threads_of(client, address))
    except distributed.scheduler.KilledWorker as error:
        raise RunError(f"--scheduler {address}: this study kills workers ({error}); finished blocks are kept") from None
    except (CancelledError, distributed.comm.CommClosedError) as error:
        raise RunError(
            f"--scheduler {address}: the scheduler was lost ({' '.join(str(error).split())}); finished blocks are "
            "kept: the same command resumes the run"
        ) from None
    finally:
        client.close(timeout=ANSWER_S)


def _client(distributed: Any, address: str) -> Any:
    """A client of a scheduler."""
    try:
        return distributed.Client(address, timeout=ANSWER_S, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        why = " ".join(str(error).split()) or type(error).__name__
    # What is half made closes itself when it is collected: here, and not while the next one starts and holds a lock.
    gc.collect()
    raise InputError(
        f"--scheduler {address}: no Dask scheduler answered within {ANSWER_S:.0f} s ({why}); expected an address "
        "such as tcp://127.0.0.1:8786, which `dask scheduler` prints"
    )


def _threads_of(client: Any, address: str) -> int:
    try:
        client.wait_for_workers(1, timeout=ANSWER_S)
    except TimeoutError:
        raise InputError(f"--scheduler {address}: it has no workers; start some with `dask worker {address}`") from None
    return int(sum(client.nthreads().values()))


def in_order(pool: Pool, calls: Iterable[tuple[Tag, Pending[T]]]) -> Iterator[tuple[Tag, T]]:
    """Results in the order of the calls, taking no more than keep all workers busy."""
    waiting: deque[tuple[Tag, Pending[T]]] = deque()
    try:
        for call in calls:
            waiting.append(call)
            if len(waiting) >= CALLS_A_SLOT * pool.slots:
                tag, pending = waiting.popleft()
                yield tag, pending.result()
        while waiting:
            tag, pending = waiting.popleft()
            yield tag, pending.result()
    finally:
        for _, pending in waiting:
            pending.cancel()


def suggested_workers(contacts: int, concurrency: Concurrency = Concurrency.PROCESSES) -> int:
    """One for a study of seconds, the time to start processes; every core for a longer one, and for threads."""
    return 1 if concurrency is Concurrency.PROCESSES and contacts <= SHORT_STUDY else os.cpu_count() or 1
