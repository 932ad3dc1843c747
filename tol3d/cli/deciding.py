"""Commands by which tolerances are decided on."""

from pathlib import Path
from typing import Annotated, Any

import typer

from tol3d.cli.analysed import (
    CsvOption,
    PictureOption,
    SubjectArgument,
    asked_of,
    draw_picture,
    tell_found,
    write_numbers,
)
from tol3d.cli.arguments import RunBuilders, TrustParts, whole
from tol3d.cli.console import tell, warn


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
    from tol3d.analyses.changes import change_of, factor_of, slips
    from tol3d.analyses.changes import changed as changed_response
    from tol3d.analyses.subject import subject_of
    from tol3d.analyses.what_if import what_if as asked
    from tol3d.analyses.what_if_table import what_if_report

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    with asked_of(own, "what if") as status:
        response = own.response
        changes = [change_of(response, text) for text in changed or ()]
        changes += [factor_of(response, text) for text in factor or ()]
        for slip in slips(response, changed_response(response, changes)):
            warn(slip)
        trials, draws = (0, 0) if quick else (trials, draws)
        found = asked(response, changes, measure, trials=trials, draws=draws, seed=seed, activity=status.update)
    report = what_if_report(own.name, found)
    tell_found(own, "what-if", found, report)
    write_numbers(csv, report.csv())
    draw_picture(picture, "tol3d.analyses.what_if_picture:draw_what_if", own.name, found)


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
    from tol3d.analyses.allocate import allocation
    from tol3d.analyses.allocate_table import allocation_report
    from tol3d.analyses.allocated_scene import allocated_scene, groups_of
    from tol3d.analyses.asked_allocation import bounds_of, named_bounds, stays_of, targets_of
    from tol3d.analyses.costs import Costs, costs_from
    from tol3d.analyses.subject import subject_of
    from tol3d.analyses.tolerance_search import Question

    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    with asked_of(own, "tolerances") as status:
        response, groups = own.response, groups_of(own.response)
        question = Question(
            costs=Costs() if cost is None else costs_from(cost, groups),
            bounds=bounds_of("--bounds", bounds),
            own_bounds=named_bounds(bound or ()),
            frozen=frozenset(freeze or ()),
            stays=stays_of(stays or (), groups),
            groups=groups,
            beyond_least=beyond_least,
        )
        targets = targets_of(response, measure or (), ppm, ppk)
        found = allocation(response, targets, question, draws=draws, seed=seed, activity=status.update)
        scene = None if out is None else allocated_scene(own.scene, response, found, question.stays)
    report = allocation_report(own.name, found)
    tell_found(own, "allocation", found, report)
    write_numbers(csv, report.csv())
    draw_picture(picture, "tol3d.analyses.allocate_picture:draw_allocation", own.name, found)
    if scene is not None and out is not None:
        from tol3d.scene.edit import write_scene

        write_scene(scene, out)
        tell(f"scene: {out}")
