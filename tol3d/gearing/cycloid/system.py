"""An RV reducer as a study sees it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from typing import Any, ClassVar, Final

from typing_extensions import override

from tol3d.gearing.cycloid.exact.places import usual_shapes
from tol3d.gearing.cycloid.model.shapes import lobe_strips
from tol3d.gearing.cycloid.reducer.formula import stages_by_formula
from tol3d.gearing.cycloid.reducer.neglected import neglected
from tol3d.gearing.cycloid.reducer.problems import problems_at
from tol3d.gearing.cycloid.reducer.regressors import TAKEN, regress_touching, slopes_over_turn
from tol3d.gearing.cycloid.reducer.resting import SOLVERS
from tol3d.gearing.cycloid.reducer.shown import ShownReducer
from tol3d.gearing.cycloid.reducer.trials import STATUSES, RVMethod, RVTrials
from tol3d.gearing.reducers.trials import Solver
from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import INDEPENDENT, Copula
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD, Method, MethodKind
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.pooled import PooledTerms
from tol3d.study.system.stated import mean_build
from tol3d.study.system.system import Columns, KeyPath, Published
from tol3d.study.system.trials import Trials

FCL: Final = "fcl"
WITNESS: Final = "tol3d.gearing.cycloid.reducer.witness"  # it loads FCL, in the worker
METHODS: Final[Mapping[str, MethodKind]] = {
    "exact": MethodKind("kernels", compiled=True, contacts_per_minute=900_000_000),
    FCL: MethodKind("discs: solid and measuring strips", threads=False, witness=True, contacts_per_minute=800_000),
    ANALYTIC_METHOD: MethodKind("kernels", compiled=True),
}


@dataclass(frozen=True)
class RVSystem(RVTrials):
    """Implements System.

    Args:
        width: of a disc where it is shown [mm]; None: a usual one.
        crank_hole: diameter of the discs' crank holes there [mm]; None: as large as walls allow.
        profile_steps: of the strips of a flank that FCL measures.
    """

    width: float | None = None
    crank_hole: float | None = None
    profile_steps: int = 120

    methods: ClassVar[Mapping[str, MethodKind]] = METHODS
    solvers: ClassVar[Mapping[str, Solver]] = SOLVERS
    statuses: ClassVar[Statuses] = STATUSES

    @override
    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        mean = self.deviated(mean_build(self, self.measures[0]))
        return problems_at(self.own, self.acts, self.contributors, mean)

    def materials(self, method: str) -> Any:
        """See System: the strips of a disc's solid, for FCL."""
        return (
            lobe_strips(usual_shapes(self.own.contact, self.width, self.crank_hole).discs[0], self.profile_steps)
            if method == FCL
            else None
        )

    @override
    def method(self, name: str, materials: Any) -> Method:
        if name == FCL:
            made: Method = import_module(WITNESS).witness(self, materials)
            return made
        return RVMethod(self, self.solvers[name].turning(self.own))

    def cost(self, measures: Sequence[Measure]) -> int:
        """Every pin of every disc at each position, for each sense; measures of one curve share them; see System."""
        read = [
            (own.positions, sense, own.deflection)
            for own in (self.read[measure.name] for measure in measures)
            for sense in ((1, -1) if own.is_free_turn else (own.load,))
        ]
        counted = {(positions, sense) for positions, sense, deflection in read if deflection is not None}
        apart = {own for own in read if own[2] is not None or own[:2] not in counted}
        return int(sum(positions.in_a_trial for positions, _, _ in apart)) * self.own.contacts

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """See System: by the contacts at the positions that are taken; of a harmonic and a curve by mean slopes."""
        own = self.read[measure.name]
        if own.positions.in_a_trial == 1:
            regress_touching(self, own, contributors, columns, rows)
        elif own.take in TAKEN:
            self.regress_slopes(own, contributors, columns, rows, partial(slopes_over_turn, self, own))
        else:
            super().regress(measure, contributors, columns, rows)

    @override
    def neglected(self, measure: Measure, trials: Trials) -> Mapping[str, Array]:
        return neglected(self, self.read[measure.name], trials)

    def sections(
        self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published, copula: Copula = INDEPENDENT
    ) -> Mapping[str, Any]:
        """Its cycloid stage by formula; see System."""
        found = stages_by_formula(self.own, self.acts, self.contributors)
        return {"cycloid_stages": found} if found else {}

    def display(self, trials: Trials, method: Method) -> ShownReducer:
        """Its parts in the first trial, see System."""
        turns = float(trials.positions[self.own.name][0])
        deviated = self.deviated(trials.part(0, 1))
        return ShownReducer(self.own, deviated, turns, self.width, self.crank_hole)


@dataclass(frozen=True)
class PlayingSystem(RVSystem):
    """A reducer whose bearings have play: no other engine knows its rest position."""

    methods: ClassVar[Mapping[str, MethodKind]] = {name: kind for name, kind in METHODS.items() if not kind.witness}
