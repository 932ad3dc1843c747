"""The command on the tolerances of a STEP file."""

from pathlib import Path
from typing import Annotated

import typer

from tol3d.cli.console import out_console, tell


def pmi(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A STEP file with PMI (AP242).")],
    csv: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the tables as comma-separated values.")
    ] = None,
) -> None:
    """List the datums, tolerances and dimensions of a STEP file, and what each tolerance means in a scene."""
    from tol3d.errors import unwritable
    from tol3d.files import read_file
    from tol3d.report.step_pmi import pmi_report
    from tol3d.runs.atomic_write import write_whole
    from tol3d.step import read_step_text

    content = read_file(file)
    report = pmi_report(read_step_text(content.content, content.path.name))
    out_console.print(report)
    if csv is not None:
        try:
            write_whole(csv, report.csv().encode())
        except OSError as error:
            raise unwritable(csv, error, "choose another file") from None
        tell(str(csv))
