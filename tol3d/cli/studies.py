"""The command that simulates."""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tol3d.cli.arguments import (
    EngineOption,
    SamplerName,
    SceneArgument,
    TrustParts,
    accepted_ppm,
    scene_path,
    trials_or_auto,
)
from tol3d.cli.console import INTERRUPTED, LIMITS_FAILED, err_console, out_console, tell, warn

if TYPE_CHECKING:
    from types import FrameType

    from tol3d.runs.run import Run
    from tol3d.study.simulation import Simulation

PICTURE = "histogram.png"
PATIENCE = 5.0  # s; worker processes that will not end may hold up an interrupted command no longer


def run(
    context: typer.Context,
    scene: SceneArgument,
    trials: Annotated[
        Any, typer.Option(parser=trials_or_auto, metavar="N|auto", help="Number of trials instead of the scene's.")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed instead of the scene's.")] = None,
    engine: EngineOption = None,
    sampler: Annotated[SamplerName | None, typer.Option(help="Sampler instead of the scene's.")] = None,
    witness: Annotated[
        int | None, typer.Option(min=0, help="Trials that another engine measures again, of gears FCL.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="The run's folder; by default runs/<scene>, or -2, -3 … of another study.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace a run of another study; what else lies there is moved aside.")
    ] = False,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Threads or processes; by default one, or all cores for a long study.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Run on the workers of this Dask scheduler.")
    ] = None,
    no_trials: Annotated[bool, typer.Option("--no-trials", help="Keep statistics only, no rows of trials.")] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with an interrupted run, or mend a damaged one; never start anew.")
    ] = False,
    no_picture: Annotated[bool, typer.Option("--no-picture", help=f"Draw no {PICTURE}.")] = False,
    accept: Annotated[
        Any,
        typer.Option(parser=accepted_ppm, metavar="SHARE", help="Share of trials that may be out of limits; 0.27 %."),
    ] = None,
    fail_on_limits: Annotated[
        bool,
        typer.Option(
            "--fail-on-limits",
            help="Exit with 1 when a trial is out of limits or failed; with --accept, when a verdict is not OK.",
        ),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print the verdict and warnings only.")] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print the tables of every measure, however many there are.")
    ] = False,
    trust_parts: TrustParts = False,
) -> None:
    """Simulate a scene: analytic model and 3D simulation side by side."""
    if force and resume:
        raise typer.BadParameter("--resume goes on with what --force would replace; leave out one of them")
    if workers is not None and scheduler is not None:
        raise typer.BadParameter("--scheduler has its own workers; leave out --workers")
    if quiet and verbose:
        raise typer.BadParameter("--quiet says less and --verbose more; leave out one of them")
    draw = context.with_resource(_drawing(wanted=not no_picture))  # it loads what it draws with beside all that follows

    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from tol3d.execution.pools import Execution
    from tol3d.report.table import Detail, run_report
    from tol3d.report.verdict import ACCEPTED_PPM, all_ok
    from tol3d.simulate import Overrides, Watch, folder_for, load, run_scene, simulation_of, workers_for

    path = scene_path(scene)
    overrides = Overrides(trials, seed, engine, sampler.value if sampler else None, witness)
    loaded = load(path, trust_parts=trust_parts)
    simulation = simulation_of(loaded, overrides)
    for warning in simulation.warnings:
        warn(warning)
    if told := long_study(simulation):
        err_console.print(told)
    execution = Execution(workers or workers_for(simulation), scheduler, keep_trials=not no_trials, resume=resume)
    folder, taken = out or Path("runs") / path.stem, ""
    if out is None and not force:
        folder, taken = folder_for(loaded, simulation, execution, Path("runs"))
    if taken:
        err_console.print(f"{taken}: this run goes to {folder} (--force would replace the other)")
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    try:
        with _stopped_in_order(), Progress(*columns, console=err_console, transient=True) as progress:
            bar = progress.add_task("scene", total=simulation.study.trials)
            finished = run_scene(
                loaded,
                overrides=overrides,
                out=folder,
                execution=execution,
                force=force,
                watch=Watch(
                    activity=lambda text: progress.update(bar, description=text),
                    progress=lambda done: progress.advance(bar, done),
                    finisher=draw,
                ),
            )
    except KeyboardInterrupt:
        err_console.print(_how_to_resume(folder))
        raise typer.Exit(INTERRUPTED) from None
    shown = Detail.VERDICT if quiet else Detail.MEASURES if verbose else Detail.fitting(finished.found)
    out_console.print(run_report(finished.found, shown, ACCEPTED_PPM if accept is None else accept))
    if not quiet:
        tell(f"run: {finished.path}{_pictures_text(finished)}")
    failed = _out_of_limits(finished) if accept is None else not all_ok(finished.found, accept)
    if fail_on_limits and failed:
        err_console.print("limits failed", style="red")
        raise typer.Exit(LIMITS_FAILED)


def _pictures_text(run: "Run") -> str:
    """The pictures that were drawn of a run."""
    from tol3d.report.picture import measure_files, system_files

    pictures = [run.path / name for name in (PICTURE, *system_files(run.found).values())]
    drawn = [str(picture) for picture in pictures if picture.exists()]
    if any((run.path / name).exists() for name in measure_files(run.found).values()):
        drawn.append(str(run.path / "histogram-*.png"))
    return f"    picture{'s' if len(drawn) > 1 else ''}: {', '.join(drawn)}" if drawn else ""


def _how_to_resume(folder: Path) -> str:
    """What is kept of an interrupted run, and the command that goes on with it."""
    import shlex

    from tol3d.runs.run import partial_of

    partial = partial_of(folder)
    if not partial.exists():
        return "stopped before anything was kept"
    arguments = [argument for argument in sys.argv[1:] if argument != "--resume"]
    return f"stopped; what was done is kept in {partial}. To go on:\n{shlex.join(['tol3d', *arguments, '--resume'])}"


@contextmanager
def _drawing(*, wanted: bool) -> "Iterator[Callable[[Path, Mapping[str, Any]], None]]":
    """What draws the picture of a run; one that cannot be drawn costs a warning, not the run."""
    from tol3d.report.picture import PictureError, drawing

    if not wanted:
        yield lambda place, summary: None
        return
    with drawing() as draw:

        def finish(place: Path, summary: "Mapping[str, Any]") -> None:
            try:
                draw(summary, place / PICTURE)
            except PictureError as error:
                warn(f"{PICTURE} could not be drawn ({error}); the run is whole without it")

        yield finish


def long_study(simulation: "Simulation") -> str:
    """What is said before a study that takes a minute of one core or more; nothing of a shorter one."""
    from tol3d.study.blocks import contacts_of

    positions = contacts_of(simulation)
    study = simulation.study
    minutes = study.trials * positions / simulation.road.contacts_per_minute
    if minutes <= 1.0:
        return ""
    each = "one position" if positions == 1 else f"{positions} positions"
    return f"{each} a trial: about {minutes:.0f} min of one core"


@contextmanager
def _stopped_in_order() -> Iterator[None]:
    """Within it Ctrl-C stops in order, and after a while in any case; behind it, it is what it was before.

    What is on disk is whole at every moment.
    """
    last = threading.Timer(PATIENCE, os._exit, (INTERRUPTED,))
    last.daemon = True

    def interrupted(number: int, frame: "FrameType | None") -> None:
        if not last.is_alive():
            last.start()
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, interrupted)
    try:
        yield
    finally:
        last.cancel()
        signal.signal(signal.SIGINT, before)


def _out_of_limits(run: "Run") -> bool:
    return any(measure.shares.out_ppm for measure in run.found.measures.values())
