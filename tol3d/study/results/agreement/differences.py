"""Builds that are made again to explain the differences of the methods of a run, as many as may follow its trials.

First trials tell the order of the differences, those with the largest differences are looked at one by one, and second
differences name contributors. Where all that would take longer than the trials did the first trials come first, then
the worst ones, of the measures whose methods differ most, and the contributors that act most; the rest is said.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from tol3d.statistics.estimates.linear_fit import LEAST_FREEDOM
from tol3d.study.effects.regressors import MOST_REGRESSED, regressor_groups
from tol3d.study.results.agreement.explaining import ROUNDING, Case
from tol3d.study.results.agreement.explanation import Explanation
from tol3d.study.results.agreement.method_fits import MethodFits
from tol3d.study.results.agreement.second_look import BEND_POSITIONS, STEPS, bends, scalars_of, second_look
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Method
from tol3d.study.system.stated import component_count, component_slices, mean_deviations
from tol3d.study.system.system import System
from tol3d.study.tallies.tally import Tally
from tol3d.study.trials.budget import ALONE, Use, price
from tol3d.study.trials.evaluation import Evaluation, measures_alike
from tol3d.study.trials.simulation import Simulation

FURTHER_LOOKS = 256  # trials looked at again beyond the regressors: what is left of 256 has an rms known to 4 %
FURTHER_SLOW_LOOKS = 64  # by an engine with chord errors, which takes a millisecond for each of the three builds
LEAST_LOOKS = LEAST_FREEDOM + 1  # trials looked at again; with fewer nothing is told
NOT_LOOKED_AT = "looking at builds again would take longer than the trials did; more trials let more builds follow them"


def explanations(simulation: Simulation, method: Method | None, tally: Tally) -> dict[str, Explanation]:
    """Explanation of the difference of each scalar measure that both methods gave, however many builds it takes."""
    differences = Differences.of(simulation, method, tally)
    return differences.explained(differences.looks(differences.wanted))


@dataclass(frozen=True)
class Looks:
    """Builds that are made again to explain differences.

    Args:
        first: the number of the first trials that are looked at again.
        wanted: the number that would do for all fits.
        worst: trials of the largest difference that are looked at besides.
        unseen: measures whose trial of the largest difference is not looked at.
        bent: contributors whose second differences are taken.
        unbent: the number of the others.
        positions: at which they are taken.
    """

    first: int
    wanted: int
    worst: Sequence[int]
    unseen: Collection[str]
    bent: Collection[str]
    unbent: int
    positions: int

    @property
    def enough(self) -> bool:
        """True if anything can be told."""
        return self.first >= min(LEAST_LOOKS, self.wanted)


@dataclass(frozen=True, eq=False)
class Differences:
    """Differences of the methods in a run, to be explained.

    Args:
        simulation, tally: of the run.
        method: of its engine; None without one.
        fits: of each scalar measure that both methods gave; None where trials are too few.
    """

    simulation: Simulation
    method: Method | None
    tally: Tally
    fits: Mapping[str, MethodFits | None]

    @classmethod
    def of(cls, simulation: Simulation, method: Method | None, tally: Tally) -> Self:
        """Those of a run."""
        own = tally.measures
        measures = [m for m in scalars_of(simulation.system) if method is not None and own[m.name].disagreement]
        return cls(simulation, method, tally, {m.name: MethodFits.of(simulation, m, own[m.name]) for m in measures})

    @cached_property
    def _known(self) -> Mapping[str, MethodFits]:
        """Fits of measures with trials enough, of the largest difference beside what they vary by first."""
        known = [(name, fit) for name, fit in self.fits.items() if fit is not None]
        return dict(sorted(known, key=lambda own: -own[1].disagreement.largest / max(own[1].sigma, ROUNDING)))

    @cached_property
    def _wanted_first(self) -> int:
        measures = [measure for measure in self.simulation.system.measures if measure.name in self.fits]
        widest = max(_together(self.simulation, measure) for measure in measures)
        return 2 * widest + (FURTHER_SLOW_LOOKS if self.method and self.method.chord_error else FURTHER_LOOKS)

    @cached_property
    def _worst(self) -> Sequence[int]:
        return list(dict.fromkeys(max(fit.disagreement.trial, 0) for fit in self._known.values()))

    @cached_property
    def _of_a_build(self) -> int:
        """Contacts of a build by both methods."""
        return 2 * price(self.simulation.system, scalars_of(self.simulation.system))

    @cached_property
    def _of_a_position(self) -> float:
        """Contacts of all second differences at a position."""
        return ALONE * self._of_a_build * (1 + 2 * component_count(self.simulation.system))

    @property
    def wanted(self) -> Mapping[Use, float]:
        """Contacts that all takes that explains."""
        if not self._known:
            return {}
        builds = STEPS * (self._wanted_first + len(self._worst))
        positions = BEND_POSITIONS if self.simulation.system.streams else 1
        return {"second look": builds * self._of_a_build, "second differences": positions * self._of_a_position}

    def looks(self, contacts: Mapping[Use, float]) -> Looks | None:
        """Builds that are made, within contacts: first trials before the worst ones; None if nothing is to explain."""
        if not self._known:
            return None
        count = int(contacts["second look"] / (STEPS * self._of_a_build) + ROUNDING)
        worst = self._worst[: max(count - min(LEAST_LOOKS, self._wanted_first), 0)]
        seen = set(worst)
        positions = int(contacts["second differences"] / self._of_a_position + ROUNDING)
        slices = component_slices(self.simulation.system)
        bent = [*slices] if positions else self._largest(contacts["second differences"] / self._of_a_position)
        return Looks(
            min(count - len(worst), self._wanted_first),
            self._wanted_first,
            worst,
            [name for name, fit in self._known.items() if max(fit.disagreement.trial, 0) not in seen],
            bent,
            len(slices) - len(bent),
            min(max(positions, 1), BEND_POSITIONS),
        )

    def _largest(self, part: float) -> Sequence[str]:
        """Contributors that move a measure most, as many as have a part of all components."""
        sizes = dict[str, float]()
        for fit in self._known.values():
            for name, own in zip(fit.regressed.names, (fit.own / max(fit.sigma, ROUNDING)).tolist(), strict=True):
                sizes[name] = max(sizes.get(name, 0.0), own)
        slices, chosen = component_slices(self.simulation.system), list[str]()
        left = part * component_count(self.simulation.system)
        for name in sorted(sizes, key=lambda own: -sizes[own]):
            left -= slices[name].stop - slices[name].start
            if left < 0:
                break
            chosen.append(name)
        return chosen

    def explained(self, looks: Looks | None) -> dict[str, Explanation]:
        """Explanation of each measure's difference, from the builds that are made again."""
        simulation, method, system = self.simulation, self.method, self.simulation.system
        scalars = [measure for measure in system.measures if measure.name in self.fits]
        undecided = {
            scalar.name: Explanation(undecided=_too_few(simulation, scalar, self.tally))
            for scalar in scalars
            if self.fits[scalar.name] is None
        }
        if looks is None or method is None:
            return undecided
        if not looks.enough:
            return undecided | {name: Explanation(undecided=NOT_LOOKED_AT) for name in self._known}
        look = second_look(simulation, method, looks.first, looks.worst)
        bent, by_means = bends(simulation, method, looks.bent, looks.positions), _effects_of_means(system)
        places = {trial: looks.first + k for k, trial in enumerate(looks.worst)}
        return undecided | {
            scalar.name: Case(
                system,
                scalar,
                fit,
                look,
                places.get(max(fit.disagreement.trial, 0)),
                looks.first,
                looks.first >= looks.wanted,
                by_means[scalar.name],
                system.chord_bound(scalar, method.chord_error),
            ).explained(bent[scalar.name])
            for scalar in scalars
            if (fit := self.fits[scalar.name]) is not None
        }

    def not_looked_at(self, looks: Looks | None) -> Iterator[str]:
        """A sentence on what would have taken more builds than may follow the trials."""
        if looks is None:
            return
        if not looks.enough:
            yield f"why the methods differ: {NOT_LOOKED_AT}"
            return
        left = []
        if any(looks.first < _regressors(fit) + LEAST_FREEDOM + 1 for fit in self._known.values()):
            left.append(f"{looks.first} builds were looked at again, {looks.wanted} tell more")
        if looks.unseen:
            left.append(
                f"the trial of the largest difference was not looked at of {len(looks.unseen)} of {len(self._known)} "
                "measures"
            )
        if looks.unbent:
            left.append(f"second-order terms were looked for of {len(looks.bent)} tolerances, not of {looks.unbent}")
        if left:
            yield f"why the methods differ: {'; '.join(left)}; more trials let more builds follow them"


def _regressors(fit: MethodFits) -> int:
    return int(fit.regressed.ends[-1])


def _too_few(simulation: Simulation, measure: Measure, tally: Tally) -> str:
    own = tally.measures[measure.name].disagreement
    compared = own.sums.count if own else 0
    needed = 2 * _together(simulation, measure) + LEAST_FREEDOM + 1
    return f"{compared} trials are too few to tell what explains that, {needed} are enough"


def _together(simulation: Simulation, measure: Measure) -> int:
    """Largest number of contributors of a measure that are regressed on together."""
    return min(len(regressor_groups(simulation, measure)), MOST_REGRESSED)


def _effects_of_means(system: System) -> Mapping[str, Mapping[str, float]]:
    """Shift of each measure by each contributor's mean on the analytic method, in its unit, by measure and name."""
    found = {}
    slices = component_slices(system)
    for _, alike in measures_alike(system, scalars_of(system)):
        middle = mean_deviations(system, alike[0].positions)
        rows = np.zeros((len(slices) + 1, component_count(system)))
        for row, own in zip(rows[1:], slices.values(), strict=True):
            row[own] = middle[0, own]
        for name, values in Evaluation(system).values(rows, alike).items():
            found[name] = dict(zip(slices, np.abs(values[1:] - values[0]).tolist(), strict=True))
    return found
