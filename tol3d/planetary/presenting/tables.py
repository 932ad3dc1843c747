"""Tables of a scene's planetary set."""

from collections.abc import Sequence

from tol3d.planetary.model.set_mesh import SetMesh
from tol3d.planetary.presenting.efficiencies import set_blocks
from tol3d.planetary.set_link import SetLink
from tol3d.planetary.system import PlanetarySystem
from tol3d.reducers.shown import gear_sizes
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, line
from tol3d.runs.summary.shows import Computed, RowOf, Shows
from tol3d.system.contributor import Contributor


def blocks(reducer: PlanetarySystem | SetLink, contributors: Sequence[Contributor]) -> Sequence[PageItem]:
    """Ratio, meshes and efficiencies of a set, torques of its spring, and what shops measure of its gears."""
    own = reducer.own
    ratio = f"{own.name}: {own.input} to {own.output}, {own.held} held: ratio {float(own.ratio):.6g} = {own.ratio}"
    planets = f"{own.planets} planets, centre distance {own.centre_distance:.4f} mm; all teeth meet again after "
    return (
        line(ratio),
        line(f"{planets}{own.period_planet_turns} turns of the planets"),
        declared_table("mesh, nominal", [(mesh.name, MeshRow(mesh)) for mesh in own.meshes]),
        *set_blocks(reducer.summaries),
        *gear_sizes(reducer.made, reducer.acts, contributors),
    )


class MeshRow(RowOf[SetMesh]):
    """A nominal mesh of a set."""

    teeth = Computed(Shows("teeth", "d"), lambda own: own.of.central.teeth)
    planet_teeth = Computed(Shows("of the planet", "d"), lambda own: own.of.planet.teeth)
    angle = Computed(Shows("working pressure angle", ".4f", "°"), lambda own: own.of.working_pressure_angle)
    backlash = Computed(Shows("normal backlash", ".3f", "µm"), lambda own: 2 * own.of.clearance)
    tight_at = Computed(Shows("tight at a", ".4f", "mm"), lambda own: own.of.tight_centre_distance)
