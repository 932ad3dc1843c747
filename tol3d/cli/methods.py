"""The command that sets worst case, RSS, modified RSS and simulation side by side."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import RunBuilders, TrustParts, whole

if TYPE_CHECKING:
    from collections.abc import Callable

    from tol3d.runs.summary.values import Section


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
    from tol3d.analyses.side_by_side import methods as found_by
    from tol3d.analyses.side_by_side import trials_of
    from tol3d.analyses.subject import subject_of

    asked = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)

    def find(activity: "Callable[[str], None]") -> "Section":
        response = asked.response if measure is None else asked.response.of(measure)
        return found_by(response, trials_of(asked, response, trials), activity)

    answer("methods", asked, "trials", find, csv, picture)
