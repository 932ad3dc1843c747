"""Whose folder this is: what lies where a run is to go, whether it may go on there, take its place, or delete it.

A run is replaced by one of the same study only, and only where nothing but its own files is in its folder: notes,
exports and other people's work are never deleted. `--force` replaces a run of another study too; what holds anything
else it moves aside whole, to the first free of `<name>.1`, `<name>.2` ... An unfinished run is written in
`<name>.partial`, which its fingerprint shows to be one; `writer.py` does what is decided here.
"""

import glob
import itertools
import os
import re
import secrets
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock, Timeout

from tol3d.errors import RunError
from tol3d.study.runs.atomic_write import UNFINISHED
from tol3d.study.runs.block_files import CHECKSUMS, BlockFiles
from tol3d.study.runs.manifest import (
    FINGERPRINT,
    STUDY,
    TRIALS,
    Fingerprint,
    Manifest,
    another_study,
    differences,
    interrupted,
)
from tol3d.study.runs.run import CHECKPOINT, LOCK, PIECES, SUMMARY, Run, read_run, warn_of_damage, whole_file
from tol3d.study.runs.summary.kinds import SummaryKinds

SHOWN = 3  # foreign files in a message
BEGINNING = {LOCK, f"{FINGERPRINT}.writing"}  # what there may be before the fingerprint
BEING_WRITTEN = "is being written by another run"
REPLACED = "replaced"
REPLACED_NAME = re.compile(rf"\.{REPLACED}-[0-9]+-[0-9a-f]{{8}}")  # of a run until it is deleted, after the run's own


class MovedAsideWarning(UserWarning):
    """A folder that held more than a run was moved aside."""


@dataclass(frozen=True)
class Occupant:
    """A run that lies where another is to go.

    Args:
        run: the existing one.
        others: differences of its study from the new one, in words.
        foreign: files in its folder that are not its own.
    """

    run: Run
    others: tuple[str, ...]
    foreign: tuple[str, ...]

    @property
    def reason(self) -> str:
        """Reason why it is not simply replaced; empty if it is."""
        if self.others:
            return f"holds another study ({'; '.join(self.others)})"
        return f"holds files that are not of the run ({_some(self.foreign)})" if self.foreign else ""


@dataclass(frozen=True)
class Place:
    """Destination of a run.

    Args:
        path: its future folder.
        fingerprint: identity of the blocks of an interrupted run.
        kinds: contents that a summary may have; by default those of this package's mechanisms.
    """

    path: Path
    fingerprint: Fingerprint
    kinds: SummaryKinds | None = None

    @property
    def partial(self) -> Path:
        """The folder in which it is written."""
        return partial_of(self.path)

    def occupant(self) -> Occupant | None:
        """The run that lies there; None if there is none.

        Raises:
            RunError: something lies there that is not a run, or cannot be recognised as one; nothing may replace it.
        """
        path = self.path
        if not path.exists() and not path.is_symlink():
            return None
        try:
            run = read_run(path, self.kinds)
            _tidy_after_kill(run)
            return Occupant(run, tuple(another_study(run.fingerprint, self.fingerprint)), tuple(run.manifest.foreign()))
        except RunError as error:
            words = f"{path}: exists and is not a tol3d run that this version knows ({error})"
            raise RunError(f"{words}; choose another folder with --out") from None

    def refuse_taken(self, *, force: bool) -> None:
        """Raise unless a new run may take the place, or move aside the existing folder.

        Raises:
            RunError: with the remedy.
        """
        occupant = self.occupant()
        if occupant is None or force or not occupant.reason:
            return
        way = "moves the whole folder aside" if occupant.foreign else "replaces it"
        raise RunError(f"{self.path}: {occupant.reason}; choose another --out, or --force, which {way}")

    def whole_run(self) -> Run | None:
        """The finished run of that fingerprint, if no other was begun there since and all its blocks are whole."""
        if self.partial.exists() or not (self.path / SUMMARY).is_file():
            return None
        run = read_run(self.path, self.kinds)
        if differences(run.fingerprint, self.fingerprint) or (run.keeps_trials and not _has_whole_blocks(run)):
            return None
        _tidy_after_kill(run)
        return run

    def refuse_unmendable(self) -> None:
        """Raise unless a finished run is there whose blocks may be made again, with all that lies in its folder.

        Raises:
            RunError: there is nothing to go on with.
        """
        path = self.path
        if not path.exists():
            raise RunError(f"{path}: nothing to resume, neither a run nor {self.partial.name} is there")
        run = read_run(path, self.kinds)
        self._refuse_another(run.fingerprint, f"{path}: nothing to resume, this is a finished run")
        made_again = (SUMMARY, f"{TRIALS}/{CHECKSUMS}")
        if changed := [name for name in run.manifest.foreign() if name in run.manifest.sums and name not in made_again]:
            raise RunError(f"{path / changed[0]}: was changed since the run was made; move it away first")

    def begun(self) -> Fingerprint | None:
        """The fingerprint of the interrupted run there; None if there is none, {} if it was being cleared.

        Raises:
            RunError: something else is in the folder of an unfinished run.
        """
        partial, there = self.partial, interrupted(self.partial)
        if partial.exists() and there is None and {file.name for file in partial.iterdir()} - BEGINNING:
            raise RunError(f"{partial}: exists and is not an interrupted run; move it away")
        return there

    def goes_on(self, there: Fingerprint | None, *, resume: bool, force: bool) -> bool:
        """True if this run continues the one that was begun; else that one is to be cleared.

        Raises:
            RunError: it is another run, which is not thrown away.
        """
        if there is None or there == self.fingerprint:
            return True
        if resume:
            self._refuse_another(there, f"{self.partial}: this is an interrupted run")
        if there and not force and (others := another_study(there, self.fingerprint)):
            raise RunError(
                f"{self.partial}: an interrupted run of another study is kept there ({'; '.join(others)}); choose "
                "another --out, or --force, which throws it away"
            )
        return False

    def _refuse_another(self, there: Fingerprint, words: str) -> None:
        if found := differences(there, self.fingerprint):
            raise RunError(
                f"{words} of something else ({'; '.join(found)}); choose another --out, or --force without --resume"
            )

    def taken(self, *, resume: bool) -> str | None:
        """Reason why a folder will not do; None if this study is there, "" if nothing is."""
        begun = self.partial.exists()
        if begun:
            there = interrupted(self.partial)
            if there is None:
                return "is taken by something else"
            if others := another_study(there, self.fingerprint) if there else []:
                if self.is_being_written():
                    return f"{BEING_WRITTEN} ({'; '.join(others)})"
                return f"is that of an interrupted run of another study ({'; '.join(others)})"
        try:
            occupant = self.occupant()
        except RunError:
            return "is taken by something else"
        if occupant is None:
            return None if begun else ""
        reason = "; ".join(occupant.others) if resume else occupant.reason
        return reason or None

    def is_being_written(self) -> bool:
        """True while a run is written there by a process that lives."""
        lock = FileLock(self.partial / LOCK)
        try:
            with lock.acquire(blocking=False):
                return False
        except Timeout:
            return True
        except OSError:  # a folder that may not be written in
            return False

    def put_in_place(self, *, force: bool) -> None:
        """Rename the written folder; an existing one is deleted if it may be replaced, else moved aside."""
        path = self.path
        old = self._moved_away(force=force) if path.exists() else None
        self.partial.replace(path)
        _tidy(path)
        if old is not None and not Manifest.read(old).remove():  # something came into it since
            self._move_aside(old, "more than the run")
        for left in path.parent.glob(f"{glob.escape(path.name)}.{REPLACED}-*"):
            if REPLACED_NAME.fullmatch(left.name.removeprefix(path.name)):
                self._remove_left(left)

    def _remove_left(self, folder: Path) -> None:
        """Delete the remains of a replaced run after a kill; with anything else in it, it is moved aside."""
        with suppress(OSError):
            folder.rmdir()  # its list goes last: without one there is only the folder
        with suppress(RunError):
            manifest = Manifest.read(folder)
            if manifest.foreign() or not manifest.remove():
                self._move_aside(folder, "more than the run")

    def _moved_away(self, *, force: bool) -> Path | None:
        """Free the run's place: the old run's new name if it may be deleted, None if it was moved aside."""
        try:
            occupant = self.occupant()
        except RunError:
            self._move_aside(self.path, "something else than a run")
            return None
        if occupant is not None and (occupant.foreign or (occupant.others and not force)):
            self._move_aside(self.path, occupant.reason.removeprefix("holds "))
            return None
        old = self.path.with_name(f"{self.path.name}.{REPLACED}-{os.getpid()}-{secrets.token_hex(4)}")
        self.path.rename(old)
        return old

    def _move_aside(self, folder: Path, what: str) -> None:
        asides = (self.path.with_name(f"{self.path.name}.{number}") for number in itertools.count(1))
        aside = next(aside for aside in asides if not aside.exists() and not aside.is_symlink())
        folder.rename(aside)
        warnings.warn(f"{self.path}: held {what}, and was moved aside to {aside}", MovedAsideWarning, stacklevel=2)


def partial_of(path: Path) -> Path:
    """The folder in which a run that goes to `path` is written.

    Raises:
        RunError: it is the root folder, which has no name.
    """
    path = path.resolve()  # so that "." has a name
    if not path.name:
        raise RunError(f"{path}: no run takes the place of the root of all folders; name a folder in it")
    return path.with_name(path.name + ".partial")


def free_folder(
    wanted: Path, fingerprint: Fingerprint, *, resume: bool = False, kinds: SummaryKinds | None = None
) -> tuple[Path, str]:
    """Default folder of a run.

    The wanted folder, or the first of `<name>-2`, `<name>-3` ... that another study has not taken. A study finds its
    own folder again.

    Args:
        wanted: the folder.
        fingerprint: of the run.
        resume: only a folder with this very study will do; the wanted one if there is none.
        kinds: contents that a summary may have; by default those of this package's mechanisms.

    Returns:
        the folder, and the contents of the wanted one if it is another.
    """
    taken = ""
    for path in numbered(wanted):
        reason = Place(path, fingerprint, kinds).taken(resume=resume)
        if reason is None:
            return (path, taken)
        if not reason:
            return (wanted, "") if resume else (path, taken)
        taken = taken or f"{path} {reason}"
    raise AssertionError("numbers do not end")


def numbered(wanted: Path) -> Iterator[Path]:
    """Default folders of a scene's runs: its folder, then `<name>-2`, `<name>-3` ..."""
    yield wanted
    yield from (wanted.with_name(f"{wanted.name}-{number}") for number in itertools.count(2))


def refuse_changed(folders: Iterable[Path], scene: str, files: Mapping[str, str]) -> None:
    """Raise where the first of the folders have runs, and none of them is of this scene and these files.

    Args:
        folders: where a run may go on.
        scene: SHA-256 of its text.
        files: SHA-256 of the files that it names; other kept files are ignored.

    Raises:
        RunError: with the differences of the first run.
    """
    reasons = []
    for path in folders:
        try:
            there = _begun_or_finished(path)
        except RunError as error:
            reasons.append(str(error))
            continue
        if not there:
            break
        kept = {"scene": there.get("scene"), "files": {name: (there.get("files") or {}).get(name) for name in files}}
        others = differences(kept, {"scene": scene, "files": files})
        if not others:
            return
        words = f"{path}: nothing to resume, its run is of something else ({'; '.join(others)})"
        reasons.append(f"{words}; choose another --out, or --force without --resume")
    if reasons:
        raise RunError(reasons[0])


def _begun_or_finished(path: Path) -> Fingerprint:
    """The fingerprint of the run that a folder has, interrupted or not; empty if it has none."""
    if (partial := partial_of(path)).exists():
        return interrupted(partial) or {}
    return read_run(path).fingerprint if path.exists() else {}


def _has_whole_blocks(run: Run) -> bool:
    """True if every block is as it was written; warns of each damaged one."""
    try:
        blocks = run.blocks
    except RunError as error:
        warn_of_damage(error)
        return False
    whole = [whole_file(blocks, name) for name in blocks.names]
    return len(whole) == -(-run.trials // run.block_trials) and all(whole)


def _tidy_after_kill(run: Run) -> None:
    """Delete the remains of a kill between the end of a run and its tidying; only files of that run."""
    there = interrupted(run.path)
    if there and not differences({key: there.get(key) for key in STUDY}, {key: run.fingerprint[key] for key in STUDY}):
        _tidy(run.path)


def _tidy(folder: Path) -> None:
    """Delete the files of an unfinished run alone; after a kill in here they remain in the finished run."""
    for name in (LOCK, CHECKPOINT, CHECKPOINT + UNFINISHED):
        (folder / name).unlink(missing_ok=True)
    BlockFiles(folder / PIECES).clear()
    (folder / FINGERPRINT).unlink(missing_ok=True)  # last, for it shows that the others are ours


def _some(names: tuple[str, ...]) -> str:
    left = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {left} more" if left > 0 else "")
