"""The pictures of a run, drawn beside it by a process of its own: see histogram_process."""

import json
import pickle
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from enum import StrEnum
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

from tol3d.report.presenter import presenter_of
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.text import kinds_of

MOST_TOGETHER = 4  # measures in one picture; of more, the worst
HEAT_MAP = "contributors.png"  # with all pictures
IN_FILE_NAMES = frozenset(" -_.,()+")  # besides letters and digits; anything else would be a folder or a drive

DrawRun = Callable[[Mapping[str, Any], Path], None]

COMMAND = (sys.executable, "-P", "-m", "tol3d.report.histogram_process")  # -P: not from the folder it is called in


class Pictures(StrEnum):
    """Measures that are drawn where there are more than MOST_TOGETHER: the worst, or an overview and each by itself."""

    WORST = "worst"
    ALL = "all"


class PictureError(Exception):
    """A histogram that could not be drawn; its message says why."""


class PictureWarning(UserWarning):
    """A picture of the system or of one measure that could not be drawn beside the histogram."""


@contextmanager
def drawing(presenter: str | None = None, pictures: Pictures = Pictures.WORST) -> Iterator[DrawRun]:
    """Within it a process that can draw gets ready, and draws one run: its summary, and where its histogram goes.

    What the system's presenter draws, and where all of many measures are wanted a picture of each, go beside the
    histogram; one that cannot be drawn is a PictureWarning.

    Args:
        presenter: import path of what shows the system; by default that of the run's measures.
        pictures: which of many measures are drawn.

    Raises:
        PictureError: by the drawing, which leaves no half of a picture.
    """
    try:
        process = subprocess.Popen(COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    except OSError as error:
        yield partial(_refuse, str(error))
        return
    with process:
        try:
            yield partial(_draw, process, presenter, pictures)
        finally:
            process.kill()


def _draw(
    process: "subprocess.Popen[bytes]",
    presenter: str | None,
    pictures: Pictures,
    summary: Mapping[str, Any],
    picture: Path,
) -> None:
    order = (picture, presenter, pictures, kinds_of(summary), json.dumps(summary))
    refused, errors = process.communicate(pickle.dumps(sys.path) + pickle.dumps(order))
    for name, reason in json.loads(refused or "{}").items():
        words = f"{name} could not be drawn ({reason}); the run is whole without it"
        warnings.warn(words, PictureWarning, stacklevel=2)
    if process.returncode == 0:
        return
    picture.unlink(missing_ok=True)
    last = errors.decode(errors="replace").strip().splitlines()[-1:]
    raise PictureError(*(last or [f"its process ended with {process.returncode}"]))


def _refuse(reason: str, summary: Mapping[str, Any], picture: Path) -> None:
    raise PictureError(reason)


def measure_files(measures: Iterable[str]) -> dict[str, str]:
    """Names of the pictures of single measures of a run, where there are too many for one; each another one.

    >>> measure_files(["play", "turn"])
    {}
    >>> list(measure_files(["a/b", "a:b", "c", "d", "e"]).values())
    ['histogram-a_b.png', 'histogram-a_b 2.png', 'histogram-c.png', 'histogram-d.png', 'histogram-e.png']
    """
    names = list(measures)
    return _files([(name, f"histogram-{_words(name)}") for name in names]) if len(names) > MOST_TOGETHER else {}


def system_files(summary: RunSummary, presenter: str | None = None) -> dict[str, str]:
    """Names of the further pictures that a system's presenter draws of a run, by its own names; each another one."""
    return named_files(presenter_of(summary, presenter).pictures(summary))


def named_files(names: Iterable[str]) -> dict[str, str]:
    """Files of pictures by their names.

    >>> list(named_files(["chain", "chain-left/right", "chain-left:right"]).values())
    ['chain.png', 'chain-left_right.png', 'chain-left_right 2.png']
    """
    return _files([(name, _words(name)) for name in names])


def _words(name: str) -> str:
    return "".join(sign if sign.isalnum() or sign in IN_FILE_NAMES else "_" for sign in name)


def _files(stems: Sequence[tuple[str, str]]) -> dict[str, str]:
    """A file for each name by its stem; all differ, even if case does not count."""
    files = dict[str, str]()
    for name, stem in stems:
        taken = {known.casefold() for known in files.values()}
        indexed = (f"{stem}{'' if index == 1 else f' {index}'}.png" for index in count(1))
        files[name] = next(file for file in indexed if file.casefold() not in taken)
    return files
