"""The run on disk: summary.json, trials/ in Parquet, the scene and every file it read.

A run is written into `<name>.partial` and renamed at the end, so a folder of that name is always whole.
"""

import json
import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from filelock import FileLock, Timeout
from numpy.typing import NDArray

from tol3d.errors import RunError
from tol3d.files import FileContent, Files, kept_name

Columns = dict[str, NDArray[np.generic]]

SUMMARY = "summary.json"
SCENE = "scene.yaml"
TRIALS = "trials"
PIECES = "pieces"
FINGERPRINT = "fingerprint.json"
FILES = "files"
LOCK = "lock"
NOBODYS = "{}"  # the fingerprint of no run


@dataclass(frozen=True)
class Run:
    """A finished run.

    Args:
        path: its folder.
        summary: what summary.json holds: statistics of each measure, contributors, timing, versions.
    """

    path: Path
    summary: Mapping[str, Any]

    @property
    def trials(self) -> int:
        """How many trials it holds."""
        return int(self.summary["trials"])

    @property
    def column_names(self) -> tuple[str, ...]:
        """Names of the columns of trials/."""
        first = _blocks(self.path)[0]
        try:
            return tuple(pq.read_schema(first).names)
        except (OSError, pa.ArrowException) as error:
            raise _damaged(first, error) from None

    def columns(self, *names: str) -> dict[str, NDArray[np.generic]]:
        """Columns as numpy arrays, trial on axis 0 (a curve: positions on axis 1); all of them by default.

        Raises:
            RunError: no such column, or the files are damaged.
        """
        unknown = [name for name in names if name not in self.column_names]
        if unknown:
            raise RunError(f"{self.path}: no column {unknown[0]!r}; there are: {', '.join(self.column_names)}")
        pieces = [read_columns(path, names or None) for path in _blocks(self.path)]
        return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}

    @property
    def scene_path(self) -> Path:
        """The scene as it was when the run was made.

        Raises:
            RunError: it is not there, or was changed since.
        """
        return self._kept(SCENE, self.path / SCENE).path

    @property
    def files(self) -> Files:
        """The files that the scene names, as they were then, by the names it gives them.

        Raises:
            RunError: one is not there, or was changed since.
        """
        kept = {name: sha256 for name, sha256 in self.summary["files"].items() if name != SCENE}
        return {name: self._kept(name, self.path / FILES / kept_name(name, kept[name])) for name in kept}

    def _kept(self, name: str, path: Path) -> FileContent:
        try:
            file = FileContent(path, path.read_bytes())
        except OSError as error:
            raise RunError(f"{path}: cannot be read ({error.strerror}); the run is damaged") from None
        if file.sha256 != self.summary["files"].get(name):
            raise RunError(f"{path}: was changed since the run was made, so its trials cannot be made again")
        return file


def open_run(path: Path) -> Run:
    """Open a run's folder; executes nothing of it.

    Raises:
        RunError: not a run, or damaged.
    """
    try:
        summary = json.loads((path / SUMMARY).read_text(encoding="utf-8"))
    except FileNotFoundError:
        hint = "; it was not finished: run the scene again to go on" if path.name.endswith(".partial") else ""
        raise RunError(f"{path}: expected a run's folder with {SUMMARY} in it{hint}") from None
    except (OSError, ValueError) as error:
        raise RunError(f"{path / SUMMARY}: cannot be read ({error})") from None
    if not isinstance(summary, dict) or not {"trials", "measures", "study", "files"} <= summary.keys():
        raise RunError(f"{path / SUMMARY}: expected the summary of a tol3d run")
    if not _blocks(path):
        raise RunError(f"{path / TRIALS}: expected Parquet files with the trials, found none")
    return Run(path, summary)


def _blocks(path: Path) -> list[Path]:
    return sorted((path / TRIALS).glob("block-*.parquet"))


def read_columns(path: Path, names: tuple[str, ...] | None = None) -> Columns:
    """Columns of one Parquet file.

    Raises:
        RunError: it is damaged.
    """
    try:
        table = pq.read_table(path, columns=list(names) if names else None, partitioning=None)
    except (OSError, pa.ArrowException) as error:
        raise _damaged(path, error) from None
    return {name: _to_numpy(table.column(name)) for name in table.column_names}


def _damaged(path: Path, error: Exception) -> RunError:
    return RunError(f"{path}: damaged or unreadable, run the scene again ({str(error).splitlines()[0]})")


def _to_numpy(column: pa.ChunkedArray) -> NDArray[np.generic]:
    if pa.types.is_fixed_size_list(column.type):
        flat = column.combine_chunks().flatten().to_numpy(zero_copy_only=False)
        return np.asarray(flat).reshape(len(column), -1)
    if pa.types.is_dictionary(column.type) or pa.types.is_string(column.type):
        return np.array(column.to_pylist())
    return np.asarray(column.to_numpy())


def _to_arrow(values: NDArray[np.generic]) -> pa.Array:
    if values.ndim == 2:
        return pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])
    if values.dtype.kind == "U":
        return pa.array(values.tolist()).dictionary_encode()
    return pa.array(values)


class RunWriter:
    """Writes a run: blocks as they come, the rest at the end. Implements execution.BlockStore.

    Args:
        path: the run's folder to be; an older run there is replaced at the end, anything else refused.
        fingerprint: what makes the blocks of an interrupted run this run's own.
        units: unit of each column, kept in the files' metadata.

    Raises:
        RunError: the folder is something else, cannot be written, or is being written by another run.
    """

    def __init__(self, path: Path, fingerprint: Mapping[str, Any], units: Mapping[str, str]) -> None:
        path = path.resolve()  # so that "." has a name
        self.path = path
        self._units = units
        self._partial = path.with_name(path.name + ".partial")
        self._lock = FileLock(self._partial / LOCK)
        if path.exists() and not (path / SUMMARY).is_file():
            raise RunError(f"{path}: exists and is not a tol3d run; choose another folder with --out")
        try:
            self._open_partial(fingerprint)
        except OSError as error:
            raise RunError(f"{self._partial}: cannot be written ({error.strerror}); choose another --out") from None

    def _open_partial(self, fingerprint: Mapping[str, Any]) -> None:
        mark = self._partial / FINGERPRINT
        text = json.dumps(fingerprint, sort_keys=True, indent=1)
        if self._partial.exists() and not mark.is_file() and any(self._partial.iterdir()):
            raise RunError(f"{self._partial}: exists and is not an interrupted run; move it away")
        self._partial.mkdir(parents=True, exist_ok=True)
        try:
            self._lock.acquire(blocking=False)
        except Timeout:
            raise RunError(f"{self.path}: another run is being written there; choose another --out") from None
        if mark.is_file() and mark.read_text(encoding="utf-8") != text:
            _write_whole(mark, NOBODYS)  # killed in here, the next run still sees that the rest is not its own
            for folder in (TRIALS, PIECES):
                shutil.rmtree(self._partial / folder, ignore_errors=True)
        _write_whole(mark, text)
        for folder in (TRIALS, PIECES):
            (self._partial / folder).mkdir(exist_ok=True)

    def _block_path(self, index: int) -> Path:
        return self._partial / TRIALS / f"block-{index:06d}.parquet"

    def read(self, index: int) -> Columns | None:
        """A block that an interrupted run has finished, or None; a damaged one counts as none."""
        return self._read(self._block_path(index))

    @staticmethod
    def _read(path: Path) -> Columns | None:
        if not path.exists():
            return None
        try:
            return read_columns(path)
        except RunError:
            return None

    def _piece_path(self, index: int, first: int) -> Path:
        return self._partial / PIECES / f"block-{index:06d}-{first}.parquet"

    def read_piece(self, index: int, first: int) -> Columns | None:
        """A piece of an unfinished block that begins at a trial, or None; a damaged one counts as none."""
        return self._read(self._piece_path(index, first))

    def write_piece(self, index: int, first: int, columns: Columns) -> None:
        """Keep a piece of an unfinished block."""
        self._write(self._piece_path(index, first), columns)

    def write(self, index: int, columns: Columns) -> None:
        """Write a finished block; its pieces go."""
        self._write(self._block_path(index), columns)
        for piece in (self._partial / PIECES).glob(f"block-{index:06d}-*"):
            piece.unlink()

    def _write(self, path: Path, columns: Columns) -> None:
        """Write columns beside their place and rename them there."""
        fields, arrays = [], []
        for name, values in columns.items():
            array = _to_arrow(values)
            arrays.append(array)
            fields.append(pa.field(name, array.type, metadata={"unit": self._units.get(name, "")}))
        beside = path.with_suffix(".writing")
        try:
            pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), beside)
            os.replace(beside, path)
        except OSError as error:
            raise RunError(f"{path}: cannot be written ({error.strerror or error})") from None

    def keep(self, scene: FileContent, files: Files) -> dict[str, str]:
        """Keep the scene and the files that it names; the SHA-256 of each by its name."""
        shutil.rmtree(self._partial / FILES, ignore_errors=True)
        places = {name: self._partial / FILES / kept_name(name, file.sha256) for name, file in files.items()}
        everything = {name: (path, files[name]) for name, path in places.items()} | {
            SCENE: (self._partial / SCENE, scene)
        }
        for path, file in everything.values():
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(file.content)
        return {name: file.sha256 for name, (_, file) in everything.items()}

    def picture_path(self, name: str) -> Path:
        """Where a picture of the run goes."""
        return self._partial / name

    def finish(self, summary: Mapping[str, Any]) -> Run:
        """Write the summary and put the run in its place."""
        _write_whole(self._partial / SUMMARY, json.dumps(summary, indent=1, ensure_ascii=False, allow_nan=False) + "\n")
        (self._partial / FINGERPRINT).unlink()
        shutil.rmtree(self._partial / PIECES)
        self._lock.release()
        (self._partial / LOCK).unlink(missing_ok=True)
        if self.path.exists():
            old = self.path.with_name(self.path.name + ".old")
            shutil.rmtree(old, ignore_errors=True)
            os.replace(self.path, old)
            os.replace(self._partial, self.path)
            shutil.rmtree(old, ignore_errors=True)
        else:
            os.replace(self._partial, self.path)
        return Run(self.path, json.loads(json.dumps(summary)))


def _write_whole(path: Path, text: str) -> None:
    beside = path.with_name(path.name + ".writing")
    beside.write_text(text, encoding="utf-8")
    os.replace(beside, path)
