"""Commands on measured data: what a rig read, what a synthetic one would read, and how well it would identify."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tol3d.cli.arguments import RunBuilders, TrustParts, scene_path
from tol3d.cli.console import err_console, out_console, tell

if TYPE_CHECKING:
    from tol3d.gearing.model import Model

SceneOption = Annotated[
    str, typer.Option(metavar="SCENE", help="The pair's scene: a file, or the name of one that tol3d brings along.")
]
MeshOption = Annotated[str | None, typer.Option(metavar="NAME", help="Which mesh was on the rig; the only one.")]


def identify(
    drive: Annotated[
        list[Path], typer.Option(metavar="CSV", help="Drive flanks in contact; several passes repeat it.")
    ],
    back: Annotated[list[Path], typer.Option(metavar="CSV", help="Back flanks in contact; several passes repeat it.")],
    scene: SceneOption,
    mesh: MeshOption = None,
    unit: Annotated[str | None, typer.Option(help="Of angles whose column has none: deg, rad, arcsec, rev …")] = None,
    j0: Annotated[
        str | None,
        typer.Option(metavar="ANGLE", help="Backlash at phi1 = 0, where encoders were set to zero between the sides."),
    ] = None,
    j0_half_width: Annotated[str, typer.Option(metavar="ANGLE", help="Of its 95 % interval.")] = "0 arcsec",
    encoder_error: Annotated[
        str, typer.Option(metavar="ANGLE", help="Once per turn, that is believed of the driven encoder.")
    ] = "20 arcsec",
    drift: Annotated[bool, typer.Option("--drift", help="Fit a linear drift of each side along.")] = False,
    out: Annotated[Path | None, typer.Option(help="Folder for tables, curve, pictures and the unit's scene.")] = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Identify eccentricities, play and the backlash of the whole long period from two-sided transmission error."""
    from tol3d.records.from_scene import mesh_of, rig_of
    from tol3d.records.identified_table import identified_report
    from tol3d.records.identify import Settings
    from tol3d.records.identify import identify as identified
    from tol3d.records.output import write_identified
    from tol3d.records.quantity import stated

    settings = Settings(
        unit=unit,
        j0=None if j0 is None else stated("--j0", j0, "angle"),
        j0_half_width=stated("--j0-half-width", j0_half_width, "angle"),
        encoder_error=stated("--encoder-error", encoder_error, "angle"),
        drift=drift,
    )
    path = scene_path(scene)
    model = _model(path, trust_parts=trust_parts, run_builders=run_builders)
    own = mesh_of(model, mesh)
    with err_console.status("reading") as status:
        found = identified(rig_of(model, own), drive, back, settings, tell=status.update)
        report = identified_report(found, model.name, own.name)
        written = write_identified(found, report, own, model.name, out) if out is not None else ()
    out_console.print(report)
    for file in written:
        tell(str(file))


def _model(path: Path, *, trust_parts: bool, run_builders: bool) -> "Model":
    from tol3d.records.from_scene import gears_of
    from tol3d.simulate import load, simulation_of

    return gears_of(simulation_of(load(path, trust_parts=trust_parts, run_builders=run_builders)).system)
