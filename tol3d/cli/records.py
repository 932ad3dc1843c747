"""Commands on measured data: what a rig read, what a synthetic one would read, and how well it would identify."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from tol3d.cli.arguments import RunBuilders, SceneArgument, TrustParts, scene_path
from tol3d.cli.console import err_console, out_console, tell
from tol3d.cli.rig_options import (
    BacklashOption,
    DriftOption,
    Eccentricity1,
    Eccentricity2,
    Encoder1,
    Encoder2,
    HiddenTurns,
    MeshOption,
    NoiseOption,
    Phase1,
    Phase2,
    RepeatsOption,
    ResolutionOption,
    RigSeed,
    SamplesOption,
    SceneOption,
    ToothMesh,
    TorqueOption,
    TurnsOption,
    WindingOption,
    Wrapped,
    Zeroed,
)

if TYPE_CHECKING:
    from tol3d.gearing.model import Model
    from tol3d.records.pair import Specimen
    from tol3d.records.quantity import Kind


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
        str, typer.Option(metavar="ANGLE", help="Once per turn, that is believed of either encoder.")
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


def rig(
    scene: SceneArgument,
    mesh: MeshOption = None,
    turns: TurnsOption = 16.0,
    samples: SamplesOption = 720,
    repeats: RepeatsOption = 1,
    noise: NoiseOption = "0.5 arcsec",
    resolution: ResolutionOption = "0 arcsec",
    encoder1: Encoder1 = "0 arcsec",
    encoder2: Encoder2 = "0 arcsec",
    tooth_mesh: ToothMesh = "0 arcsec",
    drift: DriftOption = "0 arcsec",
    torque: TorqueOption = None,
    winding: WindingOption = "0 arcsec",
    hidden_turns: HiddenTurns = 0,
    zeroed: Zeroed = False,
    wrapped: Wrapped = False,
    seed: RigSeed = 1,
    e1: Eccentricity1 = None,
    theta1: Phase1 = None,
    e2: Eccentricity2 = None,
    theta2: Phase2 = None,
    backlash: BacklashOption = None,
    out: Annotated[Path, typer.Option(help="Folder for drive.csv and back.csv.")] = Path(),
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Write what a synthetic transmission error rig would measure of a scene's pair: drive.csv and back.csv."""
    from tol3d.records.quantity import stated
    from tol3d.records.rig import Rig
    from tol3d.records.rig_files import write_both

    path = scene_path(scene)
    model = _model(path, trust_parts=trust_parts, run_builders=run_builders)
    own = Rig(
        turns=turns,
        samples=samples,
        repeats=repeats,
        noise=stated("--noise", noise, "angle"),
        resolution=stated("--resolution", resolution, "angle"),
        encoder1=stated("--encoder1", encoder1, "angle"),
        encoder2=stated("--encoder2", encoder2, "angle"),
        tooth_mesh=stated("--tooth-mesh", tooth_mesh, "angle"),
        drift=stated("--drift", drift, "angle"),
        torques=tuple(stated("--torque", each, "torque") for each in torque or ()),
        winding=stated("--winding", winding, "angle"),
        hidden_turns=hidden_turns,
        zeroed=zeroed,
        seed=seed,
    )
    specimen = _specimen(model, mesh, _Stated(e1, theta1, e2, theta2, backlash))
    with err_console.status("rig"):
        written = write_both(specimen, own, out, wrapped=wrapped)
    for file in written:
        tell(str(file))


def plan_rig(
    scene: SceneArgument,
    mesh: MeshOption = None,
    turns: Annotated[str, typer.Option(metavar="N,...", help="Of the driver on each side.")] = "1,2,4,8,16",
    samples: SamplesOption = 720,
    repeats: RepeatsOption = 1,
    noise: NoiseOption = "0.5 arcsec",
    resolution: ResolutionOption = "0 arcsec",
    drift: Annotated[bool, typer.Option("--drift", help="A linear drift of each side is fitted along.")] = False,
    e1: Eccentricity1 = None,
    theta1: Phase1 = None,
    e2: Eccentricity2 = None,
    theta2: Phase2 = None,
    backlash: BacklashOption = None,
    out: Annotated[Path | None, typer.Option(help="Write the table to this CSV file.")] = None,
    trust_parts: TrustParts = False,
    run_builders: RunBuilders = False,
) -> None:
    """Predict the 95 % intervals that a rig would find, over its turns, rows and encoders: before it is built."""
    from tol3d.records.folder import write_texts
    from tol3d.records.plan_table import plan_report, plan_table
    from tol3d.records.planning import plan_rig as planned
    from tol3d.records.quantity import numbers, stated
    from tol3d.records.rig import Rig

    own = Rig(
        samples=samples,
        repeats=repeats,
        noise=stated("--noise", noise, "angle"),
        resolution=stated("--resolution", resolution, "angle"),
    )
    path = scene_path(scene)
    model = _model(path, trust_parts=trust_parts, run_builders=run_builders)
    specimen = _specimen(model, mesh, _Stated(e1, theta1, e2, theta2, backlash))
    plans = planned(specimen, own, numbers("--turns", turns), drift=drift)
    out_console.print(plan_report(plans, specimen, own, model.name))
    if out is not None:
        write_texts({out.name: plan_table(plans).csv()}, out.parent)
        tell(str(out))


class _Stated(NamedTuple):
    """What options say of the pair instead of the scene."""

    e1: str | None
    theta1: str | None
    e2: str | None
    theta2: str | None
    backlash: str | None


def _specimen(model: "Model", mesh: str | None, options: _Stated) -> "Specimen":
    """The scene's mean build, with what options say otherwise."""
    from tol3d.records.from_scene import mesh_of, specimen_of_scene
    from tol3d.records.pair import Specimen
    from tol3d.records.quantity import stated

    def said(option: str, text: str | None, kind: "Kind", otherwise: float) -> float:
        return otherwise if text is None else stated(option, text, kind)

    own = specimen_of_scene(model, mesh_of(model, mesh))
    return Specimen(
        own.pair,
        said("--e1", options.e1, "length", own.e1),
        said("--theta1", options.theta1, "angle", own.theta1),
        said("--e2", options.e2, "length", own.e2),
        said("--theta2", options.theta2, "angle", own.theta2),
        said("--backlash", options.backlash, "length", own.normal_backlash),
    )


def _model(path: Path, *, trust_parts: bool, run_builders: bool) -> "Model":
    from tol3d.records.from_scene import gears_of
    from tol3d.simulate import load, simulation_of

    return gears_of(simulation_of(load(path, trust_parts=trust_parts, run_builders=run_builders)).system)
