"""First order by differences: the effect of each deviation on a measure, by either method.

No theory is needed, so any system has it; both methods stand beside each other before a trial is drawn.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.study.effects.acting_contributors import acting
from tol3d.study.effects.extremes import ends_together
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import Copula
from tol3d.study.system.dependent import reads_of
from tol3d.study.system.draw import JointDraw, drawn_each
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Method
from tol3d.study.system.stated import component_slices, mean_deviations
from tol3d.study.system.system import Described, System
from tol3d.study.trials.correlated import divided_variances
from tol3d.study.trials.evaluation import Values, batches, evaluations, of_alike
from tol3d.study.trials.simulation import Simulation

ALIKE = 1e-6  # of the greatest; slopes of features that are alike differ by rounding and by where they stand
AS_LARGE = 0.99  # of the size of another one: of slopes of both signs the positive one is shown, by either method
NOISE = 1e-9  # of the values; smaller differences are rounding, and have no sign


@dataclass(frozen=True)
class FirstOrderEffect:
    """First-order effect of a contributor on a measure, at the mean build.

    Args:
        name, unit: of the contributor.
        slope: change of the measure [its unit] per unit of the deviation; of several components the size of their
            gradient, of several deviations of their own that of each or the greatest; nan where a build fails.
        each: number of independent deviations, such as one per feature; 1 for a single one or for components.
        alike: True if their slopes are equal.
        variance: its part of the measure's variance [the measure's unit, squared].
        reach: change of the measure between its low and high ends [the measure's unit].
    """

    name: str
    unit: str
    slope: float
    variance: float
    reach: float
    each: int = 1
    alike: bool = True


@dataclass(frozen=True)
class FirstOrder:
    """A measure by one method before any trial, in its unit; nan where a build cannot be assembled.

    Args:
        nominal: without deviations.
        mean: with every contributor at its mean.
        effects: of the contributors that act on it.
        ends: every contributor at its lowering limit, and at its raising one, by the sign of its slopes:
            the worst case of a measure that is a sum of effects.
    """

    nominal: float
    mean: float
    effects: tuple[FirstOrderEffect, ...]
    ends: tuple[float, float]

    @property
    def sigma(self) -> float:
        """Standard deviation by the root sum of squares (RSS)."""
        return math.sqrt(sum(effect.variance for effect in self.effects))

    def variance_percent(self, effect: FirstOrderEffect) -> float:
        """Share of the variance [%]; 0 if nothing varies."""
        return _percent(effect.variance, sum(own.variance for own in self.effects))

    def reach_percent(self, effect: FirstOrderEffect) -> float:
        """Share of the worst case [%]: of the sum of all reaches; 0 if nothing varies."""
        return _percent(effect.reach, sum(own.reach for own in self.effects))


def first_orders(
    simulation: Simulation, method: Method | None, measures: Sequence[Measure]
) -> dict[str, dict[str, FirstOrder]]:
    """Measures of one number a trial, by name and method: "analytic", and "geometric" if there is an engine.

    Args:
        simulation: to be studied.
        method: of its engine; None without one.
        measures: of its system, no curves.
    """
    system = simulation.system
    found = {
        shown: first_order(simulation, measures, own.values)
        for shown, own in evaluations(system, method).items()
        if measures
    }
    return {
        measure.name: {shown: by_measure[measure.name] for shown, by_measure in found.items()} for measure in measures
    }


def first_order(simulation: Simulation, measures: Sequence[Measure], values: Values) -> dict[str, FirstOrder]:
    """Measures of first order about their mean builds, by central differences over one sigma to both sides.

    Args:
        simulation, measures: to build and to read; where contributors are correlated their parts in the variance
            are Shapley effects.
        values: by one method, in units of the measures.
    """
    system, copula = simulation.system, simulation.copula
    found = of_alike(system, measures, lambda alike, turning: _first_order(simulation, alike, turning, values))
    return {name: _correlated(own, system, copula) for name, own in found.items()} if copula.blocks else found


def _correlated(found: FirstOrder, system: System, copula: Copula) -> FirstOrder:
    """First order with the variance that correlations make of the sum."""
    draws = {contributor.name: contributor.draw for contributor in system.contributors}
    effects = {
        effect.name: math.copysign(math.sqrt(effect.variance), effect.slope)
        for effect in found.effects
        if effect.name in copula.names and not math.isnan(effect.slope)
    }
    parts = divided_variances(effects, copula, draws)
    return replace(
        found,
        effects=tuple(replace(effect, variance=parts.get(effect.name, effect.variance)) for effect in found.effects),
    )


def _first_order(
    simulation: Simulation, measures: Sequence[Measure], turning: Mapping[str, bool], values: Values
) -> dict[str, FirstOrder]:
    """Measures that share the mean build."""
    system = simulation.system
    mean = mean_deviations(system, measures[0].positions)
    slices = component_slices(system)
    every = {measure.name: acting(simulation, measure) for measure in measures}
    slopes = _slopes(system, mean, measures, every, values)
    ends = {}
    rows = [np.zeros_like(mean), mean]
    for measure in measures:
        own_slopes = slopes[measure.name]
        ends[measure.name] = ends_together(_concerned(system, every[measure.name]), own_slopes, turning)
        low, high = mean.copy(), mean.copy()
        for name, own_ends in ends[measure.name].items():
            low[:, slices[name]], high[:, slices[name]] = own_ends
        rows += [low, high]
    builds = np.concatenate(rows)
    known = np.isfinite(builds).all(axis=1)  # ends are not where a slope is not
    read = values(builds[known], measures)
    found = {}
    for place, measure in enumerate(measures):
        numbers = np.full(len(builds), np.nan)
        numbers[known] = read[measure.name]
        effects = tuple(
            _effect(own, slopes[measure.name][own.name], ends[measure.name][own.name], turning=turning[own.name])
            for own in every[measure.name]
        )
        low, high = numbers[2 + 2 * place : 4 + 2 * place]
        found[measure.name] = FirstOrder(float(numbers[0]), float(numbers[1]), effects, (float(low), float(high)))
    return found


def _slopes(
    system: System,
    mean: Array,
    measures: Sequence[Measure],
    acting: Mapping[str, Sequence[Contributor]],
    values: Values,
) -> dict[str, dict[str, Array]]:
    """Change of measures per mm, rad or K of each contributor's components (components,); 0 if it does not act."""
    names = {measure: {own.name for own in those} for measure, those in acting.items()}
    slopes = {
        measure.name: {
            contributor.name: np.zeros(len(contributor.draw.components)) for contributor in system.contributors
        }
        for measure in measures
    }
    slices = component_slices(system)
    asked = [
        contributor for contributor in system.contributors if any(contributor.name in those for those in names.values())
    ]
    for batch in batches(asked, [2 * len(own.draw.components) for own in asked], mean.shape[1]):
        ends = np.cumsum([2 * len(own.draw.components) for own in batch]).tolist()
        places = [slice(end - 2 * len(own.draw.components), end) for own, end in zip(batch, ends, strict=True)]
        rows = np.repeat(mean, ends[-1], axis=0)
        for own, place in zip(batch, places, strict=True):
            each = np.eye(len(own.draw.components))
            rows[place, slices[own.name]] += _step(own) * np.concatenate([each, -each])
        found = values(rows, measures)
        for own, place in zip(batch, places, strict=True):
            count = len(own.draw.components)
            for measure in measures:
                if own.name in names[measure.name]:
                    read = found[measure.name][place]
                    change = read[:count] - read[count:]
                    change[np.abs(change) <= NOISE * np.abs(read).max()] = 0.0
                    slopes[measure.name][own.name] = change / (2 * _step(own))
    return slopes


def _step(contributor: Contributor) -> float:
    return contributor.draw.sigma or contributor.per_unit


def _concerned(system: Described, acting: Sequence[Contributor]) -> list[Contributor]:
    """Contributors that act on a measure and those that they read, directly or not, in the system's order."""
    known = {contributor.name: contributor for contributor in system.contributors}
    names = {own.name for own in acting}
    while added := {name for own in names for name in reads_of(known[own])} - names:
        names |= added
    return [contributor for contributor in system.contributors if contributor.name in names]


def _effect(contributor: Contributor, slopes: Array, ends: Array, *, turning: bool) -> FirstOrderEffect:
    law, sigma, draw = contributor.distribution, contributor.draw.sigma, contributor.draw
    size = float(slopes[0]) if len(slopes) == 1 else float(np.sqrt((slopes * slopes).sum()))
    variance = float(slopes @ draw.covariance @ slopes) if isinstance(draw, JointDraw) else size**2 * sigma**2
    if draw.uniforms == 1 and len(slopes) > 1 and not isinstance(draw, JointDraw):  # a length in one direction
        if turning:
            variance = size**2 * (law.variance + law.mean**2) / 2
        else:
            along = ends[1] - ends[0]
            size = float(slopes @ along) / (float(np.sqrt((along * along).sum())) or 1.0)
            variance = size**2 * sigma**2
    reach = float((ends[1] - ends[0]) @ slopes)
    name, unit, per = contributor.name, contributor.unit, contributor.per_unit
    if not drawn_each(draw):
        return FirstOrderEffect(name, unit, size * per, variance, reach)
    largest, smallest = float(slopes.max()), float(slopes.min())
    greatest = largest if largest >= AS_LARGE * abs(smallest) else smallest
    alike = bool((np.abs(slopes - greatest) <= ALIKE * abs(greatest)).all())
    return FirstOrderEffect(name, unit, greatest * per, variance, reach, len(slopes), alike)


def _percent(part: float, whole: float) -> float:
    return 100.0 * part / whole if whole != 0.0 else 0.0
