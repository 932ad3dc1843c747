"""What the stack-up of a spur pair has of its own: tilts and temperature.

Sources: ISO/TR 10064-3 (deviations of axes); ISO 21771-1:2024, 5.6 (nominal). Neglected: squares of deviations
(0.05 um on the inputs of Jiang et al.), and contact away from the pitch point: gears that grow by different
strains have different base pitches (up to 3.5 um for a pinion alone 20 K warmer).
"""

import math

import numpy as np

from tol3d.gearing.model import AxisTilt, Contributor, Temperature
from tol3d.gearing.stack_up.neglect import Neglect, Part
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Role, Term
from tol3d.gears import SpurPair


class SpurStack(Stack[SpurPair]):
    """The stack-up of a spur pair."""

    def tilt(self, effect: AxisTilt, contributor: Contributor, role: Role) -> Term | None:
        """The tighter end of the face loses b/2 times the tilt on each flank side.

        In plane (about y): b sin(alpha_w); out of plane (about x): b cos(alpha_w); b the smaller face
        width. Which ends are the tighter ones tells `lost`; the loss is one-sided and shifts the mean. A flank side
        that is read in the middle of the face loses nothing, nor do gears that lean alike: a driver's lean counts
        against its mate's.
        """
        sides = [self.reading.contact, self.reading.gap].count("face")
        half_width = min(self.pair.pinion.face_width, self.pair.wheel.face_width) / 2
        per_tilt = sides * half_width * (-1 if role == "driver" else 1)
        x, y = self.turns_of(effect, contributor, role)
        in_plane, across = per_tilt * self.sin * y, per_tilt * self.cos * x
        largest = float(np.abs([in_plane, across]).max())
        return Term(contributor, largest, tilts=(tuple(in_plane.tolist()), tuple(across.tolist())))

    def temperature(self, effect: Temperature, contributor: Contributor) -> Term | None:
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
        return Term(contributor, sum(2 * self.sin * strain[p] * self.model.expansions[p] for p in touched))

    @property
    def neglects(self) -> tuple[Neglect, ...]:
        """Base pitches that grow apart, and the nominal backlash that grows.

        A pair whose contact lies s along the path from the pitch point gains or loses s times the difference of the
        gears' strains, on each flank side; both sides may touch at the end of the longer part of the path. A pair
        that grows as a whole scales its nominal backlash.
        """
        growth = {part: self._growth(part) for part in (self.mesh.driver, self.mesh.driven, self.mesh.housing) if part}
        if not any(growth.values()):
            return ()
        apart = (*growth[self.mesh.driver], *(term.times(-1.0) for term in growth[self.mesh.driven]))
        scaled = (Part(abs(self.nominal), terms) for terms in growth.values())
        return (
            Neglect("base pitches of gears that grow by different strains", (Part(2 * self._longest_path, apart),)),
            Neglect("growth of the nominal backlash", tuple(scaled)),
        )

    def _growth(self, part: str) -> tuple[Term, ...]:
        """Strain of a part by each temperature that acts on it [1/K]."""
        return tuple(
            Term(contributor, self.model.expansions[part])
            for contributor in self.model.contributors
            for effect in contributor.effect.singles
            if isinstance(effect, Temperature) and part in effect.parts
        )

    @property
    def _longest_path(self) -> float:
        """Longer part of the path of contact, from pitch point to tip [mm]: r_b (tan alpha_a - tan alpha_w)."""
        at_pitch = math.tan(self.pair.working_pressure_angle)
        return max(gear.base_radius * (gear.tip_roll - at_pitch) for gear in (self.pair.pinion, self.pair.wheel))
