"""The command that tells what each contributor does to each measure."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from tol3d.cli.arguments import RunBuilders, TrustParts, whole
from tol3d.cli.console import err_console, out_console, tell


class PositionWord(StrEnum):
    """What positions are to indices."""

    AVERAGED = "averaged"
    AS_INPUT = "as-input"


def effects(
    subject: Annotated[str, typer.Argument(metavar="SCENE|RUN", help="A scene, or the folder of a finished run.")],
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
    csv: Annotated[Path | None, typer.Option(metavar="FILE", help="Write all numbers here.")] = None,
    picture: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw the matrix here.")] = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find what each contributor does to each measure: changes, shares of the variance and of failures."""
    from tol3d.analyses.effects import effects as found_effects
    from tol3d.analyses.effects_table import effects_csv, effects_report
    from tol3d.analyses.subject import subject_of
    from tol3d.records.folder import write_texts
    from tol3d.system.faults import faults_of

    asked = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    with faults_of(asked.simulation.mechanism), err_console.status("effects") as status:
        response = asked.response if measure is None else asked.response.of(measure)
        found = found_effects(
            response,
            base=base,
            seed=seed,
            position=position is PositionWord.AS_INPUT,
            shapley=shapley,
            activity=status.update,
        )
    out_console.print(effects_report(found))
    if csv is not None:
        write_texts({csv.name: effects_csv(found)}, csv.parent)
        tell(f"numbers: {csv}")
    if picture is not None:
        from tol3d.analyses.effects_picture import draw_effects

        draw_effects(found, picture)
        tell(f"picture: {picture}")
    if (kept := asked.keep("effects", found)) is not None:
        tell(f"kept in the run: {kept}")
