"""Centres off their axes: a shift across the axis that turns with its gear."""

import math

from tol3d.gearing.effects import TurningOffset
from tol3d.gearing.model import Contributor
from tol3d.gearing.stack_up.nominal_mesh import NominalMesh, as_counted
from tol3d.gearing.stack_up.term import Term
from tol3d.gearing.stack_up.terms.contribution import NOTHING, Contribution, contributes
from tol3d.gears import GearPair


@contributes(TurningOffset)
def _(effect: TurningOffset, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    if (role := mesh.role(effect.part)) is None:
        return NOTHING
    plane = effect.plane.seen_from(-mesh.seat(role).ahead)
    away, sense = as_counted(plane, mesh.azimuth_away(role))
    onwards, _ = as_counted(plane, mesh.azimuth_onwards(role))
    opening = Term(contributor, mesh.across(role), along=away, turns=role, sense=sense)
    towards_line = (-1.0 if role == "driver" else 1.0) * math.sin(mesh.gear(role).pitch_angle)
    return Contribution(
        opening=opening,
        aside=Term(contributor, mesh.cos, along=onwards, turns=role, sense=sense),
        by_shifts=opening,
        along_line=opening.times(towards_line / mesh.across(role)),
    )
