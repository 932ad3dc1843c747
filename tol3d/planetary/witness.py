"""The road of planetary sets by FCL, which witnesses the exact one: it knows how far it may be off."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from tol3d.gearing.roads.witness import ALLOWANCE
from tol3d.planetary.roads import PlanetaryRoad
from tol3d.planetary.set_trials import SetTrials
from tol3d.planetary.shown import Made
from tol3d.planetary.strip_contact import StripContact
from tol3d.planetary.strip_gaps import StripGaps
from tol3d.solids import FlankStrips
from tol3d.system.measure import Measure

MOST_POSITIONS: Final = 24
"""Of a measure that a witness reads: a turn of 360 would take it ten seconds a trial."""


@dataclass(frozen=True)
class PlanetaryWitness(PlanetaryRoad):
    """Implements WitnessRoad.

    Args:
        strips: of every gear, by name.
    """

    strips: Mapping[str, FlankStrips]

    @property
    def chord_error(self) -> float:
        """See Road."""
        return max(own.chord_error for own in self.strips.values())

    def reads(self, measure: Measure) -> bool:
        """See WitnessRoad."""
        return measure.positions.in_a_trial <= MOST_POSITIONS

    def bounds(self, measure: Measure) -> tuple[float, float]:
        """See WitnessRoad: by chords of both flanks of a gap, and by all else."""
        system = self.system
        chords = [
            self.strips[mesh.central.name].chord_error + self.strips[mesh.planet.name].chord_error
            for mesh in system.own.meshes
        ]
        others = [ALLOWANCE * mesh.central.module for mesh in system.own.meshes]
        return system.gap_bound(measure, chords), system.gap_bound(measure, others)


def witness(system: SetTrials, made: Made, strips: Mapping[str, FlankStrips]) -> PlanetaryWitness:
    """The road of a set's trials by FCL."""
    turning = StripContact(system.own, made, StripGaps(system.own, strips))
    overcome = StripContact(system.overcome, made, StripGaps(system.overcome, strips))
    return PlanetaryWitness(system, turning, overcome, strips)
