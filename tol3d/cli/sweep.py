"""The command on variants of a scene."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, draw_picture, write_numbers
from tol3d.cli.arguments import (
    EngineOption,
    RunBuilders,
    SceneArgument,
    SeedOption,
    TrustParts,
    WorkersOption,
    scene_path,
    whole,
)
from tol3d.cli.console import INTERRUPTED, err_console, out_console, tell


def sweep(
    scene: SceneArgument,
    vary: Annotated[
        list[str], typer.Option(metavar="FIELD=VALUES", help="10um,20um lists; 17..25:2 counts; 10um..30um is a range.")
    ],
    latin_hypercube: Annotated[
        Any, typer.Option(parser=whole(2), metavar="N", help="Draw N variants from the ranges instead of a grid.")
    ] = None,
    hypercube_seed: Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="Of that drawing.")] = 1,
    trials: Annotated[
        Any, typer.Option(parser=whole(1), metavar="N", help="Of each variant instead of the scene's.")
    ] = None,
    seed: SeedOption = None,
    engine: EngineOption = None,
    workers: WorkersOption = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Keep variants here; by default runs/<scene>-sweep. What is there is not run again."),
    ] = None,
    csv: CsvOption = None,
    picture: PictureOption = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Simulate variants of a scene: numbers that take several values, on a grid or a Latin hypercube."""
    from tol3d.analyses.subject import text_of_section
    from tol3d.analyses.sweep_charts import sweep_charts
    from tol3d.analyses.sweep_table import sweep_report, whole_table
    from tol3d.analyses.variant_sweep import NAME, Order, SweepQuestion, write_text
    from tol3d.analyses.variant_sweep import sweep as swept
    from tol3d.analyses.variants import variable_of
    from tol3d.simulate import Overrides, load

    question = SweepQuestion(tuple(map(variable_of, vary)), latin_hypercube, hypercube_seed)
    count = len(question.points)
    loaded = load(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders)
    folder = out or Path("runs") / f"{loaded.source.stem}-sweep"
    order = Order(
        folder,
        Overrides(trials=trials, seed=seed, engine=engine),
        workers or 1,
        trust_parts=trust_parts,
        run_builders=run_builders,
    )
    with _stopping(folder, count) as done:
        found = swept(loaded, question, replace(order, done=done))
    out_console.print(sweep_report(found))
    write_text(text_of_section(found), folder / NAME)
    tell(f"variants: {folder}    all of them: {folder / NAME}")
    if csv is not None:
        write_numbers(csv, whole_table(found).csv())
    if picture is not None:
        draw_picture(picture, "tol3d.report.chart_figure:save_charts", sweep_charts(found))


@contextmanager
def _stopping(folder: Path, count: int) -> "Iterator[Callable[[int, int, str], None]]":
    """Show the progress of a sweep as a bar; on Ctrl-C, report what is kept."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    finished = 0
    try:
        with Progress(*columns, console=err_console, transient=True) as progress:
            bar = progress.add_task("variants", total=count)

            def done(number: int, of: int, words: str) -> None:
                nonlocal finished
                finished = number
                progress.update(bar, completed=number, description=words)

            yield done
    except KeyboardInterrupt:
        err_console.print(f"stopped; {finished} of {count} variants are kept in {folder}; the same command resumes")
        raise typer.Exit(INTERRUPTED) from None
