"""Axes that pass each other."""

import math

from tol3d.gearing.effects import AxesOffset
from tol3d.gearing.model import Contributor
from tol3d.gearing.stack_up.nominal_mesh import NominalMesh
from tol3d.gearing.stack_up.term import Term
from tol3d.gearing.stack_up.terms.contribution import NOTHING, Contribution, contributes
from tol3d.gears import BevelPair, GearPair


@contributes(AxesOffset)
def _(effect: AxesOffset, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    if mesh.role(effect.part, effect.mesh) is None:
        return NOTHING
    return Contribution(aside=_aside(mesh, contributor))


@contributes(AxesOffset, BevelPair)
def _(effect: AxesOffset, mesh: NominalMesh[BevelPair], contributor: Contributor) -> Contribution:
    """2 sin(alpha) sin(delta) of the driven gear, as the source has it for its "axial distance".

    That is what a shift along the axis does. An offset across both axes changes nothing in the middle of
    the face, to first order: the 3D simulation shows it.
    """
    if (role := mesh.role(effect.part, effect.mesh)) is None:
        return NOTHING
    opening = Term(contributor, mesh.along(role))
    return Contribution(opening=opening, aside=_aside(mesh, contributor), claimed=opening)


def _aside(mesh: NominalMesh[GearPair], contributor: Contributor) -> Term:
    """The driven axis lies at +y of the world."""
    own = mesh.pair.world_from_wheel.T @ (0.0, 1.0, 0.0)
    azimuth = mesh.azimuth_onwards("driven")
    return Term(contributor, mesh.cos * float(own[0] * math.cos(azimuth) + own[1] * math.sin(azimuth)))
