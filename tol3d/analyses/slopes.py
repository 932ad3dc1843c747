"""Rates of measures: their change, spread and mean shift by each contributor.

Slopes are central differences of builds as they are drawn, at their positions, and averaged: for a measure that is the
length of a sum, or the least of several, slopes at the mean build are useless.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.analyses.response import NUDGE, Response
from tol3d.numerics.arrays import Array
from tol3d.system.dependent import Dependent
from tol3d.system.draw import Ball, Planar, component_sigmas, drawn_each

AT_ONCE: Final = 2**22
"""Numbers of a batch of builds: rows times components, 32 MB."""
BATCHES: Final = 6
"""Builds of each row for each component: three pairs of differences."""
STEADY: Final = 0.5
"""Least mean of a slope over its rms if it acts in one direction, so that a nominal can be moved along it."""


@dataclass(frozen=True, eq=False)
class Rates:
    """Rates of measures by contributors, in the units of the measures a mm, rad or K.

    Args:
        response: the response.
        slopes: mean over builds (measures, components).
        steadiness: its size over the rms of the slopes (measures, components); 1 where all builds have the same.
        variances: by slopes, of each contributor (measures, contributors).
        nominal: every deviation 0, averaged over positions (measures,).
        mean_build: every contributor at its mean, likewise.
        first: what each contributor's mean moves of that way (measures, contributors).
        second: what the curvature along each contributor adds to the mean of the builds (measures, contributors).
    """

    response: Response
    slopes: Array
    steadiness: Array
    variances: Array
    nominal: Array
    mean_build: Array
    first: Array
    second: Array

    @property
    def shares(self) -> Array:
        """Shares of the variances by slopes (measures, contributors); they sum to 1 where anything acts."""
        whole = self.variances.sum(axis=1, keepdims=True)
        return self.variances / np.where(whole > 0.0, whole, 1.0)


@dataclass(frozen=True, eq=False)
class Lever:
    """A nominal that can be moved.

    Args:
        name: of the contributor, with its component where it has several.
        contributor: its name.
        direction: in which deviations move (components,) [mm, rad or K].
        slope: change of the measure, in its unit.
        unit, per_unit: of the contributor.
        room: the least change that is physical [mm, rad or K].
    """

    name: str
    contributor: str
    direction: Array
    slope: float
    unit: str
    per_unit: float
    room: float

    def allows(self, change: float) -> bool:
        """True if its mean stays physical."""
        return change >= self.room


def rates_of(response: Response, deviations: Array, positions: Mapping[str, Array], rows: int) -> Rates:
    """Rates of the measures of a response.

    Args:
        response: of one or several measures.
        deviations, positions: builds as they are drawn.
        rows: at how many of them slopes are taken.
    """
    rows = min(rows, len(deviations))
    places = {name: own[:rows] for name, own in positions.items()}
    drawn = _gradients(response, deviations[:rows], places)
    mean, zero = response.mean, np.zeros(response.components)
    middle = _mean(_gradients(response, np.repeat((mean / 2)[None], rows, axis=0), places))
    slopes, steadiness = _steady(drawn)
    off = deviations - deviations.mean(axis=0)
    variances = np.array([_variances(drawn[:, :, own], off[:, own]) for own in response.slices.values()]).reshape(
        -1, len(response.measures)
    )
    first = np.array([middle[:, own] @ mean[own] for own in response.slices.values()]).reshape(variances.shape)
    nominal, built = (_at(response, row, places, rows) for row in (zero, mean))
    second = _second(response, mean, built, places, rows)
    by_contributor = np.array([second[:, own].sum(axis=1) for own in response.slices.values()]).reshape(first.shape)
    return Rates(
        response,
        slopes,
        steadiness,
        variances.T,
        nominal,
        built,
        first.T,
        by_contributor.T,
    )


def levers_of(response: Response, slopes: Array, steadiness: Array) -> list[Lever]:
    """Nominals that move a measure in one direction, the steepest first: lengths, then others.

    A length in a random direction, a share of a play and a draw that follows others have no nominal to be moved.

    Args:
        response: whose contributors.
        slopes, steadiness: of the measure (components,), see `Rates`.
    """
    found = []
    for own in response.contributors:
        draw, columns = response.draws[own.name], response.slices[own.name]
        if (
            isinstance(draw, Ball | Dependent)
            or own.unit == "1"
            or (isinstance(draw, Planar) and draw.direction is None)
        ):
            continue
        count = columns.stop - columns.start
        together = count > 1 and drawn_each(draw)
        for k in range(1 if together else count):
            direction = np.zeros(response.components)
            direction[columns if together else columns.start + k] = 1.0
            slope = float(slopes @ direction)
            steady = float(steadiness[columns].min() if together else steadiness[columns][k])
            if steady < STEADY or slope == 0.0:
                continue
            component = "" if together else draw.components[k]
            least = own.least if count == 1 else None
            room = -np.inf if least is None else least - float(response.mean[columns][0])
            name = f"{own.name}, {component}" if component else own.name
            found.append(Lever(name, own.name, direction, slope, own.unit, own.per_unit, room))
    return sorted(found, key=lambda each: (each.unit != "um", each.unit, -abs(each.slope) * each.per_unit, each.name))


def _variances(slopes: Array, off: Array) -> Array:
    """Variance of one contributor's first order (measures,), averaged over the builds at which slopes were taken."""
    covariance = off.T @ off / max(len(off) - 1, 1)
    return _mean(np.einsum("rmi,ij,rmj->rm", slopes, covariance, slopes))


def _gradients(response: Response, rows: Array, positions: Mapping[str, Array]) -> Array:
    """Gradients (n, measures, components) in batches that fit the memory; NaN where a build cannot be assembled."""
    many = max(1, AT_ONCE // max(2 * response.components**2, 1))
    pieces = [
        response.gradient(rows[k : k + many], {name: own[k : k + many] for name, own in positions.items()})
        for k in range(0, len(rows), many)
    ]
    return np.concatenate(pieces)


def few_slopes(
    response: Response, names: Sequence[str], deviations: Array, positions: Mapping[str, Array]
) -> tuple[Array, Array]:
    """Slopes of measures by some contributors, and how steady they are: see `Rates`; 0 for all others.

    Args:
        response: of the measures.
        names: of the contributors.
        deviations, positions: builds at which slopes are taken.
    """
    columns = np.array([k for name in names for k in _places(response.slices[name])], dtype=np.int64)
    units = {k: own.unit for own in response.contributors for k in _places(response.slices[own.name])}
    steps = np.array([NUDGE.get(units[int(k)], 1e-3) for k in columns])
    shifts = np.zeros((2 * len(columns), response.components))
    shifts[np.arange(len(columns)), columns] = steps
    shifts[len(columns) + np.arange(len(columns)), columns] = -steps
    builds = (deviations[:, None] + shifts).reshape(-1, response.components)
    places = {name: np.repeat(own, len(shifts), axis=0) for name, own in positions.items()}
    found = response.values(builds, places).values.reshape(len(deviations), 2, len(columns), len(response.measures))
    gradient = np.zeros((len(deviations), len(response.measures), response.components))
    gradient[:, :, columns] = np.moveaxis((found[:, 0] - found[:, 1]) / (2 * steps[:, None]), 1, 2)
    return _steady(gradient)


def _places(columns: slice) -> range:
    return range(columns.start, columns.stop)


def _steady(gradients: Array) -> tuple[Array, Array]:
    """Means of gradients over builds, and their sizes over the root mean square."""
    slopes, rms = _mean(gradients), np.sqrt(_mean(gradients * gradients))
    return slopes, np.abs(slopes) / np.where(rms > 0.0, rms, 1.0)


def _mean(values: Array) -> Array:
    """Over the first axis, of what is known; 0 where nothing is."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # nothing of a measure seats
        return np.asarray(np.nan_to_num(np.nanmean(values, axis=0)))


def _at(response: Response, row: Array, positions: Mapping[str, Array], count: int) -> Array:
    """Values of one build (measures,), averaged over positions; NaN where it seats at none."""
    found = response.values(np.repeat(row[None], count, axis=0), positions).values
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanmean(found, axis=0))


def _second(response: Response, mean: Array, built: Array, positions: Mapping[str, Array], rows: int) -> Array:
    """Half the curvature times the variance of each component (measures, components), over one sigma to both sides."""
    sigmas = np.array([own for each in response.contributors for own in component_sigmas(response.draws[each.name])])
    acting = np.flatnonzero(sigmas > 0.0)
    found = np.zeros((len(response.measures), response.components))
    many = max(1, AT_ONCE // max(2 * rows * response.components, 1))
    for first in range(0, len(acting), many):
        columns = acting[first : first + many]
        shifts = np.zeros((2 * len(columns), response.components))
        shifts[np.arange(len(columns)), columns] = sigmas[columns]
        shifts[len(columns) + np.arange(len(columns)), columns] = -sigmas[columns]
        builds = np.repeat(mean + shifts, rows, axis=0)
        places = {name: np.concatenate([own] * len(shifts)) for name, own in positions.items()}
        values = response.values(builds, places).values.reshape(2, len(columns), rows, len(response.measures))
        either = _mean(np.moveaxis(values, 2, 0))
        found[:, columns] = ((either[0] + either[1] - 2 * built) / 2).T
    return np.asarray(np.nan_to_num(found))
