"""The command on the effect of other tolerances.

The command on what to change where limits are left.

The command on the effect of each contributor on each measure.

The command that sets worst case, RSS, modified RSS and simulation side by side.

The command on tolerances of least cost.
"""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import AcceptOption, AcceptPpkOption, RunBuilders, TrustParts, accepted_of, whole
from tol3d.cli.console import tell, warn

if TYPE_CHECKING:
    from tol3d.analyses.answers import OtherTolerances


def what_if(
    subject: SubjectArgument,
    changed: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help='Such as "centre distance"=±10um, "runout"=5um..20um.'),
    ] = None,
    factor: Annotated[
        list[str] | None, typer.Option(metavar="NAME=NUMBER", help='Such as "centre distance"=0.5: half as wide.')
    ] = None,
    limits: Annotated[
        list[str] | None,
        typer.Option(metavar="MEASURE=LOW..HIGH", help='Such as "normal backlash"="10um..40um"; or one of them.'),
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
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the scene with them here.")] = None,
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
    words |= {"set": changed or (), "factor": factor or (), "limits": limits or (), "warn": warn}
    found = answer("what-if", own, "what if", lambda activity: ask(own, **words, activity=activity), csv, picture)
    if out is not None:
        _write(found, out)


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
    from tol3d.study.runs.summary.judged import AcceptedPpk

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    accepted = accepted_of(accept, accept_ppk)
    ppm, ppk = (None, accepted.ppk) if isinstance(accepted, AcceptedPpk) else (accepted, None)
    words: dict[str, Any] = {"measure": measure, "accept": ppm, "accept_ppk": ppk, "builds": builds}
    answer("changes", own, "builds", lambda activity: ask(own, **words, activity=activity), csv, picture)


class PositionWord(StrEnum):
    """Treatment of positions in sensitivity indices."""

    AVERAGED = "averaged"
    AS_INPUT = "as-input"


def effects(
    subject: SubjectArgument,
    measure: Annotated[str | None, typer.Option(help="On which measure; all that are one number a trial.")] = None,
    base: Annotated[
        Any, typer.Option(parser=whole(2), metavar="N", help="Pairs of builds, a power of two; as time allows.")
    ] = None,
    seed: Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="Of their points.")] = 1,
    position: Annotated[
        PositionWord, typer.Option(help="averaged: indices at a position, averaged; as-input: an input as well.")
    ] = PositionWord.AVERAGED,
    shapley: Annotated[
        bool, typer.Option("--shapley", help="Shapley effects too, also where nothing is correlated.")
    ] = False,
    csv: CsvOption = None,
    picture: PictureOption = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find what each contributor does to each measure: changes, shares of the variance and of failures."""
    from tol3d.analyses import effects as ask
    from tol3d.analyses.subject import subject_of

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    words: dict[str, Any] = {
        "measure": measure,
        "base": base,
        "seed": seed,
        "position": position.value,
        "shapley": shapley,
    }
    answer("effects", own, "effects", lambda activity: ask(own, **words, activity=activity), csv, picture)


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


def allocate(
    subject: SubjectArgument,
    ppm: Annotated[
        float | None, typer.Option(metavar="NUMBER", help="Builds that may be out of the limits of a measure.")
    ] = None,
    ppk: Annotated[
        float | None, typer.Option(metavar="NUMBER", help="Instead, for each limit; 1.33 if neither is given.")
    ] = None,
    measure: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME[:low|high]", help="Which, and which of its limits; all that have some."),
    ] = None,
    cost: Annotated[Path | None, typer.Option(metavar="FILE", help="Costs by contributor, YAML; 1 by factor.")] = None,
    bounds: Annotated[str, typer.Option(metavar="LOW..HIGH", help="Of factors.")] = "0.5..3",
    bound: Annotated[
        list[str] | None, typer.Option(metavar="NAME=LOW..HIGH", help="Of the factor of one contributor.")
    ] = None,
    freeze: Annotated[list[str] | None, typer.Option(metavar="NAME", help="A tolerance that stays as it is.")] = None,
    stays: Annotated[
        list[str] | None, typer.Option(metavar="NAME=low|high", help="A limit that stays, instead of the middle.")
    ] = None,
    beyond_least: Annotated[
        bool, typer.Option("--beyond-least", help="Draw below what is physical, such as clearances below 0.")
    ] = False,
    draws: Annotated[
        Any, typer.Option(parser=whole(100), metavar="N", help="Of importance sampling, each time and for each limit.")
    ] = 12000,
    seed: Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="Of them.")] = 1,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the scene with them here.")] = None,
    csv: CsvOption = None,
    picture: PictureOption = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find the tolerances of least cost for a share out of limits, which simulation confirms."""
    from tol3d.analyses import allocate as ask
    from tol3d.analyses.subject import subject_of

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    words: dict[str, Any] = {"ppm": ppm, "ppk": ppk, "measure": measure or (), "cost": cost, "bounds": bounds}
    words |= {"bound": bound or (), "freeze": freeze or (), "stays": stays or (), "beyond_least": beyond_least}
    words |= {"draws": draws, "seed": seed}
    found = answer("allocation", own, "tolerances", lambda activity: ask(own, **words, activity=activity), csv, picture)
    if out is not None:
        _write(found, out)


def _write(found: "OtherTolerances[Any]", out: Path) -> None:
    """Write the scene with other tolerances, and tell which limits of a standard are numbers there."""
    from tol3d.scene.edit import write_scene

    write_scene(found.scene, out)
    tell(f"scene: {out}")
    for name, words in found.in_numbers.items():
        tell(f"{name}: {words}")
