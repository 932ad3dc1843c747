"""The command line: arguments, exit codes, progress. The only place that prints.

Exit codes: 0 done, 1 limits failed (with --fail-on-limits), 2 wrong input, 3 a fault of tol3d, 130 interrupted.
Imports stand inside the functions here, so that `tol3d --help` loads no numpy, no CAD and no plotting.
"""

import gc
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TextIO

import typer
from rich.console import Console

if TYPE_CHECKING:
    from types import FrameType

    from tol3d.model import Model
    from tol3d.result import Run

CONTACTS_PER_MINUTE = {"fcl": 180_000, "exact": 40_000_000, "analytic": 40_000_000}
"""By an engine on one core, draws and statistics included; only for the estimate before what takes a minute or more."""

OBJECTS_A_COLLECTION = 50_000  # instead of Python's 700: 0.15 s of a command of 1.5 s
PICTURE = "histogram.png"
PATIENCE = 5.0  # s; worker processes that will not end may hold up an interrupted command no longer

DONE, LIMITS_FAILED, WRONG_INPUT, FAULT, INTERRUPTED = 0, 1, 2, 3, 130

app = typer.Typer(
    name="tol3d",
    help="Open 3D tolerance simulator for gears and robots: thousands of virtual builds on real geometry, "
    "beside an independent analytic model.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
out_console = Console(highlight=False, soft_wrap=False, markup=False)
err_console = Console(stderr=True, highlight=False, soft_wrap=True, markup=False)

SceneArgument = Annotated[
    str, typer.Argument(metavar="SCENE", help="A scene file, or the name of one that tol3d brings along (spur_pair).")
]
RunArgument = Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a finished run.")]
TrustParts = Annotated[
    bool, typer.Option("--trust-parts", help="Allow the scene to read files outside its own folder.")
]


class EngineName(StrEnum):
    """Engines that a run may choose."""

    EXACT = "exact"
    FCL = "fcl"
    ANALYTIC = "analytic"


class SamplerName(StrEnum):
    """Ways to draw that a run may choose."""

    MONTE_CARLO = "monte_carlo"
    SOBOL = "sobol"
    LATIN_HYPERCUBE = "latin_hypercube"


class MinimumName(StrEnum):
    """What may be called the minimum of a backlash."""

    LOW_3SIGMA = "low_3sigma"
    QUANTILE = "p0.135"
    SAMPLE_MIN = "sample_min"


class RoundingName(StrEnum):
    """Ways to a thickness of the stock."""

    DOWN = "down"
    NEAREST = "nearest"


class MeshFormat(StrEnum):
    """Files that an export may write."""

    STL = "stl"
    PLY = "ply"
    GLB = "glb"
    STEP = "step"


def _version(asked: bool) -> None:
    from importlib.metadata import version

    if asked:
        typer.echo(f"tol3d {version('tol3d')}")
        raise typer.Exit(DONE)


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Options of tol3d itself; the help of `app` is shown for it."""


def _trials(text: str) -> int | str:
    """A number of trials, or auto, as --trials gives it."""
    if text == "auto":
        return text
    if not text.isdecimal() or int(text) < 1:
        raise typer.BadParameter(f"expected a whole number from 1 on, or auto, got {text!r}")
    return int(text)


@app.command()
def run(
    context: typer.Context,
    scene: SceneArgument,
    trials: Annotated[
        Any, typer.Option(parser=_trials, metavar="N|auto", help="Number of trials instead of the scene's.")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed instead of the scene's.")] = None,
    engine: Annotated[EngineName | None, typer.Option(help="Engine instead of the scene's.")] = None,
    sampler: Annotated[SamplerName | None, typer.Option(help="Sampler instead of the scene's.")] = None,
    witness: Annotated[
        int | None, typer.Option(min=0, help="Trials of an exact study that FCL measures again.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="The run's folder; runs/<scene> by default.")] = None,
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
    fail_on_limits: Annotated[bool, typer.Option(help="Exit with 1 when a trial is out of limits or failed.")] = False,
    trust_parts: TrustParts = False,
) -> None:
    """Simulate a scene: analytic model and 3D simulation side by side."""
    if workers is not None and scheduler is not None:
        raise typer.BadParameter("--scheduler has its own workers; leave out --workers")
    draw = context.with_resource(_drawing(wanted=not no_picture))  # it loads what it draws with beside all that follows

    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from tol3d.execution import Execution
    from tol3d.report import run_report
    from tol3d.simulate import Overrides, Watch, effective_model, load, run_scene, workers_for

    path = scene_path(scene)
    overrides = Overrides(trials, seed, engine.value if engine else None, sampler.value if sampler else None, witness)
    folder = out or Path("runs") / path.stem
    loaded = load(path, trust_parts=trust_parts)
    model = effective_model(loaded, overrides)
    for warning in model.warnings:
        _warn(warning)
    if told := _long_study(model):
        err_console.print(told)
    own = workers or workers_for(model)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    try:
        with _stopped_in_order(), Progress(*columns, console=err_console, transient=True) as progress:
            bar = progress.add_task("scene", total=model.study.trials)
            finished = run_scene(
                loaded,
                overrides=overrides,
                out=folder,
                execution=Execution(own, scheduler, keep_trials=not no_trials, resume=resume),
                watch=Watch(
                    stage=lambda text: progress.update(bar, description=text),
                    progress=lambda done: progress.advance(bar, done),
                    finisher=draw,
                ),
            )
    except KeyboardInterrupt:
        err_console.print(_how_to_resume(folder))
        raise typer.Exit(INTERRUPTED) from None
    out_console.print(run_report(finished.summary))
    picture = finished.path / PICTURE
    _tell(f"run: {finished.path}" + (f"    picture: {picture}" if picture.exists() else ""))
    if fail_on_limits and _out_of_limits(finished):
        err_console.print("limits failed", style="red")
        raise typer.Exit(LIMITS_FAILED)


def _how_to_resume(folder: Path) -> str:
    """What is kept of an interrupted run, and the command that goes on with it."""
    import shlex

    from tol3d.result import partial_of

    partial = partial_of(folder)
    if not partial.exists():
        return "stopped before anything was kept"
    arguments = [argument for argument in sys.argv[1:] if argument != "--resume"]
    return f"stopped; what was done is kept in {partial}. To go on:\n{shlex.join(['tol3d', *arguments, '--resume'])}"


def _warn(text: str) -> None:
    err_console.print(f"warning: {text}", style="yellow")


def _tell(text: str) -> None:
    """A line for people and pipes: paths in it are never broken."""
    out_console.print(text, soft_wrap=True)


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
                _warn(f"{PICTURE} could not be drawn ({error}); the run is whole without it")

        yield finish


def _long_study(model: "Model") -> str:
    """What is said before a study that takes a minute of one core or more; nothing of a shorter one."""
    from tol3d.block import positions_in_all

    positions = positions_in_all(model)
    minutes = model.study.trials * positions / CONTACTS_PER_MINUTE[model.study.engine]
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
    road = "analytic" if run.summary["engine"] == "analytic" else "geometric"
    measures = run.summary["measures"].values()
    samples = [measure["curve"][road] if measure["take"] == "curve" else measure[road] for measure in measures]
    ppm = [sample[key] or 0.0 for sample in samples for key in ("below_limit_ppm", "above_limit_ppm", "failed_ppm")]
    return any(ppm) or any(count for text, count in run.summary["status"].items() if text != "ok")


@app.command()
def check(scene: SceneArgument, trust_parts: TrustParts = False) -> None:
    """Read a scene and show what it means: parts, moves, measures, contributors with their coefficients."""
    from tol3d.report import check_report
    from tol3d.simulate import effective_model, load

    out_console.print(check_report(effective_model(load(scene_path(scene), trust_parts=trust_parts))))


@app.command()
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
        Any, typer.Option(parser=_trials, metavar="N|auto", help="Number of trials instead of the scene's.")
    ] = None,
    engine: Annotated[EngineName | None, typer.Option(help="Engine instead of the scene's.")] = None,
    out: Annotated[Path | None, typer.Option(help="Write the scene with the chosen shims to this new file.")] = None,
    trust_parts: TrustParts = False,
) -> None:
    """Find the thickness of shims with which a bevel pair has a wanted minimum of backlash."""
    from tol3d.analyses import ShimQuestion, length_of, shim_plan, stock_of
    from tol3d.report.shim_table import shim_report
    from tol3d.scene.edit import tolerance_lines, write_scene
    from tol3d.simulate import Overrides, load

    names = tuple(name.strip() for name in shims.split(",") if name.strip())
    target = length_of("--target-min", target_min)
    question = ShimQuestion(target, measure, names, minimum.value, stock_of(stock), rounding.value)
    overrides = Overrides(trials=trials, engine=engine.value if engine else None)
    loaded = load(scene_path(scene), trust_parts=trust_parts)
    with err_console.status("studies") as status:
        plan = shim_plan(loaded, question, overrides, tell=status.update)
    out_console.print(shim_report(plan))
    _tell(f"\ntolerances of the scene:\n{tolerance_lines(plan.tolerances)}")
    if out is not None:
        write_scene(plan.scene, out)
        _tell(f"scene: {out}")


@app.command()
def compensate(
    scenes: Annotated[
        list[str], typer.Argument(metavar="SCENE...", help="Scene files, or names of those that tol3d brings along.")
    ],
    train: Annotated[str | None, typer.Option(help="Whose motor; the first train of each scene.")] = None,
    trials: Annotated[
        int | None, typer.Option(min=2, help="Number of robots; as many as the study's trials, 2000 at most.")
    ] = None,
    positions: Annotated[int, typer.Option(min=1, help="At how many a robot's own mean is taken.")] = 16,
    out: Annotated[Path | None, typer.Option(help="Draw the picture here.")] = None,
    trust_parts: TrustParts = False,
) -> None:
    """Find the motor's correction for a load that changes side, and what it leaves of the lost motion."""
    from tol3d.analyses.compensation import CompensationQuestion, compensation
    from tol3d.report.compensation_picture import draw_compensation
    from tol3d.report.compensation_table import compensation_report
    from tol3d.simulate import load

    question = CompensationQuestion(train, positions, trials)
    with err_console.status("robots"):
        found = [compensation(load(scene_path(scene), trust_parts=trust_parts), question) for scene in scenes]
    if out is not None:
        draw_compensation(found, out)
    out_console.print(compensation_report(found))
    if out is not None:
        _tell(f"picture: {out}")


@app.command()
def schema() -> None:
    """Print the JSON Schema of scenes, for editors."""
    import json

    from tol3d.scene import Scene

    typer.echo(json.dumps(Scene.model_json_schema(), indent=2, ensure_ascii=False))


@app.command()
def compare(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN...", help="Folders of finished runs.")],
    out: Annotated[Path, typer.Option(help="The picture to write.")] = Path("comparison.png"),
) -> None:
    """Lay the histograms of both roads of one or several runs over each other, with the per-trial difference."""
    from tol3d.report import comparison_report, draw_comparison
    from tol3d.result import open_run

    opened = [open_run(path) for path in runs]
    draw_comparison(opened, out)
    out_console.print(comparison_report(opened))
    _tell(f"picture: {out}")


TrialOption = Annotated[int | None, typer.Option(min=0, help="This trial.")]
WorstOption = Annotated[bool, typer.Option("--worst", help="The trial nearest to a limit, or furthest beyond it.")]
NominalOption = Annotated[bool, typer.Option("--nominal", help="The build without deviations.")]
MeanOption = Annotated[bool, typer.Option("--mean", help="The build with every contributor at its mean.")]
MagnifyOption = Annotated[float, typer.Option(min=0.0, help="Scale the deviations and seat again.")]


@app.command()
def export(
    run: RunArgument,
    trial: TrialOption = None,
    worst: WorstOption = False,
    nominal: NominalOption = False,
    mean: MeanOption = False,
    format: Annotated[
        MeshFormat, typer.Option(help="stl and ply: a file a part; glb, step and any of a train: one.")
    ] = MeshFormat.GLB,
    magnify: MagnifyOption = 1.0,
    out: Annotated[Path, typer.Option(help="Folder to write into.")] = Path("."),
) -> None:
    """Write the perturbed parts of a trial where they ended up."""
    from tol3d.report import export_run
    from tol3d.result import open_run

    finished = open_run(run)
    which = _which(finished, trial, worst=worst, nominal=nominal, mean=mean)
    exported = export_run(finished, which, format.value, magnify=magnify, out=out)
    for note in exported.notes:
        err_console.print(note, style="yellow")
    for path in exported.files:
        _tell(str(path))


@app.command()
def view(
    run: RunArgument,
    trial: TrialOption = None,
    worst: WorstOption = False,
    nominal: NominalOption = False,
    mean: MeanOption = False,
    magnify: MagnifyOption = 1.0,
    screenshot: Annotated[Path | None, typer.Option(help="Write a picture instead of opening a window.")] = None,
) -> None:
    """Show a trial in 3D, with its contact and gap marked."""
    from tol3d.report.view import view_run
    from tol3d.result import open_run

    finished = open_run(run)
    which = _which(finished, trial, worst=worst, nominal=nominal, mean=mean)
    for note in view_run(finished, which, screenshot=screenshot, magnify=magnify):
        err_console.print(note, style="yellow")
    if screenshot:
        _tell(str(screenshot))


def _which(run: "Run", trial: int | None, *, worst: bool, nominal: bool, mean: bool) -> "int | str":
    """The one build that was asked for; the worst when nothing was said. Tells which trial that is."""
    from tol3d.errors import InputError
    from tol3d.report.heading import worst_words
    from tol3d.worst import worst_trial

    words = [word for word, said in (("worst", worst), ("nominal", nominal), ("mean", mean)) if said]
    if len(words) + (trial is not None) > 1:
        raise InputError("expected one of --trial, --worst, --nominal, --mean, got several")
    if trial is not None or nominal or mean:
        return words[0] if trial is None else trial
    found = worst_trial(run)
    unnamed = "" if worst else "no build named: "
    err_console.print(f"{unnamed}trial {found}, the worst: {worst_words(run.summary['measures'])}")
    return found


def scene_path(text: str) -> Path:
    """A scene's file: the path itself, or the scene of that name that tol3d brings along.

    Raises:
        InputError: a bare name, and there is neither.
    """
    from importlib.resources import files

    path = Path(text)
    if os.path.isfile(path) or path.suffix or len(path.parts) > 1:
        return path
    brought = {Path(str(file)).stem: Path(str(file)) for file in files("tol3d.scenes").iterdir()}
    scenes = {name: file for name, file in sorted(brought.items()) if file.suffix == ".yaml"}
    if text in scenes or os.path.exists(path):
        return scenes.get(text, path)

    from tol3d.errors import InputError
    from tol3d.scene.name import LONGEST_NAME
    from tol3d.scene.nearest import nearest

    listed = f"(tol3d brings along: {', '.join(scenes)})"
    raise InputError(f"{text[:LONGEST_NAME]}: no such file, and no scene of that name {listed}{nearest(text, scenes)}")


@contextmanager
def _plain_warnings() -> Iterator[None]:
    """Warnings of ours are one yellow line each; those of other packages stay as Python shows them."""
    with warnings.catch_warnings():
        as_python_does = warnings.showwarning

        def show(
            message: Warning | str,
            category: type[Warning],
            filename: str,
            lineno: int,
            file: TextIO | None = None,
            line: str | None = None,
        ) -> None:
            if category.__module__.startswith("tol3d."):
                _warn(str(message))
            else:
                as_python_does(message, category, filename, lineno, file, line)

        warnings.showwarning = show
        yield


@contextmanager
def _exit_codes() -> Iterator[None]:
    from tol3d.errors import InputError

    try:
        yield
    except InputError as error:
        err_console.print(str(error))
        sys.exit(WRONG_INPUT)
    except KeyboardInterrupt:
        err_console.print("stopped")
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        sys.exit(DONE)
    except Exception as error:
        import traceback

        err_console.print(f"a fault in tol3d, not in your scene: {type(error).__name__}: {error}")
        err_console.print("please report it with the scene and these lines:")
        err_console.print("".join(traceback.format_exception(error)[-3:]).rstrip())
        sys.exit(FAULT)


@contextmanager
def _few_collections() -> Iterator[None]:
    """Within it Python looks for garbage seldom: libraries being loaded make much that stays, and little garbage."""
    before = gc.get_threshold()
    gc.set_threshold(OBJECTS_A_COLLECTION, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)


def main() -> None:
    """Entry point of the `tol3d` command."""
    with _few_collections(), _plain_warnings(), _exit_codes():
        app()


if __name__ == "__main__":
    main()
