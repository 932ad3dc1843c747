"""The pictures of a run, drawn beside it by a process of its own: see histogram_process."""

import json
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

IN_FILE_NAMES = frozenset(" -_.,()+")  # besides letters and digits; anything else would be a folder or a drive

Draw = Callable[[Mapping[str, Any], Path], None]

COMMAND = (sys.executable, "-P", "-m", "tol3d.report.histogram_process")  # -P: not from the folder it is called in


class PictureError(Exception):
    """A histogram that could not be drawn; its message says why."""


class PictureWarning(UserWarning):
    """The chain of a train that could not be drawn beside the histogram."""


@contextmanager
def drawing() -> Iterator[Draw]:
    """Within it a process that can draw gets ready, and draws one run: its summary, and where its histogram goes.

    The chains of its trains go beside the histogram; one that cannot be drawn is a PictureWarning.

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
            yield partial(_draw, process)
        finally:
            process.kill()


def _draw(process: "subprocess.Popen[bytes]", summary: Mapping[str, Any], picture: Path) -> None:
    order = json.dumps({"picture": str(picture), "summary": summary})
    refused, told = process.communicate(order.encode())
    for name, reason in json.loads(refused or "{}").items():
        words = f"{name} could not be drawn ({reason}); the run is whole without it"
        warnings.warn(words, PictureWarning, stacklevel=2)
    if process.returncode == 0:
        return
    picture.unlink(missing_ok=True)
    last = told.decode(errors="replace").strip().splitlines()[-1:]
    raise PictureError(*(last or [f"its process ended with {process.returncode}"]))


def _refuse(reason: str, summary: Mapping[str, Any], picture: Path) -> None:
    raise PictureError(reason)


def chain_files(summary: Mapping[str, Any]) -> dict[str, str]:
    """Names of the pictures of a run's trains, by train; each another one.

    >>> chain_files({"trains": {"shoulder": {}, "wrist": {}, "left/right": {}, "left:right": {}}})
    {'shoulder': 'chain.png', 'wrist': 'chain-wrist.png', 'left/right': 'chain-left_right.png', \
'left:right': 'chain-left_right 2.png'}
    """
    files = dict[str, str]()
    for name in summary.get("trains", {}):
        words = "".join(sign if sign.isalnum() or sign in IN_FILE_NAMES else "_" for sign in name)
        stem, file, count = f"chain-{words}" if files else "chain", "", 1
        while not file or file.lower() in {known.lower() for known in files.values()}:
            file = f"{stem}{'' if count == 1 else f' {count}'}.png"
            count += 1
        files[name] = file
    return files
