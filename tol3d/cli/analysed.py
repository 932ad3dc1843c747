"""Output of an analysis by a command: the table, the requested files, and their folder in a run."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tol3d.cli.console import err_console, out_console, tell

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.status import Status

    from tol3d.analyses.subject import Subject
    from tol3d.runs.summary.values import Section

SubjectArgument = Annotated[
    str, typer.Argument(metavar="SCENE|RUN", help="A scene's file or bundled name, or the folder of a finished run.")
]
CsvOption = Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write all numbers to this file.")]
PictureOption = Annotated[Path | None, typer.Option(metavar="FILE", help="Draw the picture here: .png, .svg or .pdf.")]


@contextmanager
def asked_of(subject: "Subject", activity: str) -> Iterator["Status"]:
    """While an analysis goes on: show its activity, keep a mechanism's faults its own, let Ctrl-C keep it.

    Args:
        subject: the scene or the run.
        activity: the first one, in words.
    """
    from tol3d.system.faults import faults_of

    with faults_of(subject.simulation.mechanism), err_console.status(activity) as status:
        try:
            yield status
        except KeyboardInterrupt:
            if subject.batches.written:
                err_console.print("evaluations are kept: the same command resumes from there")
            raise
    subject.batches.clear()


def tell_found(subject: "Subject", section: str, found: "Section", report: "RenderableType") -> None:
    """Print the findings, and keep them in the run if it was asked of one.

    Args:
        subject: the scene or the run.
        section: its name in a run.
        found: findings to keep.
        report: tables to print.
    """
    out_console.print(report)
    if (kept := subject.keep(section, found)) is not None:
        tell(f"kept in the run: {kept}")


def write_numbers(path: Path | None, text: str) -> None:
    """Write a table, if a file was asked for.

    Raises:
        InputError: it cannot be written.
    """
    if path is None:
        return
    from tol3d.errors import unwritable
    from tol3d.runs.atomic_write import write_whole

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
