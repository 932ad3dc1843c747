"""A planetary set as a study sees it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from importlib import import_module
from typing import Any, ClassVar, Final

import numpy as np
from typing_extensions import override

from tol3d.cad.solids import measuring_strips
from tol3d.gearing.planetary.backlash import set_backlash
from tol3d.gearing.planetary.exact.shown import Made, ShownSet, shown_set
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.problems import problems_at
from tol3d.gearing.planetary.sections import set_sections, spring_summary
from tol3d.gearing.planetary.spring_curve import LeafSpring
from tol3d.gearing.planetary.summary_types import PlanetarySetSummary
from tol3d.gearing.planetary.trials import STATUSES, PlanetaryMethod, SetTrials
from tol3d.gearing.reducers.trials import ReducerMeasure
from tol3d.gearing.summary.types import BacklashLimits
from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import INDEPENDENT, Copula
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD, Method, MethodKind
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.pooled import PooledTerms
from tol3d.study.system.stated import mean_build
from tol3d.study.system.system import Columns, KeyPath, Published
from tol3d.study.system.taken import weights_taken
from tol3d.study.system.trials import Trials

FCL: Final = "fcl"
WITNESS: Final = "tol3d.gearing.planetary.witness"  # it loads FCL, in the worker
METHODS: Final[Mapping[str, MethodKind]] = {
    "exact": MethodKind("kernels", compiled=True, contacts_per_minute=120_000_000),
    FCL: MethodKind("gears: solids and measuring strips", threads=False, witness=True, contacts_per_minute=14_000),
    ANALYTIC_METHOD: MethodKind("kernels", compiled=True),
}


@dataclass(frozen=True)
class PlanetarySystem(SetTrials):
    """Implements System.

    Args:
        made: its gears by their names, nominal, to be shown.
        friction: coefficient of friction of the teeth; None where none is given.
        profile_steps: of the strips that FCL measures.
        spring: of a flexible carrier; None where none is given.
    """

    made: Made
    friction: float | None = None
    profile_steps: int = 120
    spring: LeafSpring | None = None

    methods: ClassVar[Mapping[str, MethodKind]] = METHODS
    statuses: ClassVar[Statuses] = STATUSES

    @override
    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        measure = self.measures[0]
        return problems_at(self.own, self.deviated(mean_build(self, measure)), self.read[measure.name].shaft)

    # its methods --------------------------------------------------------------------------------------

    def materials(self, method: str) -> Any:
        """See System: the strips of every gear's solid, for FCL."""
        if method != FCL:
            return None
        return {name: measuring_strips(gear, self.profile_steps) for name, gear in self.made.items()}

    @override
    def method(self, name: str, materials: Any) -> Method:
        if name == FCL:
            made: Method = import_module(WITNESS).witness(self, self.made, materials)
            return made
        turning = self.solvers[name].turning
        return PlanetaryMethod(self, turning(self.own), turning(self.overcome))

    def cost(self, measures: Sequence[Measure]) -> int:
        """A contact for each mesh of each planet, at each position; measures of one curve share them; see System."""
        read = {
            own.name if own.is_free_turn else own.curve_key: own.positions.in_a_trial
            for own in (self.read[measure.name] for measure in measures)
        }
        return int(sum(read.values())) * self.own.planets * len(self.own.meshes)

    # what acts on a measure -------------------------------------------------------------------------

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """See System: offsets as they lie seen from the planets."""
        own = self.read[measure.name]
        self.regress_slopes(own, contributors, columns, rows, partial(slopes_of, self, own))

    def sections(
        self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published, copula: Copula = INDEPENDENT
    ) -> Mapping[str, Any]:
        """Limits of backlash; efficiencies and torques of the set, where friction or a spring is given; see System."""
        limits = self.backlash_limits(copula)
        found: dict[str, Any] = {"backlash": limits} if limits else {}
        return found | ({"planetary_sets": self.summaries} if self.summaries else {})

    def backlash_limits(self, copula: Copula = INDEPENDENT) -> Sequence[BacklashLimits]:
        """Limits of the backlash of its meshes."""
        return set_backlash(self.own, self.made, self.contributors, self.acts, copula)

    @cached_property
    def summaries(self) -> Mapping[str, PlanetarySetSummary]:
        """Efficiencies, and data of a spring of the carrier, by the set's name; empty if neither is given."""
        if self.spring is None:
            return set_sections(self.own, self.friction)
        mean = self.deviated(mean_build(self, self.measures[0]))
        return set_sections(self.own, self.friction, spring_summary(self.own, mean, self.spring))

    def display(self, trials: Trials, method: Method) -> ShownSet:
        """Its gears in the first trial, see System."""
        return shown_set(self.own, self.made, self.deviated(trials), float(trials.positions[self.own.name][0]))


def slopes_of(system: SetTrials, measure: ReducerMeasure, trials: Trials) -> Deviated:
    """Change of a measure [rad] by a unit of each deviation in each trial, while contacts that are met stay the same.

    The multipliers of first-order gaps times what deviations do to these; zeros of trials that jam.
    """
    own, deviated, shaft = system.own, system.deviated(trials), measure.shaft
    method, stands = StackUp(own), own.opposite(measure.shaft)
    if measure.is_free_turn:
        at = system.turns_at(measure, trials)
        slopes = method.lost_motion_slopes(deviated, at, shaft)
        if measure.reading == "lost motion":
            return slopes
        return StackUp(system.overcome).lost_motion_slopes(deviated, at, shaft).plus(slopes, -1.0)
    turns = np.array(measure.positions.fixed) / (2 * np.pi)

    def coefficients(ends: Array) -> Array:
        return own.sense * weights_taken(measure, own.sense * ends)

    return method.slopes(deviated, turns, shaft, stands, own.end(measure.load), coefficients)
