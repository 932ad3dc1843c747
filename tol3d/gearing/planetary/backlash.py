"""Backlash of the meshes of a planetary set as drawings state it: a central gear and the gear of one planet as a pair.

Planets are alike and the tolerances of each are its own, so one stands for all. Its pin decides the centre distance.
"""

from collections.abc import Iterator, Mapping, Sequence

from tol3d.gearing.effects import AxisOffset, Effect, ToothThickness, TurningOffset
from tol3d.gearing.model import Contributor, Model
from tol3d.gearing.model.model import GearPart
from tol3d.gearing.model.pairs import cylindrical_pair
from tol3d.gearing.planetary.exact.shown import Made
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.model.set_mesh import SetMesh
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gearing.shafts import Mesh
from tol3d.gearing.summary.backlash_stages import CENTRE_DISTANCE, backlash_stages
from tol3d.gearing.summary.types import BacklashLimits
from tol3d.gearing.system import EXACT, GearSystem
from tol3d.gears import RIGHT
from tol3d.study.system import contributor as system_contributor
from tol3d.study.system.copula import INDEPENDENT, Copula
from tol3d.study.system.draw import Draw, Each, Scalar
from tol3d.study.system.each_planar import EachOwn


def pair_meshes(own: PlanetarySet, made: Made) -> list[Mesh]:
    """Meshes of one planet as those of pairs, the central gear as the driver.

    Args:
        own: the set.
        made: its gears by their names, nominal.
    """
    return [
        Mesh(
            mesh.name,
            mesh.central.name,
            mesh.planet.name,
            cylindrical_pair(made[mesh.central.name], made[mesh.planet.name], own.centre_distance),
            RIGHT,
        )
        for mesh in own.meshes
    ]


def set_backlash(
    own: PlanetarySet,
    made: Made,
    contributors: Sequence[system_contributor.Contributor],
    acts: Mapping[str, Acts],
    copula: Copula = INDEPENDENT,
) -> list[BacklashLimits]:
    """Limits of the backlash of each mesh of one planet, of which thickness or the place of the pin has a tolerance.

    Args:
        own: the set.
        made: its gears by their names, nominal.
        contributors: of its system; those of others are left out.
        acts: effect of each contributor, by its name.
        copula: which contributors are correlated.
    """
    found = list[BacklashLimits]()
    for mesh, turned in zip(own.meshes, pair_meshes(own, made), strict=True):
        gears = tuple(GearPart(name, made[name]) for name in (mesh.central.name, mesh.planet.name))
        outwards = 1.0 if turned.pair.wheel_origin[0] > 0.0 else -1.0
        drawn = tuple(_of_pair(mesh, made, contributors, acts, outwards))
        model = Model(mesh.name, gears, (), drawn, (turned,), ())
        found += backlash_stages(model, GearSystem, EXACT, copula)
    return found


def _of_pair(
    mesh: SetMesh,
    made: Made,
    contributors: Sequence[system_contributor.Contributor],
    acts: Mapping[str, Acts],
    outwards: float,
) -> Iterator[Contributor]:
    """Contributors as they act on a pair; of the planets' the draw of one."""
    for own in contributors:
        its = acts.get(own.name)
        effect = None if its is None else _effect(mesh, made, its, outwards)
        if its is not None and effect is not None:
            kind = CENTRE_DISTANCE if isinstance(effect, AxisOffset) else own.kind
            yield Contributor(own.name, kind, effect, _one(own.draw), "um")


def _effect(mesh: SetMesh, made: Made, acts: Acts, outwards: float) -> Effect | None:
    """Effect of a contributor on a pair; None without one."""
    planet = mesh.planet.name
    if acts.effect in ("pin", "pin outwards"):
        return AxisOffset(planet, (outwards, 0.0, 0.0), mesh=mesh.name)
    if acts.gear not in (mesh.central.name, planet):
        return None
    if acts.effect == "thickness":
        return ToothThickness(acts.gear, 0.5 * acts.factor / made[acts.gear].thickness_radius, 0.0, acts.over)
    return TurningOffset(acts.gear) if acts.effect == "offset" else None


def _one(draw: Draw) -> Draw:
    """The draw of one planet; that of a central gear as it is."""
    if isinstance(draw, Each):
        return Scalar(draw.distribution)
    if isinstance(draw, EachOwn):
        one: Draw = draw.each
        return one
    return draw
