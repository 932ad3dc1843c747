"""Runs blocks of trials, one process or several, in order, from where an earlier run stopped.

Results do not depend on the number of workers nor on how trials are handed out: a trial is a pure
function, and blocks come back in their order.
"""

import os
from collections.abc import Callable, Iterator
from typing import Protocol

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

Columns = dict[str, NDArray[np.generic]]
Task = Callable[[int, int], Columns]
Progress = Callable[[int], None]

BLOCK_TRIALS = 65_536  # trials whose statistics are folded together, and that are written as one file
SHORT_STUDY = 20_000  # trials; about 8 s of contact on one core
TASK_TRIALS = 256  # trials handed out at once: 0.1 s of contact, so progress moves and workers end together


class BlockStore(Protocol):
    """Where finished blocks are kept."""

    def read(self, index: int) -> Columns | None:
        """A finished block, or None."""
        ...

    def write(self, index: int, columns: Columns) -> None:
        """Keep a finished block, all or nothing."""
        ...


def run_blocks(
    task: Task, trials: int, workers: int, store: BlockStore, on_progress: Progress = lambda done: None
) -> Iterator[Columns]:
    """Run `task(first, count)` over all trials and yield finished blocks in order.

    Args:
        task: columns of trials first ... first + count - 1; must pickle for more than one worker.
        trials: how many trials.
        workers: processes; 1 stays in this one.
        store: blocks found there are read, not run again; new ones are written before they are yielded.
        on_progress: told how many trials were finished since it was told last.
    """
    with Parallel(n_jobs=workers, return_as="generator", pre_dispatch="3 * n_jobs") as parallel:
        for index, first in enumerate(range(0, trials, BLOCK_TRIALS)):
            count = min(BLOCK_TRIALS, trials - first)
            columns = store.read(index)
            if columns is None:
                columns = _run_block(parallel, task, first, count, workers, on_progress)
                store.write(index, columns)
            else:
                on_progress(count)
            yield columns


def _run_block(
    parallel: Parallel, task: Task, first: int, count: int, workers: int, on_progress: Progress
) -> Columns:
    starts = range(first, first + count, TASK_TRIALS)
    counts = [min(TASK_TRIALS, first + count - start) for start in starts]
    calls = zip(starts, counts, strict=True)
    results = (task(*call) for call in calls) if workers == 1 else parallel(delayed(task)(*call) for call in calls)
    pieces: list[Columns] = []
    for size, piece in zip(counts, results, strict=True):
        pieces.append(piece)
        on_progress(size)
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}


def suggested_workers(trials: int) -> int:
    """One process for what takes seconds, as starting others does; every core beyond."""
    return 1 if trials <= SHORT_STUDY else os.cpu_count() or 1
