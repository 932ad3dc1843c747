"""Options of `tol3d identify`, `rig` and `plan-rig`."""

from enum import StrEnum
from typing import Annotated

import typer

SceneOption = Annotated[
    str, typer.Option(metavar="SCENE", help="The pair's scene: a file, or the name of one that tol3d brings along.")
]
MeshOption = Annotated[str | None, typer.Option(metavar="NAME", help="Which mesh was on the rig; the only one.")]


class RigEngine(StrEnum):
    """By what a rig knows where flanks touch."""

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
    typer.Option(metavar="N", min=0, help="Trial of the scene's study that is measured; the mean build if not given."),
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
