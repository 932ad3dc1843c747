"""What a scene's planetary set is, in tables."""

import math
from collections.abc import Mapping, Sequence

from tol3d.gearing.presenting.scene_check import mechanics_blocks
from tol3d.gearing.system import gear_model
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.presenting.efficiencies import set_blocks
from tol3d.planetary.sections import set_sections
from tol3d.planetary.stage.set_link import SetLink
from tol3d.planetary.summary_types import PlanetarySetSummary
from tol3d.planetary.system import PlanetarySystem
from tol3d.report.page import Heading, PageItem, Row, Table, line
from tol3d.report.system_check import system_blocks
from tol3d.study.simulation import Simulation


def check_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Ratio and meshes of the set, of a train with sets its gears and shafts too; then what any system shows."""
    system = simulation.system
    if isinstance(system, PlanetarySystem):
        return (*_nominal(system.own, system.summaries), *system_blocks(simulation))
    model = gear_model(system)
    links = [link for link in model.links if isinstance(link, SetLink)]
    sets = [block for link in links for block in _nominal(link.own, set_sections(link.own, link.friction))]
    return (*sets, *mechanics_blocks(model), *system_blocks(simulation))


def _nominal(own: PlanetarySet, sections: Mapping[str, PlanetarySetSummary]) -> Sequence[PageItem]:
    """Ratio, meshes and efficiencies of a set, and torques of its spring."""
    rows = [
        Row(
            mesh.name,
            [
                f"{mesh.central.teeth}",
                f"{mesh.planet.teeth}",
                f"{math.degrees(mesh.working_pressure_angle):.4f}",
                f"{2e3 * mesh.clearance:z.3f}",
                f"{mesh.tight_centre_distance:.4f}",
            ],
        )
        for mesh in own.meshes
    ]
    heads = ("teeth", "of the planet", "working pressure angle [°]", "normal backlash [µm]", "tight at a [mm]")
    ratio = f"{own.name}: {own.input} to {own.output}, {own.held} held: ratio {float(own.ratio):.6g} = {own.ratio}"
    planets = f"{own.planets} planets, centre distance {own.centre_distance:.4f} mm; all teeth meet again after "
    return (
        line(ratio),
        line(f"{planets}{own.period_planet_turns} turns of the planets"),
        Table("mesh, nominal", [Heading(head) for head in heads], rows),
        *set_blocks(sections),
    )
