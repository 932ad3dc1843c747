"""Trials of a planetary set: what they deviate by, and where its shafts stand."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.deviated import Acts, Deviated
from tol3d.planetary.measure import PlanetaryMeasure
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.plain import PlainSystem
from tol3d.system.positions import Positions
from tol3d.system.stated import component_slices
from tol3d.system.system import StreamKey
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SetTrials(PlainSystem):
    """What a System of a planetary set says of trials.

    Args:
        own: the set.
        acts: what each contributor acts on, by its name.
        planetary_measures: the measures by their names.
    """

    own: PlanetarySet
    acts: Mapping[str, Acts]
    planetary_measures: Mapping[str, PlanetaryMeasure]

    @property
    def streams(self) -> tuple[StreamKey, ...]:
        """One, of the position of the output; see System."""
        return ((self.own.name, "position"),)

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        """Turns of the output, uniform over the time until all teeth meet again as they did; see System."""
        return {self.own.name: uniforms[self.streams[0]] * float(self.own.period)}

    @property
    def position_column(self) -> str:
        """Name of the column of positions."""
        return f"position:{self.own.name} [deg]"

    def columns(self, trials: Trials) -> Mapping[str, NDArray[np.generic]]:
        """Angle of the output; see System."""
        return {self.position_column: 360.0 * trials.positions[self.own.name]}

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """Offsets of gears from their axes do, at random positions; see System."""
        return positions.over == "random" and self.acts[contributor.name].effect == "offset"

    def deviated(self, trials: Trials) -> Deviated:
        """What trials deviate by, by gear and planet."""
        found = Deviated.nothing(self.own, len(trials))
        for name, own in component_slices(self).items():
            found.add(self.own, self.acts[name], trials.deviations[:, own])
        return found

    @cached_property
    def _known_slopes(self) -> dict[tuple[str, str], Array]:
        """Slopes that are known: each takes a programme a component."""
        return {}

    def slopes(self, measure: Measure, contributor: Contributor) -> Array:
        """Change of a measure by each component of a contributor, at rest."""
        key = measure.name, contributor.name
        if key not in self._known_slopes:
            self._known_slopes[key] = self._slopes(measure, contributor)
        return self._known_slopes[key]
