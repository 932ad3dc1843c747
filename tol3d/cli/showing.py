"""Commands that show a scene or finished runs."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tol3d.cli.arguments import (
    AcceptOption,
    AcceptPpkOption,
    RunArgument,
    RunBuilders,
    SceneArgument,
    TrustParts,
    accepted_of,
    scene_path,
    whole,
)
from tol3d.cli.console import WRONG_INPUT, err_console, out_console, seconds, tell

if TYPE_CHECKING:
    from collections.abc import Mapping

    from tol3d.study.runs.run import Run


LONG = 5.0  # s; a check that takes longer says where the time went


class MeshFormat(StrEnum):
    """Files that an export may write."""

    STL = "stl"
    PLY = "ply"
    GLB = "glb"
    STEP = "step"


def check(
    scene: SceneArgument,
    parts: Annotated[bool, typer.Option("--parts", help="Show instead which move lays which part on which.")] = False,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write all tables whole, as comma-separated values.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print its errors and warnings instead, as JSON for programs.")
    ] = False,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Read a scene and show what it means: parts, moves, measures, contributors with their coefficients."""
    from tol3d.errors import InputError, unwritable
    from tol3d.numerics.seldom import load_when_used

    load_when_used()

    from tol3d.report.check import check_report, drawn_limits, parts_report
    from tol3d.simulate import load, simulation_of
    from tol3d.study.runs.atomic_write import write_whole

    if parts and out is not None:
        raise InputError("--out: of --parts leave it out; the tree is no table")
    if as_json:
        if parts or out is not None:
            raise InputError(f"{'--parts' if parts else '--out'}: of --json leave it out, which prints no tables")
        _print_problems(scene, trust_parts=trust_parts, run_builders=run_builders)
        return
    with err_console.status("reading the scene") as status:
        loaded = load(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders)
        spent = {"to read the scene": seconds()}
        status.update("building its system")
        simulation = simulation_of(loaded)
        spent["to build its system"] = seconds() - sum(spent.values())
        status.update(f"coefficients and worst cases of {len(simulation.system.measures)} measures")
        report = parts_report(simulation) if parts else check_report(simulation, drawn_limits(loaded))
    spent["for what it shows"] = seconds() - sum(spent.values())
    out_console.print(report)
    if out is not None:
        try:
            write_whole(out, report.csv().encode())
        except OSError as error:
            raise unwritable(out, error, "choose another file") from None
        tell(str(out))
    spent["to print it"] = seconds() - sum(spent.values())
    if sum(spent.values()) > LONG:
        tell(f"time: {sum(spent.values()):.1f} s in all: {', '.join(f'{s:.1f} s {word}' for word, s in spent.items())}")


def _print_problems(scene: str, *, trust_parts: bool, run_builders: bool) -> None:
    """Print errors of a scene, or else its warnings, as JSON; with errors the exit code is that of wrong input."""
    import json

    from tol3d.errors import InputError, Problem
    from tol3d.simulate import load, simulation_of

    try:
        simulation = simulation_of(load(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders))
        found = [Problem.of(own).data("warning") for own in simulation.warnings]
    except InputError as error:
        found = [own.data() for own in error.problems]
    typer.echo(json.dumps(found, indent=2, ensure_ascii=False))
    if any(own["severity"] == "error" for own in found):
        raise typer.Exit(WRONG_INPUT)


def workspace(
    scene: SceneArgument,
    out: Annotated[Path, typer.Option(metavar="FILE", help="The picture: .png, .svg or .pdf.")] = Path("workspace.png"),
    of: Annotated[
        str | None,
        typer.Option(metavar="MEASURE", help="Show its sigma, by first order, instead of the condition number."),
    ] = None,
    csv: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the numbers too.")] = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Draw how far a linkage reaches, where it is singular, and how well its inputs hold it."""
    from tol3d.errors import InputError, unwritable
    from tol3d.report.presenter import Mapped, presenter_at
    from tol3d.simulate import load, simulation_of
    from tol3d.study.runs.atomic_write import write_whole

    loaded = load(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders)
    simulation = simulation_of(loaded)
    presenter = presenter_at(simulation.presenter)
    if not isinstance(presenter, Mapped):
        raise InputError(f"{loaded.scene}: expected a scene with a linkage (kind: close_loop), got none")
    with err_console.status("workspace") as status:
        found = presenter.workspace(simulation, of, status.update)
    found.draw(out)
    tell(str(out))
    if csv is not None:
        try:
            write_whole(csv, found.csv().encode())
        except OSError as error:
            raise unwritable(csv, error, "choose another file") from None
        tell(str(csv))


def scenes(
    copy: Annotated[
        str | None, typer.Option(metavar="NAME", help="Copy that scene, with its files, or planetary_stage.rexs.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder to copy into.")] = Path(),
) -> None:
    """List the bundled scenes, or copy one to start your own from."""
    from tol3d.kinds import all_kinds
    from tol3d.scene.collection import copy_scene, scene_lines

    for line in scene_lines(all_kinds()) if copy is None else map(str, copy_scene(copy, out, all_kinds())):
        tell(line)
    if copy is None:
        err_console.print("tol3d run NAME runs one; tol3d scenes --copy NAME puts its file here to start your own from")


def schema(
    summary: Annotated[bool, typer.Option("--summary", help="That of a run's summary.json instead.")] = False,
    identified: Annotated[bool, typer.Option("--identified", help="That of identified.json instead.")] = False,
) -> None:
    """Print the JSON Schema of scenes, for editors; or those of summary.json and identified.json, for programs."""
    import json

    from pydantic import BaseModel

    described: type[BaseModel]
    if identified:
        from tol3d.import_path import named

        described = named("tol3d.apps.records.summary:IdentifiedSummary")
    elif summary:
        from tol3d.study.runs.summary.kinds import default_kinds

        described = default_kinds().run
    else:
        from tol3d.kinds import all_kinds

        described = all_kinds().scene
    typer.echo(json.dumps(described.model_json_schema(), indent=2, ensure_ascii=False))


def compare(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN...", help="Folders of finished runs.")],
    out: Annotated[Path, typer.Option(help="The picture to write.")] = Path("comparison.png"),
) -> None:
    """Lay the histograms of both methods of one or several runs over each other, with the per-trial difference."""
    from tol3d.report import comparison_report, draw_comparison
    from tol3d.study.runs.run import open_run

    opened = [open_run(path) for path in runs]
    draw_comparison(opened, out)
    out_console.print(comparison_report(opened))
    tell(f"picture: {out}")


class ReportFormatWord(StrEnum):
    """Files that a report may be."""

    HTML = "html"
    XLSX = "xlsx"
    CSV = "csv"
    JSON = "json"


def report(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN...", help="Folders of finished runs.")],
    out: Annotated[
        Path | None,
        typer.Option(
            help="The file to write; default: report.html, .xlsx or .json in this folder, of csv the folder report-csv."
        ),
    ] = None,
    format: Annotated[
        ReportFormatWord,
        typer.Option(
            help="html: the page; its tables as xlsx: a workbook, csv: a file each in a folder, json: one file."
        ),
    ] = ReportFormatWord.HTML,
    trials: Annotated[
        str, typer.Option("--trials", metavar="N,…", help="Trials that its 3D view has besides nominal and worst.")
    ] = "",
    no_3d: Annotated[bool, typer.Option("--no-3d", help="Leave out the parts in 3D: a tenth of the size.")] = False,
    accept: AcceptOption = None,
    accept_ppk: AcceptPpkOption = None,
    force: Annotated[bool, typer.Option("--force", help="Replace what is there.")] = False,
) -> None:
    """Write a run, or several compared, as one page that opens anywhere, or as its tables."""
    from tol3d.errors import InputError
    from tol3d.notebook import write_report

    if format is not ReportFormatWord.HTML and (trials or no_3d):
        raise InputError(f"{'--trials' if trials else '--no-3d'}: is of the page; leave it out with --format {format}")
    accepted_of(accept, accept_ppk)  # refuses both
    chosen = [whole(0)(own.strip()) for own in trials.split(",") if own.strip()]
    path = out or Path("report-csv" if format is ReportFormatWord.CSV else f"report.{format}")
    with err_console.status("report"):
        write_report(
            runs,
            path,
            accepted_ppm=accept,
            accepted_ppk=accept_ppk,
            trials=chosen,
            in_3d=not no_3d,
            format=format.value,
            force=force,
        )
    tell(str(path.resolve()))
    if format is ReportFormatWord.HTML:
        err_console.print(f"any browser opens it, also without a network: {path.resolve().as_uri()}", soft_wrap=True)


TrialOption = Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="This trial.")]
WorstOption = Annotated[bool, typer.Option("--worst", help="The trial nearest to a limit, or furthest beyond it.")]
NominalOption = Annotated[bool, typer.Option("--nominal", help="The build without deviations.")]
MeanOption = Annotated[bool, typer.Option("--mean", help="The build with every contributor at its mean.")]
MagnifyOption = Annotated[float, typer.Option(min=0.0, help="Scale the deviations and assemble again.")]


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
    out: Annotated[Path, typer.Option(help="Folder to write into.")] = Path(),
) -> None:
    """Write the perturbed parts of a trial where they ended up."""
    from tol3d.report import export_run
    from tol3d.study.runs.run import open_run

    finished = open_run(run)
    which = _which(finished, trial, worst=worst, nominal=nominal, mean=mean)
    exported = export_run(finished, which, format.value, magnify=magnify, out=out)
    for note in exported.notes:
        err_console.print(note, style="yellow")
    for path in exported.files:
        tell(str(path))


def view(
    run: RunArgument,
    trial: TrialOption = None,
    worst: WorstOption = False,
    nominal: NominalOption = False,
    mean: MeanOption = False,
    magnify: MagnifyOption = 1.0,
    mesh: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which mesh is shown close up; default: the first.")
    ] = None,
    screenshot: Annotated[Path | None, typer.Option(help="Write a picture instead of opening a window.")] = None,
    animate: Annotated[
        Path | None, typer.Option(help="Write moving pictures instead: .gif, .webp, .png (animated), or a page, .html.")
    ] = None,
    motion: Annotated[
        str | None, typer.Option(metavar="NAME", help="What moves, with --animate; default: the first there is.")
    ] = None,
    frames: Annotated[int | None, typer.Option(help="How many frames, with --animate.")] = None,
) -> None:
    """Show a trial in 3D; of gears with contact and gap marked."""
    from tol3d.study.runs.run import open_run

    _refuse_mixed(screenshot, animate, mesh, {"--motion": motion, "--frames": frames})
    finished = open_run(run)
    which = _which(finished, trial, worst=worst, nominal=nominal, mean=mean)
    if animate is not None:
        from tol3d.report.animation import animate_run

        notes = animate_run(finished, which, animate, motion=motion, frames=frames, magnify=magnify)
    else:
        from tol3d.report.view import view_run

        notes = view_run(finished, which, screenshot=screenshot, magnify=magnify, close_up=mesh)
    for note in notes:
        err_console.print(note, style="yellow")
    if written := animate or screenshot:
        tell(str(written))


def _refuse_mixed(
    screenshot: Path | None, animate: Path | None, mesh: str | None, of_motions: "Mapping[str, object]"
) -> None:
    """Refuse options of which one would be left out."""
    from tol3d.errors import InputError

    if animate is not None and screenshot is not None:
        raise InputError("expected one of --screenshot and --animate, got both")
    if animate is not None and mesh is not None:
        raise InputError("--mesh: of moving pictures leave it out; --motion chooses what moves")
    if animate is None and (said := [option for option, value in of_motions.items() if value is not None]):
        raise InputError(f"{said[0]}: expected with --animate FILE, which writes moving pictures")


def _which(run: "Run", trial: int | None, *, worst: bool, nominal: bool, mean: bool) -> "int | str":
    """The one build that was asked for; the worst by default. Tells which trial that is."""
    from tol3d.errors import InputError
    from tol3d.report.heading import worst_words
    from tol3d.study.runs.worst import worst_trial

    words = [word for word, said in (("worst", worst), ("nominal", nominal), ("mean", mean)) if said]
    if len(words) + (trial is not None) > 1:
        raise InputError("expected one of --trial, --worst, --nominal, --mean, got several")
    if trial is not None or nominal or mean:
        return words[0] if trial is None else trial
    found = worst_trial(run)
    unnamed = "" if worst else "no build named: "
    err_console.print(f"{unnamed}trial {found}, the worst: {worst_words(run.found)}")
    return "worst"  # the presenter may have to pass over one that is not built
