"""First order by differences: what each deviation does to a measure, on either road.

No theory is needed, so any system has it; both roads stand beside each other before a trial is drawn.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.study.columns import columns_of
from tol3d.study.extremes import ends_together
from tol3d.study.simulation import Simulation
from tol3d.system.contributor import Contributor
from tol3d.system.dependent import reads_of
from tol3d.system.draw import JointDraw, drawn_each
from tol3d.system.measure import Measure
from tol3d.system.outcome import ANALYTIC, GEOMETRIC, outcome_of
from tol3d.system.road import Road
from tol3d.system.stated import component_count, component_slices, mean_deviations, stated
from tol3d.system.system import System

Array = NDArray[np.float64]
Values = Callable[[Array], Array]
"""A measure (rows,) of deviations (rows, components); nan where a build does not seat."""

ALIKE = 1e-6  # of the greatest; slopes of features that are alike differ by rounding and by where they stand
AS_LARGE = 0.99  # of the size of another one: of slopes of both signs the positive one is shown, by either road
NOISE = 1e-9  # of the values; smaller differences are rounding, and have no sign


@dataclass(frozen=True)
class FirstOrderEffect:
    """What a contributor does to a measure, of first order at the mean build.

    Args:
        name, unit: of the contributor.
        slope: change of the measure [its unit] per unit of the deviation; of several components the size of their
            gradient, of several deviations of their own that of each or the greatest; nan where a build does not seat.
        each: how many deviations of their own it has, such as one a feature; 1 of a single one or of components.
        alike: whether their slopes are.
        variance: its part of the measure's variance [the measure's unit, squared].
        reach: how far it moves the measure between its low and high ends [the measure's unit].
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
    """A measure by one road before any trial, in its unit; nan where a build does not seat.

    Args:
        nominal: without deviations.
        mean: with every contributor at its mean.
        effects: of the contributors that act on it.
        ends: with every contributor at the end that lowers it, and at the one that raises it, by sign of its slopes:
            the worst case of a measure that is a sum of effects.
    """

    nominal: float
    mean: float
    effects: tuple[FirstOrderEffect, ...]
    ends: tuple[float, float]

    @property
    def sigma(self) -> float:
        """Standard deviation by the root sum of squares (RSS)."""
        return math.sqrt(sum(own.variance for own in self.effects))

    def variance_percent(self, effect: FirstOrderEffect) -> float:
        """Share of the variance [%]; 0 where nothing varies."""
        return _percent(effect.variance, sum(own.variance for own in self.effects))

    def reach_percent(self, effect: FirstOrderEffect) -> float:
        """Share of the worst case [%]: of the sum of all reaches; 0 where nothing varies."""
        return _percent(effect.reach, sum(own.reach for own in self.effects))


def first_orders(simulation: Simulation, road: Road | None, measure: Measure) -> dict[str, FirstOrder]:
    """A measure of one number a trial by each road: "analytic", and "geometric" where there is an engine.

    Args:
        simulation: what is studied.
        road: of its engine; None without one.
        measure: one of its system's, no curve.
    """
    system = simulation.system

    def values_by(shown: str) -> Values:
        def values(deviations: Array) -> Array:
            columns = columns_of(system, road, stated(system, deviations), (measure,))
            return outcome_of(columns, shown, measure.name, system.statuses.lacking).values

        return values

    roads = (ANALYTIC, GEOMETRIC) if road else (ANALYTIC,)
    return {shown: first_order(system, measure, values_by(shown)) for shown in roads}


def first_order(system: System, measure: Measure, values: Values) -> FirstOrder:
    """A measure of first order about the mean build, by central differences over one sigma to both sides.

    Args:
        system, measure: what is built, and what is read of it.
        values: by one road, in the unit of the measure.
    """
    nominal = np.zeros((1, component_count(system)))
    mean = mean_deviations(system, measure.positions)
    slices = component_slices(system)
    turning = {own.name: system.turns_at_random(own, measure.positions) for own in system.contributors}
    slopes = {own.name: np.zeros(len(own.draw.components)) for own in system.contributors}
    acting = system.acting(measure)
    for own in acting:
        slopes[own.name] = _slopes(mean, slices[own.name], own.draw.sigma or own.per_unit, values)
    ends = ends_together(_concerned(system, acting), slopes, turning)
    low, high = mean.copy(), mean.copy()
    for name, own_ends in ends.items():
        low[:, slices[name]], high[:, slices[name]] = own_ends
    effects = [_effect(own, slopes[own.name], ends[own.name], turning=turning[own.name]) for own in acting]
    rows = np.concatenate([nominal, mean, low, high])
    known = np.isfinite(rows).all(axis=1)  # ends are not where a slope is not
    found = np.full(len(rows), np.nan)
    found[known] = values(rows[known])
    return FirstOrder(float(found[0]), float(found[1]), tuple(effects), (float(found[2]), float(found[3])))


def _concerned(system: System, acting: Sequence[Contributor]) -> list[Contributor]:
    """Those that act on a measure and those that they read, directly or not, in the system's order."""
    known = {own.name: own for own in system.contributors}
    names = {own.name for own in acting}
    while added := {name for own in names for name in reads_of(known[own])} - names:
        names |= added
    return [own for own in system.contributors if own.name in names]


def _slopes(mean: Array, own: slice, step: float, values: Values) -> Array:
    """Change of a measure per mm, rad or K of each component (components,)."""
    count = own.stop - own.start
    rows = np.repeat(mean, 2 * count, axis=0)
    rows[:, own] += step * np.concatenate([np.eye(count), -np.eye(count)])
    found = values(rows)
    change = found[:count] - found[count:]
    change[np.abs(change) <= NOISE * np.abs(found).max()] = 0.0
    return np.asarray(change / (2 * step))


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
