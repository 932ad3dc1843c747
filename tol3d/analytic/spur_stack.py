"""Normal backlash of a spur pair: exact nominal plus the first-order change by each deviation.

Sources: Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, 1533-1542, section 2.1 (tooth
thickness, centre distance, eccentricity, clearance, run-out; there with the reference pressure angle);
ISO/TR 10064-3 (deviations of axes); ISO 21771-1:2024, 5.6 (nominal). alpha_w is the working pressure angle.
Neglected: squares of deviations (0.05 um on the paper's inputs), contact away from the pitch point.
"""

import math
from dataclasses import dataclass
from functools import singledispatchmethod

import numpy as np
from numpy.typing import NDArray

from tol3d.model import (
    AxisOffset,
    AxisTilt,
    Backlash,
    Contributor,
    Effect,
    Mesh,
    Model,
    Temperature,
    ToothThickness,
    TurningOffset,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Term:
    """A contributor's first-order change of the normal backlash.

    Args:
        contributor: whose it is.
        coefficient: change of j_bn per deviation [mm/mm, mm/rad, mm/K]; for a deviation with a
            direction, per length along its worst direction.
        along: that direction for Planar draws, as the azimuth [rad] of largest opening: in the world
            for a resting axis; for a turning offset, in the world too, so that the gear's turn is subtracted.
        turns: which gear the deviation turns with ("driver", "driven"), or None when it rests.
        one_sided: it enters through the loss by tilts, not linearly.
    """

    contributor: Contributor
    coefficient: float
    along: float = 0.0
    turns: str | None = None
    one_sided: bool = False

    def change(self, deviation: Array, angles: tuple[Array, Array]) -> Array:
        """Change of j_bn [mm], (rows,), for deviations (rows, components) at turns (driver, driven) [rad]."""
        if deviation.shape[1] == 1:
            return self.coefficient * deviation[:, 0]
        turn = np.zeros(len(deviation)) if self.turns is None else angles[0 if self.turns == "driver" else 1]
        azimuth = self.along - turn
        return self.coefficient * (np.cos(azimuth) * deviation[:, 0] + np.sin(azimuth) * deviation[:, 1])


class SpurStack:
    """The stack-up of one mesh of a model."""

    def __init__(self, model: Model, mesh: Mesh) -> None:
        self.model = model
        self.mesh = mesh
        self.pair = mesh.pair
        self._sin = math.sin(mesh.pair.working_pressure_angle)
        self._cos = math.cos(mesh.pair.working_pressure_angle)
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
            elif self.is_in_plane(term):
                in_plane = in_plane + term.change(columns, angles)
            else:
                out_of_plane = out_of_plane + term.change(columns, angles)
        return total - np.maximum(np.abs(in_plane), np.abs(out_of_plane))

    @staticmethod
    def is_in_plane(term: Term) -> bool:
        """Whether a one-sided term tilts in the plane of the axes (about +y)."""
        return isinstance(term.contributor.effect, AxisTilt) and term.contributor.effect.axis[1] != 0.0

    # one function an effect -------------------------------------------------------------------------

    @singledispatchmethod
    def _term(self, effect: Effect, contributor: Contributor) -> Term | None:
        raise TypeError(f"spur_stack.py has no function for the effect {type(effect).__name__}")

    def _role(self, part: str) -> str | None:
        return {self.mesh.driver: "driver", self.mesh.driven: "driven"}.get(part)

    @_term.register
    def _(self, effect: ToothThickness, contributor: Contributor) -> Term | None:
        """-cos(alpha) of the reference circle, at any centre distance."""
        if self._role(effect.part) is None:
            return None
        return Term(contributor, -math.cos(self.pair.pinion.pressure_angle))

    @_term.register
    def _(self, effect: TurningOffset, contributor: Contributor) -> Term | None:
        """2 sin(alpha_w) times the offset away from the mesh: -x for the driver, +x for the driven."""
        role = self._role(effect.part)
        if role is None:
            return None
        return Term(contributor, 2 * self._sin, along=math.pi if role == "driver" else 0.0, turns=role)

    @_term.register
    def _(self, effect: AxisOffset, contributor: Contributor) -> Term | None:
        """2 sin(alpha_w) times the shift of the axis away from the mesh; along the axis nothing."""
        role = self._role(effect.part)
        if role is None:
            return None
        away = 1.0 if role == "driven" else -1.0
        if len(contributor.draw.components) == 2:
            return Term(contributor, 2 * self._sin * effect.factor, along=0.0 if away > 0 else math.pi)
        return Term(contributor, 2 * self._sin * effect.factor * effect.direction[0] * away)

    @_term.register
    def _(self, effect: AxisTilt, contributor: Contributor) -> Term | None:
        """The tighter end of the face loses b/2 times the tilt on each flank side.

        In plane (about y): b sin(alpha_w); out of plane (about x): b cos(alpha_w); b the smaller face
        width. The larger of both counts, so the loss is one-sided and shifts the mean.
        """
        if self._role(effect.part) is None:
            return None
        width = min(self.pair.pinion.face_width, self.pair.wheel.face_width)
        lever = self._sin if effect.axis[1] != 0.0 else self._cos
        return Term(contributor, width * lever * effect.per_length, one_sided=True)

    @_term.register
    def _(self, effect: Temperature, contributor: Contributor) -> Term | None:
        """A growing housing opens by 2 a sin(alpha_w), a growing gear closes by 2 r_w sin(alpha_w), per strain.

        Taken at the pitch point: two gears of one material with the housing only scale, to first order.
        """
        radius = dict(zip((self.mesh.driver, self.mesh.driven), self.pair.working_radii, strict=True))
        strain = {part: -length for part, length in radius.items()}
        if self.mesh.housing:
            strain[self.mesh.housing] = self.pair.centre_distance
        touched = [part for part in effect.parts if part in strain]
        if not touched:
            return None
        return Term(contributor, sum(2 * self._sin * strain[p] * self.model.expansions[p] for p in touched))


def analytic_backlash(model: Model, kind: Backlash, deviations: Array, driver_angle: Array) -> Array:
    """Value of a backlash measure by the stack-up [mm, or rad for an angle], (rows,).

    j_wt = j_bn / cos(alpha_w); an angle is j_bn / r_b of the gear that turns.
    """
    stack = SpurStack(model, model.mesh(kind.mesh))
    return stack.normal_backlash(deviations, driver_angle) * per_normal_backlash(model, kind)


def per_normal_backlash(model: Model, kind: Backlash) -> float:
    """What turns j_bn [mm] into the measure: 1, 1/cos(alpha_w) or 1/r_b [rad/mm]."""
    if kind.quantity == "normal_backlash":
        return 1.0
    if kind.quantity == "circumferential_backlash":
        return 1.0 / math.cos(model.mesh(kind.mesh).pair.working_pressure_angle)
    return 1.0 / model.gear(kind.gear).gear.base_radius
