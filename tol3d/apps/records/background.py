"""Deviating pitches at the order of an eccentricity: their variance, by the orders beside it.

Pitches that deviate on one flank otherwise than on the other look like an eccentricity once per turn, and no rig tells
them apart. Orders two, three and so on of the same gear are free of eccentricities: what both sides share of them, and
by what they differ, are samples of what deviating pitches do at order one. Their strength is taken to fall with the
order k as k^-p, from p = 0 (pitches that deviate each for itself) over 2 (a random walk from tooth to tooth) to 3, all
alike before anything is measured. Orders are random effects of a mixed linear model, so that short records, which do
not tell all apart, are read as far as they go.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from tol3d.apps.records.pair import ARCSEC, TURN, RigPair, Side
from tol3d.apps.records.terms import Points, Terms, columns
from tol3d.numerics.arrays import Array

Kind = Literal["common", "opposite"]

MOST_ORDERS: Final = 12  # of a gear; a third of its teeth at most, over which steps from tooth to tooth are no waves
PLACES_A_WAVE: Final = 16  # at which the highest order is read: 0.6 % of its amplitude
SLOPES: Final = np.linspace(0.0, 3.0, 31)  # p; 2 is that of a random walk from tooth to tooth
FAR: Final = 3.0  # standard errors from which orders count as stronger than white noise
ROUNDS: Final = 30  # of expectation and maximisation
NO_NOISE: Final = (1e-6 * ARCSEC) ** 2  # rad^2 a row, under which nothing but rounding is left
LOW_ORDERS: Final = 6.0  # per turn of the driver, below which what is left besides counts
FAR_LOW: Final = 2.0  # standard errors from which that counts as stronger than white noise


@dataclass(frozen=True, eq=False)
class Background:
    """Contribution of deviating teeth to a fit's covariance.

    Args:
        hidden: by their own part at the fitted orders (terms, terms).
        leaked: by higher orders that the rows do not tell apart from the fitted ones (terms, terms).
        low_orders: strength of the residual below LOW_ORDERS over that of white noise; 1 if it is not stronger.
    """

    hidden: Array
    leaked: Array
    low_orders: float


@dataclass(frozen=True, eq=False)
class Cells:
    """Rows of one side gathered by places of the long period: arrays (cells,)."""

    at: Points
    rows: Array
    left: Array


@dataclass(frozen=True, eq=False)
class _Effects:
    """Random effects of one gear: the part that both sides share, or the one with opposite signs on them."""

    gear: int
    kind: Kind
    orders: NDArray[np.int64]


def background_of(
    pair: RigPair,
    terms: Terms,
    points: Mapping[Side, Points],
    rows: Mapping[Side, Array],
    residual: Mapping[Side, Array],
    turned: Mapping[Side, float],
    variance: float,
) -> Background:
    """The background of a fit.

    Args:
        pair: nominal numbers.
        terms: that were fitted.
        points, rows, residual: of each side, see Measured and Fit.
        turned: turns of the driver that a side covers.
        variance: of one row about the fit [rad^2].
    """
    count = len(terms.names)
    nothing = np.zeros((count, count))
    if variance < NO_NOISE:
        return Background(nothing, nothing, 1.0)
    top = [min(MOST_ORDERS, max(3, teeth // 3)) for teeth in (pair.driver_teeth, pair.driven_teeth)]
    places = PLACES_A_WAVE * math.ceil(max(top[0], top[1] * pair.rate, LOW_ORDERS))
    cells = {side: gathered(points[side], rows[side], residual[side], places) for side in terms.sides}
    effects = _effects(terms, top)
    model = _Mixed(pair, terms, cells, effects, variance)
    low = {side: own.left for side, own in cells.items()}
    if not model.effects:
        return Background(nothing, nothing, _low_orders(pair, cells, low, turned, variance))
    powers, explained = model.solved()
    hidden, leaked = nothing.copy(), nothing.copy()
    index = np.ix_(*2 * [terms.index(model.low.names)])
    for own, power in zip(model.effects, powers, strict=True):
        leaked[index] += model.read_as(own, power / 2)
        weights = model.slopes(powers, own.gear)
        fitted_orders = np.arange(1, own.orders[0])
        expected = np.array([expected_variance(power, own.orders, weights, int(order)) for order in fitted_orders])
        hidden[index] += model.read_as(replace(own, orders=fitted_orders), expected)
    left = {side: own.left - explained[side] for side, own in cells.items()}
    return Background(hidden, leaked, _low_orders(pair, cells, left, turned, variance))


def gathered(at: Points, rows: Array, left: Array, places: int) -> Cells:
    """Means at evenly spaced places of the driver's turn, of those that have rows."""
    index = (at.phi1 * (places / TURN)).astype(np.int64)
    count = np.bincount(index, rows).astype(np.float64)
    used = count > 0.0

    def mean(values: Array) -> Array:
        return np.asarray(np.bincount(index, rows * values)[used] / count[used])

    return Cells(Points(mean(at.phi1), mean(at.phi2), mean(at.travel), mean(at.torque)), count[used], mean(left))


def likely_slopes(powers: Sequence[Array], orders: Sequence[NDArray[np.int64]]) -> Array:
    """Weights of SLOPES, by several spectra of one slope and levels of their own.

    Args:
        powers: sum of squares of both components at each of some orders.
        orders: these.
    """
    log = np.zeros(len(SLOPES))
    for own, at in zip(powers, orders, strict=True):
        log += SLOPES * np.log(at).sum() - len(own) * np.log(_sums(own, at))
    weight = np.exp(log - log.max())
    return np.asarray(weight / weight.sum())


def expected_variance(powers: Array, orders: NDArray[np.int64], weights: Array, order: int) -> float:
    """Variance of either component at one order, such that 1.96 of its roots hold it in 95 of 100 cases.

    Of each slope the component over the root of the mean power is distributed as Student's t.

    Args:
        powers, orders: see likely_slopes, of one spectrum.
        weights: of SLOPES.
        order: the wanted one.
    """
    scale = np.sqrt(_sums(powers, orders) / (2 * len(powers)) * float(order) ** -SLOPES)
    own = stats.t(2 * len(powers))
    most = float(scale.max() * own.ppf(0.976))
    half_width = optimize.brentq(lambda x: float(weights @ own.cdf(x / scale)) - 0.975, 0.0, most, rtol=1e-6)
    return float((half_width / stats.norm.ppf(0.975)) ** 2)


def _sums(powers: Array, orders: NDArray[np.int64]) -> Array:
    return np.asarray(np.maximum(powers @ (orders[:, None].astype(np.float64) ** SLOPES), 1e-300))


def _effects(terms: Terms, top: Sequence[int]) -> list[_Effects]:
    """All that may be: of either gear what both sides share and no encoder takes along, and what they differ by."""
    found = []
    for gear, highest in enumerate(top, 1):
        first = 3 if gear in terms.twice else 2
        found.append(_Effects(gear, "common", np.arange(first, max(highest, first + 1) + 1)))
        if len(terms.sides) == 2:
            found.append(_Effects(gear, "opposite", np.arange(2, highest + 1)))
    return found


class _Mixed:
    """The mixed model of a fit's residual: its own columns as fixed effects, orders as random ones.

    Columns are those of rows over the standard deviation of one.
    """

    def __init__(
        self, pair: RigPair, terms: Terms, cells: Mapping[Side, Cells], effects: list[_Effects], variance: float
    ) -> None:
        self.low = replace(terms, winding=False, teeth=())
        self._pair, self._cells = pair, cells
        self._root = np.sqrt(np.concatenate([cell.rows for cell in cells.values()]) / variance)
        self._fixed = np.concatenate([columns(pair, self.low, side, own.at) for side, own in cells.items()])
        self._fixed *= self._root[:, None]
        self._inverse = _inverse(_product(self._fixed, self._fixed))
        self._left = np.concatenate([cell.left for cell in cells.values()]) * self._root
        blocks = {effect: self._columns(effect) for effect in effects}
        blocks = {own: block for own, block in blocks.items() if self._stands_out(block)}
        self.effects = list(blocks)
        self._random = np.concatenate(list(blocks.values()), axis=1) if blocks else np.zeros((len(self._left), 0))

    def solved(self) -> tuple[list[Array], Mapping[Side, Array]]:
        """Powers of each effect's orders, by expectation and maximisation, and what they explain of the cells."""
        every, fixed = np.concatenate([self._fixed, self._random], axis=1), len(self._inverse)
        normal, right = _product(every, every), _product(every, self._left[:, None])[:, 0]
        ends = np.cumsum([0, *(2 * len(effect.orders) for effect in self.effects)])
        parts = [slice(low, high) for low, high in pairwise(ends.tolist())]
        square = (right[fixed:] / np.diagonal(normal)[fixed:]) ** 2
        values = np.zeros(len(square))
        for _ in range(ROUNDS):
            powers = [square[part].reshape(-1, 2).sum(axis=1) for part in parts]
            prior = np.concatenate([np.zeros(fixed), *(1.0 / level for level in self._levels(powers))])
            inverse = _inverse(normal + np.diag(prior))
            values = (inverse @ right)[fixed:]
            square = values**2 + np.diagonal(inverse)[fixed:]
        sizes = np.cumsum([len(cell.rows) for cell in self._cells.values()])[:-1]
        explained = np.split(self._random @ values / self._root, sizes)
        return powers, dict(zip(self._cells, explained, strict=True))

    def slopes(self, powers: Sequence[Array], gear: int) -> Array:
        """Weights of SLOPES, which all effects of a gear share."""
        own = [
            (power, effects.orders) for power, effects in zip(powers, self.effects, strict=True) if effects.gear == gear
        ]
        return likely_slopes(*zip(*own, strict=True))

    def _levels(self, powers: Sequence[Array]) -> list[Array]:
        """Variances of the columns of each effect, smooth over the orders."""
        found = []
        for power, own in zip(powers, self.effects, strict=True):
            shape = own.orders.astype(np.float64) ** -float(self.slopes(powers, own.gear) @ SLOPES)
            found.append(np.repeat(np.mean(power / shape) / 2 * shape, 2))
        return found

    def read_as(self, effects: _Effects, variances: Array) -> Array:
        """Covariance of the fixed effects as which a fit reads orders of such variances of either component."""
        leak = self._inverse @ _product(self._fixed, self._columns(effects))
        return np.asarray((leak * np.repeat(variances, 2)) @ leak.T)

    def _columns(self, effects: _Effects) -> Array:
        """Sine and cosine of each order, (cells, 2 orders)."""
        every = []
        for side, own in self._cells.items():
            sign = -1.0 if effects.kind == "opposite" and side == "back" else 1.0
            turn = own.at.phi1 if effects.gear == 1 else own.at.phi2
            angle = turn[:, None] * effects.orders
            every.append(sign * np.stack([np.sin(angle), np.cos(angle)], axis=2).reshape(len(turn), -1))
        return np.asarray(np.concatenate(every) * self._root[:, None])

    def _stands_out(self, block: Array) -> bool:
        """True if columns explain more of the residual than they would of white noise."""
        own = block - self._fixed @ (self._inverse @ _product(self._fixed, block))
        square = _product(own, own)
        length = np.sqrt(np.maximum(np.diagonal(square), 1e-12 * np.einsum("ni,ni->i", block, block)))
        power = float(np.sum((own.T @ self._left / length) ** 2))
        alike = square / np.outer(length, length)
        return power > float(np.trace(alike)) + FAR * math.sqrt(2 * float(np.sum(alike**2)))


def _product(first: Array, second: Array) -> Array:
    return np.asarray(first.T @ second)


def _inverse(normal: Array) -> Array:
    """Inverse by columns of length one."""
    length = np.sqrt(np.diagonal(normal))
    return np.asarray(np.linalg.inv(normal / np.outer(length, length)) / np.outer(length, length))


def _low_orders(
    pair: RigPair,
    cells: Mapping[Side, Cells],
    left: Mapping[Side, Array],
    turned: Mapping[Side, float],
    variance: float,
) -> float:
    """Strength of the residual below LOW_ORDERS over that of white noise; 1 if it may be white."""
    power = np.concatenate([_powers(pair, own, left[side], turned[side], variance) for side, own in cells.items()])
    if not len(power):
        return 1.0
    mean, error = float(power.mean()), 1.0 / math.sqrt(len(power))
    return mean if mean > 1.0 + FAR_LOW * error else 1.0


def _powers(pair: RigPair, cells: Cells, left: Array, turns: float, variance: float) -> Array:
    """Powers of orders that are not fitted, over those of white noise: each of mean 1 and standard deviation 1."""
    orders = np.arange(1, int(LOW_ORDERS * turns) + 1) / turns
    fitted_orders = np.array([0.0, 1.0, pair.rate])
    free = np.abs(orders[:, None] - fitted_orders).min(axis=1) > 0.75 / turns
    weighted, phi1 = cells.rows * left, cells.at.phi1
    power = [abs(complex(np.sum(weighted * np.exp(-1j * order * phi1)))) ** 2 for order in orders[free]]
    return np.asarray(np.array(power) / (cells.rows.sum() * variance))
