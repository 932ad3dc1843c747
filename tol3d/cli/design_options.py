"""Options of `tol3d design`."""

from enum import StrEnum
from typing import Annotated

import typer


class FamilyName(StrEnum):
    """Kinds of set that are sought."""

    THREE_K = "3k"
    SIMPLE = "simple"
    COMPOUND = "compound"


class GoalName(StrEnum):
    """What profile shifts are chosen for."""

    SMALLEST = "smallest"
    FORWARD = "forward"
    BACKWARD = "backward"


FamilyArgument = Annotated[FamilyName, typer.Argument(metavar="3k|simple|compound", help="Kind of planetary set.")]
RatioOption = Annotated[float, typer.Option(help="Speed of the input over the output's; negative: opposite senses.")]
ToleranceOption = Annotated[float, typer.Option(min=0.0, help="Of the ratio, either way.")]
PlanetsOption = Annotated[int, typer.Option(min=1, max=12, help="Alike, at equal angles.")]
ModuleOption = Annotated[str, typer.Option(metavar="LENGTH", help="Of all gears.")]
PressureAngle = Annotated[str, typer.Option(metavar="ANGLE", help="At the reference circle.")]
CentreDistance = Annotated[str | None, typer.Option(metavar="LENGTH", help="Stated; otherwise it is free.")]
LeastTeeth = Annotated[int, typer.Option(min=3, max=200, help="Of sun and planets.")]
LargestRing = Annotated[int, typer.Option(min=10, max=300, help="Teeth of rings.")]
SumDifference = Annotated[int, typer.Option(min=0, max=10, help="Of the tooth sums of two meshes.")]
PlanetGap = Annotated[str, typer.Option(metavar="LENGTH", help="Least, between neighbours' tips.")]
TipThickness = Annotated[float, typer.Option(min=0.0, max=1.0, help="Least, in modules.")]
TipClearance = Annotated[float, typer.Option(min=0.0, max=0.5, help="Least, from the mate's root, in modules.")]
ContactRatio = Annotated[float, typer.Option(min=1.0, max=3.0, help="Least of each mesh.")]
LargestShift = Annotated[float, typer.Option(min=0.0, max=5.0, help="Of any gear either way, in modules.")]
OptimiseOption = Annotated[
    GoalName, typer.Option(help="Profile shifts: the smallest, or for efficiency forward or backward.")
]
FrictionOption = Annotated[float, typer.Option(min=0.0, max=0.3, help="Coefficient in the meshes.")]
MostOption = Annotated[int, typer.Option(min=1, max=200, help="Candidates shown at most.")]
DetailOption = Annotated[int, typer.Option(min=1, metavar="N", help="Candidate shown mesh by mesh.")]
SceneNumber = Annotated[int | None, typer.Option(min=1, metavar="N", help="Print candidate N as a scene instead.")]
