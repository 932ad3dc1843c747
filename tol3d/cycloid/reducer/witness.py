"""The road of RV reducers by FCL, which witnesses the exact one: it knows how far it may be off."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.cycloid.exact.strip_contact import StripContact
from tol3d.cycloid.model.shapes import LobeStrips
from tol3d.cycloid.reducer.deviated import RVDeviated
from tol3d.cycloid.reducer.first_stage import crank_turns, held_stage, placed_mesh
from tol3d.cycloid.reducer.rv_set import RVSet
from tol3d.cycloid.reducer.trials import RVRoad, RVTrials
from tol3d.cycloid.reducer.turning import Turned, led_angles, output_turns
from tol3d.numerics.arrays import Array
from tol3d.system.measure import Measure

MOST_POSITIONS: Final = 24
"""Of a measure that a witness reads: a turn of 200 would take it a second a trial."""
ALLOWANCE: Final = 1.5e-5  # mm; what a gap may be off besides chords: FCL's cylinders by 8e-6, the solid by 1e-6


@dataclass(frozen=True)
class StripTurning:
    """The cycloid stage by FCL on strips of the discs' solids, the first stage in finite geometry."""

    own: RVSet
    strips: StripContact

    def turned(self, deviated: RVDeviated, turns: Array, sense: int, deflection: float | None = None) -> Turned:
        """See Turning; pins near contact are not counted."""
        own = self.own
        beta, planets = crank_turns(own, deviated, turns, sense, placed_mesh)
        tilts = deviated.disc_tilts if np.any(deviated.disc_tilts) else None
        found = self.strips.touches(held_stage(own, deviated), led_angles(own, turns, beta), (float(sense),), tilts)
        return Turned(
            output_turns(own, deviated, turns, sense, found.turns[..., 0], beta), found.places[..., 0], planets
        )


@dataclass(frozen=True)
class RVWitness(RVRoad):
    """Implements WitnessRoad.

    Args:
        strips: of a disc.
    """

    strips: LobeStrips

    @property
    def chord_error(self) -> float:
        """See Road."""
        return self.strips.chord_error

    def reads(self, measure: Measure) -> bool:
        """See WitnessRoad: all but counts of pins near contact."""
        own = self.system.read[measure.name]
        return not own.counts and measure.positions.in_a_trial <= MOST_POSITIONS

    def bounds(self, measure: Measure) -> tuple[float, float]:
        """See WitnessRoad: by chords, and by all else."""
        return self.system.gap_bound(measure, self.chord_error), self.system.gap_bound(measure, ALLOWANCE)


def witness(system: RVTrials, strips: LobeStrips) -> RVWitness:
    """The road of a reducer's trials by FCL."""
    return RVWitness(system, StripTurning(system.own, StripContact(system.own.contact, strips)), strips)
