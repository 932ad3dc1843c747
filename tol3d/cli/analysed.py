"""An analysis by a command: its progress, its page, the requested files, and what a run keeps of it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from tol3d.cli.console import err_console, out_console, tell

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.status import Status

    from tol3d.analyses.answers import Answer
    from tol3d.analyses.subject import Subject

    Own = TypeVar("Own", bound=Answer[Any])

SubjectArgument = Annotated[
    str, typer.Argument(metavar="SCENE|RUN", help="A scene's file or bundled name, or the folder of a finished run.")
]
CsvOption = Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write all numbers to this file.")]
PictureOption = Annotated[Path | None, typer.Option(metavar="FILE", help="Draw the picture here: .png, .svg or .pdf.")]


@contextmanager
def asked_of(subject: "Subject", activity: str) -> Iterator["Status"]:
    """While an analysis goes on: show its activity, and say on Ctrl-C that its evaluations are kept.

    Args:
        subject: the scene or the run.
        activity: the first one, in words.
    """
    with err_console.status(activity) as status:
        try:
            yield status
        except KeyboardInterrupt:
            if subject.batches.written:
                err_console.print("evaluations are kept: the same command resumes from there")
            raise


def answer(
    name: str,
    asked: "Subject",
    activity: str,
    ask: "Callable[[Callable[[str], None]], Own]",
    csv: Path | None,
    picture: Path | None,
) -> "Own":
    """Do an analysis: show its progress, print what it found, and write and draw what was asked for.

    Args:
        name: of the analysis, see tol3d.analyses.subject.KEPT.
        asked: the scene or the run.
        activity: the first one, in words.
        ask: the function of tol3d.analyses, with a progress callback.
        csv, picture: the files that are asked for.
    """
    with asked_of(asked, activity) as status:
        found = ask(status.update)
        numbers = "" if csv is None else found.csv()
    out_console.print(found.page)
    if found.kept is not None:
        tell(f"kept in the run: {found.kept}")
    if csv is not None:
        write_numbers(csv, numbers)
    if picture is not None:
        draw_picture(picture, "tol3d.report.chart_figure:save_charts", found.charts())
    return found


def write_numbers(path: Path, text: str) -> None:
    """Write a table.

    Raises:
        InputError: it cannot be written.
    """
    from tol3d.errors import unwritable
    from tol3d.study.runs.atomic_write import write_whole

    try:
        write_whole(path, text.encode())
    except OSError as error:
        raise unwritable(path, error, "choose another file") from None
    tell(f"numbers: {path}")


def draw_picture(path: Path | None, draw: str, *found: object) -> None:
    """Draw a picture, if a file was asked for.

    Args:
        path: the file.
        draw: import path of the function that draws `found` there.
        found: findings to draw.
    """
    if path is None:
        return
    from tol3d.import_path import named

    named(draw)(*found, path)
    tell(f"picture: {path}")
