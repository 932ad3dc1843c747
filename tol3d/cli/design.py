"""Commands that design gears before a scene is written: planetary sets for a wished ratio."""

from pathlib import Path
from typing import Annotated

import typer

from tol3d.cli.console import out_console, tell
from tol3d.cli.design_options import (
    CentreDistance,
    ContactRatio,
    DetailOption,
    FamilyArgument,
    FrictionOption,
    GoalName,
    LargestRing,
    LargestShift,
    LeastTeeth,
    ModuleOption,
    MostOption,
    OptimiseOption,
    PlanetGap,
    PlanetsOption,
    PressureAngle,
    RatioOption,
    SceneNumber,
    SumDifference,
    TipClearance,
    TipThickness,
    ToleranceOption,
)


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
    from tol3d.errors import InputError
    from tol3d.planetary.design.candidates import candidate_table, design_report, scene_text
    from tol3d.planetary.design.families import FAMILIES, Teeth
    from tol3d.planetary.design.optimum import Goal
    from tol3d.planetary.design.search import Wish, find
    from tol3d.planetary.design.shifted_set import Limits
    from tol3d.planetary.design.working_mesh import BasicRack
    from tol3d.records.folder import write_texts
    from tol3d.records.quantity import stated

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
