"""Commands that say what to change in a scene, and what comes of changing it."""

from pathlib import Path
from typing import Annotated, Any

import typer

from tol3d.cli.arguments import AcceptOption, RunBuilders, TrustParts, whole
from tol3d.cli.console import err_console, out_console, tell

SubjectArgument = Annotated[
    str, typer.Argument(metavar="SCENE|RUN", help="A scene's file or bundled name, or the folder of a finished run.")
]
CsvOption = Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write the table to this file.")]


def changes(
    scene: SubjectArgument,
    measure: Annotated[str | None, typer.Option(help="Which; by default all that are NOT OK.")] = None,
    accept: AcceptOption = None,
    builds: Annotated[
        Any, typer.Option(parser=whole(50), metavar="N", help="By which each change is judged; 5000, or less if slow.")
    ] = None,
    csv: Annotated[
        Path | None,
        typer.Option("--csv", metavar="FILE", help="Write slopes and shares of every contributor and measure."),
    ] = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find what to change where limits are left: which nominal to move, which tolerance to halve."""
    from tol3d.analyses.estimated_changes import not_ok
    from tol3d.analyses.subject import subject_of
    from tol3d.analyses.what_to_change import ChangesQuestion, changes_of, contributions_of
    from tol3d.analyses.what_to_change_table import changes_report, contributions_table
    from tol3d.report.verdict import ACCEPTED_PPM
    from tol3d.system.faults import faults_of

    subject = subject_of(scene, trust_parts=trust_parts, run_builders=run_builders)
    accepted = ACCEPTED_PPM if accept is None else accept
    question = ChangesQuestion(measure, accepted, builds)
    with faults_of(subject.simulation.mechanism), err_console.status("builds") as status:
        response = subject.response
        bad = None if subject.run is None else not_ok(subject.run, accepted)
        found = changes_of(response, question, bad=bad, activity=status.update)
        if csv is not None:
            status.update("contributions")
            write_csv(contributions_table(contributions_of(response, measure)).csv(), csv)
    out_console.print(changes_report(subject.simulation.system.name, found))
    if csv is not None:
        tell(f"contributions: {csv}")
    if (path := subject.keep("changes", found)) is not None:
        tell(f"kept: {path}")


def write_csv(text: str, path: Path) -> None:
    """Write a table.

    Raises:
        InputError: the file cannot be written.
    """
    from tol3d.errors import unwritable

    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise unwritable(path, error, "choose another file") from None
