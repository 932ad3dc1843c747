"""A planetary set as a study sees it."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.contact import Contact, seated_ranges
from tol3d.planetary.deviated import Acts, Deviated
from tol3d.planetary.measure import PlanetaryMeasure
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.problems import problems_of
from tol3d.planetary.programme import ranges
from tol3d.planetary.regressors import regress
from tol3d.planetary.roads import PlanetaryRoad
from tol3d.planetary.stack_up import StackUp
from tol3d.planetary.statuses import STATUSES
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.plain import PlainSystem
from tol3d.system.positions import Positions
from tol3d.system.road import ANALYTIC_ROAD, Road, RoadKind
from tol3d.system.stated import component_slices
from tol3d.system.statuses import Statuses
from tol3d.system.system import Columns, KeyPath, StreamKey
from tol3d.system.trials import Trials

Array = NDArray[np.float64]

ROADS: Final[Mapping[str, RoadKind]] = {
    "exact": RoadKind("kernels", compiled=True),
    ANALYTIC_ROAD: RoadKind("kernels", compiled=True),
}


@dataclass(frozen=True)
class PlanetarySystem(PlainSystem):
    """Implements System.

    Args:
        own: the set.
        acts: what each contributor acts on, by its name.
        planetary_measures: the measures by their names.
    """

    own: PlanetarySet
    acts: Mapping[str, Acts]
    planetary_measures: Mapping[str, PlanetaryMeasure]

    roads: ClassVar[Mapping[str, RoadKind]] = ROADS
    statuses: ClassVar[Statuses] = STATUSES

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """See System."""
        return problems_of(self)

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """See System."""
        return {"kind": self.planetary_measures[measure.name].kind}

    # its trials -------------------------------------------------------------------------------------

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

    # its roads --------------------------------------------------------------------------------------

    def is_compiled(self, road: str) -> bool:
        """See System."""
        return ranges.kept if road == ANALYTIC_ROAD else seated_ranges.kept

    def road(self, name: str, materials: Any) -> Road:
        """See System."""
        return PlanetaryRoad(self, StackUp(self.own) if name == ANALYTIC_ROAD else Contact(self.own))

    def cost(self, measures: Sequence[Measure]) -> int:
        """A contact for each mesh of each planet, at each position; see System."""
        return sum(own.positions.in_a_trial for own in measures) * self.own.planets * len(self.own.meshes)

    # what acts on a measure -------------------------------------------------------------------------

    def regressor_key(self, measure: Measure) -> Hashable:
        """Of its own: groups are regressed by what they do to it."""
        return measure.name

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """See System: offsets as they lie seen from the planets."""
        regress(self, self.planetary_measures[measure.name], contributors, columns, rows)

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
