"""Axes that lean: cylinders lose backlash at an end of the face, cones change their shaft angle."""

import math

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.effects import AxisTilt
from tol3d.gearing.model import Contributor
from tol3d.gearing.stack_up.nominal_mesh import NominalMesh
from tol3d.gearing.stack_up.term import Role, Term
from tol3d.gearing.stack_up.terms.contribution import NOTHING, Contribution, contributes
from tol3d.gears import BevelPair, GearPair, InternalPair, SpurPair

Array = NDArray[np.float64]


@contributes(AxisTilt, SpurPair)
def _(effect: AxisTilt, mesh: NominalMesh[SpurPair], contributor: Contributor) -> Contribution:
    return _leaning(effect, mesh, contributor)


@contributes(AxisTilt, InternalPair)
def _(effect: AxisTilt, mesh: NominalMesh[InternalPair], contributor: Contributor) -> Contribution:
    return _leaning(effect, mesh, contributor)


@contributes(AxisTilt, BevelPair)
def _(effect: AxisTilt, mesh: NominalMesh[BevelPair], contributor: Contributor) -> Contribution:
    """Shaft angle: 2 R_m sin(alpha) about the apex.

    About a point of the gear's axis at the distance h from the apex 2 h sin(alpha) cos(delta) less, which is what the
    shift of the apex towards the mesh takes. A turn out of the plane of the axes changes nothing.
    """
    if (role := mesh.role(effect.part, effect.mesh)) is None:
        return NOTHING
    turns = _turns(effect, mesh, contributor, role)
    delta, sense = mesh.gear(role).pitch_angle, 1.0 if role == "driver" else -1.0
    mean = mesh.pair.mean_cone_distance
    _, y = turns
    per_turn = -2 * mesh.sin * (mean - effect.pivot * math.cos(delta))
    if len(y) == 1:
        opening = Term(contributor, per_turn * float(y[0]))
    else:
        opening = Term(contributor, per_turn * math.hypot(*y), along=math.atan2(y[1], y[0]))
    return Contribution(
        opening=opening,
        by_shifts=_turned(contributor, turns, per_y=mesh.across(role) * effect.pivot),
        by_turns=_turned(contributor, turns, per_y=-2 * mesh.sin * mean),
        aside_by_turns=_turned(contributor, turns, per_x=mesh.cos * effect.pivot),
        along_line=_turned(contributor, turns, per_y=-sense * math.sin(delta) * effect.pivot),
    )


def _leaning(effect: AxisTilt, mesh: NominalMesh[SpurPair | InternalPair], contributor: Contributor) -> Contribution:
    """The tighter end of the face loses b/2 times the tilt on each flank side.

    In plane (about y): b sin(alpha_w); out of plane (about x): b cos(alpha_w); b the smaller face width. `Stack.lost`
    decides which ends are the tighter ones; the loss is one-sided and shifts the mean. A flank side that is read in
    the middle of the face loses nothing, nor do gears that lean alike: a driver's lean counts against its mate's.
    """
    if (role := mesh.role(effect.part, effect.mesh)) is None:
        return NOTHING
    sides = [mesh.reading.contact, mesh.reading.gap].count("face")
    half_width = min(mesh.pair.pinion.face_width, mesh.pair.wheel.face_width) / 2
    per_tilt = sides * half_width * (-1 if role == "driver" else 1)
    x, y = _turns(effect, mesh, contributor, role)
    away = math.cos(mesh.azimuth_away("driven"))  # -1 where the driven axis at +x lies nearer to the ring's teeth
    in_plane, across = per_tilt * away * mesh.sin * y, per_tilt * mesh.cos * x
    largest = float(np.abs([in_plane, across]).max())
    return Contribution(Term(contributor, largest, tilts=(tuple(in_plane.tolist()), tuple(across.tolist()))))


def _turns(effect: AxisTilt, mesh: NominalMesh[GearPair], contributor: Contributor, role: Role) -> tuple[Array, Array]:
    """x and y of the rotation vector of a gear's axis per component [rad/mm], in its frame at rest in the mesh."""
    azimuth = mesh.on_shaft(0.0, role, effect.mesh)
    if len(contributor.draw.components) == 2:
        x, y, _ = effect.matrix(azimuth)
        return x, y
    cos, sin, (x, y, _) = math.cos(azimuth), math.sin(azimuth), effect.axis
    return effect.per_length * np.array([cos * x + sin * y]), effect.per_length * np.array([cos * y - sin * x])


def _turned(contributor: Contributor, turns: tuple[Array, Array], *, per_y: float = 0.0, per_x: float = 0.0) -> Term:
    """A change by the turns of a gear's axis about x and y of its frame at rest in the mesh."""
    x, y = turns
    per = per_x * x + per_y * y
    if len(per) == 1:
        return Term(contributor, float(per[0]))
    return Term(contributor, math.hypot(*per), along=math.atan2(per[1], per[0]))
