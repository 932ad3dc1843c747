"""The geometric road by FCL, which witnesses the exact one: it knows how far it may be off.

A strip's chords lie inside the tooth, by the chord error at most: FCL sees up to four of them more backlash than
there is, for two flanks touch and two are measured.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.gearing.model import Measure, TransmissionError
from tol3d.gearing.model.measure import gear_measure
from tol3d.gearing.roads.geometric import GeometricRoad
from tol3d.gearing.stack_up import first_order, per_normal_backlash
from tol3d.solids import FlankStrips
from tol3d.system import measure as system_measure

FLANKS_OF_A_BACKLASH: Final = 4  # two that touch, two that are measured
ALLOWANCE: Final = 0.02e-3
"""What FCL may be off besides chord errors, in modules: an edge whose normal lies far off the contact's (0.0073 um a
millimetre of module at 0.46 rad, as a tip reaches a flank a fifth of a pitch beyond the path of contact), its own
rounding (0.002 um a millimetre), and squares of tilts within a section's width. 0.05 um at module 2.5."""


@dataclass(frozen=True, eq=False)
class FclRoad(GeometricRoad):
    """Implements WitnessRoad.

    Args:
        strips: of every gear, by name.
    """

    strips: Mapping[str, FlankStrips]

    def reads(self, measure: system_measure.Measure) -> bool:
        """See WitnessRoad: every one."""
        return True

    def bounds(self, measure: system_measure.Measure) -> tuple[float, float]:
        """See WitnessRoad: by chords, and by all else."""
        chords = {
            mesh.name: FLANKS_OF_A_BACKLASH * max(self.strips[gear].chord_error for gear in (mesh.driver, mesh.driven))
            for mesh in self.model.meshes
        }
        others = {mesh.name: ALLOWANCE * mesh.pair.pinion.module for mesh in self.model.meshes}
        own = gear_measure(measure)
        return self._of_gaps(own, chords), self._of_gaps(own, others)

    def _of_gaps(self, measure: Measure, normal_backlash: Mapping[str, float]) -> float:
        """What a measure makes of normal backlashes [mm], one of each mesh, in its unit.

        A transmission error sees the two flanks that touch, each further off than at the first position or less.
        """
        free = sum(
            abs(factor) * normal_backlash[backlash.mesh] * per_normal_backlash(self.model, backlash)
            for factor, backlash in measure.kind.backlashes
        )
        if isinstance(measure.kind, TransmissionError):
            return free / 2 * measure.per_internal
        positions = np.full((1, max(1, len(measure.positions.fixed or ()))), free)
        return float(first_order(measure.kind, positions).max()) * measure.per_internal
