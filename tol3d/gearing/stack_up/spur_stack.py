"""What the stack-up of a spur pair leaves out.

Sources: ISO/TR 10064-3 (deviations of axes); ISO 21771-1:2024, 5.6 (nominal). Neglected: squares of deviations
(0.05 um on the inputs of Jiang et al.), and contact away from the pitch point: gears that grow by different
strains have different base pitches (up to 3.5 um for a pinion alone 20 K warmer).
"""

import math

from tol3d.gearing.stack_up.neglect import Bound, Neglect
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Term
from tol3d.gears import InternalPair, SpurPair


class SpurStack(Stack[SpurPair | InternalPair]):
    """The stack-up of two spur gears, of which one may be internal."""

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
