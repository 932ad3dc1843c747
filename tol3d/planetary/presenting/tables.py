"""Tables of a scene's planetary set."""

from collections.abc import Mapping, Sequence

from tol3d.gearing.links import StatedLink
from tol3d.planetary.model.planetary_set import PlanetarySet
from tol3d.planetary.model.set_mesh import SetMesh
from tol3d.planetary.presenting.efficiencies import set_blocks
from tol3d.planetary.sections import set_sections
from tol3d.planetary.set_link import SetLink
from tol3d.planetary.summary_types import PlanetarySetSummary
from tol3d.planetary.system import PlanetarySystem
from tol3d.reducers.shown import gear_sizes
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, line
from tol3d.report.system_check import system_blocks
from tol3d.runs.summary.shows import Computed, RowOf, Shows
from tol3d.study.simulation import Simulation
from tol3d.system.contributor import Contributor


def check_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Ratio and meshes of the set, then the items of any system."""
    system = simulation.system
    assert isinstance(system, PlanetarySystem)
    sizes = gear_sizes(system.made, system.acts, system.contributors)
    return (*_nominal(system.own, system.summaries), *sizes, *system_blocks(simulation))


def link_blocks(link: StatedLink, contributors: Sequence[Contributor]) -> Sequence[PageItem]:
    """Ratio and meshes of a set in a train, and what shops measure of its gears."""
    assert isinstance(link, SetLink)
    sizes = gear_sizes(link.made, link.acts, contributors)
    return (*_nominal(link.own, set_sections(link.own, link.friction)), *sizes)


class MeshRow(RowOf[SetMesh]):
    """A nominal mesh of a set."""

    teeth = Computed(Shows("teeth", "d"), lambda own: own.of.central.teeth)
    planet_teeth = Computed(Shows("of the planet", "d"), lambda own: own.of.planet.teeth)
    angle = Computed(Shows("working pressure angle", ".4f", "°"), lambda own: own.of.working_pressure_angle)
    backlash = Computed(Shows("normal backlash", ".3f", "µm"), lambda own: 2 * own.of.clearance)
    tight_at = Computed(Shows("tight at a", ".4f", "mm"), lambda own: own.of.tight_centre_distance)


def _nominal(own: PlanetarySet, sections: Mapping[str, PlanetarySetSummary]) -> Sequence[PageItem]:
    """Ratio, meshes and efficiencies of a set, and torques of its spring."""
    ratio = f"{own.name}: {own.input} to {own.output}, {own.held} held: ratio {float(own.ratio):.6g} = {own.ratio}"
    planets = f"{own.planets} planets, centre distance {own.centre_distance:.4f} mm; all teeth meet again after "
    return (
        line(ratio),
        line(f"{planets}{own.period_planet_turns} turns of the planets"),
        declared_table("mesh, nominal", [(mesh.name, MeshRow(mesh)) for mesh in own.meshes]),
        *set_blocks(sections),
    )
