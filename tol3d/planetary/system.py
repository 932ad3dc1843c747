"""A planetary set as a study sees it."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.contact import Contact, seated_ranges
from tol3d.planetary.problems import problems_of
from tol3d.planetary.programme import ranges
from tol3d.planetary.regressors import regress
from tol3d.planetary.roads import PlanetaryRoad
from tol3d.planetary.set_trials import SetTrials
from tol3d.planetary.shown import Made, ShownSet, shown_set
from tol3d.planetary.stack_up import StackUp
from tol3d.planetary.statuses import STATUSES
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.road import ANALYTIC_ROAD, Road, RoadKind
from tol3d.system.statuses import Statuses
from tol3d.system.system import Columns, KeyPath
from tol3d.system.trials import Trials

Array = NDArray[np.float64]

ROADS: Final[Mapping[str, RoadKind]] = {
    "exact": RoadKind("kernels", compiled=True),
    ANALYTIC_ROAD: RoadKind("kernels", compiled=True),
}


@dataclass(frozen=True)
class PlanetarySystem(SetTrials):
    """Implements System.

    Args:
        made: its gears by their names, nominal, to be shown.
    """

    made: Made

    roads: ClassVar[Mapping[str, RoadKind]] = ROADS
    statuses: ClassVar[Statuses] = STATUSES

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """See System."""
        return problems_of(self)

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """See System."""
        return {"kind": self.planetary_measures[measure.name].kind}

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

    def display(self, trials: Trials, road: Road) -> ShownSet:
        """Its gears in the first trial, see System."""
        return shown_set(self.own, self.made, self.deviated(trials), float(trials.positions[self.own.name][0]))
