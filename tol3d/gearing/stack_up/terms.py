"""First-order terms of effects, derived without the geometric method.

Each effect registers its own, external ones by `contributes`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from tol3d.gearing.effects import (
    AxesOffset,
    AxialPlay,
    AxisOffset,
    AxisTilt,
    Clocking,
    FlankDeviation,
    LinkDeviation,
    Temperature,
    ToothThickness,
    TurningOffset,
)
from tol3d.gearing.model import Contributor, Effect
from tol3d.gearing.stack_up.term import NominalMesh, Role, Term, as_counted
from tol3d.gears import BevelPair, GearPair, InternalPair, SpurPair
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class Contribution:
    """First-order effect in one mesh, and the parts of it that a stack-up neglects, for its bounds.

    Args:
        opening: change of the normal backlash [mm].
        aside: shift [mm] of the middle of the driven gear's play, along the flanks' normals; positive turns the driven
            gear in the positive sense about its z.
        strains: of parts that grow [1/K], by name.
        by_shifts, by_turns: of the opening, the part that is constant over the face, and the one that grows with the
            distance from the apex of a cone.
        aside_by_turns: a shift of that middle not in `aside`, by turns about a pivot that is not the apex.
        along_line: shift of the driver's apex less the driven gear's, along the pitch line [mm].
        claimed: of the opening, the part that a source claims and the geometry does not show.
    """

    opening: Term | None = None
    aside: Term | None = None
    strains: tuple[tuple[str, Term], ...] = ()
    by_shifts: Term | None = None
    by_turns: Term | None = None
    aside_by_turns: Term | None = None
    along_line: Term | None = None
    claimed: Term | None = None


NOTHING = Contribution()

Law = Callable[[Any, Any, Contributor], Contribution]
F = TypeVar("F", bound=Law)

_KNOWN: dict[tuple[type[Effect], type | None], Law] = {}


def contributes(effect: type[Effect], pair: type[GearPair] | None = None) -> Callable[[F], F]:
    """Register the contribution of an effect in meshes of one kind of pair, or of every kind without its own.

    The registered function is called with the effect, the mesh and the contributor.
    """

    def register(function: F) -> F:
        _KNOWN[effect, pair] = function
        return function

    return register


def contribution(effect: Effect, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    """Contribution of an effect in a mesh.

    Raises:
        TypeError: nothing is registered for it.
    """
    for pair in (*type(mesh.pair).__mro__, None):
        if function := _KNOWN.get((type(effect), pair)):
            return function(effect, mesh, contributor)
    raise TypeError(f"stack_up/terms.py has no function for the effect {type(effect).__name__}")


def of_both_loads(drive: Contribution, coast: Contribution, mesh: NominalMesh[GearPair]) -> tuple[Contribution, ...]:
    """Contributions of an effect to a free turn whose ends are read where either load pushes the shafts.

    With o the opening and a the shift of the middle, the driven gear rests at a - s o/2 on the working flanks and at
    a + s o/2 on the others, s its own working flank. From the first under one load to the second under the other one it
    turns by s (a' - a) + (o + o')/2, with the middle at (a + a')/2 + s (o' - o)/4. Tilts take from each flank side by
    itself, i + w c from the working one and i - w c from the other one, i in the plane of the axes and c across it, w
    the driver's working flank.
    """
    found, side, own = list[Contribution](), mesh.mesh.driven_flank, mesh.mesh.working_flank
    tilted, leant = drive.opening, coast.opening
    if tilted and leant and tilted.tilts and leant.tilts:
        (first, first_across), (last, last_across) = np.array(tilted.tilts), np.array(leant.tilts)
        working, other = first + own * first_across, last - own * last_across
        in_plane, across = (working + other) / 2, own * (working - other) / 2
        largest = float(np.abs([in_plane, across]).max())
        tilts = tuple(in_plane.tolist()), tuple(across.tolist())
        found.append(Contribution(replace(tilted, coefficient=largest, tilts=tilts)))
        drive, coast = replace(drive, opening=None), replace(coast, opening=None)
    contributor = next((term.contributor for term in (drive.opening, drive.aside) if term), None)
    if contributor is None:
        return tuple(found)
    opened, opens = (load.opening.coefficient if load.opening else 0.0 for load in (drive, coast))
    stood, stands = (load.aside.coefficient if load.aside else 0.0 for load in (drive, coast))
    opening = Term(contributor, (opened + opens) / 2 + side * (stands - stood))
    aside = Term(contributor, (stood + stands) / 2 + side * (opens - opened) / 4)
    found.append(replace(drive, opening=opening, aside=aside, by_shifts=opening if drive.by_shifts else None))
    return tuple(found)


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


@contributes(AxisOffset)
def _(effect: AxisOffset, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    """Across the axis 2 sin(alpha_w) cos(delta) away from the mesh, along it 2 sin(alpha_w) sin(delta) off the apex."""
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
    """A shift towards the mesh moves the apex along the pitch line by sin(delta), one along the axis by cos(delta).

    A helical gear screws in its mate's teeth as it moves along its axis: the driven one turns, and nothing opens.
    """
    x, y, z = effect.direction
    away = mesh.on_shaft(mesh.azimuth_away(role), role, effect.mesh)
    onwards = mesh.on_shaft(mesh.azimuth_onwards(role), role, effect.mesh)
    leaving = x * math.cos(away) + y * math.sin(away)
    turning = x * math.cos(onwards) + y * math.sin(onwards)
    opening = Term(contributor, effect.factor * (mesh.across(role) * leaving + mesh.along(role) * z))
    delta, lengthwise = mesh.gear(role).pitch_angle, effect.factor * z
    left = (opening.coefficient - mesh.along(role) * lengthwise) / mesh.across(role)
    return Contribution(
        opening=opening,
        aside=Term(contributor, mesh.cos * effect.factor * turning + mesh.screwed(role) * effect.factor * z),
        by_shifts=opening,
        along_line=Term(contributor, _sense(role) * (math.cos(delta) * lengthwise - math.sin(delta) * left)),
    )


def _sense(role: Role) -> float:
    """Sign with which a shift of a gear's apex along the pitch line counts: the driver's less the driven gear's."""
    return 1.0 if role == "driver" else -1.0


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


@contributes(AxisTilt, SpurPair)
@contributes(AxisTilt, InternalPair)
def _leaning(effect: AxisTilt, mesh: NominalMesh[SpurPair | InternalPair], contributor: Contributor) -> Contribution:
    """The tighter end of the face loses b/2 times the tilt on each flank side.

    In plane (about y): b sin(alpha_w); out of plane (about x): b cos(alpha_w); b the smaller face width. `Stack.lost`
    decides which ends are the tighter ones; the loss is one-sided and shifts the mean. A flank side that is read in
    the middle of the face loses nothing, nor do gears that lean alike: a driver's lean counts against its mate's. Of
    helical gears b/2 stands for the end of the face; see HelicalStack for the contact lines, which end elsewhere too. A
    turn in the plane of the axes moves the teeth at the mesh along the axis, r_w of it: they screw.
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
    opening = Term(contributor, largest, tilts=(tuple(in_plane.tolist()), tuple(across.tolist())))
    if not mesh.pair.pinion.helix_angle:
        return Contribution(opening)
    towards = math.cos(mesh.pair.mesh_azimuths[0 if role == "driver" else 1])  # the mesh, from the gear's axis
    radius = mesh.pair.working_radii[0 if role == "driver" else 1]
    screwed = -mesh.screwed(role) * towards * radius  # its teeth there move along the axis against the turn about y
    return Contribution(opening, aside=_turned(contributor, (x, y), per_y=screwed))


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


@contributes(FlankDeviation)
@contributes(LinkDeviation)
@contributes(Clocking)
@contributes(AxialPlay)
@contributes(Temperature)
def _nothing(effect: Effect, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    """No term of a sum.

    Of single flanks the pair that touches first decides, see tooth_pairs.py; no mesh sees links, nor how gears sit on
    their shafts and these slide; a bevel pair of one material only scales as it grows.
    """
    return NOTHING


@contributes(Temperature, SpurPair)
@contributes(Temperature, InternalPair)
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


@contributes(ToothThickness)
def _(effect: ToothThickness, mesh: NominalMesh[GearPair], contributor: Contributor) -> Contribution:
    """Both flanks leave their tooth; an arc s at the reference circle takes s cos(alpha)."""
    if (role := mesh.role(effect.part)) is None:
        return NOTHING
    arm = mesh.gear(role).section_arm
    return Contribution(
        opening=Term(contributor, -2 * (effect.turn * arm + effect.offset)),
        by_shifts=Term(contributor, -2 * effect.offset),
        by_turns=Term(contributor, -2 * effect.turn * arm),
    )


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
