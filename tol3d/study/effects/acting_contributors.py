"""Contributors that act on a measure: one answer for a run and for every analysis.

A contributor acts if theory gives it a slope, or if redrawing it moves the measure in one of a few dozen builds of the
study's engine: at a dead centre, of a cosine error or of a distance across nothing has a slope, and trials move all the
same. Only contributors without a slope are redrawn, all together first, then by halves (group testing, Dorfman 1943),
so that a scene where all have slopes pays nothing. Builds as they are drawn, builds with all contributors at ends of
their laws, and the worst by the analytic method are among them, so that some are out of limits.

That a contributor moved none of so many builds is no proof that it does not act; see `looked_at`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import Itself
from tol3d.study.effects.regions import Drawing, Rows, Space, furthest, gradient_of, settled
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import component_sigmas
from tol3d.study.system.measure import Measure
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import System
from tol3d.study.system.trials import Trials
from tol3d.study.trials.budget import PLACING, price
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.evaluation import Evaluation, measures_alike
from tol3d.study.trials.simulation import Seen, Simulation
from tol3d.study.trials.study import Study

MOVES: Final = 0.05
"""Change of a measure, as a share of its sigma, that counts: less has a share of the variance of about 1e-4."""
ROUNDING: Final = 1e-9
"""The same as a share of the measure's size."""
BUILDS: Final = 48
"""Builds of a measure, half of them as they are drawn, half at ends, but for the worst."""
WORST: Final = 12
FEWEST: Final = 6
"""Builds of a measure where there are many measures."""
FIRST: Final = 8
"""Builds that are looked at before the others: nearly all that acts moves one of these."""
POOL: Final = 128
"""Builds as they are drawn, and as many at ends, among which the worst are chosen by the analytic method."""
ENDS: Final = 4
"""Ends of each contributor."""
SHARE: Final = 0.05
"""Share of the builds of a run that may be made."""
AT_LEAST: Final = 100
"""Builds that may be made in any case."""


def acting(simulation: Simulation, measure: Measure) -> Sequence[Contributor]:
    """Contributors that act on a measure, in the system's order."""
    by_theory = simulation.system.acting(measure)
    seen = looked_at(simulation, measure).names
    if not seen:
        return by_theory
    names = seen | {own.name for own in by_theory}
    return [contributor for contributor in simulation.system.contributors if contributor.name in names]


def looked_at(simulation: Simulation, measure: Measure) -> Seen:
    """The contributors without a slope that were seen to act on a measure, and the number of builds that show it."""
    key = Itself(simulation.system)
    if key not in simulation.seen:
        simulation.seen[key] = _look(simulation)
    return simulation.seen[key].get(measure.name, Seen())


def nothing_acts(simulation: Simulation, measure: Measure) -> str:
    """A sentence on a measure that depends on no contributor, as far as was seen; "" where one acts."""
    if acting(simulation, measure):
        return ""
    builds = looked_at(simulation, measure).builds
    return f"no tolerance was seen to act on it in {builds} builds" if builds else "no tolerance acts on it"


def _look(simulation: Simulation) -> Mapping[str, Seen]:
    system, engine = simulation.system, simulation.study.engine
    without = {measure.name: names for measure in system.measures if (names := _without_slope(system, measure))}
    if not without:
        return {}
    method = system.method(engine, system.materials(engine)) if simulation.has_geometry else None
    evaluation, measures = (
        Evaluation(system, method),
        [measure for measure in system.measures if measure.name in without],
    )
    prices = {measure.name: price(system, (measure,)) for measure in measures}
    budget = max(SHARE * simulation.study.trials, AT_LEAST) * price(system, system.measures)
    count = int(np.clip(budget / (max(prices.values()) + sum(prices.values())), FEWEST, BUILDS))
    found = {}
    for turning, alike in measures_alike(system, measures):
        builds = _Builds.of(simulation, turning, count)
        for look in _looks(evaluation, builds, {own.name: without[own.name] for own in alike}, alike):
            name = look.measure.name
            look.left = int(budget / len(measures) / prices[name]) - count
            found[name] = Seen(count, frozenset(look.acting_of(without[name], moves=look.moved)))
    return found


def _without_slope(system: System, measure: Measure) -> tuple[str, ...]:
    """Names of contributors that vary and do not act by theory."""
    names = {own.name for own in system.acting(measure)}
    others = (contributor for contributor in system.contributors if contributor.name not in names)
    return tuple(other.name for other in others if any(sigma > 0.0 for sigma in component_sigmas(other.draw)))


@dataclass(frozen=True, eq=False)
class _Builds:
    """Builds of measures that share a mean build, in turn as they are drawn and with all contributors at ends.

    Args:
        space: the regions of all contributors, whether they act or not.
        builds, others: deviations, and other ones of both kinds for each build (builds, components).
        positions: of the builds.
        pool: builds of both kinds among which the worst are chosen.
    """

    space: Space
    builds: Array
    others: Array
    positions: Mapping[str, Array]
    pool: Array

    @classmethod
    def of(cls, simulation: Simulation, turning: Mapping[str, bool], count: int) -> "_Builds":
        """So many builds."""
        slices = component_slices(simulation.system)
        drawings = [Drawing(contributor.name, contributor.draw, slices[contributor.name], turning[contributor.name])
                    for contributor in simulation.system.contributors]  # fmt: skip
        space, every = Space(drawings), 2 * count + POOL
        plain = replace(simulation, study=Study(trials=every, engine=simulation.study.engine))
        trials, ends = drawn(plain, 0, every), _mixed_ends(space, every)
        number = np.arange(count)
        builds = np.where((number % 2 == 0)[:, None], trials.deviations[:count], ends[:count])
        others = np.where((number % 4 < 2)[:, None], trials.deviations[count : 2 * count], ends[count : 2 * count])
        positions = {name: own[:count] for name, own in trials.positions.items()}
        pool = np.concatenate([trials.deviations[2 * count :], ends[2 * count :]])
        return cls(space, builds, others, positions, pool)


def _mixed_ends(space: Space, count: int) -> Array:
    """Builds (count, components) with each contributor at one of a few ends of its own."""
    generator = np.random.default_rng(1)
    slopes = generator.standard_normal((ENDS, len(space.mean)))
    each = furthest(space, np.repeat(space.mean[None], ENDS, axis=0), slopes)
    chosen = [generator.integers(ENDS, size=count) for _ in space.drawings]
    rows = np.repeat(space.mean[None], count, axis=0)
    towards = np.zeros_like(rows)
    for own, place in zip(space.drawings, chosen, strict=True):
        rows[:, own.columns], towards[:, own.columns] = each.deviations[place, own.columns], slopes[place, own.columns]
    return settled(space, Rows(rows, towards, np.ones_like(rows))).deviations


@dataclass(eq=False)
class _Look:
    """Builds of a measure, and other deviations for each of them.

    Args:
        evaluation, measure: by which it is read.
        builds, others: deviations (builds, components).
        positions: of the builds.
        values: of the measure (builds,), or (builds, positions) of a curve; nan where one cannot be assembled.
        moved: whether redrawing all contributors without a slope moves it.
        left: builds that may still be made.
    """

    evaluation: Evaluation
    measure: Measure
    builds: Array
    others: Array
    positions: Mapping[str, Array]
    values: Array
    moved: bool = False
    left: int = 0

    @cached_property
    def least(self) -> float:
        """Change that counts, by the spread of builds as they are drawn."""
        as_drawn = self.values[: BUILDS - WORST : 2]
        good = as_drawn[np.isfinite(as_drawn).reshape(len(as_drawn), -1).all(axis=1)]
        spread = float(np.std(good, axis=0).max()) if len(good) else 0.0
        size = float(np.max(np.abs(self.values), where=np.isfinite(self.values), initial=0.0))
        return MOVES * spread + ROUNDING * size

    def redrawn(self, names: Sequence[str]) -> Array:
        """The builds with others' deviations of some contributors (builds, components)."""
        slices, builds = component_slices(self.evaluation.system), self.builds.copy()
        for name in names:
            builds[:, slices[name]] = self.others[:, slices[name]]
        return builds

    def differs(self, values: Array, rows: slice) -> bool:
        """True if values of redrawn builds are others, or cannot be assembled where the builds can, or can be."""
        before = self.values[rows]
        alike = (np.abs(values - before) <= self.least) | (np.isnan(values) & np.isnan(before))
        return not alike.all()

    def acting_of(self, names: Sequence[str], *, moves: bool | None = None) -> Sequence[str]:
        """Those that move the measure; where builds run short, all of a group that does."""
        if not (self._moves(names) if moves is None else moves):
            return ()
        if len(names) == 1 or self.left <= 0:
            return names
        half = len(names) // 2
        return [*self.acting_of(names[:half]), *self.acting_of(names[half:])]

    def _moves(self, names: Sequence[str]) -> bool:
        builds = self.redrawn(names)
        for rows in (slice(0, FIRST), slice(FIRST, len(builds))):
            some = Trials(builds[rows], {name: own[rows] for name, own in self.positions.items()})
            self.left -= len(some)
            if len(some) and self.differs(self.evaluation.of(some, (self.measure,))[self.measure.name], rows):
                return True
        return False


def _looks(
    evaluation: Evaluation, builds: _Builds, without: Mapping[str, Sequence[str]], measures: Sequence[Measure]
) -> Sequence[_Look]:
    """Looks at measures, all contributors without a slope redrawn together; of few measures some builds are the worst.

    Where a build is dear for its parts and not for what is read of them, all builds are placed at once.
    """
    count, system = len(builds.builds), evaluation.system
    if count < BUILDS:
        values = evaluation.of(Trials(builds.builds, builds.positions), measures)
        own = {measure.name: (builds.builds, values[measure.name]) for measure in measures}
    else:
        own = {}
        for measure in measures:
            rows = np.concatenate([builds.builds[:-WORST], _worst(system, measure, builds)])
            own[measure.name] = rows, evaluation.of(Trials(rows, builds.positions), (measure,))[measure.name]
    looks = [
        _Look(evaluation, measure, rows, builds.others, builds.positions, values)
        for measure in measures
        for rows, values in [own[measure.name]]
    ]
    together = system.cost(measures) <= PLACING * len(measures)
    for some in [looks] if together else [[look] for look in looks]:
        redrawn = np.concatenate([look.redrawn(without[look.measure.name]) for look in some])
        places = {name: np.concatenate([each] * len(some)) for name, each in builds.positions.items()}
        values = evaluation.of(Trials(redrawn, places), [look.measure for look in some])
        for k, look in enumerate(some):
            its = values[look.measure.name][k * count : (k + 1) * count]
            look.moved = look.differs(its, slice(None))
    return looks


def _worst(system: System, measure: Measure, builds: _Builds) -> Array:
    """Builds (WORST, components) lowest and highest by the analytic method at rest, and those at ends by its slopes."""
    analytic, space = Evaluation(system), builds.space

    def built(deviations: Array, positions: Mapping[str, Array]) -> tuple[Array, NDArray[np.int8]]:
        found = analytic.values(deviations, (measure,))[measure.name].reshape(len(deviations), -1).mean(axis=1)
        return found, np.zeros(len(found), dtype=np.int8)

    values, mean = built(builds.pool, {})[0], space.mean[None]
    slopes = gradient_of(space, built, mean, {}, built(mean, {})[0], 1.0)
    ends = settled(space, furthest(space, np.repeat(mean, 2, axis=0), np.concatenate([-slopes, slopes])))
    ranked, half = np.argsort(values), WORST // 2 - 1
    return np.concatenate([ends.deviations, builds.pool[ranked[:half]], builds.pool[ranked[-half:]]])
