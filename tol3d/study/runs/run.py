"""The run on disk: summary.json, trials/ in Parquet, the scene and every file it read, and the checksums of all.

`writer.py` writes it into `<name>.partial` and renames that at the end, so a folder of that name is always whole.
"""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import RunError
from tol3d.files import LARGEST_FILE, FileContent, Files, UnreadableFileError, kept_name, read_contained
from tol3d.scene.nearest import nearest
from tol3d.study.runs.block_files import CHECKSUMS, MENDED, BlockFiles, block_name
from tol3d.study.runs.frame import Curves, frame_of
from tol3d.study.runs.manifest import TRIALS, Fingerprint, Manifest
from tol3d.study.runs.parquet import Shape
from tol3d.study.runs.summary.kinds import SummaryKinds
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.text import missing_mechanism, parsed, typed
from tol3d.study.runs.worst import worst_trial
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC

if TYPE_CHECKING:
    import pandas as pd

Columns = dict[str, NDArray[Any]]

SUMMARY = "summary.json"
SCENE = "scene.yaml"
PIECES = "pieces"
CHECKPOINT = "checkpoint"
FILES = "files"
STATUS = "status"  # columns of words begin so; of all others only details may be words
LOCK = "lock"
LARGEST_SUMMARY = 50_000_000  # bytes; a thousand curves of a thousand positions


class DamageWarning(UserWarning):
    """A block of a run is damaged and is made again."""


@dataclass(frozen=True, repr=False)
class Run:
    """A finished run.

    Args:
        path: its folder.
        summary: content of summary.json: statistics of each measure, contributors, timing, versions.
        kinds: allowed contents of a summary; default: those of this package's mechanisms.
    """

    path: Path
    summary: Mapping[str, Any]
    kinds: SummaryKinds | None = None

    def __repr__(self) -> str:
        """Scene and folder of the run."""
        found = self.found
        words = (found.scene, f"{self.trials} trials", f"seed {found.seed}", f"engine {found.engine}")
        return f"<Run {str(self.path)!r}: {', '.join(words)}>"

    @cached_property
    def found(self) -> RunSummary:
        """The summary as an object: `run.found.measures["play"].geometric.sigma`.

        Raises:
            RunError: it is not a summary as this version writes them, or of a mechanism that is not installed.
        """
        if missing := missing_mechanism(self.summary, self.kinds):
            raise RunError(f"{self.path / SUMMARY}: {missing}")

        def fault(place: str, words: str) -> RunError:
            return RunError(f"{self.path / SUMMARY}: {place}: {words}; it is damaged, or of another tol3d")

        return typed(self.summary, fault, self.kinds)

    @property
    def trials(self) -> int:
        """Number of trials that were run."""
        return self.found.trials

    @property
    def block_trials(self) -> int:
        """Trials of a block, but for the last one."""
        return self.found.blocks.trials

    @property
    def keeps_trials(self) -> bool:
        """True if it holds its trials one by one, not their statistics only."""
        return self.found.blocks.kept

    @property
    def manifest(self) -> Manifest:
        """Its own files with their checksums.

        Raises:
            RunError: it has no such list.
        """
        return Manifest.read(self.path)

    @property
    def blocks(self) -> BlockFiles:
        """The files of its trials.

        Raises:
            RunError: it kept no trials, or their list of checksums was changed since.
        """
        if not self.keeps_trials:
            raise RunError(
                f"{self.path}: this run kept its statistics only (--no-trials); run the scene again without "
                "--no-trials for columns, or replay single trials by their number"
            )
        try:
            self.manifest.content(f"{TRIALS}/{CHECKSUMS}")
        except RunError as error:
            raise RunError(f"{error}; {MENDED}") from None
        return BlockFiles(self.path / TRIALS, shape=self._shape_of)

    def _shape_of(self, name: str) -> Shape | None:
        """Shape of the file of a block."""
        rows = self._block_sizes.get(name)
        return None if rows is None else Shape(rows, self._width_of)

    def _width_of(self, column: str) -> int:
        """Number of positions of a column: 1, or those of a curve."""
        method, _, name = column.partition(":")
        measure = self.found.measures.get(name) if method in ("analytic", "geometric") else None
        return len(measure.position_deg or ()) if measure and measure.take == "curve" else 1

    @cached_property
    def _block_sizes(self) -> Mapping[str, int]:
        """Trials of each block, by the name of its file, in order."""
        size, firsts = self.block_trials, range(0, self.trials, self.block_trials)
        return {block_name(index): min(size, self.trials - first) for index, first in enumerate(firsts)}

    @property
    def column_names(self) -> tuple[str, ...]:
        """Names of the columns of trials/; none in a run that kept no trials."""
        return self._columns_in(self.blocks) if self.keeps_trials else ()

    def _columns_in(self, blocks: BlockFiles) -> tuple[str, ...]:
        """Names of the columns of the first block, which has every measure of the summary."""
        needed = (f"{method}:{name}" for name in self.found.measures for method in self.found.methods)
        known = blocks.column_names
        if missing := next((name for name in needed if name not in known), None):
            raise RunError(f"{blocks.folder}: no column {missing!r}, which the summary names; {MENDED}")
        return known

    def columns(self, *names: str) -> dict[str, NDArray[Any]]:
        """Columns as numpy arrays, trial on axis 0 (a curve: positions on axis 1); all of them by default.

        Raises:
            RunError: no such column, the run kept no trials, or a block is damaged.
        """
        pieces = [*self.pieces(*names)]
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
        return frame_of(self.columns(*names), self.found.measures, curves)

    def worst(self, measure: str | None = None) -> int:
        """Trial that is nearest to a limit of a measure, or furthest beyond it; see `runs/worst.py`.

        Raises:
            RunError: no such measure, or the run kept no trials.
        """
        return worst_trial(self, measure)

    def pieces(self, *names: str) -> Iterator[Columns]:
        """Columns block by block, in the order of the trials: memory does not grow with their number.

        Raises:
            RunError: no such column, the run kept no trials, or a block is damaged.
        """
        blocks = self.blocks
        known = self._columns_in(blocks)
        unknown = [name for name in names if name not in known]
        if unknown:
            raise RunError(f"{self.path}: no column {unknown[0]!r}; there are: {', '.join(known)}")
        for block in self._block_sizes:
            piece = blocks.read(block, names or known)
            for name, values in piece.items():
                if (values.dtype.kind == "U") != name.startswith(STATUS) and not _is_words(name, values):
                    raise RunError(f"{blocks.path(block)}: column {name!r:.100} holds something else; {MENDED}")
            yield piece

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
        kept = {name: sha256 for name, sha256 in self.found.files.items() if name != SCENE}
        return {name: self._kept(name, self.path / FILES / kept_name(name, kept[name])) for name in kept}

    def _kept(self, name: str, path: Path) -> FileContent:
        try:
            file = FileContent(path, read_contained(path, self.path, LARGEST_FILE))
        except UnreadableFileError as error:
            raise RunError(f"{path}: cannot be read ({error}); the run is damaged") from None
        if file.sha256 != self.found.files.get(name):
            raise RunError(f"{path}: was changed since the run was made, so its trials cannot be made again")
        return file

    @property
    def fingerprint(self) -> Fingerprint:
        """Identity of its blocks: scene, files, study, versions and processor, blocks."""
        files = dict(self.found.files)
        versions = {name: version for name, version in self.found.versions.items() if name != "python"}
        study, blocks = self.summary["study"], self.summary["blocks"]  # as they were written
        return {"scene": files.pop(SCENE, None), "files": files, "study": study, "versions": versions, "blocks": blocks}


def open_run(path: Path | str, kinds: SummaryKinds | None = None) -> Run:
    """Open a run's folder, which a stranger may have made; executes nothing of it.

    Checked here are the summary's checksum, all its keys and values, and the number of blocks; scene, files and trials
    are checked when they are read. That nothing was changed is not to say who made it.

    Args:
        path: the folder.
        kinds: allowed contents of a summary; default: those of this package's mechanisms.

    Raises:
        RunError: not a run, damaged, or changed since it was made.
    """
    path = Path(path)
    run = read_run(path, kinds)
    if run.keeps_trials:
        there, expected = len(run.blocks.names), -(-run.trials // run.block_trials)
        if there != expected:
            words = f"expected {expected} Parquet files with the trials, found {there}"
            raise RunError(f"{path / TRIALS}: {words}; {MENDED}")
    return run


def _no_run_hint(path: Path) -> str:
    """Advice on a path that is no run; "" for none."""
    if path.name.endswith(".partial"):
        return "; it was not finished: run the scene again to go on"
    if path.is_file():
        return f"; tol3d run {path} makes one" if path.suffix == ".yaml" else ""
    return nearest(path.name, (own.parent.name for own in path.parent.glob(f"*/{SUMMARY}")))


def read_run(path: Path, kinds: SummaryKinds | None = None) -> Run:
    """A run by its summary alone: its blocks may be damaged.

    Raises:
        RunError: not a run, or its summary is damaged or was changed since it was made.
    """
    if not (path / SUMMARY).exists():
        raise RunError(f"{path}: expected a run's folder with {SUMMARY} in it{_no_run_hint(path)}")
    content = Manifest.read(path).content(SUMMARY, LARGEST_SUMMARY)
    run = Run(path, parsed(content, path / SUMMARY), kinds)
    _ = run.found  # refused here, if at all
    return run


def whole_file(files: BlockFiles, name: str) -> bool:
    """True if a file is as it was written; warns of a damaged one."""
    try:
        files.verify(name)
    except RunError as error:
        warn_of_damage(error)
        return False
    return True


def warn_of_damage(error: RunError) -> None:
    """Warn that a damaged block is made again."""
    warnings.warn(str(error).removesuffix(f"; {MENDED}") + "; it is made again", DamageWarning, stacklevel=2)


def _is_words(name: str, values: NDArray[Any]) -> bool:
    """True if a column is a detail in words, such as the contacts that carry; values and units mean numbers."""
    return values.dtype.kind == "U" and not name.startswith((ANALYTIC, GEOMETRIC)) and not name.endswith("]")
