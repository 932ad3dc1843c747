"""Commands on STEP files of others."""

from pathlib import Path
from typing import Annotated

import typer

from tol3d.cli.console import out_console, tell


def features(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A STEP file (.stp, .step).")],
    picture: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the parts with their features named: .png, .svg, .pdf.")
    ] = None,
    csv: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write all numbers whole, as comma-separated values.")
    ] = None,
) -> None:
    """List the features of the parts in a STEP file, each with a line that selects it in a scene."""
    from tol3d.errors import unwritable
    from tol3d.files import read_file
    from tol3d.report.step_features import features_csv, features_report
    from tol3d.runs.atomic_write import write_whole
    from tol3d.step.reading import read_step

    found = read_step(read_file(file))
    out_console.print(features_report(found))
    if csv is not None:
        try:
            write_whole(csv, features_csv(found).encode())
        except OSError as error:
            raise unwritable(csv, error, "choose another file") from None
        tell(str(csv))
    if picture is not None:
        from tol3d.report.step_picture import draw_features

        draw_features(found, picture)
        tell(str(picture))
