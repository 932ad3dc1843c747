"""Parts that grow. Of bevel pairs growth is left out: a pair of one material only scales."""

from tol3d.gearing.effects import Temperature
from tol3d.gearing.model import Contributor
from tol3d.gearing.stack_up.nominal_mesh import NominalMesh
from tol3d.gearing.stack_up.term import Term
from tol3d.gearing.stack_up.terms.contribution import NOTHING, Contribution, contributes
from tol3d.gears import GearPair, InternalPair, SpurPair


@contributes(Temperature)
def _(effect: Temperature, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    return NOTHING


@contributes(Temperature, SpurPair)
def _(effect: Temperature, mesh: NominalMesh[SpurPair], contributor: Contributor) -> Contribution:
    return _growing(effect, mesh, contributor)


@contributes(Temperature, InternalPair)
def _(effect: Temperature, mesh: NominalMesh[InternalPair], contributor: Contributor) -> Contribution:
    return _growing(effect, mesh, contributor)


def _growing(effect: Temperature, mesh: NominalMesh[SpurPair | InternalPair], contributor: Contributor) -> Contribution:
    """A growing housing opens by 2 a sin(alpha_w), a growing gear closes by 2 r_w sin(alpha_w), per strain.

    Inside a ring the housing closes, and the ring opens. Taken at the pitch point: two gears of one material with the
    housing only scale, to first order.
    """
    gears = (mesh.mesh.driver, mesh.mesh.driven)
    pair = mesh.pair
    signs = [gear.iso_sign for gear in (pair.pinion, pair.wheel)]
    strain = {part: -sign * r for part, sign, r in zip(gears, signs, pair.working_radii, strict=True)}
    if mesh.mesh.housing:
        strain[mesh.mesh.housing] = pair.iso_sign * pair.centre_distance
    touched = [part for part in effect.parts if part in strain]
    if not touched:
        return NOTHING
    expansions = mesh.model.expansions
    return Contribution(
        opening=Term(contributor, sum(2 * mesh.sin * strain[part] * expansions[part] for part in touched)),
        strains=tuple((part, Term(contributor, expansions[part])) for part in dict.fromkeys(touched)),
    )
