"""One contributor's term in a stack-up, and first-order terms neglected by a stack-up, with their sizes.

The nominal mesh of a stack-up: azimuth of each gear's mate, and the opening by its shifts.

alpha_w is the working pressure angle, delta the pitch angle of a gear (0 for a cylinder). Of helical gears alpha_w is
that of the transverse section, and what happens in that section counts cos(beta_b) of itself along the normals.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Generic, Literal, TypeVar

import numpy as np

from tol3d.gearing.effects import Plane
from tol3d.gearing.model import Contributor, Mesh, Model, Reading, Seat
from tol3d.gears import RIGHT, Gear, GearPair
from tol3d.numerics.arrays import Array

Role = Literal["driver", "driven"]


@dataclass(frozen=True)
class Term:
    """A contributor's first-order change of the normal backlash.

    Args:
        contributor: its contributor.
        coefficient: change of j_bn per deviation [mm/mm, mm/rad, mm/K]; for a deviation with a
            direction, per length along its worst direction.
        along: that direction for Planar draws, as the azimuth [rad] of largest opening in the gear's frame at
            rest; for a turning offset the gear's turn is subtracted.
        turns: which gear the deviation turns with, or None when it rests.
        sense: in which azimuths of the deviation count, against those of the gear.
        tilts: for what enters through the one-sided loss by tilts, not linearly: loss in the plane of the axes (about
            y) and across it (about x) per component of the deviation; `coefficient` is the largest of them.
    """

    contributor: Contributor
    coefficient: float
    along: float = 0.0
    turns: Role | None = None
    sense: float = 1.0
    tilts: tuple[tuple[float, ...], tuple[float, ...]] | None = None

    @property
    def leans(self) -> bool:
        """True if it enters through the loss by tilts; none does in a mesh read in the middle of its face."""
        return self.tilts is not None and any(map(any, self.tilts))

    def change(self, deviation: Array, angles: tuple[Array, Array]) -> Array:
        """Change of j_bn [mm], (rows,), for deviations (rows, components) at turns (driver, driven) [rad]."""
        if deviation.shape[1] == 1:
            return self.coefficient * deviation[:, 0]
        turn = np.zeros(1) if self.turns is None else angles[0 if self.turns == "driver" else 1]
        azimuth = self.along - self.sense * turn
        return self.coefficient * (np.cos(azimuth) * deviation[:, 0] + np.sin(azimuth) * deviation[:, 1])

    def times(self, factor: float) -> "Term":
        """The same with another coefficient; not for tilts."""
        return replace(self, coefficient=factor * self.coefficient)


@dataclass(frozen=True)
class Bound:
    """A bound: `factor` times the absolute value of the sum of some terms."""

    factor: float
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Neglect:
    """A term that a stack-up neglects on purpose, and a bound of its effect on j_bn.

    Args:
        words: description for people.
        parts: bounds that add up [mm].
    """

    words: str
    parts: tuple[Bound, ...]

    def bound(self, slices: Mapping[str, slice], deviations: Array, angles: tuple[Array, Array]) -> Array:
        """Largest neglected change of j_bn [mm], (rows,); 0 where no deviation of its terms acts.

        Args:
            slices: columns of each contributor in the deviations.
            deviations: (rows, components) [mm, rad, K].
            angles: turns of driver and driven gear [rad], each (rows,).
        """
        total = np.zeros(len(deviations))
        for part in self.parts:
            change = np.zeros(len(deviations))
            for term in part.terms:
                change = change + term.change(deviations[:, slices[term.contributor.name]], angles)
            total = total + part.factor * np.abs(change)
        return total


Pair = TypeVar("Pair", bound=GearPair, covariant=True)


class NominalMesh(Generic[Pair]):
    """One mesh of a model, for one of its readings; `pair` is the mesh's.

    `sin` and `cos` are those of alpha_w, times cos(beta_b) of helical gears: the parts along the normals of shifts in
    the plane of the axes and across it. `sense` is that in which the driven gear turns to leave the driver's right
    flanks: 1, of an internal pair -1.
    """

    def __init__(self, model: Model, mesh: Mesh, pair: Pair, reading: Reading) -> None:
        self.model = model
        self.mesh = mesh
        self.pair = pair
        self.reading = reading
        self.sin = math.sin(pair.working_pressure_angle) * pair.base_helix_cosine
        self.cos = math.cos(pair.working_pressure_angle) * pair.base_helix_cosine
        self.sense = float(pair.mating_flank(RIGHT))

    def role(self, part: str, mesh: str | None = None) -> Role | None:
        """Role of the part in this mesh; None if it is in others only, or acts in another one."""
        if mesh not in (None, self.mesh.name):
            return None
        return "driver" if part == self.mesh.driver else "driven" if part == self.mesh.driven else None

    def gear(self, role: Role) -> Gear:
        """The gear of that role."""
        return self.pair.pinion if role == "driver" else self.pair.wheel

    def seat(self, role: Role) -> Seat:
        """The place of the gear of that role in this mesh."""
        gear = self.mesh.driver if role == "driver" else self.mesh.driven
        return self.model.seats[self.model.seat_index[self.mesh.name, gear]]

    def across(self, role: Role) -> float:
        """Opening by a shift of the axis away from the mesh, of a ring's towards it: 2 sin(alpha_w) cos(delta)."""
        return 2 * self.sin * math.cos(self.gear(role).pitch_angle)

    def along(self, role: Role) -> float:
        """Opening by a shift along the axis, away from the apex: 2 sin(alpha_w) sin(delta)."""
        return 2 * self.sin * math.sin(self.gear(role).pitch_angle)

    def screwed(self, role: Role) -> float:
        """Turn of the driven gear [mm at its arm] by a shift of a gear along its axis: kappa2 (dz2 - dz1)."""
        turn = self.pair.wheel.twist * self.pair.wheel.section_arm
        return turn if role == "driven" else -turn

    def azimuth_away(self, role: Role) -> float:
        """Azimuth [rad], in the gear's frame at rest in the mesh, in which a shift of its axis opens."""
        own = 0 if role == "driver" else 1
        return (self.pair.mesh_azimuths[own] + self.pair.opening_off_mesh[own]) % (2 * math.pi)

    def azimuth_onwards(self, role: Role) -> float:
        """Azimuth [rad], in the gear's frame at rest in the mesh, of a shift that turns the driven gear positively.

        The driven gear turns on where its shift takes its teeth back; the driver's shift takes them along.
        """
        towards = self.pair.mesh_azimuths[1]
        onwards = np.array([-math.sin(towards), math.cos(towards), 0.0])  # motion of the driven teeth at the mesh
        if role == "driven":
            return math.atan2(-onwards[1], -onwards[0])
        x, y, _ = self.pair.world_from_wheel @ onwards
        return math.atan2(y, x)

    def on_shaft(self, azimuth: float, role: Role, mesh: str | None = None) -> float:
        """An azimuth of a gear's frame at rest in the mesh, in its frame at rest on its shaft [rad].

        Where a deviation is stated in the frame of a mesh, named by `mesh`, it stays as it is.
        """
        return azimuth + (self.seat(role).azimuth if mesh is None else 0.0)


def as_counted(plane: Plane, azimuth: float) -> tuple[float, float]:
    """An azimuth of a gear's frame in the frame in which a deviation is counted [rad], and the sense of that."""
    sense = -1.0 if plane.mirrored else 1.0
    return sense * (azimuth - plane.azimuth), sense
