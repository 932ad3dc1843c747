"""The command that simulates."""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from tol3d.cli.arguments import (
    PICTURE,
    AcceptOption,
    AcceptPpkOption,
    EngineOption,
    FailOnLimits,
    ForceOption,
    NoPicture,
    NoTrials,
    OutOption,
    PicturesOption,
    QuietOption,
    ReportOption,
    ResumeOption,
    RunBuilders,
    SamplerOption,
    SceneArgument,
    SchedulerOption,
    SeedOption,
    TrialsOption,
    TrustParts,
    VerboseOption,
    WitnessOption,
    WorkersOption,
    accepted_of,
    scene_path,
)
from tol3d.cli.console import INTERRUPTED, LIMITS_FAILED, err_console, out_console, seconds, tell, warn

if TYPE_CHECKING:
    from types import FrameType

    from tol3d.report.page import Page
    from tol3d.study.execution.watch import Finisher, Watch
    from tol3d.study.runs.run import Run
    from tol3d.study.runs.summary.judged import Accepted
    from tol3d.study.trials.simulation import Simulation

PATIENCE = 5.0  # s; worker processes that will not end may hold up an interrupted command no longer


def run(
    context: typer.Context,
    scene: SceneArgument,
    trials: TrialsOption = None,
    seed: SeedOption = None,
    engine: EngineOption = None,
    sampler: SamplerOption = None,
    witness: WitnessOption = None,
    out: OutOption = None,
    force: ForceOption = False,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    no_trials: NoTrials = False,
    resume: ResumeOption = False,
    no_picture: NoPicture = False,
    pictures: PicturesOption = None,
    accept: AcceptOption = None,
    accept_ppk: AcceptPpkOption = None,
    fail_on_limits: FailOnLimits = False,
    quiet: QuietOption = False,
    verbose: VerboseOption = False,
    report: ReportOption = False,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Simulate a scene: analytic model and 3D simulation side by side."""
    _refuse(force and resume, "--resume continues the run that --force would replace; leave out one of them")
    _refuse(workers is not None and scheduler is not None, "--scheduler has its own workers; leave out --workers")
    _refuse(quiet and verbose, "--quiet says less and --verbose more; leave out one of them")
    _refuse(no_picture and pictures is not None, "--no-picture draws nothing; leave out --pictures")
    wanted = None if no_picture else pictures.value if pictures else "worst"
    draw = context.with_resource(_drawing(wanted))  # it loads what it draws with beside all that follows

    from tol3d.numerics.seldom import load_when_used

    load_when_used()
    asked = accepted_of(accept, accept_ppk)

    from tol3d.report.table import Detail, Elapsed, run_report
    from tol3d.simulate import Overrides, folder_for, load, run_simulation, simulation_of, workers_for
    from tol3d.study.execution.pools import Execution
    from tol3d.study.runs.occupant import BEING_WRITTEN, numbered
    from tol3d.study.runs.summary.judged import all_ok, demand_of
    from tol3d.study.system.faults import faults_of

    path = scene_path(scene)
    overrides = Overrides(trials, seed, engine, sampler.value if sampler else None, witness)
    by_default = Path("runs") / path.stem
    resumed = ([out] if out else numbered(by_default)) if resume else ()
    loaded = load(path, trust_parts=trust_parts, run_builders=run_builders, resumed=resumed)
    simulation = simulation_of(loaded, overrides)
    with faults_of(simulation.mechanism):
        for warning in simulation.warnings:
            warn(warning)
        if notice := long_study(simulation):
            err_console.print(notice)
        workers = workers or workers_for(simulation)
    execution = Execution(workers, scheduler, keep_trials=not no_trials, resume=resume)
    folder, taken = out or by_default, ""
    if out is None and not force:
        folder, taken = folder_for(loaded, simulation, execution, Path("runs"))
    if taken:
        way = "" if BEING_WRITTEN in taken else " (--force would replace the other)"
        err_console.print(f"{taken}: this run goes to {folder}{way}")
    loading = seconds()
    with _watched(simulation, folder, draw) as watch:
        finished = run_simulation(loaded, simulation, folder, execution=execution, force=force, watch=watch)
    shown = Detail.VERDICT if quiet else Detail.MEASURES if verbose else Detail.SHORT
    found = finished.found
    accepted = demand_of(found.study.accept_ppk, asked)
    out_console.print(run_report(found, shown, accepted, elapsed=Elapsed(loading, seconds())))
    if not quiet and not all_ok(found, accepted):
        out_console.print(_what_to_change(finished, simulation, accepted))
    if not quiet:
        tell(f"run: {finished.path}{_pictures_text(finished)}")
        if words := pictured(finished, wanted):
            tell(words)
    if report:
        _write_report(finished, accepted)
    by_trials = asked is None and found.study.accept_ppk is None
    failed = _out_of_limits(finished) if by_trials else not all_ok(found, accepted)
    if fail_on_limits and failed:
        err_console.print("limits failed", style="red")
        raise typer.Exit(LIMITS_FAILED)


def _refuse(contradiction: bool, words: str) -> None:
    if contradiction:
        raise typer.BadParameter(words)


@contextmanager
def _watched(simulation: "Simulation", folder: Path, draw: "Finisher") -> Iterator["Watch"]:
    """Show the progress of a run as a bar; Ctrl-C ends it in order and tells how to resume it."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from tol3d.simulate import Watch

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    try:
        with _stopped_in_order(), Progress(*columns, console=err_console, transient=True) as progress:
            bar = progress.add_task("scene", total=simulation.study.trials)
            yield Watch(
                activity=lambda text: progress.update(bar, description=text),
                progress=lambda done: progress.advance(bar, done),
                finisher=draw,
            )
    except KeyboardInterrupt:
        err_console.print(_how_to_resume(folder))
        raise typer.Exit(INTERRUPTED) from None


def _write_report(run: "Run", accepted: "Accepted") -> None:
    """The report of a run, in its folder."""
    from tol3d.notebook import keep_report

    with err_console.status("report"):
        path = keep_report(run, accepted)
    tell(f"report: {path}")


def _pictures_text(run: "Run") -> str:
    """The pictures that were drawn of a run."""
    from tol3d.report.picture import HEAT_MAP, measure_files, system_files

    pictures = (PICTURE, HEAT_MAP, *system_files(run.found).values())
    drawn = [picture for picture in pictures if (run.path / picture).exists()]
    if any((run.path / name).exists() for name in measure_files(run.found.measures).values()):
        drawn.append("histogram-*.png")
    return f"    picture{'s' if len(drawn) > 1 else ''} in it: {', '.join(drawn)}" if drawn else ""


def pictured(run: "Run", wanted: str | None) -> str:
    """Measures in the picture of a run of many, and the form of the others, in words; "" if all are in it."""
    from tol3d.report.heading import WORST_FIRST, shown_measures
    from tol3d.report.picture import MOST_TOGETHER

    count = len(run.found.measures)
    if wanted != "worst" or count <= MOST_TOGETHER or not (run.path / PICTURE).exists():
        return ""
    names = ", ".join(shown_measures(run.found.measures, MOST_TOGETHER))
    return f"{PICTURE} shows the {MOST_TOGETHER} worst of {count} measures {WORST_FIRST}: {names}; --pictures all: each"


def _how_to_resume(folder: Path) -> str:
    """Kept part of an interrupted run, and the command that resumes it."""
    import shlex

    from tol3d.study.runs.occupant import partial_of

    partial = partial_of(folder)
    if not partial.exists():
        return "stopped before anything was kept"
    arguments = [argument for argument in sys.argv[1:] if argument != "--resume"]
    command = shlex.join(["tol3d", *arguments, "--resume"])
    return f"stopped; finished blocks are kept in {partial}. To resume:\n{command}"


@contextmanager
def _drawing(wanted: str | None) -> "Iterator[Callable[[Path, Mapping[str, Any]], None]]":
    """Drawer of the pictures of a run, worst or all, None for none; a failure costs a warning, not the run."""
    if wanted is None:
        yield lambda place, summary: None
        return
    from tol3d.report.picture import PictureError, Pictures, drawing

    with drawing(pictures=Pictures(wanted)) as draw:

        def finish(place: Path, summary: "Mapping[str, Any]") -> None:
            try:
                draw(summary, place / PICTURE)
            except PictureError as error:
                warn(f"{PICTURE} could not be drawn ({error}); the run is whole without it")

        yield finish


def long_study(simulation: "Simulation") -> str:
    """Notice before a study that takes a minute of one core or more; empty for a shorter one."""
    from tol3d.study.results.task import contacts_of

    positions = contacts_of(simulation)
    study = simulation.study
    minutes = study.trials * positions / simulation.method.contacts_per_minute
    if minutes <= 1.0:
        return ""
    each = "one position" if positions == 1 else f"{positions} positions"
    return f"{each} a trial: about {minutes:.0f} min of one core"


@contextmanager
def _stopped_in_order() -> Iterator[None]:
    """Let Ctrl-C stop in order, and after a while in any case; restored afterwards.

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


def _what_to_change(run: "Run", simulation: "Simulation", accepted: "Accepted") -> "Page":
    """A few lines below the verdict, kept in the run; a run that cannot be asked is whole without them."""
    from tol3d.analyses.changes_of_run import changes_of_run
    from tol3d.analyses.shown_changes import changes_lines
    from tol3d.analyses.subject import keep
    from tol3d.errors import InputError
    from tol3d.report.page import page
    from tol3d.study.system.faults import faults_of

    try:
        with faults_of(simulation.mechanism):
            told = changes_of_run(run, simulation, accepted)
        if told is None:
            return page()
        if told.measures:
            keep(run, "changes", told)
    except InputError as error:
        warn(f"no changes are proposed: {error}")
        return page()
    return page(*changes_lines(told, str(run.path)))


def _out_of_limits(run: "Run") -> bool:
    return any(measure.shares.out_ppm for measure in run.found.measures.values())
