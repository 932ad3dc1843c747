"""Writes a run into `<name>.partial`, block by block, and puts it in its place at the end."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TypeVar

from filelock import FileLock, Timeout

from tol3d.errors import DiskError, RunError, refused_by_disk
from tol3d.files import FileContent, Files, kept_name
from tol3d.study.runs.atomic_write import lacks_space, write_whole
from tol3d.study.runs.block_files import BlockFiles, block_name
from tol3d.study.runs.checkpoint import Checkpoint
from tol3d.study.runs.manifest import FINGERPRINT, TRIALS, Fingerprint, Manifest, own_paths_of_trials
from tol3d.study.runs.occupant import Place
from tol3d.study.runs.run import (
    CHECKPOINT,
    FILES,
    LOCK,
    PIECES,
    SCENE,
    SUMMARY,
    Columns,
    Run,
    warn_of_damage,
    whole_file,
)
from tol3d.study.runs.summary.kinds import SummaryKinds
from tol3d.study.runs.summary.text import written

T = TypeVar("T")

DRAWN = "drawn"  # folder of pictures until they are whole
NOBODYS = "{}"  # the fingerprint of no run


class RunWriter:
    """Writes a run: blocks as they come, the rest at the end. Implements execution.BlockStore.

    Args:
        path: the run's future folder; see `occupant` for its allowed contents.
        fingerprint: identity of an interrupted run's blocks.
        units: unit of each column, kept in the files' metadata.
        keep_trials: False keeps no blocks.
        resume: there must be an interrupted run of this fingerprint, or a finished one with damaged blocks.
        force: replace a run of another study; a folder with other files is moved aside.
        kinds: allowed contents of a summary; default: those of this package's mechanisms.

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
        force: bool = False,
        kinds: SummaryKinds | None = None,
    ) -> None:
        self._kinds = kinds
        self.path = path.resolve()
        self._place = Place(self.path, json.loads(json.dumps(fingerprint)), kinds)
        self.partial = self._place.partial
        self._lock = FileLock(self.partial / LOCK)
        self._keep_trials = keep_trials
        self._force = force
        self._tables: list[str] = []
        self._pictures: list[str] = []
        if not resume:
            self._place.refuse_taken(force=force)
        try:
            if resume:
                self._reopen()
            self._open_partial(resume=resume)
            self._blocks = BlockFiles(self.partial / TRIALS, units)
            self._pieces = BlockFiles(self.partial / PIECES, units)
            self._blocks.settle()
            self._pieces.settle()
        except OSError as error:
            if refused_by_disk(error):
                raise DiskError(f"{error.filename or self.partial}: cannot be written ({error.strerror})") from None
            raise RunError(f"{self.partial}: cannot be written ({error.strerror}); choose another --out") from None

    def _reopen(self) -> None:
        """A finished run with damaged blocks becomes an interrupted one, with all that lies in its folder."""
        if self.partial.exists():
            return
        self._place.refuse_unmendable()
        write_whole(self.path / FINGERPRINT, self._mark)
        self.path.replace(self.partial)

    @property
    def _mark(self) -> bytes:
        return json.dumps(self._place.fingerprint, sort_keys=True, indent=1).encode()

    def _open_partial(self, *, resume: bool) -> None:
        mark = self.partial / FINGERPRINT
        there = self._place.begun()
        self.partial.mkdir(parents=True, exist_ok=True)
        try:
            self._lock.acquire(blocking=False)
        except Timeout:
            raise RunError(f"{self.path}: another run is being written there; choose another --out") from None
        if not self._place.goes_on(there, resume=resume, force=self._force):
            write_whole(mark, NOBODYS.encode())  # killed in here, the next run sees that the rest is not its own
            for folder in (TRIALS, PIECES):
                BlockFiles(self.partial / folder).clear()
            (self.partial / CHECKPOINT).unlink(missing_ok=True)
        write_whole(mark, self._mark)
        for folder in (TRIALS, PIECES):
            (self.partial / folder).mkdir(exist_ok=True)

    # blocks -------------------------------------------------------------------------------------------

    def checkpoint(self, kind: type[T]) -> Checkpoint[T]:
        """Checkpoint of the statistics of the first blocks."""
        return Checkpoint(self.partial / CHECKPOINT, kind)

    def read(self, index: int) -> Columns | None:
        """A block that an interrupted run has finished, or None; warns of a damaged one, which counts as none."""
        return _read(self._blocks, block_name(index))

    def holds(self, index: int) -> bool:
        """True if a finished block need not be computed again; warns of a damaged one."""
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
        """Take away this block and those after it."""
        self._blocks.remove([name for name in self._blocks.names if name >= block_name(index)])

    def kept_blocks(self, kind: type[Any]) -> int:
        """Number of blocks that need not be computed again; without trials, those in the statistics of type `kind`."""
        if self._keep_trials:
            return len(self._blocks.names)
        counted = self.checkpoint(kind).read()
        return counted[0] if counted else 0

    # the rest -----------------------------------------------------------------------------------------

    def keep(self, scene: FileContent, files: Files) -> dict[str, str]:
        """Keep the scene and the files that it names; the SHA-256 of each by its name."""
        places = {name: self.partial / FILES / kept_name(name, file.sha256) for name, file in files.items()}
        everything = {name: (path, files[name]) for name, path in places.items()} | {
            SCENE: (self.partial / SCENE, scene)
        }
        for path, file in everything.values():
            path.parent.mkdir(exist_ok=True)
            write_whole(path, file.content)
        self._kept = [path.relative_to(self.partial).as_posix() for path, _ in everything.values()]
        return {name: file.sha256 for name, (_, file) in everything.items()}

    def table(self, name: str, text: str) -> None:
        """Write a table of the run's own, a CSV file in its folder."""
        write_whole(self.partial / name, text.encode())
        self._tables.append(name)

    @contextmanager
    def pictures(self) -> Iterator[Path]:
        """Within it a folder for pictures, which are the run's own afterwards."""
        drawn = self.partial / DRAWN
        drawn.mkdir(exist_ok=True)
        for unfinished in drawn.iterdir():  # of a kill
            unfinished.unlink()
        yield drawn
        for picture in sorted(drawn.iterdir()):
            picture.replace(self.partial / picture.name)
            self._pictures.append(picture.name)
        drawn.rmdir()

    def finish(self, summary: Mapping[str, Any]) -> Run:
        """Write the summary and put the run in its place; killed before that, the same command resumes."""
        text = written(summary, self._kinds)
        if self._keep_trials:
            self._blocks.settle()
        else:
            self._blocks.clear()
        write_whole(self.partial / SUMMARY, text.encode())
        lists = own_paths_of_trials(self._keep_trials)
        own = {SUMMARY, *self._kept, *self._tables, *self._pictures, *lists, *self._older()}
        Manifest.of(self.partial, own).write()
        self.close()
        self._place.put_in_place(force=self._force)
        return Run(self.path, json.loads(text), self._kinds)

    def _older(self) -> Iterator[str]:
        """Files of a finished run that is mended, such as pictures, where they are as they were."""
        with suppress(RunError):
            older = Manifest.read(self.partial)
            changed = older.foreign()
            yield from (name for name in older.sums if name not in changed and (self.partial / name).is_file())

    def close(self) -> None:
        """Let go of the folder, finished or not: another run may be written there."""
        self._lock.release()


def _piece_name(index: int, first: int | str) -> str:
    return f"{block_name(index)}-{first}"


def _read(files: BlockFiles, name: str) -> Columns | None:
    if name not in files:
        return None
    try:
        return files.read(name)
    except RunError as error:
        warn_of_damage(error)
        return None


@contextmanager
def refusals_explained(writer: RunWriter, kept: Callable[[], str]) -> Iterator[None]:
    """Turn a failed write into a RunError that states what is kept.

    Args:
        writer: writes the run.
        kept: what is kept of it, such as "300 of 2000 trials are".
    """
    try:
        yield
    except OSError as error:
        if refused_by_disk(error):
            why, way = _why(error, writer)
            raise DiskError(f"{why}: {kept()} kept in {writer.partial}; {way}, then the same command resumes") from None
        if str(error.filename or "").startswith(str(writer.partial)):
            raise RunError(f"{error.filename}: cannot be written ({error.strerror})") from None
        raise


def _why(error: OSError, writer: RunWriter) -> tuple[str, str]:
    """Error of the disk in words, and its remedy."""
    if lacks_space(error):
        return f"{writer.path}: no space left on the disk", "make room"
    return f"{error.filename or writer.partial}: cannot be written ({error.strerror})", "mend the disk or its limits"
