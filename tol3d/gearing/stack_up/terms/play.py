"""Deviations of links and gears that sit turned on their shafts: no mesh sees them."""

from tol3d.gearing.effects import Clocking, LinkDeviation
from tol3d.gearing.model import Contributor
from tol3d.gearing.stack_up.nominal_mesh import NominalMesh
from tol3d.gearing.stack_up.terms.contribution import NOTHING, Contribution, contributes
from tol3d.gears import GearPair


@contributes(LinkDeviation)
def _(effect: LinkDeviation, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    return NOTHING


@contributes(Clocking)
def _(effect: Clocking, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    return NOTHING
