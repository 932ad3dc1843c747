"""Normal backlash of a pair of gears: the nominal one plus the first-order change by each deviation.

What spur and bevel pairs share; each kind of pair has its own file for what it does not. alpha_w is the working
pressure angle, delta the pitch angle of a gear (0 for a cylinder).
Source: Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, 1533-1542, sections 2.1 and 3.1, where
alpha_w = alpha and delta = 45 deg.
"""

import math
from dataclasses import dataclass
from functools import singledispatchmethod
from typing import Generic, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from tol3d.gears import Gear, GearPair
from tol3d.model import (
    AxesOffset,
    AxisOffset,
    AxisTilt,
    Contributor,
    Effect,
    Mesh,
    Model,
    Reading,
    Temperature,
    ToothThickness,
    TurningOffset,
)

Array = NDArray[np.float64]
Role = Literal["driver", "driven"]
Pair = TypeVar("Pair", bound=GearPair, covariant=True)


@dataclass(frozen=True)
class Term:
    """A contributor's first-order change of the normal backlash.

    Args:
        contributor: whose it is.
        coefficient: change of j_bn per deviation [mm/mm, mm/rad, mm/K]; for a deviation with a
            direction, per length along its worst direction.
        along: that direction for Planar draws, as the azimuth [rad] of largest opening in the gear's frame at
            rest; for a turning offset the gear's turn is subtracted.
        turns: which gear the deviation turns with, or None when it rests.
        one_sided: it enters through the loss by tilts, not linearly.
    """

    contributor: Contributor
    coefficient: float
    along: float = 0.0
    turns: Role | None = None
    one_sided: bool = False

    @property
    def in_plane(self) -> bool:
        """Whether a one-sided term tilts in the plane of the axes (about y)."""
        return isinstance(self.contributor.effect, AxisTilt) and self.contributor.effect.axis[1] != 0.0

    def change(self, deviation: Array, angles: tuple[Array, Array]) -> Array:
        """Change of j_bn [mm], (rows,), for deviations (rows, components) at turns (driver, driven) [rad]."""
        if deviation.shape[1] == 1:
            return self.coefficient * deviation[:, 0]
        turn = np.zeros(len(deviation)) if self.turns is None else angles[0 if self.turns == "driver" else 1]
        azimuth = self.along - turn
        return self.coefficient * (np.cos(azimuth) * deviation[:, 0] + np.sin(azimuth) * deviation[:, 1])


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
            term for contributor in model.contributors if (term := self._term(contributor.effect, contributor))
        )

    @property
    def nominal(self) -> float:
        """j_bn of the nominal pair [mm], exact."""
        return self.pair.normal_backlash

    def normal_backlash(self, deviations: Array, driver_angle: Array) -> Array:
        """j_bn [mm], (rows,), of deviations (rows, components) at the driver's turns [rad] (rows,)."""
        angles = (driver_angle, self.pair.driven_angle(driver_angle))
        total = np.full(len(deviations), self.nominal)
        out_of_plane, in_plane = np.zeros(len(deviations)), np.zeros(len(deviations))
        for term in self.terms:
            columns = deviations[:, self.model.component_slices[term.contributor.name]]
            if not term.one_sided:
                total = total + term.change(columns, angles)
            elif term.in_plane:
                in_plane = in_plane + term.change(columns, angles)
            else:
                out_of_plane = out_of_plane + term.change(columns, angles)
        return total - np.maximum(np.abs(in_plane), np.abs(out_of_plane))

    # one function an effect -------------------------------------------------------------------------

    @singledispatchmethod
    def _term(self, effect: Effect, contributor: Contributor) -> Term | None:
        raise TypeError(f"stack.py has no function for the effect {type(effect).__name__}")

    def role(self, part: str) -> Role | None:
        """What the part is in this mesh."""
        return "driver" if part == self.mesh.driver else "driven" if part == self.mesh.driven else None

    def gear(self, role: Role) -> Gear:
        """The gear of that role."""
        return self.pair.pinion if role == "driver" else self.pair.wheel

    def _away(self, role: Role) -> float:
        """Azimuth [rad], in the gear's frame at rest, in which its axis leaves the mesh."""
        return (self.pair.mesh_azimuths[0 if role == "driver" else 1] + math.pi) % (2 * math.pi)

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
        return Term(contributor, self._across(role), along=self._away(role), turns=role)

    @_term.register
    def _(self, effect: AxisOffset, contributor: Contributor) -> Term | None:
        """Across the axis as above; along it, away from the apex, 2 sin(alpha_w) sin(delta)."""
        role = self.role(effect.part)
        if role is None:
            return None
        away = self._away(role)
        if len(contributor.draw.components) == 2:
            return Term(contributor, self._across(role) * effect.factor, along=away)
        x, y, z = effect.direction
        leaving = x * math.cos(away) + y * math.sin(away)
        along_axis = 2 * self.sin * math.sin(self.gear(role).pitch_angle) * z
        return Term(contributor, effect.factor * (self._across(role) * leaving + along_axis))

    @_term.register
    def _(self, effect: AxisTilt, contributor: Contributor) -> Term | None:
        role = self.role(effect.part)
        return None if role is None else self.tilt(effect, contributor, role)

    @_term.register
    def _(self, effect: AxesOffset, contributor: Contributor) -> Term | None:
        role = self.role(effect.part)
        return None if role is None else self.axes_offset(contributor, role)

    @_term.register
    def _(self, effect: Temperature, contributor: Contributor) -> Term | None:
        return self.temperature(effect, contributor)

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
