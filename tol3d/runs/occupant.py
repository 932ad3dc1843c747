"""What lies where a run is to go, and whether a run may take its place.

A run is replaced by one of the same study only, and only where nothing but its own files is in its folder: notes,
exports and other people's work are never deleted. `--force` replaces a run of another study too; what holds anything
else it moves aside whole, to the first free of `<name>.1`, `<name>.2` ...
"""

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from tol3d.errors import RunError
from tol3d.runs.fingerprint import Fingerprint, another_study, differences, interrupted
from tol3d.runs.run import Run, partial_of, read_run, tidy_after_kill
from tol3d.runs.summary.kinds import SummaryKinds

SHOWN = 3  # foreign files in a message


class MovedAsideWarning(UserWarning):
    """A folder that held more than a run was moved aside."""


@dataclass(frozen=True)
class Occupant:
    """A run that lies where another is to go.

    Args:
        run: what is there.
        others: in what its study differs from the one that is to go there, in words.
        foreign: what lies in its folder and is not its own.
    """

    run: Run
    others: tuple[str, ...]
    foreign: tuple[str, ...]

    @property
    def reason(self) -> str:
        """Why it is not simply replaced; empty where it is."""
        if self.others:
            return f"holds another study ({'; '.join(self.others)})"
        return f"holds what is not of the run ({_some(self.foreign)})" if self.foreign else ""

    def refuse(self, *, force: bool) -> None:
        """Raise unless it may be replaced, or moved aside.

        Raises:
            RunError: it says the way out.
        """
        if force or not self.reason:
            return
        way = "moves the whole folder aside" if self.foreign else "replaces it"
        raise RunError(f"{self.run.path}: {self.reason}; choose another --out, or --force, which {way}")


def occupant_of(path: Path, fingerprint: Fingerprint, kinds: SummaryKinds | None = None) -> Occupant | None:
    """The run that lies at a path; None where nothing does.

    Raises:
        RunError: something lies there that is not a run, or cannot be recognised as one; nothing may replace it.
    """
    if not path.exists() and not path.is_symlink():
        return None
    try:
        run = read_run(path, kinds)
        tidy_after_kill(run)
        return Occupant(run, tuple(another_study(run.fingerprint, fingerprint)), tuple(run.manifest.foreign()))
    except RunError as error:
        raise RunError(
            f"{path}: exists and is not a tol3d run that this version knows ({error}); choose another folder with --out"
        ) from None


def free_folder(
    wanted: Path, fingerprint: Fingerprint, *, resume: bool = False, kinds: SummaryKinds | None = None
) -> tuple[Path, str]:
    """Where a run goes by default.

    The wanted folder, or the first of `<name>-2`, `<name>-3` ... that another study has not taken. A study finds its
    own folder again.

    Args:
        wanted: the folder.
        fingerprint: of the run.
        resume: only a folder with this very study will do; the wanted one where there is none.
        kinds: what a summary may hold; by default what this package's mechanisms add.

    Returns:
        the folder, and what is in the wanted one where it is another.
    """
    taken = ""
    for path in numbered(wanted):
        reason = _taken(path, fingerprint, kinds, resume=resume)
        if reason is None:
            return (path, taken)
        if not reason:
            return (wanted, "") if resume else (path, taken)
        taken = taken or f"{path} {reason}"
    raise AssertionError("numbers do not end")


def numbered(wanted: Path) -> Iterator[Path]:
    """Where runs of a scene go by default: its folder, then `<name>-2`, `<name>-3` ..."""
    yield wanted
    yield from (wanted.with_name(f"{wanted.name}-{number}") for number in itertools.count(2))


def refuse_changed(folders: Iterable[Path], scene: str, files: Mapping[str, str]) -> None:
    """Raise where the first of the folders have runs, and none of them is of this scene and these files.

    Args:
        folders: where a run may go on.
        scene: SHA-256 of its text.
        files: SHA-256 of the files that it names; what else a run keeps is not looked at.

    Raises:
        RunError: in what the first run differs.
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
    """The fingerprint of the run that a folder has, interrupted or not; empty where it has none."""
    if (partial := partial_of(path)).exists():
        return interrupted(partial) or {}
    return read_run(path).fingerprint if path.exists() else {}


def _taken(path: Path, fingerprint: Fingerprint, kinds: SummaryKinds | None, *, resume: bool) -> str | None:
    """Why a folder will not do; None where this study is there, "" where nothing is."""
    partial = partial_of(path)
    begun = partial.exists()
    if begun:
        there = interrupted(partial)
        if there is None:
            return "is taken by something else"
        if others := another_study(there, fingerprint) if there else []:
            return f"is that of an interrupted run of another study ({'; '.join(others)})"
    try:
        occupant = occupant_of(path, fingerprint, kinds)
    except RunError:
        return "is taken by something else"
    if occupant is None:
        return None if begun else ""
    reason = "; ".join(occupant.others) if resume else occupant.reason
    return reason or None


def free_aside(path: Path) -> Path:
    """Where a folder is moved aside: the first of `<name>.1`, `<name>.2` ... that is not there."""
    asides = (path.with_name(f"{path.name}.{number}") for number in itertools.count(1))
    return next(aside for aside in asides if not aside.exists() and not aside.is_symlink())


def _some(names: tuple[str, ...]) -> str:
    left = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {left} more" if left > 0 else "")
