"""Measures and trials of a reducer, and the method that reads them; its two methods differ in the turns of shafts."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Final, Literal

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from tol3d.gearing.reducers.deviations import Acts, Deviations
from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD, Answers
from tol3d.study.system.output_system import OutputSystem, Parts
from tol3d.study.system.plain import PlainMeasure, one_position, stated_of
from tol3d.study.system.pooled_statistic import HalfSpan
from tol3d.study.system.positions import Positions, Take
from tol3d.study.system.spectrum import Spectrum
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import Columns
from tol3d.study.system.trials import Trials

Reading = Literal["lost motion", "low stiffness", "drive", "back"]


@dataclass(frozen=True, kw_only=True)
class ReducerMeasure(PlainMeasure):
    """A measure of one reducer.

    Args:
        reading: the whole free turn of a shaft, its turn against springs alone, or the output's rest position while
            its load resists it (drive) or drives it on (back).
        shaft: that turns.
        deflection: contacts within it are counted then [mm]; None where the turn itself is read.
    """

    reading: Reading
    shaft: str
    deflection: float | None = None

    @property
    def is_free_turn(self) -> bool:
        """True if it is a free turn of a shaft at one position, or a part of it."""
        return self.reading in ("lost motion", "low stiffness")

    @property
    def counts(self) -> bool:
        """True if contacts are counted."""
        return self.deflection is not None

    @property
    def load(self) -> int:
        """Sense in which a load turns the output: back (-1) where it resists."""
        return -1 if self.reading == "drive" else 1

    @property
    def curve_key(self) -> Hashable:
        """Measures of one key are read from the same curve."""
        return self.reading, self.shaft, self.positions


def reducer_measure(
    name: str, spec: Any, reading: Reading, shaft: str, take: Take = "value", deflection: float | None = None
) -> ReducerMeasure:
    """A measure that a scene states: at one position, or over a turn of the output.

    Args:
        name, spec: of the scene; over a turn it has its number of positions, and orders of what is taken.
        reading, shaft, deflection: see ReducerMeasure.
        take: of its positions.
    """
    positions = one_position(spec.over)
    if spec.over == "turn":  # over it the curve bends where other contacts take over
        positions = Positions("turn", 1, spec.positions, jumps=True)
    orders = (spec.order or 1,) if take == "harmonic" else getattr(spec, "orders", None) if take == "curve" else None
    rests = take == "value" and reading in ("drive", "back") and deflection is None
    return ReducerMeasure(
        *stated_of(name, spec),
        worse="high" if deflection is None else "low",
        adds_up=False,
        pooled_statistics=(HalfSpan(),) if rests else (),
        positions=positions,
        take=take,
        spectrum=Spectrum.over(positions, orders) if orders else None,
        reading=reading,
        shaft=shaft,
        deflection=deflection,
    )


@dataclass(frozen=True)
class Solver:
    """One of the two solvers of a kind of reducers.

    Args:
        turning: turns of the shafts of a reducer by it, from the reducer's model.
        is_kept: True if its kernels for that model are compiled on this machine.
    """

    turning: Callable[[Any], Any]
    is_kept: Callable[[Any], bool]


@dataclass(frozen=True)
class ReducerTrials(OutputSystem):
    """The part of the System of a reducer that all models share.

    Args:
        acts: effect of each contributor, by its name.
    """

    solvers: ClassVar[Mapping[str, Solver]]
    """By the names of both methods."""

    made_of: ClassVar[type[Deviations]]
    """Deviations of its parts."""

    acts: Mapping[str, Acts]

    @abstractmethod
    def gap_bound(self, measure: Measure, errors: Any) -> float:
        """Bound on the effect of errors of gaps [mm] on a measure, in its unit."""

    def deviated(self, trials: Trials) -> Any:
        """Deviations of its parts in trials."""
        drawn = ((name, trials.deviations[:, own]) for name, own in component_slices(self).items())
        return self.made_of.drawn(self.own, self.acts, drawn, len(trials))

    def is_compiled(self, method: str) -> bool:
        """See System; a witness takes the kernels of the analytic method."""
        return self.solvers.get(method, self.solvers[ANALYTIC_METHOD]).is_kept(self.own)

    def turns_at(self, measure: Measure, trials: Trials) -> Array:
        """Turns of the output (trials,) at the only position of a measure."""
        return np.broadcast_to(self.turns(measure.positions, trials), (len(trials), 1))[:, 0]

    @override
    def describe(self, measure: Measure) -> Mapping[str, Any]:
        own: ReducerMeasure = self.read[measure.name]
        order = {"order": int(own.spectrum.orders[0])} if own.take == "harmonic" and own.spectrum else {}
        counted = {} if own.deflection is None else {"deflection_um": round(1e3 * own.deflection, 9)}
        return {"kind": own.kind, "of": self.own.name, **order, **counted}

    def regress_slopes(
        self,
        measure: Measure,
        contributors: Sequence[Contributor],
        columns: Columns,
        rows: Mapping[str, Array],
        slopes_of: Callable[[Trials], Deviations],
    ) -> None:
        """Regress by parts with the contacts of each trial; see System.regress.

        Which contacts are met turns from trial to trial. With those of a trial a turn is a sum of parts, one of each
        contributor, and none is left over; so is whatever adds or subtracts turns at positions: lost motions, extremes,
        ranges, and a harmonic along its own phase. A contributor's part is its regressor. Its share of the variance is
        then the covariance of its part with the measure: of the absolute value of a normal sum, whose parts neither
        raise nor lower it on average, that is each one's share of the variance of the sum.

        Args:
            measure, contributors, columns, rows: see System.regress.
            slopes_of: change of the measure [mm or rad] by each deviation in some trials.
        """

        def parts(trials: Trials) -> Parts:
            slopes = slopes_of(trials)
            return lambda own, off: slopes.term(self.own, self.acts[own.name], off)

        self.regress_parts(measure, contributors, columns, rows, parts)


@dataclass(frozen=True)
class Read:
    """A measure of some trials.

    Args:
        values: (trials, positions) [rad], or counts.
        status: codes (trials,) of the system's statuses.
        details: columns besides.
    """

    values: Array
    status: NDArray[np.int8]
    details: Mapping[str, NDArray[np.generic]] = field(default_factory=dict)


@dataclass(frozen=True)
class ReducerMethod(ABC):
    """Implements Method."""

    system: ReducerTrials
    chord_error: float = field(default=0.0, kw_only=True)

    @abstractmethod
    def read(self, measure: Any, deviated: Any, trials: Trials, known: dict[Hashable, Any]) -> Read:
        """A measure of trials with these deviations; `known` keeps what measures share."""

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Method."""
        deviated, known = self.system.deviated(trials), dict[Hashable, Any]()
        asked: list[ReducerMeasure] = [self.system.read[measure.name] for measure in measures]
        counts_first = sorted(asked, key=lambda own: not own.counts)
        found = {own.name: self.read(own, deviated, trials, known) for own in counts_first}
        return Answers(
            {own.name: found[own.name].values for own in asked},
            details={name: column for own in asked for name, column in found[own.name].details.items()},
            status={own.name: found[own.name].status for own in asked},
        )


MOST_POSITIONS: Final = 24
"""Largest number of positions of a measure that a witness reads: a turn of 200 would take it seconds a trial."""


@dataclass(frozen=True, kw_only=True)
class Witnesses:
    """The rest of WitnessMethod, of a ReducerMethod by faceted parts.

    Args:
        errors: of gaps by chords, and by all else, as the system's gap_bound takes them.
    """

    errors: tuple[Any, Any]

    def reads(self: Any, measure: Measure) -> bool:
        """See WitnessMethod: all but counts."""
        return not self.system.read[measure.name].counts and measure.positions.in_a_trial <= MOST_POSITIONS

    def bounds(self: Any, measure: Measure) -> tuple[float, float]:
        """See WitnessMethod."""
        chords, others = (self.system.gap_bound(measure, error) for error in self.errors)
        return chords, others
