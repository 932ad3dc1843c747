"""Commands on measured data: identification, synthetic rigs, and the expected accuracy of a rig."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from tol3d.cli.arguments import RunBuilders, SceneArgument, TrustParts, scene_path
from tol3d.cli.console import err_console, out_console, tell, warn

if TYPE_CHECKING:
    from tol3d.apps.records.pair import Specimen, Unit
    from tol3d.cli.quantity import Kind
    from tol3d.study import Simulation


SceneOption = Annotated[
    str, typer.Option(metavar="SCENE", help="The pair's scene: a file, or the name of a bundled one.")
]
MeshOption = Annotated[str | None, typer.Option(metavar="NAME", help="Which mesh was on the rig; the only one.")]


class RigEngine(StrEnum):
    """Engines by which a rig finds where flanks touch."""

    CLOSED_FORM = "closed_form"
    EXACT = "exact"


EngineOption = Annotated[
    RigEngine,
    typer.Option(
        "--engine",
        help="closed_form: eccentricities, tooth thickness and the distance of the axes; exact: the scene's exact "
        "engine, with all that its tolerances do.",
    ),
]
TrialOption = Annotated[
    int | None,
    typer.Option(metavar="N", min=0, help="Trial of the scene's study that is measured; default: the mean build."),
]
TurnsOption = Annotated[float, typer.Option(min=0.1, max=1e4, help="Of the driver on each side.")]
SamplesOption = Annotated[int, typer.Option(min=4, max=10**7, help="Rows per turn of the driver.")]
RepeatsOption = Annotated[int, typer.Option(min=1, max=1000, help="Passes of each side.")]
NoiseOption = Annotated[str, typer.Option(metavar="ANGLE", help="Standard deviation of each encoder.")]
ResolutionOption = Annotated[str, typer.Option(metavar="ANGLE", help="Step of each encoder.")]
Eccentricity1 = Annotated[str | None, typer.Option("--e1", metavar="LENGTH", help="Of the driver; the scene's mean.")]
Phase1 = Annotated[str | None, typer.Option("--theta1", metavar="ANGLE", help="Its phase, in its sense of rotation.")]
Eccentricity2 = Annotated[
    str | None, typer.Option("--e2", metavar="LENGTH", help="Of the driven gear; the scene's mean.")
]
Phase2 = Annotated[str | None, typer.Option("--theta2", metavar="ANGLE", help="Its phase, in its sense of rotation.")]
BacklashOption = Annotated[
    str | None,
    typer.Option("--backlash", metavar="LENGTH", help="Normal one without eccentricities; the scene's mean."),
]
Encoder1 = Annotated[str, typer.Option("--encoder1", metavar="ANGLE", help="Its error once per turn.")]
Encoder2 = Annotated[str, typer.Option("--encoder2", metavar="ANGLE", help="Its error once per turn.")]
ToothMesh = Annotated[str, typer.Option(metavar="ANGLE", help="Amplitude of the transmission error at tooth mesh.")]
DriftOption = Annotated[str, typer.Option(metavar="ANGLE", help="Of the driven encoder over one pass.")]
TorqueOption = Annotated[
    list[str] | None, typer.Option(metavar="TORQUE", help="Of the passes in turn; several repeat it.")
]
WindingOption = Annotated[str, typer.Option(metavar="ANGLE", help="Of the shafts, per N m of torque.")]
HiddenTurns = Annotated[
    int, typer.Option(help="Turns of the driver by which the back side lies further on, unknown to the encoders.")
]
Zeroed = Annotated[bool, typer.Option("--zeroed", help="Set the encoders to zero before each side.")]
Wrapped = Annotated[bool, typer.Option("--wrapped", help="Angles within one turn.")]
RigSeed = Annotated[int, typer.Option(min=0, max=2**63, help="Of all that is random.")]


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
    from tol3d.apps.records.findings import Settings
    from tol3d.apps.records.identification import identify as identified
    from tol3d.apps.records.output import refuse_others, write_identified
    from tol3d.apps.records.scene_mesh import SceneMesh
    from tol3d.apps.records.tables import identified_report
    from tol3d.cli.quantity import stated

    settings = Settings(
        unit=unit,
        j0=None if j0 is None else stated("--j0", j0, "angle"),
        j0_half_width=stated("--j0-half-width", j0_half_width, "angle", 0.0),
        encoder_error=stated("--encoder-error", encoder_error, "angle", 0.0),
        drift=drift,
    )
    if out is not None:
        refuse_others(out)
    simulation = _simulation(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders)
    own = SceneMesh.of(simulation, mesh)
    pair = own.specimen().pair
    with err_console.status("reading") as status:
        found = identified(pair, drive, back, settings, tell=status.update)
        report = identified_report(found, own)
        written = write_identified(found, report, own, out) if out is not None else ()
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
    engine: EngineOption = RigEngine.CLOSED_FORM,
    trial: TrialOption = None,
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
    from tol3d.apps.records.rig import Rig, write_both
    from tol3d.cli.quantity import stated

    simulation = _simulation(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders)
    own = Rig(
        turns=turns,
        samples=samples,
        repeats=repeats,
        noise=stated("--noise", noise, "angle", 0.0),
        resolution=stated("--resolution", resolution, "angle", 0.0),
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
    stated_by_options = _Stated(e1, theta1, e2, theta2, backlash)
    with err_console.status("rig"):
        unit = _unit(simulation, mesh, trial, engine, stated_by_options)
        written = write_both(unit, own, out, wrapped=wrapped)
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
    from tol3d.apps.records.planning import plan_rig as planned
    from tol3d.apps.records.rig import Rig
    from tol3d.apps.records.tables import plan_report, plan_table
    from tol3d.cli.quantity import numbers, stated
    from tol3d.study.runs import write_texts

    own = Rig(
        samples=samples,
        repeats=repeats,
        noise=stated("--noise", noise, "angle", 0.0),
        resolution=stated("--resolution", resolution, "angle", 0.0),
    )
    simulation = _simulation(scene_path(scene), trust_parts=trust_parts, run_builders=run_builders)
    specimen = _specimen(simulation, mesh, None, _Stated(e1, theta1, e2, theta2, backlash))
    plans = planned(specimen, own, numbers("--turns", turns), drift=drift)
    out_console.print(plan_report(plans, specimen, own, simulation.system.name))
    if out is not None:
        write_texts({out.name: plan_table(plans).csv()}, out.parent)
        tell(str(out))


class _Stated(NamedTuple):
    """Options that state the pair instead of the scene."""

    e1: str | None
    theta1: str | None
    e2: str | None
    theta2: str | None
    backlash: str | None


def _unit(
    simulation: "Simulation", mesh: str | None, trial: int | None, engine: RigEngine, options: _Stated
) -> "Specimen | Unit":
    """The unit measured: by closed form as the options state, or by the exact engine as the scene states."""
    from tol3d.apps.records.scene_mesh import SceneMesh
    from tol3d.errors import InputError

    if engine is RigEngine.CLOSED_FORM:
        if SceneMesh.of(simulation, mesh).builds.flanks_deviate:
            warn("single teeth deviate, which the closed form leaves out; --engine exact has them")
        return _specimen(simulation, mesh, trial, options)
    if given := [f"--{name}" for name, text in options._asdict().items() if text is not None]:
        raise InputError(
            f"{', '.join(given)}: of --engine closed_form only; the exact engine takes all from the scene, where "
            "tolerances of constant distributions state a unit"
        )
    return SceneMesh.of(simulation, mesh).unit(trial)


def _specimen(simulation: "Simulation", mesh: str | None, trial: int | None, options: _Stated) -> "Specimen":
    """A trial or the mean build by closed form, with the values of options."""
    from tol3d.apps.records.pair import Specimen
    from tol3d.apps.records.scene_mesh import SceneMesh
    from tol3d.cli.quantity import stated

    def said(option: str, text: str | None, kind: "Kind", otherwise: float) -> float:
        return otherwise if text is None else stated(option, text, kind)

    own = SceneMesh.of(simulation, mesh).specimen(trial)
    return Specimen(
        own.pair,
        said("--e1", options.e1, "length", own.e1),
        said("--theta1", options.theta1, "angle", own.theta1),
        said("--e2", options.e2, "length", own.e2),
        said("--theta2", options.theta2, "angle", own.theta2),
        said("--backlash", options.backlash, "length", own.normal_backlash),
    )


def _simulation(path: Path, *, trust_parts: bool, run_builders: bool) -> "Simulation":
    from tol3d.simulate import load, simulation_of

    return simulation_of(load(path, trust_parts=trust_parts, run_builders=run_builders))
