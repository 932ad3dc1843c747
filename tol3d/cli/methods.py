"""The command that sets worst case, RSS, modified RSS and simulation side by side."""

from pathlib import Path
from typing import Annotated, Any

import typer

from tol3d.cli.arguments import RunBuilders, TrustParts, whole
from tol3d.cli.console import err_console, out_console, tell


def methods(
    subject: Annotated[
        str, typer.Argument(metavar="SCENE|RUN", help="A scene file, the name of a bundled one, or a run's folder.")
    ],
    measure: Annotated[str | None, typer.Option(help="Which; all measures.")] = None,
    trials: Annotated[
        Any,
        typer.Option(
            parser=whole(2), metavar="N", help="Of the simulation; the study's, 20000 at most, or a run's own."
        ),
    ] = None,
    csv: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write all tables as comma-separated values.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the intervals: .png, .svg or .pdf.")
    ] = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Set worst case, RSS, modified RSS and simulation of each measure side by side."""
    from tol3d.analyses.methods import methods as found_by
    from tol3d.analyses.methods import trials_of
    from tol3d.analyses.methods_table import methods_report
    from tol3d.analyses.subject import subject_of
    from tol3d.errors import unwritable
    from tol3d.runs.atomic_write import write_whole
    from tol3d.system.faults import faults_of

    asked = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    with faults_of(asked.simulation.mechanism), err_console.status("trials") as status:
        response = asked.response if measure is None else asked.response.of(measure)
        found = found_by(response, trials_of(asked, response, trials), status.update)
    report = methods_report(found, response.contributors)
    if csv is not None:
        try:
            write_whole(csv, report.csv().encode())
        except OSError as error:
            raise unwritable(csv, error, "choose another file") from None
    if picture is not None:
        from tol3d.analyses.methods_picture import draw_methods

        draw_methods(found, picture)
    kept = asked.keep("methods", found)
    out_console.print(report)
    for file in (csv, picture):
        if file is not None:
            tell(str(file))
    if kept is not None:
        tell(f"kept in the run: {kept}")
