"""Normal backlash of a pair of gears: the nominal one plus the first-order change by each deviation.

What spur and bevel pairs share; each kind of pair has its own file for what it does not. alpha_w is the working
pressure angle, delta the pitch angle of a gear (0 for a cylinder).
Source: Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, 1533-1542, sections 2.1 and 3.1, where
alpha_w = alpha and delta = 45 deg.
"""

import math
from functools import singledispatchmethod
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import (
    AxesOffset,
    AxisOffset,
    AxisTilt,
    Clocking,
    Contributor,
    Mesh,
    Model,
    Reading,
    ReducerBacklash,
    Seat,
    Temperature,
    ToothThickness,
    TurningOffset,
)
from tol3d.gearing.model.effects import Effect, Plane
from tol3d.gearing.stack_up.neglect import Neglect
from tol3d.gearing.stack_up.term import Role, Term
from tol3d.gears import Gear, GearPair

Array = NDArray[np.float64]
Pair = TypeVar("Pair", bound=GearPair, covariant=True)


class Stack(Generic[Pair]):
    """The stack-up of one mesh of a model, for a way of reading it; `pair` is the mesh's."""

    def __init__(self, model: Model, mesh: Mesh, pair: Pair, reading: Reading) -> None:
        self.model = model
        self.mesh = mesh
        self.pair = pair
        self.reading = reading
        self.sin = math.sin(pair.working_pressure_angle)
        self.cos = math.cos(pair.working_pressure_angle)
        self.terms = tuple(
            term
            for contributor in model.contributors
            for effect in contributor.effect.singles
            if (term := self._term(effect, contributor))
        )
        self.sideways = tuple(
            term
            for contributor in model.contributors
            for effect in contributor.effect.singles
            if (term := self._sideways(effect, contributor))
        )

    @property
    def nominal(self) -> float:
        """j_bn of the nominal pair [mm], exact."""
        return self.pair.normal_backlash

    def normal_backlash(self, deviations: Array, driver_angle: Array) -> Array:
        """j_bn [mm], (rows,), of deviations (rows, components) at the driver's turns [rad] (rows,)."""
        angles = (driver_angle, self.pair.driven_angle(driver_angle))
        total = np.full(len(deviations), self.nominal)
        for term in (term for term in self.terms if term.tilts is None):
            total = total + term.change(deviations[:, self.model.component_slices[term.contributor.name]], angles)
        return total - self.lost(*self._lost_by_tilts(deviations))

    @property
    def both_sides_alike(self) -> bool:
        """Whether both flank sides are read at the same place of the face; else tilts count on the working one only."""
        return self.reading.contact == self.reading.gap

    def lost(self, in_plane: Array, across: Array) -> Array:
        """Normal backlash [mm] that tilts take, (rows,), of what they take in the plane of the axes and across it.

        Half a face times |a + b| on the side of the driver's right flanks, |a - b| on the other: 2 max(|a|, |b|) of
        both together.
        """
        if self.both_sides_alike:
            return np.maximum(np.abs(in_plane), np.abs(across))
        return np.abs(in_plane + self.mesh.working_flank * across)

    def _lost_by_tilts(self, deviations: Array) -> tuple[Array, Array]:
        """What tilts in the plane of the axes and across it take from the flank sides that are read over the face.

        Signed [mm], (rows,).

        The ends of the face at which the two count are the same on one flank side and opposite on the other.
        """
        in_plane, across = np.zeros(len(deviations)), np.zeros(len(deviations))
        for term in self.terms:
            if term.tilts is not None:
                own = deviations[:, self.model.component_slices[term.contributor.name]]
                for column, (by_plane, by_across) in zip(own.T, zip(*term.tilts, strict=True), strict=True):
                    in_plane = in_plane + by_plane * column
                    across = across + by_across * column
        return in_plane, across

    def aside(self, deviations: Array, driver_angle: Array) -> Array:
        """Way [mm], (rows,), by which the middle of the driven gear's play lies aside, along its flanks' normals.

        A gear that moves along the teeth's path at the mesh takes its mate with it, or leaves its own teeth behind:
        cos(alpha_w) of that way. A gear that leans both in the plane of the axes and across it loses more on one flank
        side, half a face times |a + b|, than on the other, |a - b|. Positive turns the driven gear in the positive
        sense about its z.
        """
        angles = (driver_angle, self.pair.driven_angle(driver_angle))
        in_plane, across = self._lost_by_tilts(deviations)
        if self.both_sides_alike:
            total = (np.abs(in_plane + across) - np.abs(in_plane - across)) / 4
        else:
            total = self.mesh.working_flank * self.lost(in_plane, across) / 2
        for term in self.sideways:
            total = total + term.change(deviations[:, self.model.component_slices[term.contributor.name]], angles)
        return total

    # one function an effect -------------------------------------------------------------------------

    @singledispatchmethod
    def _term(self, effect: Effect, contributor: Contributor) -> Term | None:
        raise TypeError(f"stack.py has no function for the effect {type(effect).__name__}")

    def role(self, part: str, mesh: str | None = None) -> Role | None:
        """What the part is in this mesh; None where it is in others only, or is meant to act in another one."""
        if mesh not in (None, self.mesh.name):
            return None
        return "driver" if part == self.mesh.driver else "driven" if part == self.mesh.driven else None

    def gear(self, role: Role) -> Gear:
        """The gear of that role."""
        return self.pair.pinion if role == "driver" else self.pair.wheel

    def _away(self, role: Role) -> float:
        """Azimuth [rad], in the gear's frame at rest in the mesh, in which its axis leaves the mesh."""
        return (self.pair.mesh_azimuths[0 if role == "driver" else 1] + math.pi) % (2 * math.pi)

    def _away_on_shaft(self, role: Role, mesh: str | None) -> float:
        """The same in its frame at rest on its shaft, or in that of the mesh where the deviation is the mesh's."""
        return self._away(role) + (self._seat(role).azimuth if mesh is None else 0.0)

    def _seat(self, role: Role) -> Seat:
        """The place of the gear of that role in this mesh."""
        gear = self.mesh.driver if role == "driver" else self.mesh.driven
        return self.model.seats[self.model.seat_index[self.mesh.name, gear]]

    def _seen_turning(self, plane: Plane, azimuth: float, role: Role) -> tuple[float, float]:
        """See `_seen`, of a deviation that turns with its gear."""
        return _seen(plane.seen_from(-self._seat(role).ahead), azimuth)

    def turns_of(self, effect: AxisTilt, contributor: Contributor, role: Role) -> tuple[Array, Array]:
        """x and y of the rotation vector of a gear's axis per component [rad/mm], in its frame at rest in the mesh."""
        azimuth = self._seat(role).azimuth if effect.mesh is None else 0.0
        if len(contributor.draw.components) == 2:
            x, y, _ = effect.matrix(azimuth)
            return x, y
        cos, sin, (x, y, _) = math.cos(azimuth), math.sin(azimuth), effect.axis
        return effect.per_length * np.array([cos * x + sin * y]), effect.per_length * np.array([cos * y - sin * x])

    def _across(self, role: Role) -> float:
        """Opening by a shift of the axis away from the mesh: 2 sin(alpha_w) cos(delta)."""
        return 2 * self.sin * math.cos(self.gear(role).pitch_angle)

    @_term.register
    def _(self, effect: ToothThickness, contributor: Contributor) -> Term | None:
        """Both flanks leave their tooth: an arc s at the reference circle takes s cos(alpha)."""
        role = self.role(effect.part)
        if role is None:
            return None
        return Term(contributor, -2 * (effect.turn * self.gear(role).section_arm + effect.offset))

    @_term.register
    def _(self, effect: TurningOffset, contributor: Contributor) -> Term | None:
        role = self.role(effect.part)
        if role is None:
            return None
        along, sense = self._seen_turning(effect.plane, self._away(role), role)
        return Term(contributor, self._across(role), along=along, turns=role, sense=sense)

    @_term.register
    def _(self, effect: AxisOffset, contributor: Contributor) -> Term | None:
        """Across the axis as above; along it, away from the apex, 2 sin(alpha_w) sin(delta)."""
        role = self.role(effect.part, effect.mesh)
        if role is None:
            return None
        away = self._away_on_shaft(role, effect.mesh)
        if len(contributor.draw.components) == 2:
            along, sense = _seen(effect.plane, away)
            return Term(contributor, self._across(role) * effect.factor, along=along, sense=sense)
        x, y, z = effect.direction
        leaving = x * math.cos(away) + y * math.sin(away)
        along_axis = 2 * self.sin * math.sin(self.gear(role).pitch_angle) * z
        return Term(contributor, effect.factor * (self._across(role) * leaving + along_axis))

    @_term.register
    def _(self, effect: AxisTilt, contributor: Contributor) -> Term | None:
        role = self.role(effect.part, effect.mesh)
        return None if role is None else self.tilt(effect, contributor, role)

    @_term.register
    def _(self, effect: AxesOffset, contributor: Contributor) -> Term | None:
        role = self.role(effect.part, effect.mesh)
        return None if role is None else self.axes_offset(contributor, role)

    @_term.register
    def _(self, effect: Temperature, contributor: Contributor) -> Term | None:
        return self.temperature(effect, contributor)

    @_term.register
    def _(self, effect: ReducerBacklash, contributor: Contributor) -> Term | None:
        return None

    @_term.register
    def _(self, effect: Clocking, contributor: Contributor) -> Term | None:
        return None

    @singledispatchmethod
    def _sideways(self, effect: Effect, contributor: Contributor) -> Term | None:
        """What moves both rests alike; thickness and temperature do not, to first order, for tilts see `aside`."""
        return None

    @_sideways.register
    def _(self, effect: TurningOffset, contributor: Contributor) -> Term | None:
        role = self.role(effect.part)
        if role is None:
            return None
        along, sense = self._seen_turning(effect.plane, self._sideways_azimuth(role), role)
        return Term(contributor, self.cos, along=along, turns=role, sense=sense)

    @_sideways.register
    def _(self, effect: AxisOffset, contributor: Contributor) -> Term | None:
        role = self.role(effect.part, effect.mesh)
        if role is None:
            return None
        azimuth = self._sideways_azimuth(role)
        azimuth += self._seat(role).azimuth if effect.mesh is None else 0.0
        if len(contributor.draw.components) == 2:
            along, sense = _seen(effect.plane, azimuth)
            return Term(contributor, self.cos * effect.factor, along=along, sense=sense)
        x, y, _ = effect.direction
        return Term(contributor, self.cos * effect.factor * (x * math.cos(azimuth) + y * math.sin(azimuth)))

    @_sideways.register
    def _(self, effect: AxesOffset, contributor: Contributor) -> Term | None:
        """The driven axis lies at +y of the world."""
        if self.role(effect.part, effect.mesh) is None:
            return None
        own = self.pair.world_from_wheel.T @ (0.0, 1.0, 0.0)
        azimuth = self._sideways_azimuth("driven")
        return Term(contributor, self.cos * float(own[0] * math.cos(azimuth) + own[1] * math.sin(azimuth)))

    def _sideways_azimuth(self, role: Role) -> float:
        """Azimuth [rad], in the gear's frame at rest in the mesh, of a shift that turns the driven gear positively.

        The driven gear's teeth go on where its shift takes them back; the driver's take them along.
        """
        towards = self.pair.mesh_azimuths[1]
        onwards = np.array([-math.sin(towards), math.cos(towards), 0.0])  # way of the driven teeth at the mesh
        if role == "driven":
            return math.atan2(-onwards[1], -onwards[0])
        x, y, _ = self.pair.world_from_wheel @ onwards
        return math.atan2(y, x)

    # what each kind of pair says for itself ---------------------------------------------------------

    def tilt(self, effect: AxisTilt, contributor: Contributor, role: Role) -> Term | None:
        """Change by a turn of a gear's axis."""
        return None

    def axes_offset(self, contributor: Contributor, role: Role) -> Term | None:
        """Change by axes that pass each other."""
        return None

    def temperature(self, effect: Temperature, contributor: Contributor) -> Term | None:
        """Change by parts that grow."""
        return None

    @property
    def neglects(self) -> tuple[Neglect, ...]:
        """What it leaves out of the first order, each with its size; nothing else may differ to first order."""
        return ()


def _seen(plane: Plane, azimuth: float) -> tuple[float, float]:
    """An azimuth of a gear's frame in the frame in which a deviation is counted [rad], and the sense of that."""
    sense = -1.0 if plane.mirrored else 1.0
    return sense * (azimuth - plane.azimuth), sense
