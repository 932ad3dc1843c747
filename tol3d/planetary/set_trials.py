"""Trials of a planetary set: what they deviate by, and where its shafts stand."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.deviated import Acts, Deviated
from tol3d.planetary.levers import play_bound
from tol3d.planetary.measure import PlanetaryMeasure
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.output_system import OutputSystem
from tol3d.system.positions import Positions
from tol3d.system.stated import component_slices
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SetTrials(OutputSystem):
    """What a System of a planetary set says of trials.

    Args:
        own: the set.
        acts: what each contributor acts on, by its name.
        planetary_measures: the measures by their names.
    """

    own: PlanetarySet
    acts: Mapping[str, Acts]
    planetary_measures: Mapping[str, PlanetaryMeasure]

    @cached_property
    def overcome(self) -> PlanetarySet:
        """The set under torques that its springs give way to."""
        return replace(self.own, overcome=True)

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """Offsets of gears from their axes do, at random positions; see System."""
        return positions.over == "random" and self.acts[contributor.name].effect == "offset"

    def deviated(self, trials: Trials) -> Deviated:
        """What trials deviate by, by gear and planet."""
        found = Deviated.nothing(self.own, len(trials))
        for name, own in component_slices(self).items():
            found.add(self.own, self.acts[name], trials.deviations[:, own])
        return found

    def gap_bound(self, measure: Measure, errors: Sequence[float]) -> float:
        """What errors of the gaps of each mesh [mm] may make of a measure, in its unit.

        Of a lost motion both ends may be off, of a transmission error the position and the first one; of a region of
        low stiffness both ends twice.
        """
        own = self.planetary_measures[measure.name]
        ends = 4 if own.reading == "low stiffness" else 2
        return ends * play_bound(self.own, own.shaft, errors) * measure.per_internal

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """See System: a gap lies between two flanks."""
        return self.gap_bound(measure, [2 * chord_error] * len(self.own.meshes))
