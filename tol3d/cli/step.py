"""Commands on STEP files of others.

The command on the tolerances of a STEP file.
"""

from pathlib import Path
from typing import Annotated

import typer

from tol3d.cli.console import err_console, out_console, tell


def features(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A STEP file (.stp, .step).")],
    picture: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the parts with their features named: .png, .svg, .pdf.")
    ] = None,
    csv: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write all numbers whole, as comma-separated values.")
    ] = None,
    every: Annotated[
        bool, typer.Option("--all", help="List each feature, with the line that selects it in a scene.")
    ] = False,
) -> None:
    """List the features of the parts in a STEP file on a page; --all of them with lines that select them in a scene."""
    from tol3d.cad.step.reading import read_step
    from tol3d.errors import unwritable
    from tol3d.files import read_file
    from tol3d.report.step_tables import features_csv, features_page, features_report
    from tol3d.study.runs.atomic_write import write_whole

    with err_console.status(f"reading {file.name}"):
        found = read_step(read_file(file))
    out_console.print(features_report(found) if every else features_page(found))
    if csv is not None:
        try:
            write_whole(csv, features_csv(found).encode())
        except OSError as error:
            raise unwritable(csv, error, "choose another file") from None
        tell(str(csv))
    if picture is not None:
        from tol3d.report.step_picture import draw_features

        with err_console.status("drawing"):
            draw_features(found, picture)
        tell(str(picture))


def pmi(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A STEP file with PMI (AP242).")],
    csv: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the tables as comma-separated values.")
    ] = None,
) -> None:
    """List the datums, tolerances and dimensions of a STEP file, and what each tolerance means in a scene."""
    from tol3d.cad.step import read_step_text
    from tol3d.errors import unwritable
    from tol3d.files import read_file
    from tol3d.report.step_tables import pmi_report
    from tol3d.study.runs.atomic_write import write_whole

    content = read_file(file)
    report = pmi_report(read_step_text(content.content, content.path.name))
    out_console.print(report)
    if csv is not None:
        try:
            write_whole(csv, report.csv().encode())
        except OSError as error:
            raise unwritable(csv, error, "choose another file") from None
        tell(str(csv))
