"""Axes beside their place.

Across the axis 2 sin(alpha_w) cos(delta) away from the mesh, along it 2 sin(alpha_w) sin(delta) away from the apex.
"""

import math

from tol3d.gearing.effects import AxisOffset
from tol3d.gearing.model import Contributor
from tol3d.gearing.stack_up.nominal_mesh import NominalMesh, as_counted
from tol3d.gearing.stack_up.term import Role, Term
from tol3d.gearing.stack_up.terms.contribution import NOTHING, Contribution, contributes
from tol3d.gears import GearPair


@contributes(AxisOffset)
def _(effect: AxisOffset, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    if (role := mesh.role(effect.part, effect.mesh)) is None:
        return NOTHING
    if len(contributor.draw.components) == 2:
        return _anywhere(effect, mesh, contributor, role)
    return _along_direction(effect, mesh, contributor, role)


def _anywhere(effect: AxisOffset, mesh: NominalMesh[GearPair], contributor: Contributor, role: Role) -> Contribution:
    away, sense = as_counted(effect.plane, mesh.on_shaft(mesh.azimuth_away(role), role, effect.mesh))
    onwards, _ = as_counted(effect.plane, mesh.on_shaft(mesh.azimuth_onwards(role), role, effect.mesh))
    opening = Term(contributor, mesh.across(role) * effect.factor, along=away, sense=sense)
    return Contribution(
        opening=opening,
        aside=Term(contributor, mesh.cos * effect.factor, along=onwards, sense=sense),
        by_shifts=opening,
        along_line=opening.times(-_sense(role) * math.sin(mesh.gear(role).pitch_angle) / mesh.across(role)),
    )


def _along_direction(
    effect: AxisOffset, mesh: NominalMesh[GearPair], contributor: Contributor, role: Role
) -> Contribution:
    """A shift towards the mesh moves the apex along the pitch line by sin(delta), one along the axis by cos(delta)."""
    x, y, z = effect.direction
    away = mesh.on_shaft(mesh.azimuth_away(role), role, effect.mesh)
    onwards = mesh.on_shaft(mesh.azimuth_onwards(role), role, effect.mesh)
    leaving = x * math.cos(away) + y * math.sin(away)
    opening = Term(contributor, effect.factor * (mesh.across(role) * leaving + mesh.along(role) * z))
    delta, lengthwise = mesh.gear(role).pitch_angle, effect.factor * z
    left = (opening.coefficient - mesh.along(role) * lengthwise) / mesh.across(role)
    return Contribution(
        opening=opening,
        aside=Term(contributor, mesh.cos * effect.factor * (x * math.cos(onwards) + y * math.sin(onwards))),
        by_shifts=opening,
        along_line=Term(contributor, _sense(role) * (math.cos(delta) * lengthwise - math.sin(delta) * left)),
    )


def _sense(role: Role) -> float:
    """Sign with which a shift of a gear's apex along the pitch line counts: the driver's less the driven gear's."""
    return 1.0 if role == "driver" else -1.0
