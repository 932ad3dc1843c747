"""Commands by which tolerances are decided on."""

from pathlib import Path
from typing import Annotated, Any

import typer

from tol3d.cli.arguments import RunBuilders, TrustParts, whole
from tol3d.cli.console import err_console, out_console, tell

SubjectArgument = Annotated[str, typer.Argument(metavar="SCENE|RUN", help="A scene, or the folder of a finished run.")]
CsvOption = Annotated[Path | None, typer.Option(metavar="FILE", help="Write all numbers here.")]
PictureOption = Annotated[Path | None, typer.Option(metavar="FILE", help="Draw the picture here.")]


def what_if(
    subject: SubjectArgument,
    changed: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help='Such as "centre distance"=±10um, "runout"=5um..20um.'),
    ] = None,
    factor: Annotated[
        list[str] | None, typer.Option(metavar="NAME=NUMBER", help='Such as "centre distance"=0.5: half as wide.')
    ] = None,
    measure: Annotated[str | None, typer.Option(help="Which; all that depend on what changes.")] = None,
    trials: Annotated[
        Any, typer.Option(parser=whole(2), metavar="N", help="Of the simulation, instead of the study's.")
    ] = None,
    draws: Annotated[
        Any, typer.Option(parser=whole(100), metavar="N", help="Of importance sampling, for each limit.")
    ] = 4800,
    quick: Annotated[bool, typer.Option("--quick", help="Rates and first order alone, without a simulation.")] = False,
    seed: Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="Of importance sampling.")] = 1,
    csv: CsvOption = None,
    picture: PictureOption = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find what other tolerances would do: sigma and ppm before and after, by first order and by the same trials."""
    from tol3d.analyses.changes import change_of, factor_of
    from tol3d.analyses.subject import subject_of
    from tol3d.analyses.what_if import what_if as asked
    from tol3d.analyses.what_if_table import what_if_report
    from tol3d.system.faults import faults_of

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    with faults_of(own.simulation.mechanism), err_console.status("what if") as status:
        response = own.response
        changes = [change_of(response, text) for text in changed or ()]
        changes += [factor_of(response, text) for text in factor or ()]
        trials, draws = (0, 0) if quick else (trials, draws)
        found = asked(response, changes, measure, trials=trials, draws=draws, seed=seed, activity=status.update)
    report = what_if_report(own.name, found)
    out_console.print(report)
    _written(csv, report.csv())
    if picture is not None:
        from tol3d.analyses.what_if_picture import draw_what_if

        draw_what_if(own.name, found, picture)
        tell(f"picture: {picture}")
    if (kept := own.keep("what-if", found)) is not None:
        tell(f"section: {kept}")


def _written(path: Path | None, text: str) -> None:
    if path is not None:
        from tol3d.records.folder import write_texts

        write_texts({path.name: text}, path.parent)
        tell(f"numbers: {path}")
