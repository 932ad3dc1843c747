"""Commands that design gears before a scene is written: planetary sets for a wished ratio."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from tol3d.cli.console import out_console, tell


class FamilyName(StrEnum):
    """Kinds of set that are sought."""

    THREE_K = "3k"
    SIMPLE = "simple"
    COMPOUND = "compound"


class GoalName(StrEnum):
    """Goals of a choice of profile shifts."""

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


def design(
    family: FamilyArgument,
    ratio: RatioOption,
    tolerance: ToleranceOption = 0.005,
    planets: PlanetsOption = 3,
    module: ModuleOption = "1 mm",
    pressure_angle: PressureAngle = "20 deg",
    centre_distance: CentreDistance = None,
    least_teeth: LeastTeeth = 12,
    largest_ring: LargestRing = 150,
    sum_difference: SumDifference = 2,
    planet_gap: PlanetGap = "0.5 mm",
    tip_thickness: TipThickness = 0.2,
    tip_clearance: TipClearance = 0.15,
    contact_ratio: ContactRatio = 1.2,
    largest_shift: LargestShift = 1.0,
    optimise: OptimiseOption = GoalName.SMALLEST,
    friction: FrictionOption = 0.08,
    most: MostOption = 10,
    detail: DetailOption = 1,
    scene: SceneNumber = None,
    out: Annotated[Path | None, typer.Option(help="Write the candidates to this CSV file.")] = None,
) -> None:
    """Find tooth numbers, profile shifts and efficiencies of planetary sets that have a ratio and can be assembled."""
    from tol3d.apps.design.candidates import candidate_table, design_report, scene_text
    from tol3d.apps.design.families import FAMILIES, Teeth
    from tol3d.apps.design.optimum import Goal
    from tol3d.apps.design.search import Wish, find
    from tol3d.apps.design.shifted_set import Limits
    from tol3d.apps.design.working_mesh import BasicRack
    from tol3d.cli.quantity import stated
    from tol3d.errors import InputError
    from tol3d.study.runs import write_texts

    wish = Wish(
        family=FAMILIES[family],
        ratio=ratio,
        tolerance=tolerance,
        planets=planets,
        teeth=Teeth(least_teeth, largest_ring, sum_difference),
        rack=BasicRack(stated("--module", module, "length"), stated("--pressure-angle", pressure_angle, "angle")),
        limits=Limits(
            tip_thickness, contact_ratio, tip_clearance, stated("--planet-gap", planet_gap, "length"), largest_shift
        ),
        goal=Goal(optimise.value),
        friction=friction,
        centre_distance=None if centre_distance is None else stated("--centre-distance", centre_distance, "length"),
    )
    found = find(wish, most)
    for option, asked in (("--detail", detail), ("--scene", scene)):
        if asked is not None and asked > len(found.candidates):
            raise InputError(f"{option}: expected a candidate from 1 to {len(found.candidates)}, got {asked}")
    if scene is not None:
        typer.echo(scene_text(found.candidates[scene - 1], wish.family), nl=False)
    else:
        out_console.print(design_report(found, wish, detail))
    if out is not None:
        write_texts({out.name: candidate_table(found, wish.family).csv()}, out.parent)
        tell(str(out))
