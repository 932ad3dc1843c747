"""Thicker teeth: both flanks leave their tooth; an arc s at the reference circle takes s cos(alpha)."""

from tol3d.gearing.effects import ToothThickness
from tol3d.gearing.model import Contributor
from tol3d.gearing.stack_up.nominal_mesh import NominalMesh
from tol3d.gearing.stack_up.term import Term
from tol3d.gearing.stack_up.terms.contribution import NOTHING, Contribution, contributes
from tol3d.gears import GearPair


@contributes(ToothThickness)
def _(effect: ToothThickness, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    if (role := mesh.role(effect.part)) is None:
        return NOTHING
    arm = mesh.gear(role).section_arm
    return Contribution(
        opening=Term(contributor, -2 * (effect.turn * arm + effect.offset)),
        by_shifts=Term(contributor, -2 * effect.offset),
        by_turns=Term(contributor, -2 * effect.turn * arm),
    )
