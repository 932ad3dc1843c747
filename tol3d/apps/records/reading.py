"""One side of a rig's measurement: files read row by row, angles counted on over turns, gathered by position."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np

from tol3d.apps.records.bins import Bins, BinSums, Ends, EndSums
from tol3d.apps.records.csv_file import Block, blocks_of, line_of
from tol3d.apps.records.pair import TURN, RigPair
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

Progress = Callable[[int], None]

MOST_REVERSED: Final = math.radians(1.0)  # of the driver; noise and a rig's own play stay below it
SETTLED: Final = math.radians(1.0)  # travel of the driver from which its direction is known
LEAST_TRAVEL: Final = math.radians(0.01)  # of a file; far over an encoder's noise
LONGEST_STEP: Final = 0.4 * TURN  # between rows; from half a turn on the way round cannot be known
LARGEST_TORQUE: Final = 1e9  # N m; no machine has a thousandth of it
LEAST_ROWS: Final = 4  # of a pass on average: a column that changes more often numbers rows
TRACE_STEP: Final = math.radians(0.5)  # of both gears together between rows kept to tell degrees from radians, as read
TRACED: Final = 3 * 360.0  # rad of the driver, as read, over which they are kept: three turns if they are degrees


@dataclass(frozen=True)
class Senses:
    """Sign of each encoder's count in its gear's own sense of rotation in the drive run."""

    driver: int
    driven: int


@dataclass(frozen=True, eq=False)
class Pass:
    """Rows of one repeat in one file, with the driver turning one way.

    Args:
        path: the file.
        repeat: its number there, 0 without such a column.
        rows: their number.
        travel: turn of the driver [rad].
        torques: smallest and largest torque [N m], magnitudes; None if not measured.
        first: error at the first row [rad] and the driver's angle there.
        bins: the rows, gathered.
        ends: those of the start and of a long period later; None of a shorter pass.
        trace: phi1 and phi2 of some rows, (2, n) [rad], counted on; their number does not grow with that of all rows.
        raw: the same as the file has them.
    """

    path: Path
    repeat: int
    rows: int
    travel: float
    torques: tuple[float, float] | None
    first: tuple[float, float]
    bins: Bins
    ends: Ends | None
    trace: Array
    raw: Array

    def without_rows(self) -> "Pass":
        """The same without its rows, which are kept elsewhere as far as needed."""
        nothing = np.zeros((2, 0))
        return replace(
            self, bins=self.bins.where(np.zeros(len(self.bins.rows), dtype=bool)), ends=None, trace=nothing, raw=nothing
        )


def senses_of(path: Path, unit: str | None) -> Senses:
    """Senses in which the encoders count, by the first degree that the driver turns in the drive run.

    Raises:
        InputError: it does not turn.
    """
    travel = driven = 0.0
    for block in blocks_of(path, unit):
        travel, driven = travel + _travel(block.phi1), driven + _travel(block.phi2)
        if abs(travel) > SETTLED:
            break
    if abs(travel) < LEAST_TRAVEL:
        raise InputError(f"{path}: the driver does not turn: phi1 moves by {math.degrees(abs(travel)):.4f} deg")
    sense = 1 if travel > 0.0 else -1
    return Senses(sense, sense if driven * travel > 0.0 else -sense)


def _travel(values: Array) -> float:
    steps = np.diff(values)
    return float(np.sum(steps - TURN * turns_taken(steps)))


def read_side(
    pair: RigPair, paths: Sequence[Path], unit: str | None, senses: Senses, progress: Progress
) -> Iterator[Pass]:
    """All passes of one side, each when its rows are read.

    Args:
        pair: nominal numbers.
        paths: its files.
        unit: of angles without one.
        senses: of the encoders.
        progress: callback that gets the rows of each block.

    Raises:
        InputError: with file and line.
    """
    for path in paths:
        yield from _passes(pair, path, unit, senses, progress)


def _passes(pair: RigPair, path: Path, unit: str | None, senses: Senses, progress: Progress) -> Iterator[Pass]:
    def counted() -> Iterator[Block]:
        for block in blocks_of(path, unit):
            yield block
            progress(len(block.phi1))

    yield from passes_of(pair, path, counted(), senses)


def passes_of(pair: RigPair, path: Path, blocks: Iterable[Block], senses: Senses) -> Iterator[Pass]:
    """The passes of consecutive blocks of rows; `path` names them in messages.

    Raises:
        InputError: a jump, or the driver turns back.
    """
    reader: PassReader | None = None
    for block in blocks:
        _refuse_counter(path, block)
        for part, repeat in _by_repeat(block):
            if reader is not None and reader.repeat != repeat:
                yield reader.finished()
                reader = None
            if reader is None:
                reader = PassReader(pair, path, repeat, senses)
            reader.add(part)
    if reader is not None:
        yield reader.finished()


def _refuse_counter(path: Path, block: Block) -> None:
    """Raise where `repeat` numbers rows, not passes, or is no count; also where a torque is beyond any machine's."""
    if block.torque is not None and (largest := float(np.abs(block.torque).max(initial=0.0))) > LARGEST_TORQUE:
        where = f"{path}:{line_of(path, block.first)}"
        raise InputError(f"{where}: column 'torque': expected at most 1e9 N m, got {largest:g} N m; check its unit")
    if block.repeat is None:
        return
    if len(wrong := block.repeat[(block.repeat < 0) | (block.repeat != np.rint(block.repeat))]):
        where = f"{path}:{line_of(path, block.first)}"
        raise InputError(
            f"{where}: column 'repeat': expected whole numbers from 0, which count passes, got {wrong[0]:g}"
        )
    stretches = 1 + int(np.count_nonzero(np.diff(block.repeat)))
    if stretches > 1 and len(block.repeat) < LEAST_ROWS * stretches:
        where = f"{path}:{line_of(path, block.first)}"
        raise InputError(
            f"{where}: column 'repeat': expected one number for all rows of a pass, got "
            f"{stretches} numbers in the {len(block.repeat)} rows from here; leave out a column that counts rows"
        )


def _by_repeat(block: Block) -> Iterator[tuple[Block, int]]:
    """Its stretches of one repeat each."""
    if block.repeat is None:
        yield block, 0
        return
    starts = [0, *(np.flatnonzero(np.diff(block.repeat)) + 1).tolist(), len(block.repeat)]
    for low, high in pairwise(starts):
        torque = None if block.torque is None else block.torque[low:high]
        part = replace(block, first=block.first + low, phi1=block.phi1[low:high], phi2=block.phi2[low:high])
        yield replace(part, torque=torque), int(block.repeat[low])


def turns_taken(steps: Array) -> Array:
    """Whole turns by which an encoder's reading fell back in each step [rad], 0 in steps of up to half a turn."""
    return np.where(np.abs(steps) > TURN / 2, np.round(steps / TURN), 0.0)


def _begins_below_zero(values: Array, turns: Array) -> bool:
    """True if an encoder that restarts each turn begins less than a degree before that: its first row is below 0."""
    begun = np.flatnonzero(turns)
    return bool(len(begun) and turns[begun[0]] < 0 and values[0] > TURN - SETTLED)


class PassReader:
    """Rows of one pass, block after block."""

    def __init__(self, pair: RigPair, path: Path, repeat: int, senses: Senses) -> None:
        self.repeat = repeat
        self._pair, self._path, self._senses = pair, path, senses
        self._sums, self._end_sums = BinSums(pair), EndSums(pair)
        self._rows = 0
        self._ends: tuple[Array, Array] | None = None  # first and last (phi1, phi2)
        self._raw: tuple[float, float] | None = None
        self._offset = np.zeros(2)  # by which the count is ahead of the file's angles
        self._farthest = 0.0
        self._direction = 0
        self._torques: tuple[float, float] | None = None
        self._trace: list[Array] = []
        self._untouched: list[Array] = []
        self._traced = -1.0  # steps up to the last row that was kept

    def add(self, block: Block) -> None:
        """Add rows.

        Raises:
            InputError: a jump, or the driver turns back.
        """
        both = np.stack([self._counted(0, block.phi1, block), self._counted(1, block.phi2, block)])
        self._raw = float(block.phi1[-1]), float(block.phi2[-1])
        both[0] *= self._senses.driver
        both[1] *= self._senses.driven
        start = both[:, 0] if self._ends is None else self._ends[0]
        self._refuse_turning_back(both[0] - start[0], block)
        error = (both[1] - start[1]) - self._pair.rate * (both[0] - start[0])
        torque = None if block.torque is None else np.abs(block.torque)
        self._sums.add(both[0], error, torque)
        self._end_sums.add(np.abs(both[0] - start[0]), both[0], error, torque)
        if torque is not None:
            ends = (float(torque.min()), float(torque.max()), *(self._torques or ()))
            self._torques = min(ends), max(ends)
        self._keep_some(both, np.abs(both - start[:, None]), block)
        self._rows += len(error)
        self._ends = start.copy(), both[:, -1].copy()

    def _keep_some(self, both: Array, moved: Array, block: Block) -> None:
        """Keep rows as they came, of which none is nearer than TRACE_STEP to the next."""
        steps = np.maximum.accumulate(np.floor(moved.sum(axis=0) / TRACE_STEP))
        kept = (np.diff(steps, prepend=self._traced) > 0) & (steps > self._traced) & (moved[0] < TRACED)
        self._traced = max(self._traced, float(steps[-1]))
        self._trace.append(both[:, kept])
        self._untouched.append(np.stack([block.phi1[kept], block.phi2[kept]]))

    def finished(self) -> Pass:
        """The pass."""
        assert self._ends is not None
        start, end = self._ends
        first, travel = float(start[1] - self._pair.rate * start[0]), abs(float(end[0] - start[0]))
        return Pass(
            path=self._path,
            repeat=self.repeat,
            rows=self._rows,
            travel=travel,
            torques=self._torques,
            first=(first, float(start[0])),
            bins=self._sums.bins(first),
            ends=self._end_sums.ends(float(start[0]), travel, first),
            trace=np.concatenate(self._trace, axis=1),
            raw=np.concatenate(self._untouched, axis=1),
        )

    def _counted(self, which: int, values: Array, block: Block) -> Array:
        """An encoder's angles [rad], counted on over whole turns."""
        last = values[0] if self._raw is None else self._raw[which]
        steps = np.diff(values, prepend=last)
        longest = int(np.argmax(np.abs(steps)))
        if abs(steps[longest]) <= LONGEST_STEP:
            return np.asarray(values + self._offset[which])
        self._refuse_jump(which, steps, longest, block)
        turns = turns_taken(steps)
        left = steps - TURN * turns
        longest = int(np.argmax(np.abs(left)))
        if abs(left[longest]) > LONGEST_STEP:
            line = line_of(self._path, block.first + longest)
            raise InputError(
                f"{self._path}:{line}: phi{which + 1} moves by {math.degrees(steps[longest]):.1f} deg from one row to "
                "the next; expected less than 0.4 of a turn, or turns cannot be counted"
            )
        if self._raw is None and _begins_below_zero(values, turns):
            self._offset[which] -= TURN
        offsets = self._offset[which] - TURN * np.cumsum(turns)
        self._offset[which] = offsets[-1]
        return np.asarray(values + offsets)

    def _refuse_jump(self, which: int, steps: Array, longest: int, block: Block) -> None:
        jump = float(steps[longest])
        if abs(jump) > 1.5 * TURN:
            like = " (a jump of 360: are these degrees?)" if abs(abs(jump) - 360.0) < 20.0 else ""
            raise InputError(
                f"{self._path}:{line_of(self._path, block.first + longest)}: phi{which + 1} jumps by {jump:.4g} rad; "
                f"expected steps of less than a turn, or one back by 2 pi where an encoder begins anew{like}"
            )

    def _refuse_turning_back(self, moved: Array, block: Block) -> None:
        if self._direction == 0:
            settled = np.flatnonzero(np.abs(moved) > SETTLED)
            if not len(settled):
                return
            self._direction = 1 if moved[settled[0]] > 0 else -1
        onward = self._direction * moved
        farthest = np.maximum.accumulate(np.maximum(onward, self._farthest))
        back = farthest - onward
        self._farthest = float(farthest[-1])
        if float(back.max()) > MOST_REVERSED:
            row = int(np.flatnonzero(back > MOST_REVERSED)[0])
            jump = math.degrees(abs(float(np.diff(moved[max(row - 1, 0) : row + 1]).sum())))
            hint = "; a step of 2 pi in degrees: are these radians?" if abs(jump - TURN) < 0.2 else ""
            raise InputError(
                f"{self._path}:{line_of(self._path, block.first + row)}: the driver turns back by "
                f"{math.degrees(float(back[row])):.2f} deg, expected one way within "
                f"{math.degrees(MOST_REVERSED):.0f} deg; mark passes by a column `repeat`, or put them in files of "
                f"their own{hint}"
            )
