"""Runs of a scene in `runs/` beside it, made by the app or by `tol3d run`: listed, and deleted on request."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from itertools import islice
from pathlib import Path
from typing import Final

from tol3d.apps.workbench.attempt import RUNS, is_name
from tol3d.apps.workbench.place import inside
from tol3d.errors import InputError, RunError, unwritable
from tol3d.files import read_file
from tol3d.study.runs.run import Run, open_run

SUMMARY: Final = "summary.json"
MOST_LISTED: Final = 20
"""Runs of a scene that are listed, the newest; each is opened."""


@dataclass(frozen=True)
class MadeRun:
    """A finished run.

    Args:
        name: of its folder in `runs`.
        trials: number of them.
        made: time of its end, ISO 8601.
        is_of_now: True if the scene's file has not been changed since.
    """

    name: str
    trials: int
    made: str
    is_of_now: bool


def runs_of(scene: Path, folder: Path) -> Iterator[MadeRun]:
    """Runs of a scene, the newest first; what is no run that this tol3d can read is left out.

    Args:
        scene: its file.
        folder: the opened folder, where it lies.
    """
    own, now = re.compile(rf"{re.escape(scene.stem)}(-[0-9]+)?"), read_file(scene).sha256
    found = dict[Path, float]()
    for path in (folder / RUNS).glob(f"*/{SUMMARY}"):
        others = path.parent.name != scene.stem and (folder / f"{path.parent.name}{scene.suffix}").exists()
        if own.fullmatch(path.parent.name) and not others:
            try:
                found[inside(path, folder).parent] = path.stat().st_mtime
            except (InputError, OSError):  # it leads out, or goes at this moment
                continue
    made = ((run, found[run.path]) for run in _opened(sorted(found, key=lambda own: -found[own])))
    for run, at in islice(made, MOST_LISTED):
        when = datetime.fromtimestamp(at).astimezone().isoformat(timespec="seconds")
        yield MadeRun(run.path.name, run.trials, when, run.fingerprint.get("scene") == now)


def _opened(places: list[Path]) -> Iterator[Run]:
    for place in places:
        try:
            yield open_run(place)
        except RunError:
            continue


def delete_run(name: str, folder: Path) -> None:
    """Delete a finished run with all its files.

    Args:
        name: of its folder in `runs`.
        folder: the opened folder.

    Raises:
        InputError: no such run, other files are in its folder, or it cannot be deleted.
    """
    place = inside(folder / RUNS / name, folder)
    if not is_name(name) or place.is_symlink():
        raise InputError(f"{place}: expected the folder of a finished run")
    manifest = open_run(place).manifest
    if foreign := manifest.foreign():
        raise InputError(f"{place}: holds files that are not of the run ({foreign[0]}); delete the folder by hand")
    try:
        manifest.remove()
    except OSError as error:
        raise unwritable(place, error, "close what holds it") from None
