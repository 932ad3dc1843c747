"""The command on what to change where limits are left."""

from typing import Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import AcceptOption, AcceptPpkOption, RunBuilders, TrustParts, accepted_of, whole


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
    from tol3d.analyses import changes as ask
    from tol3d.analyses.subject import subject_of
    from tol3d.runs.summary.judged import AcceptedPpk

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    accepted = accepted_of(accept, accept_ppk)
    ppm, ppk = (None, accepted.ppk) if isinstance(accepted, AcceptedPpk) else (accepted, None)
    words: dict[str, Any] = {"measure": measure, "accept": ppm, "accept_ppk": ppk, "builds": builds}
    answer("changes", own, "builds", lambda activity: ask(own, **words, activity=activity), csv, picture)
