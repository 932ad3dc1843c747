"""Writes a run into `<name>.partial`, block by block, and puts it in its place at the end."""

import json
import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from filelock import FileLock, Timeout

from tol3d.blockfiles import BlockFiles, block_name
from tol3d.checkpoint import Checkpoint
from tol3d.durable import write_whole
from tol3d.errors import RunError
from tol3d.files import FileContent, Files, kept_name
from tol3d.result import (
    CHECKPOINT,
    FILES,
    FINGERPRINT,
    LOCK,
    PIECES,
    SCENE,
    SUMMARY,
    TRIALS,
    Columns,
    Fingerprint,
    Run,
    differences,
    open_run,
    partial_of,
    tell_of_damage,
    tidy,
    whole_file,
)

T = TypeVar("T")

BEGINNING = {LOCK, f"{FINGERPRINT}.writing"}  # what there may be before the fingerprint
NOBODYS = "{}"  # the fingerprint of no run


class RunWriter:
    """Writes a run: blocks as they come, the rest at the end. Implements execution.BlockStore.

    Args:
        path: the run's folder to be; an older run there is replaced at the end, anything else refused.
        fingerprint: what makes the blocks of an interrupted run this run's own.
        units: unit of each column, kept in the files' metadata.
        keep_trials: False keeps no blocks.
        resume: there must be an interrupted run of this fingerprint, or a finished one with damaged blocks.

    Raises:
        RunError: the folder is something else, cannot be written, or is being written by another run.
    """

    def __init__(
        self,
        path: Path,
        fingerprint: Fingerprint,
        units: Mapping[str, str],
        *,
        keep_trials: bool = True,
        resume: bool = False,
    ) -> None:
        self.path = path.resolve()
        self.partial = partial_of(path)
        self._fingerprint = json.loads(json.dumps(fingerprint))
        self._lock = FileLock(self.partial / LOCK)
        self._keep_trials = keep_trials
        if self.path.exists() and not (self.path / SUMMARY).is_file():
            raise RunError(f"{self.path}: exists and is not a tol3d run; choose another folder with --out")
        try:
            if resume:
                self._reopen()
            self._open_partial(resume=resume)
            self._blocks = BlockFiles(self.partial / TRIALS, units)
            self._pieces = BlockFiles(self.partial / PIECES, units)
            self._blocks.settle()
            self._pieces.settle()
        except OSError as error:
            raise RunError(f"{self.partial}: cannot be written ({error.strerror}); choose another --out") from None

    def _reopen(self) -> None:
        """A finished run with damaged blocks becomes an interrupted one.

        Raises:
            RunError: there is nothing to go on with.
        """
        if self.partial.exists():
            return
        if not self.path.exists():
            raise RunError(f"{self.path}: nothing to resume, neither a run nor {self.partial.name} is there")
        self._refuse_another(open_run(self.path).fingerprint, f"{self.path}: nothing to resume, this is a finished run")
        write_whole(self.path / FINGERPRINT, self._mark)
        os.replace(self.path, self.partial)

    def _refuse_another(self, there: Fingerprint, words: str) -> None:
        if found := differences(there, self._fingerprint):
            raise RunError(f"{words} of something else ({'; '.join(found)}); without --resume it is started anew")

    @property
    def _mark(self) -> bytes:
        return json.dumps(self._fingerprint, sort_keys=True, indent=1).encode()

    def _open_partial(self, *, resume: bool) -> None:
        mark = self.partial / FINGERPRINT
        if self.partial.exists() and not mark.is_file() and {file.name for file in self.partial.iterdir()} - BEGINNING:
            raise RunError(f"{self.partial}: exists and is not an interrupted run; move it away")
        self.partial.mkdir(parents=True, exist_ok=True)
        try:
            self._lock.acquire(blocking=False)
        except Timeout:
            raise RunError(f"{self.path}: another run is being written there; choose another --out") from None
        if mark.is_file() and mark.read_bytes() != self._mark:
            if resume:
                self._refuse_another(json.loads(mark.read_bytes()), f"{self.partial}: this is an interrupted run")
            write_whole(mark, NOBODYS.encode())  # killed in here, the next run sees that the rest is not its own
            for folder in (TRIALS, PIECES):
                shutil.rmtree(self.partial / folder, ignore_errors=True)
            (self.partial / CHECKPOINT).unlink(missing_ok=True)
        write_whole(mark, self._mark)
        for folder in (TRIALS, PIECES):
            (self.partial / folder).mkdir(exist_ok=True)

    # blocks -------------------------------------------------------------------------------------------

    def checkpoint(self, kind: type[T]) -> Checkpoint[T]:
        """Where the statistics of the first blocks are kept."""
        return Checkpoint(self.partial / CHECKPOINT, kind)

    def read(self, index: int) -> Columns | None:
        """A block that an interrupted run has finished, or None; a damaged one is told of and counts as none."""
        return _read(self._blocks, block_name(index))

    def holds(self, index: int) -> bool:
        """Whether a finished block need not be made again; a damaged one is told of."""
        return not self._keep_trials or whole_file(self._blocks, block_name(index))

    def write(self, index: int, columns: Columns) -> None:
        """Write a finished block; its pieces go."""
        if self._keep_trials:
            self._blocks.write(block_name(index), columns)
        self._pieces.remove([name for name in self._pieces.names if name.startswith(_piece_name(index, ""))])

    def read_piece(self, index: int, first: int) -> Columns | None:
        """A piece of an unfinished block that begins at a trial, or None; a damaged one counts as none."""
        return _read(self._pieces, _piece_name(index, first))

    def write_piece(self, index: int, first: int, columns: Columns) -> None:
        """Keep a piece of an unfinished block."""
        self._pieces.write(_piece_name(index, first), columns)

    def drop_from(self, index: int) -> None:
        """Take away this block and those behind it."""
        self._blocks.remove([name for name in self._blocks.names if name >= block_name(index)])

    def kept_blocks(self, kind: type[Any]) -> int:
        """How many blocks need not be made again; of a run without trials those in its statistics of type `kind`."""
        if self._keep_trials:
            return len(self._blocks.names)
        counted = self.checkpoint(kind).read()
        return counted[0] if counted else 0

    # the rest -----------------------------------------------------------------------------------------

    def keep(self, scene: FileContent, files: Files) -> dict[str, str]:
        """Keep the scene and the files that it names; the SHA-256 of each by its name."""
        shutil.rmtree(self.partial / FILES, ignore_errors=True)
        places = {name: self.partial / FILES / kept_name(name, file.sha256) for name, file in files.items()}
        everything = {name: (path, files[name]) for name, path in places.items()} | {
            SCENE: (self.partial / SCENE, scene)
        }
        for path, file in everything.values():
            path.parent.mkdir(exist_ok=True)
            write_whole(path, file.content)
        return {name: file.sha256 for name, (_, file) in everything.items()}

    def picture_path(self, name: str) -> Path:
        """Where a picture of the run goes."""
        return self.partial / name

    def finish(self, summary: Mapping[str, Any]) -> Run:
        """Write the summary and put the run in its place; killed before that, the same command goes on."""
        text = json.dumps(summary, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
        if self._keep_trials:
            self._blocks.settle()
        else:
            shutil.rmtree(self.partial / TRIALS)
        write_whole(self.partial / SUMMARY, text.encode())
        self._lock.release()
        old = self.path.with_name(self.path.name + ".old")
        shutil.rmtree(old, ignore_errors=True)
        if self.path.exists():
            os.replace(self.path, old)
        os.replace(self.partial, self.path)
        shutil.rmtree(old, ignore_errors=True)
        tidy(self.path)
        return Run(self.path, json.loads(text))


def _piece_name(index: int, first: int | str) -> str:
    return f"{block_name(index)}-{first}"


def _read(files: BlockFiles, name: str) -> Columns | None:
    if name not in files:
        return None
    try:
        return files.read(name)
    except RunError as error:
        tell_of_damage(error)
        return None
