"""Flanks that deviate one by one are no term of a sum: which pair touches first decides, see tooth_pairs.py."""

from tol3d.gearing.effects import FlankDeviation
from tol3d.gearing.model import Contributor
from tol3d.gearing.stack_up.nominal_mesh import NominalMesh
from tol3d.gearing.stack_up.terms.contribution import NOTHING, Contribution, contributes
from tol3d.gears import GearPair


@contributes(FlankDeviation)
def _(effect: FlankDeviation, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    return NOTHING
