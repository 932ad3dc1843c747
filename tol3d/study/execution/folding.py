"""Runs a study block by block, in order, from where an earlier run stopped, and folds its statistics.

Results do not depend on the number or kind of workers nor on how trials are handed out: a trial is a pure function,
blocks are cut alike whoever runs them, and their statistics are folded in the order of the blocks. Nothing here grows
with the number of trials.
"""

import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field, replace
from typing import Any, Generic, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from tol3d.study.execution.pools import Concurrency, Pending, Pool, Ready, in_order

Columns = dict[str, NDArray[np.generic]]
Progress = Callable[[int], None]

TASK_CONTACTS = 256  # contacts handed out at once: 0.1 s of them, so progress moves and workers end together
TOLD_EVERY = 1.0  # s; a block that takes longer tells how far it is
KEEP_EVERY = 5.0  # s; an interrupted run loses no more than what this long has made
KEPT_WITHIN = 0.25  # s; statistics that take longer to keep are kept as much more seldom


class Statistics(Protocol):
    """Statistics that are folded over blocks."""

    def merge(self, other: Self) -> Self:
        """Both as one; folded in the order of the blocks."""
        ...


S = TypeVar("S", bound=Statistics)
S_co = TypeVar("S_co", bound=Statistics, covariant=True)


class Work(Protocol[S_co]):
    """Trials as pure functions of their numbers; pickles."""

    @property
    def concurrency(self) -> Concurrency:
        """Scheduling of its trials."""
        ...

    def columns(self, first: int, count: int) -> Columns:
        """Columns of trials first ... first + count - 1."""
        ...

    def statistics(self, first: int, columns: Columns) -> S_co:
        """Statistics of a block of columns that begins at trial `first`."""
        ...

    def block(self, first: int, count: int, progress: Progress) -> tuple[Columns | None, S_co]:
        """Columns of a block, if they are kept, and its statistics; `progress` gets the trials since its last call."""
        ...


class BlockStore(Protocol):
    """Store of finished blocks."""

    def holds(self, index: int) -> bool:
        """True if a finished block need not be computed again."""
        ...

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


class StatisticsStore(Protocol[S]):
    """Store of the statistics of the first blocks."""

    def read(self) -> tuple[int, S] | None:
        """Number of blocks, and their statistics; None if there are none."""
        ...

    def write(self, blocks: int, statistics: S) -> None:
        """Keep them, all or nothing."""
        ...


@dataclass(frozen=True)
class Plan:
    """Number of trials, and their division into blocks.

    Args:
        trials: largest number of trials.
        block_trials: trials per block.
        positions: contacts per trial, for the size of the pieces that workers get.
    """

    trials: int
    block_trials: int
    positions: int = 1

    @property
    def piece_trials(self) -> int:
        """Trials that are handed out at once where a block is handed out in pieces."""
        return max(1, TASK_CONTACTS // self.positions)

    def block_count(self, trials: int) -> int:
        """Number of blocks that hold the first `trials` trials."""
        return -(-trials // self.block_trials)

    def blocks(self) -> "Iterator[Block]":
        """The blocks in their order."""
        for index in range(self.block_count(self.trials)):
            start = index * self.block_trials
            yield Block(index, start, min(self.block_trials, self.trials - start))


@dataclass(frozen=True)
class Block:
    """Trials first ... first + count - 1."""

    index: int
    first: int
    count: int

    @property
    def end(self) -> int:
        """The trial after its last."""
        return self.first + self.count


@dataclass(frozen=True)
class StudyOutcome(Generic[S]):
    """Result of a study.

    Args:
        statistics: of all its trials.
        trials: number run or read.
        resumed_trials: number of them from an earlier run.
        first_block_s: time to the first block [s].
    """

    statistics: S
    trials: int
    resumed_trials: int
    first_block_s: float


@dataclass(frozen=True)
class _Done(Generic[S]):
    """A block that is finished; without statistics if those were known before."""

    block: Block
    statistics: S | None
    resumed: int


def run_blocks(
    work: Work[S],
    plan: Plan,
    pool: Pool,
    store: BlockStore,
    kept: StatisticsStore[S],
    *,
    on_progress: Progress = lambda done: None,
    enough: Callable[[S], bool] = lambda statistics: False,
) -> StudyOutcome[S]:
    """Run all blocks of a study and fold their statistics.

    Args:
        work: task to run.
        plan: number of trials, and their division into blocks.
        pool: who runs it.
        store: blocks found there are read, not run again; new ones are written before they count. Where `enough`
            ended the run, it may hold blocks after the last one.
        kept: statistics of an interrupted run's first blocks; written every KEEP_EVERY seconds or more, and when
            interrupted.
        on_progress: progress callback, called with the number of trials finished since its last call.
        enough: called after each block, in their order, with the statistics so far; True ends the run.
    """
    started = kept_at = time.monotonic()
    counted, folded = kept.read() or (0, None)
    if folded is not None and enough(folded):
        plan = replace(plan, trials=min(counted * plan.block_trials, plan.trials))
    written, trials, resumed, first_block_s, keep_every = counted, 0, 0, 0.0, KEEP_EVERY
    handed_out = {Concurrency.THREADS: _whole_blocks, Concurrency.PROCESSES: _in_pieces}
    try:
        with closing(handed_out[work.concurrency](_Parts(work, plan, pool, store, counted, on_progress))) as blocks:
            for found in blocks:
                first_block_s = first_block_s or time.monotonic() - started
                trials, resumed = found.block.end, resumed + found.resumed
                if found.statistics is None:
                    continue
                folded = found.statistics if folded is None else folded.merge(found.statistics)
                counted = found.block.index + 1
                if enough(folded):
                    break
                if (now := time.monotonic()) - kept_at > keep_every:
                    kept.write(counted, folded)
                    written, kept_at = counted, time.monotonic()
                    keep_every = KEEP_EVERY * max(1.0, (kept_at - now) / KEPT_WITHIN)
    except BaseException:
        if folded is not None and counted > written:
            with suppress(OSError):  # what is raised says more; without this, blocks are read again
                kept.write(counted, folded)
        raise
    if folded is None:
        raise ValueError("a study has at least one trial")
    return StudyOutcome(folded, trials, resumed, first_block_s)


@dataclass(frozen=True)
class _Parts(Generic[S]):
    """Data for scheduling blocks or pieces; the statistics of the first `counted` blocks are known."""

    work: Work[S]
    plan: Plan
    pool: Pool
    store: BlockStore
    counted: int
    on_progress: Progress

    def found(self, block: Block) -> "_Done[S] | None":
        """A block that an earlier run has finished, or None."""
        if block.index < self.counted:
            return _Done(block, None, block.count) if self.store.holds(block.index) else None
        columns = self.store.read(block.index)
        return None if columns is None else _Done(block, self.work.statistics(block.first, columns), block.count)

    def done(self, block: Block, statistics: S, resumed: int) -> "_Done[S]":
        """A block that was computed; the first ones are not counted twice."""
        return _Done(block, statistics if block.index >= self.counted else None, resumed)


# whole blocks -------------------------------------------------------------------------------------


@dataclass
class _Told:
    """Progress inside a block, passed on where a block takes long.

    Args:
        progress: which is told.
        trials: told of this block.
    """

    progress: Progress
    trials: int = 0
    _made: int = 0
    _at: float = field(default_factory=time.monotonic)

    def __call__(self, done: int) -> None:
        self._made += done
        if time.monotonic() - self._at > TOLD_EVERY:
            self.progress(self._made - self.trials)
            self.trials, self._at = self._made, time.monotonic()


def _whole_blocks(parts: _Parts[S]) -> Generator[_Done[S], None, None]:
    """Blocks in order, each made by one call; a worker that shares our memory writes it too."""
    one_at_a_time = threading.Lock()

    def progress(done: int) -> None:
        with one_at_a_time:
            parts.on_progress(done)

    for block, (found, columns, statistics, told) in in_order(parts.pool, _block_calls(parts, progress)):
        if columns is not None:
            parts.store.write(block.index, columns)
        progress(block.count - told)
        yield found or parts.done(block, statistics, 0)


def _block_calls(parts: _Parts[S], progress: Progress) -> Iterator[tuple[Block, Pending[Any]]]:
    for block in parts.plan.blocks():
        found = parts.found(block)
        if found is not None:
            yield block, Ready((found, None, None, 0))
        elif parts.pool.shares_memory:
            yield block, parts.pool.submit(_made_and_written, parts.work, block, parts.store, _Told(progress))
        else:
            yield block, parts.pool.submit(_made, parts.work, block)


def _made(work: Work[S], block: Block) -> tuple[None, Columns | None, S, int]:
    columns, statistics = work.block(block.first, block.count, lambda done: None)
    return None, columns, statistics, 0


def _made_and_written(work: Work[S], block: Block, store: BlockStore, told: _Told) -> tuple[None, None, S, int]:
    columns, statistics = work.block(block.first, block.count, told)
    if columns is not None:
        store.write(block.index, columns)
    return None, None, statistics, told.trials


# pieces of blocks ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Piece(Generic[S]):
    """Trials of a block that come back together; `found` is a block that was there already, `kept` a piece."""

    block: Block
    first: int
    count: int
    found: _Done[S] | None = None
    kept: bool = False


def _in_pieces(parts: _Parts[S]) -> Generator[_Done[S], None, None]:
    """Blocks in order, pieces of them handed out and kept while a block is not finished."""
    pieces: list[Columns] = []
    fresh: list[Columns] = []
    resumed, kept_at = 0, time.monotonic()
    for piece, columns in in_order(parts.pool, _piece_calls(parts)):
        parts.on_progress(piece.count)
        if piece.found is not None:
            yield piece.found
            continue
        if piece.kept:
            pieces, resumed = [*pieces, columns], resumed + piece.count
        else:
            fresh.append(columns)
        block = piece.block
        if piece.first + piece.count == block.end:
            whole = joined_columns([*pieces, *fresh])
            parts.store.write(block.index, whole)
            yield parts.done(block, parts.work.statistics(block.first, whole), resumed)
            pieces, fresh, resumed, kept_at = [], [], 0, time.monotonic()
        elif time.monotonic() - kept_at > KEEP_EVERY and fresh:
            pieces.append(joined_columns(fresh))
            parts.store.write_piece(block.index, piece.first + piece.count - _length(pieces[-1]), pieces[-1])
            fresh, kept_at = [], time.monotonic()


def _piece_calls(parts: _Parts[S]) -> Iterator[tuple[_Piece[S], Pending[Columns]]]:
    size = parts.plan.piece_trials
    for block in parts.plan.blocks():
        found = parts.found(block)
        if found is not None:
            yield _Piece(block, block.first, block.count, found=found), Ready({})
            continue
        at = block.first
        while at < block.end and (kept := parts.store.read_piece(block.index, at)) is not None:
            yield _Piece(block, at, _length(kept), kept=True), Ready(kept)
            at += _length(kept)
        for first in range(at, block.end, size):
            count = min(size, block.end - first)
            yield _Piece(block, first, count), parts.pool.submit(parts.work.columns, first, count)


def _length(columns: Columns) -> int:
    return len(next(iter(columns.values())))


def joined_columns(pieces: Sequence[Columns]) -> Columns:
    """Columns of pieces that follow each other, as one."""
    if len(pieces) == 1:
        return pieces[0]
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}
