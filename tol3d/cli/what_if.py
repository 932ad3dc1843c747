"""The command on the effect of other tolerances."""

from typing import Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import RunBuilders, TrustParts, whole
from tol3d.cli.console import warn


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
    from tol3d.analyses import what_if as ask
    from tol3d.analyses.subject import subject_of

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    words: dict[str, Any] = {"measure": measure, "trials": trials, "draws": draws, "quick": quick, "seed": seed}
    words |= {"set": changed or (), "factor": factor or (), "warn": warn}
    answer("what-if", own, "what if", lambda activity: ask(own, **words, activity=activity), csv, picture)
