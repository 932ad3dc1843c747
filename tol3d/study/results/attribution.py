"""Shares of the variance of each contributor: one decision for the screen, reports, charts and tables.

They are those of a regression where it explains EXPLAINED of the variance. Of the size of a vector, the worst of
several poses or a product it explains little, and names what little it explains. Then total effects take its place
where they need less than MOST_OF_RUN of the run's builds: builds in which one contributor is drawn again and all else
stays. Otherwise it is high–low–mean, two builds a contributor. That sees one contributor at a time: where what it sees
is less than a sum of effects could vary by, a product makes up the rest, and fewer pairs of builds tell more. With too
few even for those the regression's shares stay, and are said to be of what little it explains.

Source of total effects: Jansen, Analysis of variance designs for model output, Comput. Phys. Commun. 117 (1999).
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import IndependentSums, independent_shares, shares
from tol3d.study.effects.acting_contributors import AT_LEAST, acting
from tol3d.study.effects.high_low_mean import Ranges, high_low_mean_percents, high_low_mean_ranges
from tol3d.study.effects.regressors import regressor_groups
from tol3d.study.runs.summary.measure import SharesBy
from tol3d.study.system.dependent import reads_of
from tol3d.study.system.measure import Measure
from tol3d.study.system.stated import component_slices
from tol3d.study.system.trials import Trials, joined
from tol3d.study.tallies.regression import Sums
from tol3d.study.tallies.sample import finite
from tol3d.study.trials.budget import FREE, of_other_method, price
from tol3d.study.trials.draws import redrawn
from tol3d.study.trials.evaluation import Evaluation, batches
from tol3d.study.trials.simulation import Simulation
from tol3d.units import RESOLVED

Percent = tuple[float | None, float | None]
"""A share of the variance [%] and its standard error; None where unknown."""

EXPLAINED: Final = 0.9
"""Fraction of the variance from which on shares are those of the regression."""
MOST_OF_RUN: Final = 0.1
"""Builds for total effects, as a fraction of the trials."""
MOST_PAIRS: Final = 512
"""Pairs of builds of each contributor."""
LEAST_PAIRS: Final = 128
"""Pairs from which on total effects are taken before high–low–mean: random ones know them to 13 %, Sobol's better."""
TELLING_PAIRS: Final = 32
"""Pairs from which on they are taken where that which leads by high–low–mean has less than half of the largest."""
FEWEST_PAIRS: Final = 8
"""Pairs from which on they are taken where high–low–mean sees too little."""
SUM: Final = 4.0
"""Sum of squared ranges over the variance: no sum of effects within their ranges has less (Popoviciu 1935)."""


@dataclass(frozen=True)
class Attribution:
    """Shares of the variance of one measure, by one method.

    Args:
        percents: of each acting contributor, with their standard errors.
        by: means by which they were found.
        explained: fraction of the variance that the regression explains, less what chance does; None where unknown.
        lacks: whether that is too little for the regression's shares.
    """

    percents: Mapping[str, Percent]
    by: SharesBy
    explained: float | None
    lacks: bool = False


def by_regression(simulation: Simulation, measure: Measure, sums: Sums | None) -> Attribution:
    """Shares of the variance of each acting contributor by regression."""
    groups = regressor_groups(simulation, measure)
    if sums is None:
        return Attribution(dict.fromkeys(groups, (None, None)), "regression", None)
    if isinstance(sums, IndependentSums):
        share, error, unexplained = independent_shares(sums)
        percents = {
            name: (finite(100 * own), finite(100 * its))
            for name, own, its in zip(groups, share.tolist(), error.tolist(), strict=True)
        }
        return Attribution(percents, "regression", finite(1.0 - unexplained))
    found = shares(sums, groups, [block.names for block in simulation.copula.blocks])
    percents = {name: (finite(100 * found.share[name]), finite(100 * found.standard_error[name])) for name in groups}
    return Attribution(percents, "regression", finite(found.determined))


@dataclass(frozen=True)
class Attributed:
    """Attributions of a run's scalar measures by one method.

    Args:
        simulation: that was run.
        evaluation: of the system by the method.
        trials: of the run.
        alone: high–low–mean ranges by measure, where the method's are known.
    """

    simulation: Simulation
    evaluation: Evaluation
    trials: int
    alone: Mapping[str, Ranges] | None = None

    def of(self, regressed: Mapping[str, Sums]) -> Mapping[str, Attribution]:
        """Attributions by measure.

        Args:
            regressed: sums of each scalar measure with its regressors.
        """
        system = self.simulation.system
        measures = [own for own in system.measures if own.name in regressed]
        found = {own.name: by_regression(self.simulation, own, regressed[own.name]) for own in measures}
        lacking = [own for own in measures if _lacks(regressed[own.name], own, found[own.name])]
        if not lacking:
            return found
        ends = self.alone
        if ends is None:
            contacts = of_other_method(self.simulation, self.trials)
            ends = high_low_mean_ranges(system, lacking, self.evaluation.values, contacts)
        sigmas = {own.name: regressed[own.name].target_sigma for own in lacking}
        alone = {
            own.name: {name: ends.get(own.name, {}).get(name) for name in found[own.name].percents} for own in lacking
        }
        unseen = {name for name, own in alone.items() if not _adds_up(own, sigmas[name])}
        at_least = min(AT_LEAST, int(FREE / price(system, lacking))) if unseen else 0
        effects = self._total_effects(lacking, sigmas, at_least)
        for measure in lacking:
            own, seen = replace(found[measure.name], lacks=True), measure.name not in unseen
            pairs, known = effects.get(measure.name, (0, {}))
            high_low = {
                name: share for name, share in high_low_mean_percents(alone[measure.name]).items() if share is not None
            }
            largest = max((share or 0.0 for share, _ in known.values()), default=0.0)
            misled = seen and known and 2 * (known[max(high_low, key=high_low.__getitem__)][0] or 0.0) < largest
            least = LEAST_PAIRS if not misled else TELLING_PAIRS
            if known and pairs >= (least if seen else FEWEST_PAIRS):
                own = replace(own, percents=known, by="total effects")
            elif seen or (own.explained is None and any(high_low.values())):
                percents = {name: (share, None) for name, share in high_low.items()}
                own = replace(own, percents=percents, by="high-low-mean")
            found[measure.name] = own
        return found

    def _total_effects(
        self, measures: Sequence[Measure], sigmas: Mapping[str, float], at_least: int
    ) -> Mapping[str, tuple[int, Mapping[str, Percent]]]:
        """By measure the least number of pairs of builds of a contributor that could be assembled, and the shares.

        Nothing where contributors are correlated: they have no total effects of their own.

        Args:
            measures: which.
            sigmas: of each.
            at_least: builds that may be made of however short a run.
        """
        system = self.simulation.system
        acts = {own.name: [each.name for each in acting(self.simulation, own)] for own in measures}
        names = [
            contributor.name
            for contributor in system.contributors
            if any(contributor.name in act for act in acts.values())
        ]
        room = min(max(int(MOST_OF_RUN * self.trials), at_least) // (len(names) + 1), MOST_PAIRS)
        if self.simulation.copula.blocks or room < FEWEST_PAIRS:
            return {}
        count = 2 ** (room.bit_length() - 1)
        pairs = _Pairs(self.simulation, count, names)
        plain = self.evaluation.of(pairs.plain, measures)
        steps: dict[str, dict[str, Array]] = {own.name: {} for own in measures}
        for batch in batches(names, [count] * len(names), pairs.plain.deviations.shape[1]):
            found = self.evaluation.of(joined([pairs.exchanged(name) for name in batch]), measures)
            for measure in measures:
                each = found[measure.name].reshape(len(batch), count) - plain[measure.name]
                steps[measure.name] |= dict(zip(batch, each, strict=True))
        seen = {
            name: {own: step[np.isfinite(step)] for own, step in found.items() if own in acts[name]}
            for name, found in steps.items()
        }
        return {name: _of_variance(found, sigmas[name] ** 2) for name, found in seen.items()}


@dataclass(frozen=True)
class _Pairs:
    """Pairs of builds that have all in common but the draws of one contributor."""

    simulation: Simulation
    count: int
    names: Sequence[str]

    @cached_property
    def plain(self) -> Trials:
        return redrawn(self.simulation, self.count, ())

    @cached_property
    def _others(self) -> Trials:
        return redrawn(self.simulation, self.count, self.names)

    @cached_property
    def _read(self) -> Collection[str]:
        """Contributors whose draws others read."""
        return {name for contributor in self.simulation.system.contributors for name in reads_of(contributor)}

    @cached_property
    def _columns(self) -> Mapping[str, slice]:
        return component_slices(self.simulation.system)

    def exchanged(self, name: str) -> Trials:
        """The plain builds with other draws of a contributor, and what follows from them."""
        own = next(contributor for contributor in self.simulation.system.contributors if contributor.name == name)
        if name in self._read or reads_of(own):
            return redrawn(self.simulation, self.count, (name,))
        rows = self.plain.deviations.copy()
        rows[:, self._columns[name]] = self._others.deviations[:, self._columns[name]]
        return replace(self.plain, deviations=rows)


def _lacks(sums: Sums, measure: Measure, found: Attribution) -> bool:
    """True if a regression explains too little of what a measure varies by, or has too few trials to tell."""
    varies = sums.count > 1 and sums.target_sigma > RESOLVED * measure.per_internal
    return varies and (found.explained is None or found.explained < EXPLAINED)


def _adds_up(ranges: Ranges, sigma: float) -> bool:
    """True if a sum of effects within known ranges could vary as much as a measure does."""
    known = [own for own in ranges.values() if own is not None]
    return len(known) == len(ranges) and any(known) and sum(own**2 for own in known) >= SUM * sigma**2


def _of_variance(steps: Mapping[str, Array], variance: float) -> tuple[int, Mapping[str, Percent]]:
    """The least number of pairs of a contributor, and half of each one's mean square step [% of the variance].

    With standard errors. A total effect is no more than all: what chance, or builds that could not be assembled, add is
    cut off.
    """
    fewest = min(map(len, steps.values()), default=0)
    if fewest < FEWEST_PAIRS:
        return fewest, {}
    found = {}
    for name, step in steps.items():
        halves = 50.0 * step**2 / variance
        found[name] = min(float(np.mean(halves)), 100.0), float(np.std(halves)) / math.sqrt(len(halves))
    return fewest, found if any(share for share, _ in found.values()) else {}
