"""Some trials again with a part of their deviations: the growth of the methods' difference shows its order.

How many trials, and how many contributors' bends, the run says, see budget.py.

A first-order stack-up is right if its difference to the geometry goes as the square of the deviations. Along the ray
from the nominal build to a trial's the difference is D(t) = D(0) + t L + t^2 Q + ...: two short steps give Q, which a
stack-up neglects, and what is left of D(1) is of first order, or jumps. A kink that the stack-up has too, such as the
one-sided loss by a tilt, is of first order as any slope.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import IndependentSums, RegressorSums
from tol3d.statistics.estimates.lazy import sparse_products
from tol3d.study.effects.regressors import Regressed, regressor_sets
from tol3d.study.system.draw import component_sigmas
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Method
from tol3d.study.system.positions import AT_RANDOM
from tol3d.study.system.stated import component_slices, mean_deviations
from tol3d.study.system.system import Described, System
from tol3d.study.system.trials import Trials, joined
from tol3d.study.tallies.regression import Sums
from tol3d.study.trials.columns import drawn_columns
from tol3d.study.trials.draws import drawn, drawn_ones
from tol3d.study.trials.evaluation import Evaluation
from tol3d.study.trials.simulation import Simulation

SHORT_STEPS = (0.25, 0.5)  # of the deviations; of what is of third order three quarters count as second
LONG_STEPS = (0.5, 1.0)  # for an engine with chord errors, which short steps would magnify
STEPS = 4  # builds of a trial that is looked at again: its own, the nominal one, and those of two shorter steps
BEND_SIGMAS = 3.0  # where a contributor's second difference is taken
BEND_POSITIONS = 4  # drawn ones, over which it is averaged: what turns acts at each by another component
NAMED_BENDS = 3  # contributors named for the second order
NAMED_SHARE = 0.1  # of the largest second difference; smaller ones are not named


@dataclass(frozen=True, eq=False)
class SecondLook:
    """Differences (geometric - analytic) of some trials, by measure and in its unit; nan if a build failed.

    Args:
        trials: which.
        whole: of their builds, (trials,).
        nominal: of the nominal build at their positions, (trials,).
        second_order: Q, (trials,).
        regressors: of the set that each measure is in, (regressors of the set, trials).
    """

    trials: Trials
    whole: Mapping[str, Array]
    nominal: Mapping[str, Array]
    second_order: Mapping[str, Array]
    regressors: Mapping[str, Array]

    def left(self, measure: str) -> Array:
        """Part that is neither there at the nominal build nor of second order, (trials,)."""
        return self.whole[measure] - self.nominal[measure] - self.second_order[measure]

    def sums(self, measure: str, regressed: Regressed, target: Array) -> Sums:
        """Sums of a target (trials,) with a measure's regressors, over the trials for which it is known."""
        good = ~np.isnan(target)
        rows = self.regressors[measure][np.ix_(regressed.rows, good)]
        if regressed.picked is None:
            return RegressorSums.of_each(rows, target[None, good])[0]
        own = regressed.picked.clusters
        return IndependentSums.of_each(rows, target[None, good], own, [own.all], sparse_products())[0]


def scalars_of(system: Described) -> tuple[Measure, ...]:
    """The measures of one value a trial."""
    return tuple(measure for measure in system.measures if measure.take != "curve")


def second_look(simulation: Simulation, method: Method, count: int, others: Sequence[int]) -> SecondLook:
    """Look at a study's first `count` trials again, and after them at some others."""
    system = simulation.system
    measures = scalars_of(system)
    trials = joined([drawn(simulation, 0, count), drawn_ones(simulation, others)])
    near, far = SHORT_STEPS if method.chord_error == 0.0 else LONG_STEPS
    steps = dict.fromkeys((1.0, 0.0, near, far))
    rays = joined([trials.scaled(step) for step in steps])  # one call: over a path of many poses calls are dear
    found = _differences(system, method, rays, measures)
    pieces = {name: dict(zip(steps, np.split(own, len(steps)), strict=True)) for name, own in found.items()}
    whole, nominal, at_near, at_far = (
        {name: own[step] for name, own in pieces.items()} for step in (1.0, 0.0, near, far)
    )
    ratio = far / near  # D(far) - ratio D(near) has no L left
    second_order = {
        name: ((at_far[name] - nominal[name]) - ratio * (at_near[name] - nominal[name])) / (near * far * (ratio - 1))
        for name in whole
    }
    rows, columns = dict[str, Array](), drawn_columns(system, trials)
    for own in regressor_sets(simulation):
        made = own.rows(system, columns) if columns else np.empty((0, count + len(others)))
        rows |= dict.fromkeys((measure.name for measure in own.measures), made)
    return SecondLook(trials, whole, nominal, second_order, rows)


def _differences(system: System, method: Method, trials: Trials, measures: Sequence[Measure]) -> Mapping[str, Array]:
    """Differences of builds that seat; of a measure that keeps its overlaps, those of builds that overlap too."""
    analytic = Evaluation(system).of(trials, measures)
    geometric = Evaluation(system, method).of(trials, measures, lambda own: own.keeps_overlap)
    return {measure.name: geometric[measure.name] - analytic[measure.name] for measure in measures}


def bends(
    simulation: Simulation, method: Method, names: Collection[str], positions: int
) -> Mapping[str, Mapping[str, float]]:
    """Second differences of (geometric - analytic) at +-3 sigma of each contributor alone, by measure and contributor.

    Half of f(m + 3 s) - 2 f(m) + f(m - 3 s), averaged over positions, in the measure's unit; a contributor with
    components: their sum. Its ninth is the shift of the mean. nan if a build cannot be assembled.

    Args:
        simulation, method: of the run.
        names: of the contributors; none are asked of others.
        positions: drawn ones, where positions are drawn.
    """
    system = simulation.system
    measures = scalars_of(system)
    if not names:
        return {measure.name: {} for measure in measures}
    middle = mean_deviations(system, AT_RANDOM)
    steps = np.diag([BEND_SIGMAS * sigma for c in system.contributors for sigma in component_sigmas(c.draw)])
    slices = {name: own for name, own in component_slices(system).items() if name in names}
    steps = steps[np.concatenate([np.arange(own.start, own.stop) for own in slices.values()])]
    builds = np.concatenate([middle, middle + steps, middle - steps])
    first = drawn(simulation, 0, positions)
    each = []
    for position in range(positions if first.positions else 1):  # one by one: builds go with contributors squared
        there = {name: np.full(len(builds), values[position]) for name, values in first.positions.items()}
        each.append(_differences(system, method, Trials(builds, there), measures))
    return {m.name: _bends(slices, np.stack([found[m.name] for found in each])) for m in measures}


def _bends(slices: Mapping[str, slice], values: Array) -> Mapping[str, float]:
    """Bends from the differences (positions, 1 + 2 steps) of the middle, all steps forth and all steps back."""
    count = values.shape[1] // 2
    half = ((values[:, 1 : count + 1] + values[:, count + 1 :]) / 2 - values[:, :1]).mean(axis=0)
    starts = np.cumsum([0, *(own.stop - own.start for own in slices.values())]).tolist()
    return {name: float(half[slice(*own)].sum()) for name, own in zip(slices, pairwise(starts), strict=True)}


def largest_bends(bent: Mapping[str, float]) -> tuple[str, ...]:
    """Names of the largest second differences, the largest first; none if unknown."""
    ranked = sorted((name for name, bend in bent.items() if bend), key=lambda name: -abs(bent[name]))
    most = abs(bent[ranked[0]]) if ranked else 0.0
    return tuple(name for name in ranked[:NAMED_BENDS] if abs(bent[name]) > NAMED_SHARE * most)
