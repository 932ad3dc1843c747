"""The command that asks how often limits are left."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tol3d.cli.analysed import CsvOption, PictureOption, SubjectArgument, answer
from tol3d.cli.arguments import RunBuilders, TrustParts, whole
from tol3d.cli.console import err_console, tell

if TYPE_CHECKING:
    from collections.abc import Sequence

    from tol3d.analyses.rare_events import RareEvent
    from tol3d.analyses.subject import Subject


class MethodName(StrEnum):
    """Ways to a small probability."""

    AUTO = "auto"
    IMPORTANCE = "importance"
    SUBSET = "subset"
    FORM = "form"
    SORM = "sorm"


def rare(
    subject: SubjectArgument,
    measure: Annotated[str | None, typer.Option(help="Whose limits; those of all measures.")] = None,
    method: Annotated[
        MethodName,
        typer.Option(
            help="auto: importance sampling where every contributor has a smooth map from normals, else subset "
            "simulation; form, sorm: first or second order alone."
        ),
    ] = MethodName.AUTO,
    draws: Annotated[
        Any,
        typer.Option(
            parser=whole(100), metavar="N", help="Of importance sampling (4800), or a level of subset (14000)."
        ),
    ] = None,
    seed: Annotated[Any, typer.Option(parser=whole(0), metavar="N", help="Of its draws.")] = 1,
    csv: CsvOption = None,
    picture: PictureOption = None,
    export: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write the design point's build: .glb, .stl, .ply or .step; of one measure."),
    ] = None,
    view: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the design point's build; of one measure.")
    ] = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Find how often limits are left where that is too rare for trials, and the most likely build that leaves them."""
    from tol3d.analyses import rare as ask
    from tol3d.analyses.subject import subject_of
    from tol3d.errors import InputError

    if measure is None and (export or view):
        raise InputError(f"{'--export' if export else '--view'}: expected with --measure NAME, whose build is shown")
    own = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    words: dict[str, Any] = {"measure": measure, "method": method.value, "draws": draws, "seed": seed}
    found = answer("rare", own, "design points", lambda activity: ask(own, **words, activity=activity), csv, picture)
    if export or view:
        _show(own, found.events, export, view)


def _show(asked: "Subject", events: "Sequence[RareEvent]", export: Path | None, view: Path | None) -> None:
    """Write the design point of the limit that is left most, as a trial of a run is exported and viewed."""
    from tol3d.analyses.rare_section import design_trials
    from tol3d.errors import InputError
    from tol3d.report.export import export_build
    from tol3d.report.presenter import presenter_at
    from tol3d.report.view import view_build
    from tol3d.simulate import replayed

    known = sorted((own for own in events if own.points), key=lambda own: -(own.estimate.probability or 0.0))
    if not known:
        raise InputError(f"{events[0].measure}: there is no design point to show: none was found")
    event = known[0]
    side = "below the lower" if event.side == "low" else "above the upper"
    tell(f"design point: {event.measure} {side} limit, β {event.points[0].beta:.3f}")
    build = replayed(asked.simulation, design_trials(asked.response, event.points[0]))
    presenter = presenter_at(asked.simulation.presenter)
    notes: list[str] = []
    if export is not None:
        exported = export_build(
            presenter.replayed(build, export.stem), export.suffix.lower().lstrip("."), export.parent
        )
        notes += exported.notes
        for path in exported.files:
            tell(str(path))
    if view is not None:
        notes += view_build(presenter.replayed(build, f"design point of {event.measure}"), screenshot=view)
        tell(str(view))
    for words in dict.fromkeys(notes):
        err_console.print(words, style="yellow")
