"""Stack-ups of gears on parallel axes: spur gears, of which one may be internal, and helical ones."""

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.gearing.model import Mesh, Model, Reading
from tol3d.gearing.stack_up.contact_lines import ContactLines, lost
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Bound, Neglect, Role, Term
from tol3d.gearing.stack_up.tooth_pairs import ToothPairs, lines_alone
from tol3d.gears import InternalPair, SpurPair
from tol3d.numerics.arrays import Array


class SpurStack(Stack[SpurPair | InternalPair]):
    """The stack-up of two spur gears, of which one may be internal.

    Sources: ISO/TR 10064-3 (deviations of axes); ISO 21771-1:2024, 5.6 (nominal). Neglected: squares of deviations
    (0.05 um on the inputs of Jiang et al.), and contact away from the pitch point: gears that grow by different
    strains have different base pitches (up to 3.5 um for a pinion alone 20 K warmer).
    """

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
        scaled = (Bound(abs(self.nominal), terms) for terms in growth.values())
        return (
            Neglect("base pitches of gears that grow by different strains", (Bound(2 * self._longest_path, apart),)),
            Neglect("growth of the nominal backlash", tuple(scaled)),
        )

    def _growth(self, part: str) -> tuple[Term, ...]:
        """Strain of a part by each temperature that acts on it [1/K]."""
        return tuple(
            strain for contribution in self.contributions for name, strain in contribution.strains if name == part
        )

    @property
    def _longest_path(self) -> float:
        """Longer part of the path of contact, from pitch point to tip [mm]: r_b |tan alpha_a - tan alpha_w|."""
        at_pitch = math.tan(self.pair.working_pressure_angle)
        return max(gear.base_radius * abs(gear.tip_roll - at_pitch) for gear in (self.pair.pinion, self.pair.wheel))


POSITIONS_OF_A_PITCH: Final = 64
"""At which the loss by contact lines is averaged; it is straight between kinks, the mean off by 1e-3 of its range."""


class HelicalStack(SpurStack):
    """The stack-up of two helical gears, of which one may be internal: contact lines, and transverse sections.

    Every slice across the axes is a spur pair, so that shifts, thickness and growth act as there, times cos(beta_b).
    Where axes lean the gap is least at an end of a contact line, which depends on the position; see contact_lines.py.
    Of second order, and so neglected: lines end where their mates do, which stand the backlash j apart (f j/tan(beta_b)
    of a lean f).

    Args:
        at: turns of the driver [rad] at which a loss is averaged that is asked for without any; None: over a pitch.
    """

    def __init__(
        self,
        model: Model,
        mesh: Mesh,
        pair: SpurPair | InternalPair,
        reading: Reading,
        at: Sequence[float] | None = None,
    ) -> None:
        super().__init__(model, mesh, pair, reading)
        self._lines = ContactLines(pair)
        if isinstance(pair, SpurPair) and self.teeth is None and any(self._apart_by_growth):
            self.teeth = lines_alone(model, mesh, pair, reading)
        step = pair.pinion.angular_pitch / POSITIONS_OF_A_PITCH
        self._at = [k * step for k in range(POSITIONS_OF_A_PITCH)] if at is None else at

    @property
    def neglects(self) -> tuple[Neglect, ...]:
        """None of external gears: base pitches that grow apart, and the growth of the nominal backlash, are summed."""
        return () if isinstance(self.pair, SpurPair) else super().neglects

    @property
    def _apart_by_growth(self) -> Sequence[float]:
        """Strain of the driven gear less that of the driver by each contributor that warms them [1/K]."""
        found = dict.fromkeys((own.contributor.name for own in self._strains), 0.0)
        for part, sign in ((self.mesh.driver, -1.0), (self.mesh.driven, 1.0)):
            for term in self._growth(part):
                found[term.contributor.name] += sign * term.coefficient
        return tuple(found.values())

    @property
    def _strains(self) -> Sequence[Term]:
        return [*self._growth(self.mesh.driver), *self._growth(self.mesh.driven)]

    def _strain(self, part: str, deviations: Array) -> Array:
        """Strain of a gear (rows,) by deviations (rows, components)."""
        total, at_rest = np.zeros(len(deviations)), (np.zeros(1), np.zeros(1))
        for term in self._growth(part):
            total += term.change(deviations[:, self.model.component_slices[term.contributor.name]], at_rest)
        return total

    def normal_backlash(self, deviations: Array, driver_angle: Array, turns: Role | None = None) -> Array:
        """As of spur gears; of external gears the nominal backlash grows with the driven one."""
        found = super().normal_backlash(deviations, driver_angle, turns)
        if isinstance(self.pair, SpurPair) and self._strains:
            found = found + self.nominal * self._strain(self.mesh.driven, deviations)
        return found

    def _leans(self, deviations: Array) -> Mapping[int, Array]:
        """As ToothPairs.taken has them, (rows, 5)."""
        strain = self._strain(self.mesh.driven, deviations) - self._strain(self.mesh.driver, deviations)
        leans = {side: lean[:, 0] for side, lean in super()._leans(deviations).items()}
        alpha, half = self.pair.working_pressure_angle, self.pair.common_face / 2
        apart = -(leans[1] + leans[-1]) / (2 * self.sin * half)
        aside = (leans[1] - leans[-1]) / (2 * self.cos * half)
        first, second = self.pair.pinion.iso_sign, self.pair.wheel.iso_sign
        found = {}
        for side, lean in leans.items():
            rolls = second * (apart / math.tan(alpha) + side * aside) / self.pair.centre_distance
            outwards = first * (apart * math.cos(alpha) + side * aside * math.sin(alpha))
            found[side] = np.stack([lean, strain, rolls, apart / math.sin(alpha), outwards], axis=-1)
        return found

    def lost(self, in_plane: Array, across: Array, driver_angle: Array | None = None) -> Array:
        """As of spur gears, on the contact lines at the driver's turns [rad] (rows,); averaged where None is given."""
        return np.asarray(sum(self._of_sides(in_plane, across, driver_angle)))

    def _of_sides(self, in_plane: Array, across: Array, driver_angle: Array | None) -> tuple[Array, Array]:
        """Losses of right and left flanks [mm], (rows,)."""
        ends = {
            side: self._mean_ends[side] if driver_angle is None else self._lines.ends(side, driver_angle)
            for side in (1, -1)
        }
        return lost((in_plane + across) / 2, ends[1]), lost((in_plane - across) / 2, ends[-1])

    @cached_property
    def _mean_ends(self) -> Mapping[int, tuple[Array, Array]]:
        """Means of the ends of contact lines over the positions that are averaged, by side."""
        each = {side: self._lines.ends(side, np.array(self._at)) for side in (1, -1)}
        return {side: (low.mean(), high.mean()) for side, (low, high) in each.items()}

    def _aside_by_tilts(self, in_plane: Array, across: Array, driver_angle: Array) -> Array:
        right, left = self._of_sides(in_plane, across, driver_angle)
        return np.asarray(self.sense * (right - left) / 2)

    @cached_property
    def turning_teeth(self) -> ToothPairs | None:
        """Those of single flanks that deviate; where axes lean all, by their contact lines."""
        leans = any(term.leans for term in self.terms)
        return lines_alone(self.model, self.mesh, self.pair, self.reading) if leans and not self.teeth else self.teeth

    @property
    def _longest_path(self) -> float:
        """Distance [mm] along the normals that a line in the middle of the face may lie from the pitch point."""
        return self._lines.furthest * self.pair.base_helix_cosine
