"""The command on what to change where limits are left."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import AcceptOption, AcceptPpkOption, RunBuilders, TrustParts, accepted_of, whole

if TYPE_CHECKING:
    from collections.abc import Callable

    from tol3d.runs.summary.values import Section


def changes(
    subject: SubjectArgument,
    measure: Annotated[str | None, typer.Option(help="Which; by default all that are NOT OK.")] = None,
    accept: AcceptOption = None,
    accept_ppk: AcceptPpkOption = None,
    builds: Annotated[
        Any, typer.Option(parser=whole(50), metavar="N", help="By which each change is judged; 5000, or less if slow.")
    ] = None,
    csv: CsvOption = None,
    picture: PictureOption = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find what to change where limits are left: which nominal to move, which tolerance to halve."""
    from tol3d.analyses.changes_of_run import not_ok
    from tol3d.analyses.subject import subject_of
    from tol3d.analyses.what_to_change import AIM, ChangesQuestion, changes_of, contributions_of
    from tol3d.analyses.what_to_change_table import contributions_table
    from tol3d.report.verdict import ACCEPTED_PPM, AcceptedPpk

    asked = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    accepted = accepted_of(accept, accept_ppk)
    if accepted is None:
        ppk = asked.simulation.study.accept_ppk
        accepted = ACCEPTED_PPM if ppk is None else AcceptedPpk(ppk)
    ppm, aim = (accepted.beyond_one_ppm, accepted.ppk) if isinstance(accepted, AcceptedPpk) else (accepted, AIM)
    question = ChangesQuestion(measure, ppm, builds, aim)
    tables: list[str] = []

    def find(activity: "Callable[[str], None]") -> "Section":
        bad = None if asked.run is None else not_ok(asked.run, accepted)
        found = changes_of(asked.response, question, bad=bad, activity=activity)
        if csv is not None:
            tables.append(contributions_table(contributions_of(asked.response, measure)).csv())
        return found

    answer("changes", asked, "builds", find, csv, picture, lambda: tables[0])
