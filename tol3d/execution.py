"""Runs blocks of trials, one process or several, in order, from where an earlier run stopped.

Results do not depend on the number of workers nor on how trials are handed out: a trial is a pure
function, and blocks come back in their order.
"""

import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

Columns = dict[str, NDArray[np.generic]]
Task = Callable[[int, int], Columns]
Progress = Callable[[int], None]

SHORT_STUDY = 20_000  # contacts (trials x positions); about 8 s of them on one core
TASK_CONTACTS = 256  # contacts handed out at once: 0.1 s of them, so progress moves and workers end together
KEEP_EVERY = 5.0  # s; an interrupted run loses no more than what this long has made


class BlockStore(Protocol):
    """Where finished blocks are kept."""

    def read(self, index: int) -> Columns | None:
        """A finished block, or None."""
        ...

    def write(self, index: int, columns: Columns) -> None:
        """Keep a finished block, all or nothing; its pieces are not needed any more."""
        ...

    def read_piece(self, index: int, first: int) -> Columns | None:
        """A piece of an unfinished block that begins at trial `first`, or None."""
        ...

    def write_piece(self, index: int, first: int, columns: Columns) -> None:
        """Keep a piece of an unfinished block."""
        ...


def run_blocks(
    task: Task,
    trials: int,
    workers: int,
    store: BlockStore,
    on_progress: Progress = lambda done: None,
    *,
    block_trials: int,
    positions: int = 1,
) -> Iterator[Columns]:
    """Run `task(first, count)` over all trials and yield finished blocks in order.

    Args:
        task: columns of trials first ... first + count - 1; must pickle for more than one worker.
        trials: how many trials.
        workers: processes; 1 stays in this one.
        store: blocks found there are read, not run again; new ones are written before they are yielded.
        on_progress: told how many trials were finished since it was told last.
        block_trials: trials of a block.
        positions: contacts that a trial takes, for the size of what is handed out.
    """
    with Parallel(n_jobs=workers, return_as="generator", pre_dispatch="3 * n_jobs") as parallel:
        for index, first in enumerate(range(0, trials, block_trials)):
            count = min(block_trials, trials - first)
            columns = store.read(index)
            if columns is None:
                runner = parallel if workers > 1 else None
                block = _Block(index, first, count, max(1, TASK_CONTACTS // positions))
                columns = _run_block(block, task, runner, store, on_progress)
                store.write(index, columns)
            else:
                on_progress(count)
            yield columns


@dataclass(frozen=True)
class _Block:
    """Trials first ... first + count - 1, run `size` at a time."""

    index: int
    first: int
    count: int
    size: int

    @property
    def end(self) -> int:
        return self.first + self.count


def _run_block(
    block: _Block, task: Task, parallel: Parallel | None, store: BlockStore, on_progress: Progress
) -> Columns:
    """All columns of a block: from the pieces that an interrupted run has kept, then from the task."""
    pieces: list[Columns] = []
    start = block.first
    while (kept := store.read_piece(block.index, start)) is not None:
        pieces.append(kept)
        start += _length(kept)
        on_progress(_length(kept))
    calls = [(at, min(block.size, block.end - at)) for at in range(start, block.end, block.size)]
    results = (task(*call) for call in calls) if parallel is None else parallel(delayed(task)(*call) for call in calls)
    fresh: list[Columns] = []
    kept_at = time.monotonic()
    for piece in results:
        fresh.append(piece)
        on_progress(_length(piece))
        if time.monotonic() - kept_at > KEEP_EVERY:
            pieces.append(_joined(fresh))
            store.write_piece(block.index, start, pieces[-1])
            start, fresh, kept_at = start + _length(pieces[-1]), [], time.monotonic()
    return _joined([*pieces, *fresh])


def _length(columns: Columns) -> int:
    return len(next(iter(columns.values())))


def _joined(pieces: list[Columns]) -> Columns:
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}


def suggested_workers(contacts: int) -> int:
    """One process for what takes seconds, as starting others does; every core beyond."""
    return 1 if contacts <= SHORT_STUDY else os.cpu_count() or 1
