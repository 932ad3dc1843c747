"""Files that are a run's own: SHA256SUMS in its folder, which `sha256sum --check` reads.

It shows that nothing was changed since it was written (integrity), not who wrote it (authenticity): whoever changes a
file can write a new list. The files of the trials have a list of their own beside them; here stands the sum of that.

Fingerprint that identifies the blocks of an interrupted run, kept while the run is written.
"""

import hashlib
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from tol3d.errors import RunError
from tol3d.files import UnreadableFileError, contained, read_contained
from tol3d.numerics.processor import unlike
from tol3d.study.runs.atomic_write import write_whole
from tol3d.study.runs.block_files import CHECKSUMS, BlockFiles

MANIFEST = "SHA256SUMS"
TRIALS = "trials"
LARGEST_MANIFEST = 1_000_000  # bytes; some ten thousand files, where a run has a dozen
LARGEST_OWN_FILE = 100_000_000  # bytes; of a summary, a scene, a file that it names, a picture, a list of blocks
LINE = re.compile(r"([0-9a-f]{64})  (\S.*)")
OF_FILE_MANAGERS = frozenset((".DS_Store", "Thumbs.db", "desktop.ini"))  # made by looking at a folder: nobody's work


@dataclass(frozen=True)
class Manifest:
    """SHA-256 of a run's own files but those of single blocks, by their paths in its folder."""

    folder: Path
    sums: Mapping[str, str]

    @classmethod
    def of(cls, folder: Path, names: Iterable[str]) -> "Manifest":
        """The list of some files as they are."""
        return cls(folder, {name: _sum_of(folder, name) for name in sorted(names)})

    @classmethod
    def read(cls, folder: Path) -> "Manifest":
        """The list that a run's folder holds.

        Raises:
            RunError: there is none, or it is not such a list.
        """
        path = folder / MANIFEST
        try:
            lines = read_contained(path, folder, LARGEST_MANIFEST).decode("utf-8").splitlines()
        except UnreadableFileError as error:
            raise RunError(f"{path}: cannot be read ({error}); every run has it now: run the scene again") from None
        except UnicodeDecodeError:
            lines = ["not a list"]
        found = [LINE.fullmatch(line) for line in lines]
        sums = {match[2]: match[1] for match in found if match and contained(match[2])}
        if not sums or len(sums) != len(lines):
            raise RunError(f"{path}: expected lines of a SHA-256 and the path of a file in the run; the run is damaged")
        return cls(folder, sums)

    def adding(self, name: str) -> "Manifest":
        """The list with one more file, or with one as it is now."""
        return Manifest(self.folder, dict(sorted({**self.sums, name: _sum_of(self.folder, name)}.items())))

    def write(self) -> None:
        """Put the list into the folder, all or nothing."""
        write_whole(self.folder / MANIFEST, "".join(f"{s}  {name}\n" for name, s in self.sums.items()).encode())

    def content(self, name: str, largest: int = LARGEST_OWN_FILE) -> bytes:
        """A file of the run, as it was when the run was made.

        Raises:
            RunError: it is missing, too large, leads out of the run, is no plain file, or was changed since.
        """
        path = self.folder / name
        try:
            content = read_contained(path, self.folder, largest)
        except UnreadableFileError as error:
            raise RunError(f"{path}: cannot be read ({error}); the run is damaged") from None
        if hashlib.sha256(content).hexdigest() != self.sums.get(name):
            raise RunError(f"{path}: was changed since the run was made: its SHA-256 is not that of {MANIFEST}")
        return content

    @property
    def paths(self) -> frozenset[str]:
        """Every file of the run, those of its blocks and the list itself too."""
        blocks = BlockFiles(self.folder / TRIALS)
        listed = [f"{TRIALS}/{blocks.path(name).name}" for name in blocks.names if name in blocks]
        return frozenset((*self.sums, *listed, MANIFEST))

    def foreign(self) -> list[str]:
        """Contents of the folder that are not the run's: other files, changed ones, links, folders.

        Blocks of trials are recognised by their names, as nobody edits those.
        """
        own = self.paths
        folders = {str(folder) for name in own for folder in PurePosixPath(name).parents}
        return [
            name
            for name in _below(self.folder)
            if not (name in folders and _is_folder(self.folder / name))
            and not (name in own and self._is_unchanged(name))
            and PurePosixPath(name).name not in OF_FILE_MANAGERS
        ]

    def _is_unchanged(self, name: str) -> bool:
        path = self.folder / name
        return not path.is_symlink() and (name not in self.sums or _sum_of(self.folder, name) == self.sums[name])

    def remove(self) -> bool:
        """Delete the run's own files, then the folders that are empty; True when nothing is left.

        The lists go last, that of the blocks after these and the manifest after all: killed in here, it can go on.
        """
        own = self.paths - {MANIFEST}
        for name in sorted(own, key=lambda name: name in self.sums):
            (self.folder / name).unlink(missing_ok=True)
        for name in _below(self.folder):
            if PurePosixPath(name).name in OF_FILE_MANAGERS:
                (self.folder / name).unlink(missing_ok=True)
        folders = {str(folder) for name in own for folder in PurePosixPath(name).parents} - {"."}
        for name in sorted(folders, reverse=True):
            with suppress(OSError):
                (self.folder / name).rmdir()
        (self.folder / MANIFEST).unlink(missing_ok=True)
        with suppress(OSError):
            self.folder.rmdir()
        return not self.folder.exists()


def _below(folder: Path) -> Iterator[str]:
    """Everything below a folder, by its path there; links are not followed."""
    for place, folders, files in os.walk(folder):
        for name in sorted((*folders, *files)):
            yield (Path(place) / name).relative_to(folder).as_posix()


def _is_folder(path: Path) -> bool:
    return path.is_dir() and not path.is_symlink()


def _sum_of(folder: Path, name: str) -> str:
    """SHA-256 of a file; empty if it cannot be read."""
    try:
        return hashlib.sha256(read_contained(folder / name, folder, LARGEST_OWN_FILE)).hexdigest()
    except UnreadableFileError:
        return ""


def own_paths_of_trials(kept: bool) -> tuple[str, ...]:
    """Paths of the trials in the list."""
    return (f"{TRIALS}/{CHECKSUMS}",) if kept else ()


FINGERPRINT = "fingerprint.json"
STUDY = ("scene", "files", "study")  # of a fingerprint; the rest decides the last bits only
LARGEST_FINGERPRINT = 10_000_000  # bytes; it names every file of the scene and every `until`

Fingerprint = Mapping[str, Any]


def differences(there: Fingerprint, asked: Fingerprint) -> list[str]:
    """Differences of an existing run from the one that is asked for, in words."""
    found = []
    for key in {**there, **asked}:
        old, new = there.get(key), asked.get(key)
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            found += [f"{key}: {words}" for words in differences(old, new)]
        elif old != new:
            there_only, now_only = unlike(old, new)
            found.append("the scene's text" if key == "scene" else f"{key} {there_only} there, {now_only} now")
    return found


def another_study(there: Fingerprint, asked: Fingerprint) -> list[str]:
    """Differences of an existing run's study from the one that is asked for, in words."""
    found = differences(*({key: print_.get(key) for key in STUDY} for print_ in (there, asked)))
    if _keeps(there) and not _keeps(asked):
        found.append("it holds the trials, too, and this would keep statistics only")
    return found


def _keeps(fingerprint: Fingerprint) -> bool:
    return bool((fingerprint.get("blocks") or {}).get("kept"))


def interrupted(partial: Path) -> Fingerprint | None:
    """The fingerprint of the interrupted run in a folder; None if there is none, {} if it was being cleared."""
    try:
        read: Any = json.loads(read_contained(partial / FINGERPRINT, partial, LARGEST_FINGERPRINT))
    except (UnreadableFileError, ValueError, RecursionError):
        return None
    return read if isinstance(read, Mapping) and (not read or "scene" in read) else None
