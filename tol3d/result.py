"""The run on disk: summary.json, trials/ in Parquet with their checksums, the scene and every file it read.

`writer.py` writes it into `<name>.partial` and renames that at the end, so a folder of that name is always whole.
"""

import json
import shutil
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tol3d.blockfiles import MENDED, BlockFiles, block_name
from tol3d.errors import RunError
from tol3d.files import FileContent, Files, kept_name
from tol3d.frame import Curves, frame_of
from tol3d.processor import unlike
from tol3d.worst import worst_trial

if TYPE_CHECKING:
    import pandas as pd

Columns = dict[str, NDArray[np.generic]]

SUMMARY = "summary.json"
SCENE = "scene.yaml"
TRIALS = "trials"
PIECES = "pieces"
CHECKPOINT = "checkpoint"
FINGERPRINT = "fingerprint.json"
FILES = "files"
LOCK = "lock"

Fingerprint = Mapping[str, Any]


class DamageWarning(UserWarning):
    """A block of a run is damaged and is made again."""


@dataclass(frozen=True, repr=False)
class Run:
    """A finished run.

    Args:
        path: its folder.
        summary: what summary.json holds: statistics of each measure, contributors, timing, versions.
    """

    path: Path
    summary: Mapping[str, Any]

    def __repr__(self) -> str:
        """Which run it is, and where."""
        study = self.summary["study"]
        words = (f"{self.trials} trials", f"seed {study.get('seed')}", f"engine {study.get('engine')}")
        return f"<Run {str(self.path)!r}: {', '.join((str(self.summary.get('scene')), *words))}>"

    @property
    def trials(self) -> int:
        """How many trials were run."""
        return int(self.summary["trials"])

    @property
    def keeps_trials(self) -> bool:
        """Whether it holds its trials one by one, not their statistics only."""
        return bool(self.summary.get("blocks", {}).get("kept", True))

    @property
    def blocks(self) -> BlockFiles:
        """The files of its trials.

        Raises:
            RunError: it kept no trials.
        """
        if not self.keeps_trials:
            raise RunError(
                f"{self.path}: this run kept its statistics only (--no-trials); run the scene again without "
                "--no-trials for columns, or replay single trials by their number"
            )
        return BlockFiles(self.path / TRIALS)

    @property
    def column_names(self) -> tuple[str, ...]:
        """Names of the columns of trials/; none in a run that kept no trials."""
        return self.blocks.column_names if self.keeps_trials else ()

    def columns(self, *names: str) -> dict[str, NDArray[np.generic]]:
        """Columns as numpy arrays, trial on axis 0 (a curve: positions on axis 1); all of them by default.

        Raises:
            RunError: no such column, the run kept no trials, or a block is damaged.
        """
        blocks = self.blocks
        unknown = [name for name in names if name not in blocks.column_names]
        if unknown:
            raise RunError(f"{self.path}: no column {unknown[0]!r}; there are: {', '.join(blocks.column_names)}")
        pieces = [blocks.read(name, names or None) for name in blocks.names]
        return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}

    def frame(self, *names: str, curves: Curves = "split") -> "pd.DataFrame":
        """Columns as a DataFrame of pandas, a row a trial; all of them by default.

        Args:
            names: columns, as in `column_names`.
            curves: "split" gives every position of a curve a column (`geometric:curve:45 deg`), "drop" leaves
                curves out.

        Raises:
            RunError: as `columns`.
            MissingPackageError: pandas is not installed.
        """
        return frame_of(self.columns(*names), self.summary["measures"], curves)

    def worst(self, measure: str | None = None) -> int:
        """Trial that is nearest to a limit of a measure, or furthest beyond it; see `tol3d.worst.worst_trial`.

        Raises:
            RunError: no such measure, or the run kept no trials.
        """
        return worst_trial(self, measure)

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

    @property
    def fingerprint(self) -> Fingerprint:
        """What makes its blocks its own: scene, files, study, versions and processor, blocks."""
        files = dict(self.summary["files"])
        versions = {name: version for name, version in self.summary["versions"].items() if name != "python"}
        blocks = self.summary.get("blocks")
        study = self.summary["study"]
        return {"scene": files.pop(SCENE, None), "files": files, "study": study, "versions": versions, "blocks": blocks}


def open_run(path: Path | str) -> Run:
    """Open a run's folder; executes nothing of it.

    Raises:
        RunError: not a run, or damaged.
    """
    path = Path(path)
    try:
        summary = json.loads((path / SUMMARY).read_text(encoding="utf-8"))
    except FileNotFoundError:
        hint = "; it was not finished: run the scene again to go on" if path.name.endswith(".partial") else ""
        raise RunError(f"{path}: expected a run's folder with {SUMMARY} in it{hint}") from None
    except (OSError, ValueError) as error:
        raise RunError(f"{path / SUMMARY}: cannot be read ({error})") from None
    if not isinstance(summary, dict) or not {"trials", "measures", "study", "files"} <= summary.keys():
        raise RunError(f"{path / SUMMARY}: expected the summary of a tol3d run")
    run = Run(path, summary)
    if run.keeps_trials and not run.blocks.names:
        raise RunError(f"{path / TRIALS}: expected Parquet files with the trials, found none")
    return run


def differences(there: Fingerprint, asked: Fingerprint) -> list[str]:
    """In what a run that is there differs from the one that is asked for, in words."""
    found = []
    for key in {**there, **asked}:
        old, new = there.get(key), asked.get(key)
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            found += [f"{key}: {words}" for words in differences(old, new)]
        elif old != new:
            there_only, now_only = unlike(old, new)
            found.append("the scene's text" if key == "scene" else f"{key} {there_only} there, {now_only} now")
    return found


def partial_of(path: Path) -> Path:
    """The folder in which a run that goes to `path` is written."""
    path = path.resolve()  # so that "." has a name
    return path.with_name(path.name + ".partial")


def whole_run(path: Path, fingerprint: Fingerprint) -> Run | None:
    """The finished run of that fingerprint, if no other was begun there since and all its blocks are whole."""
    if partial_of(path).exists() or not (path / SUMMARY).is_file():
        return None
    run = open_run(path)
    if differences(run.fingerprint, fingerprint):
        return None
    if run.keeps_trials:
        count = -(-run.trials // int(run.summary["blocks"]["trials"]))
        whole = [whole_file(run.blocks, block_name(index)) for index in range(count)]  # tells of each damaged one
        if not all(whole):
            return None
    tidy(path)
    return run


def whole_file(files: BlockFiles, name: str) -> bool:
    """Whether a file is as it was written; a damaged one is told of."""
    try:
        files.verify(name)
    except RunError as error:
        tell_of_damage(error)
        return False
    return True


def tell_of_damage(error: RunError) -> None:
    warnings.warn(str(error).removesuffix(f"; {MENDED}") + "; it is made again", DamageWarning, stacklevel=2)


def tidy(folder: Path) -> None:
    """Take away what only an unfinished run needs; of a kill in here the finished run bears what was left."""
    for name in (LOCK, CHECKPOINT, FINGERPRINT):
        (folder / name).unlink(missing_ok=True)
    shutil.rmtree(folder / PIECES, ignore_errors=True)
