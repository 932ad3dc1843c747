"""Commands that adjust gears that are made: shims, and the correction of a motor."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from tol3d.cli.arguments import EngineOption, RunBuilders, SceneArgument, TrustParts, scene_path, trials_or_auto, whole
from tol3d.cli.console import err_console, out_console, tell


class MinimumName(StrEnum):
    """Statistics that may be called the minimum of a backlash."""

    LOW_3SIGMA = "low_3sigma"
    QUANTILE = "p0.135"
    SAMPLE_MIN = "sample_min"


class RoundingName(StrEnum):
    """Ways to a thickness of the stock."""

    DOWN = "down"
    NEAREST = "nearest"


def shim(
    scene: SceneArgument,
    target_min: Annotated[str, typer.Option(metavar="LENGTH", help='The minimum that is wanted, such as "24 um".')],
    measure: Annotated[
        str | None, typer.Option(help="Whose minimum; the only normal backlash of a bevel mesh.")
    ] = None,
    shims: Annotated[
        str, typer.Option(metavar="NAME,...", help="Shims of the scene, or gears for a new one behind each.")
    ] = "",
    minimum: Annotated[MinimumName, typer.Option(help="What is called so.")] = MinimumName.LOW_3SIGMA,
    stock: Annotated[
        str, typer.Option(metavar="LENGTH[,...]", help="Thicknesses there are: a step, or pieces to stack up to three.")
    ] = "0.001 mm",
    rounding: Annotated[
        RoundingName, typer.Option("--round", help="down: never below the target; nearest: the nearest thickness.")
    ] = RoundingName.DOWN,
    trials: Annotated[
        Any, typer.Option(parser=trials_or_auto, metavar="N|auto", help="Number of trials instead of the scene's.")
    ] = None,
    engine: EngineOption = None,
    out: Annotated[Path | None, typer.Option(help="Write the scene with the chosen shims to this new file.")] = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find the thickness of shims with which a bevel pair has a wanted minimum of backlash."""
    from tol3d.apps.adjustment import ShimQuestion, length_of, shim_plan, stock_of
    from tol3d.apps.adjustment.shim_table import shim_report
    from tol3d.scene import tolerance_lines, write_scene
    from tol3d.simulate import Overrides, load

    names = tuple(name.strip() for name in shims.split(",") if name.strip())
    target = length_of("--target-min", target_min)
    question = ShimQuestion(target, measure, names, minimum.value, stock_of(stock), rounding.value)
    overrides = Overrides(trials=trials, engine=engine)
    loaded = load(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders)
    with err_console.status("studies") as status:
        plan = shim_plan(loaded, question, overrides, tell=status.update)
    out_console.print(shim_report(plan))
    tell(f"\ntolerances of the scene:\n{tolerance_lines(plan.tolerances)}")
    if out is not None:
        write_scene(plan.scene, out)
        tell(f"scene: {out}")


def compensate(
    scenes: Annotated[list[str], typer.Argument(metavar="SCENE...", help="Scene files, or names of bundled ones.")],
    train: Annotated[str | None, typer.Option(help="Whose motor; the first train of each scene.")] = None,
    trials: Annotated[
        Any,
        typer.Option(
            parser=whole(2), metavar="N", help="Number of robots; as many as the study's trials, 2000 at most."
        ),
    ] = None,
    positions: Annotated[
        Any, typer.Option(parser=whole(1), metavar="N", help="At how many a robot's own mean is taken.")
    ] = 16,
    out: Annotated[Path | None, typer.Option(help="Draw the picture here.")] = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find the motor's correction for a load that changes side, and the remaining lost motion."""
    from tol3d.apps.adjustment.compensation import CompensationQuestion, compensation
    from tol3d.apps.adjustment.compensation_picture import draw_compensation
    from tol3d.apps.adjustment.compensation_table import compensation_report
    from tol3d.simulate import load

    question = CompensationQuestion(train, positions, trials)
    with err_console.status("robots"):
        loaded = [load(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders) for scene in scenes]
        found = [compensation(each, question) for each in loaded]
    if out is not None:
        draw_compensation(found, out)
    out_console.print(compensation_report(found))
    if out is not None:
        tell(f"picture: {out}")
