"""The command on tolerances of least cost."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import RunBuilders, TrustParts, whole
from tol3d.cli.console import tell

if TYPE_CHECKING:
    from collections.abc import Callable

    from tol3d.runs.summary.values import Section


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
    from tol3d.analyses.allocated_scene import allocated_scene, groups_of
    from tol3d.analyses.allocation import allocation
    from tol3d.analyses.asked_allocation import bounds_of, named_bounds, stays_of, targets_of
    from tol3d.analyses.costs import Costs, costs_from
    from tol3d.analyses.subject import subject_of
    from tol3d.analyses.tolerance_search import Question
    from tol3d.scene import Scene
    from tol3d.scene.edit import write_scene

    asked = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    scenes: list[Scene] = []

    def find(activity: "Callable[[str], None]") -> "Section":
        response, groups = asked.response, groups_of(asked.response)
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
        found = allocation(response, targets, question, draws=draws, seed=seed, activity=activity)
        if out is not None:
            scenes.append(allocated_scene(asked.scene, response, found, question.stays))
        return found

    answer("allocation", asked, "tolerances", find, csv, picture)
    if out is not None:
        write_scene(scenes[0], out)
        tell(f"scene: {out}")
