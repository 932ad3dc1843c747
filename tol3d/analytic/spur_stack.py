"""What the stack-up of a spur pair has of its own: tilts and temperature.

Sources: ISO/TR 10064-3 (deviations of axes); ISO 21771-1:2024, 5.6 (nominal). Neglected: squares of deviations
(0.05 um on the inputs of Jiang et al.), and contact away from the pitch point: gears that grow by different
strains have different base pitches (up to 3.5 um for a pinion alone 20 K warmer).
"""

import numpy as np

from tol3d.analytic.stack import Role, Stack, Term
from tol3d.gears import SpurPair
from tol3d.model import AxisTilt, Contributor, Temperature


class SpurStack(Stack[SpurPair]):
    """The stack-up of a spur pair."""

    def tilt(self, effect: AxisTilt, contributor: Contributor, role: Role) -> Term | None:
        """The tighter end of the face loses b/2 times the tilt on each flank side.

        In plane (about y): b sin(alpha_w); out of plane (about x): b cos(alpha_w); b the smaller face
        width. The larger of both counts, so the loss is one-sided and shifts the mean. A flank side that is read in
        the middle of the face loses nothing, nor do gears that lean alike: a driver's lean counts against its mate's.
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
