"""The command that sets worst case, RSS, modified RSS and simulation side by side."""

from typing import Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import RunBuilders, TrustParts, whole


def methods(
    subject: SubjectArgument,
    measure: Annotated[str | None, typer.Option(help="Which; all measures.")] = None,
    trials: Annotated[
        Any,
        typer.Option(
            parser=whole(2), metavar="N", help="Of the simulation; the study's, 20000 at most, or a run's own."
        ),
    ] = None,
    csv: CsvOption = None,
    picture: PictureOption = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Set worst case, RSS, modified RSS and simulation of each measure side by side."""
    from tol3d.analyses import methods as ask
    from tol3d.analyses.subject import subject_of

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    words: dict[str, Any] = {"measure": measure, "trials": trials}
    answer("methods", own, "trials", lambda activity: ask(own, **words, activity=activity), csv, picture)
