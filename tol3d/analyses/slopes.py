"""Rates of measures: their change, spread and mean shift by each contributor.

Slopes are central differences of builds as they are drawn, at their positions, and averaged: for a measure that is the
length of a sum, or the least of several, slopes at the mean build are useless.
"""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.rates import covariance_of
from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor, WithNominal
from tol3d.study.system.dependent import Dependent
from tol3d.study.system.draw import Draw, Each, JointDraw, Scalar, component_sigmas, drawn_each

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
        variances: by slopes, of each contributor, at each of the builds (rows, measures, contributors).
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
        return self.mean_variances / self._whole

    @property
    def share_errors(self) -> Array:
        """Their standard errors, by how slopes differ from build to build; NaN of a single build."""
        whole = self.variances.sum(axis=2, keepdims=True)
        off = (np.nan_to_num(self.variances) - self.shares * np.nan_to_num(whole)) / self._whole
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # a single build
            return np.asarray(off.std(axis=0, ddof=1) / np.sqrt(len(off)))

    @property
    def mean_variances(self) -> Array:
        """Variances averaged over the builds (measures, contributors)."""
        return _mean(self.variances)

    @property
    def _whole(self) -> Array:
        whole = self.mean_variances.sum(axis=1, keepdims=True)
        return np.where(whole > 0.0, whole, 1.0)


@dataclass(frozen=True, eq=False)
class Lever:
    """A nominal that can be moved.

    Args:
        line: of the scene that states it, for one contributor or several.
        slope: change of the measure, in its unit, a mm, rad or K.
        nominal: word of a drawing for it.
        unit, per_unit: of the contributor.
    """

    line: str
    slope: float
    nominal: str
    unit: str
    per_unit: float


def rates_of(response: Response, deviations: Array, positions: Mapping[str, Array], rows: int) -> Rates:
    """Rates of the measures of a response.

    Args:
        response: of one or several measures.
        deviations, positions: builds as they are drawn.
        rows: at how many of them slopes are taken.
    """
    rows = min(rows, len(deviations))
    places = {name: own[:rows] for name, own in positions.items()}
    drawn = response.gradient(deviations[:rows], places)
    mean, zero = response.mean, np.zeros(response.components)
    middle = _mean(response.gradient(np.repeat((mean / 2)[None], rows, axis=0), places))
    slopes, steadiness = _steady(drawn)
    off = deviations - deviations.mean(axis=0)
    variances = np.array(
        [_variances(drawn[:, :, own], response.draws[name], off[:, own]) for name, own in response.slices.items()]
    ).reshape(-1, rows, len(response.measures))
    first = np.array(
        [
            middle[:, own] @ mean[own]
            if np.count_nonzero(mean[own]) < 2
            else _moved_together(response, own, places, rows)
            for own in response.slices.values()
        ]
    ).reshape(-1, len(response.measures))
    nominal, built = (_at(response, row, places, rows) for row in (zero, mean))
    second = _second(response, mean, built, places, rows)
    return Rates(
        response,
        slopes,
        steadiness,
        np.moveaxis(variances, 0, 2),
        nominal,
        built,
        first.T,
        second,
    )


def levers_of(response: Response, slopes: Array, steadiness: Array) -> list[Lever]:
    """Nominals that move a measure in one direction, the steepest first: lengths, then others.

    Only what a drawing states has a nominal. A zone, a length in a random direction, a share of a play and a draw that
    follows others have none.

    Args:
        response: whose contributors.
        slopes, steadiness: of the measure (components,), see `Rates`.
    """
    found, known = [], {contributor.name: contributor for contributor in response.contributors}
    for line, names in response.lines.items():
        own, columns = known[names[0]], np.concatenate([_columns(response, name) for name in names])
        if own.unit == "1" or not all(_has_nominal(known[name], response.draws[name]) for name in names):
            continue
        acting = columns[slopes[columns] != 0.0]
        slope = float(slopes[acting].sum())
        if slope != 0.0 and float(steadiness[acting].min()) >= STEADY:
            found.append(Lever(line, slope, nominal_of(own), own.unit, own.per_unit))
    return sorted(found, key=lambda each: (each.unit != "um", each.unit, -abs(each.slope) * each.per_unit, each.line))


def nominal_of(contributor: Contributor) -> str:
    """The word of a drawing for what moves its mean; "" where there is none."""
    return contributor.nominal if isinstance(contributor, WithNominal) else ""


def _has_nominal(contributor: Contributor, draw: Draw) -> bool:
    one = isinstance(draw, Scalar) or drawn_each(draw)
    return bool(nominal_of(contributor)) and one and not isinstance(draw, Dependent)


def _columns(response: Response, name: str) -> NDArray[np.int64]:
    return np.arange(response.slices[name].start, response.slices[name].stop)


def _variances(slopes: Array, draw: Draw, off: Array) -> Array:
    """Variance of one contributor's first order at each build (rows, measures), by the law where that states it."""
    if isinstance(draw, JointDraw) and not isinstance(draw, Dependent):
        covariance = draw.covariance
    elif isinstance(draw, Scalar | Each):
        covariance = np.diag(np.square(component_sigmas(draw)))
    else:
        covariance = off.T @ off / max(len(off) - 1, 1)
    return np.asarray(np.einsum("rmi,ij,rmj->rm", slopes, covariance, slopes))


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


def _moved_together(response: Response, own: slice, positions: Mapping[str, Array], count: int) -> Array:
    """What several components move by their means at once (measures,), the other contributors half way to theirs.

    Slopes of each by itself do not add up to it where the least of them decides, as of planets with equal gaps.
    """
    low, high = response.mean / 2, response.mean / 2
    low[own], high[own] = 0.0, response.mean[own]
    return np.asarray(np.nan_to_num(_at(response, high, positions, count) - _at(response, low, positions, count)))


def _second(response: Response, mean: Array, built: Array, positions: Mapping[str, Array], rows: int) -> Array:
    """Mean shift by each contributor's spread (measures, contributors), over one sigma to both sides.

    Exact for quadratic measures. Several components of one contributor move together, in signs that balance in pairs:
    each by itself counts the least of several as often as there are.
    """
    shifts = {name: _balanced(covariance_of(response.draws[name])) for name in response.slices}
    whose = np.repeat(np.arange(len(shifts)), [len(own) for own in shifts.values()])
    sides = np.zeros((len(whose), response.components))
    for k, (name, own) in enumerate(response.slices.items()):
        sides[whose == k, own] = shifts[name]
    bends = np.zeros((len(sides), len(response.measures)))
    many = max(1, AT_ONCE // max(2 * rows * response.components, 1))
    for first in range(0, len(sides), many):
        side = sides[first : first + many]
        builds = np.repeat(mean + np.concatenate([side, -side]), rows, axis=0)
        places = {name: np.concatenate([own] * 2 * len(side)) for name, own in positions.items()}
        values = response.values(builds, places).values.reshape(2, len(side), rows, len(response.measures))
        either = _mean(np.moveaxis(values, 2, 0))
        bends[first : first + many] = (either[0] + either[1] - 2 * built) / 2
    found = [np.nan_to_num(bends[whose == k]).sum(axis=0) / max(len(own), 1) for k, own in enumerate(shifts.values())]
    return np.array(found).reshape(-1, len(response.measures)).T


def _balanced(covariance: Array) -> Array:
    """Shifts (n, components) of a mean square of the covariance, n the next power of two; none where nothing spreads.

    Their signs are rows of Sylvester's Hadamard matrix.
    """
    if not covariance.any():
        return np.zeros((0, len(covariance)))
    signs = np.ones((1, 1))
    while len(signs) < len(covariance):
        signs = np.block([[signs, signs], [signs, -signs]])
    squares, axes = np.linalg.eigh(covariance)
    root = axes * np.sqrt(np.maximum(squares, 0.0)) @ axes.T
    return np.asarray(signs[:, : len(covariance)] @ root)
