"""Commands that find what an engineer decides from."""

from typing import Annotated, Any

import typer

from tol3d.cli.arguments import RunBuilders, SceneArgument, TrustParts, scene_path, whole
from tol3d.cli.console import err_console, out_console


def rare(
    scene: SceneArgument,
    measure: Annotated[str | None, typer.Option(help="Whose limits; those of all measures.")] = None,
    draws: Annotated[
        Any, typer.Option(parser=whole(100), metavar="N", help="Of importance sampling, for each limit.")
    ] = 5600,
    seed: Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="Of its draws.")] = 1,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find how often limits are left where that is too rare for trials, and the most likely build that leaves them."""
    from tol3d.analyses.rare import limits_left
    from tol3d.analyses.rare_table import rare_report
    from tol3d.analyses.response import response_of
    from tol3d.simulate import load, simulation_of
    from tol3d.system.faults import faults_of

    loaded = load(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders)
    simulation = simulation_of(loaded)
    with faults_of(simulation.mechanism), err_console.status("design points") as status:
        response = response_of(simulation)
        events = limits_left(response, measure, draws=draws, seed=seed, activity=status.update)
    out_console.print(rare_report(loaded.scene, response, events))
