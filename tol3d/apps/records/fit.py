"""Least squares of the transmission error: linear to first order, then refined on the exact geometry.

The rows' own noise is taken as white and alike on all rows; tooth-mesh orders are fitted along where there are rows
enough in a tooth, so that they are not taken for noise. What deviating pitches add to the covariance is in
background.py. What is left besides at low orders, where eccentricities are read, may be stronger than white noise, for
it may be drift or an oval shaft: the covariance of noise is then larger in the same proportion.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from tol3d.apps.records.background import Background, background_of
from tol3d.apps.records.bins import Bins
from tol3d.apps.records.pair import RigPair, Side, Specimen, driven_angle
from tol3d.apps.records.terms import ECCENTRIC, Points, Terms, columns
from tol3d.numerics.arrays import Array

MOST_ROUNDS = 8  # of Gauss-Newton with first-order columns; each gains a factor e/a
STEP_XTOL = 1e-12  # rad, of the fitted curve; a millionth of an arc second


@dataclass(frozen=True, eq=False)
class Measured:
    """Both sides as they are fitted: every pass's bins in one array a side.

    Args:
        pair: nominal numbers.
        points: where, by side.
        error: phi2 - phi1 z1/z2 [rad], by side.
        rows: in each bin, by side.
        spreads: within each bin, of phi1, of phi1 and error, of error; (3, n) by side.
        turned: turns of the driver that a side covers.
    """

    pair: RigPair
    points: Mapping[Side, Points]
    error: Mapping[Side, Array]
    rows: Mapping[Side, Array]
    spreads: Mapping[Side, Array]
    turned: Mapping[Side, float]

    def count(self, sides: Sequence[Side]) -> float:
        """Rows of some sides."""
        return float(sum(self.rows[side].sum() for side in sides))


def measured_of(pair: RigPair, sides: Mapping[Side, Sequence[Bins]], turned: Mapping[Side, float]) -> Measured:
    """Rows as they are fitted; travel counts from the middle of each pass."""
    joined = {side: _joined(bins) for side, bins in sides.items()}
    points = {
        side: Points(own["phi1"], pair.rate * own["phi1"] + own["error"], own["travel"], own["torque"])
        for side, own in joined.items()
    }
    spreads = {
        side: np.stack([own["spread_phi1"], own["spread_both"], own["spread_error"]]) for side, own in joined.items()
    }
    return Measured(
        pair,
        points,
        {side: own["error"] for side, own in joined.items()},
        {side: own["rows"] for side, own in joined.items()},
        spreads,
        turned,
    )


def _joined(bins: Sequence[Bins]) -> Mapping[str, Array]:
    return {name: np.concatenate([getattr(own, name) for own in bins]) for name in vars(bins[0])}


@dataclass(frozen=True, eq=False)
class Fit:
    """Result of a fit.

    Args:
        measured: data of the fit.
        terms: its columns.
        values: of the terms (terms,) [mm or rad].
        residual: by side (n,) [rad].
        variance: of one row about the curve [rad^2].
        background: contribution of deviating teeth to the covariance.
        unscaled: inverse of the normal matrix (terms, terms).
    """

    measured: Measured
    terms: Terms
    values: Array
    residual: Mapping[Side, Array]
    variance: float
    background: Background
    unscaled: Array

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the values (terms, terms)."""
        return np.asarray(self.told_apart + self.background.hidden)

    @property
    def told_apart(self) -> Array:
        """The same but for what teeth do at the orders that are fitted (terms, terms)."""
        return np.asarray(self.unscaled * (self.variance * self.low_orders) + self.background.leaked)

    def hidden_eccentricity(self, gear: int) -> float:
        """Standard deviation of either component of the effect of a gear's pitches on its eccentricity [mm]."""
        place = self.terms.index(ECCENTRIC[2 * gear - 2 : 2 * gear])
        return math.sqrt(float(np.diagonal(self.background.hidden)[place].mean()))

    @property
    def low_orders(self) -> float:
        """Strength of the residual at low orders over that of white noise; 1 where it is not stronger."""
        return self.background.low_orders

    def of(self, names: Sequence[str]) -> tuple[Array, Array]:
        """Values of some terms and their covariance."""
        index = self.terms.index(names)
        return self.values[index], self.covariance[np.ix_(index, index)]

    @property
    def freedom(self) -> float:
        """Degrees of freedom of the variance."""
        return self.measured.count(self.terms.sides) - len(self.values)

    def specimen(self, constant_part: float | None = None) -> Specimen:
        """The pair with these eccentricities, and a constant part [rad] other than the fitted one if given."""
        own = self._value("constant part") if constant_part is None else constant_part
        return specimen_of(self.measured.pair, self.of(ECCENTRIC)[0], own, self._value("offset"))

    def _value(self, name: str) -> float:
        return float(self.values[self.terms.index([name])[0]])


def specimen_of(pair: RigPair, eccentric: Array, constant_part: float, offset: float = 0.0) -> Specimen:
    """A pair with x1, y1, x2, y2 [mm] and a constant part [rad].

    theta2 counts from the driven encoder's zero in the fit, from the turn phi1 z1/z2 in the geometry; `offset` is what
    the encoder reads more [rad].
    """
    x1, y1, x2, y2 = (float(value) for value in eccentric)
    theta2 = math.atan2(y2, x2) + offset
    arm = pair.driven_base_radius
    return Specimen(pair, math.hypot(x1, y1), math.atan2(y1, x1), math.hypot(x2, y2), theta2, arm * constant_part)


def inverse_normal(matrix: Array) -> Array:
    """Inverse of the normal matrix (terms, terms) of weighted columns (n, terms), by columns of length one.

    These have condition numbers of ten or so (cautions.py refuses others), whose square costs two digits. By einsum:
    for a few columns BLAS spends more on its threads than on the product.
    """
    lengths = np.sqrt(np.einsum("ni,ni->i", matrix, matrix))
    own = matrix / lengths
    return np.asarray(np.linalg.inv(np.einsum("ni,nj->ij", own, own)) / np.outer(lengths, lengths))


def times(matrix: Array, vector: Array) -> Array:
    """Product of a matrix (n, m) and a vector (m,), in the same way."""
    return np.asarray(np.einsum("nm,m->n", matrix, vector))


def with_drift(fit: Fit) -> tuple[Array, Array]:
    """Linear drift of each side [rad per rad of the driver] and its standard error, from a fit's residual.

    The residual is fitted to first order by the fit's own columns and the drifts.
    """
    measured, terms = fit.measured, replace(fit.terms, drift=True)
    sides = terms.sides
    matrix = np.concatenate([columns(measured.pair, terms, side, measured.points[side]) for side in sides])
    weight = np.sqrt(np.concatenate([measured.rows[side] for side in sides]))
    left = np.concatenate([fit.residual[side] for side in sides])
    inverse = inverse_normal(matrix * weight[:, None])
    values = inverse @ times(matrix.T, left * weight**2)
    index = terms.index([f"drift {side}" for side in sides])
    return np.asarray(values[index]), np.sqrt(np.diagonal(inverse)[index] * fit.variance * fit.low_orders)


def fitted(measured: Measured, terms: Terms, *, constant_part: float | None = None) -> Fit:
    """Fit the terms to the measurement.

    Args:
        measured: both sides.
        terms: columns to fit.
        constant_part: j_c [rad] of the geometry where it is not fitted, or is hidden by encoders set to zero.
    """
    sides = terms.sides
    matrix = np.concatenate([columns(measured.pair, terms, side, measured.points[side]) for side in sides])
    wanted = np.concatenate([measured.error[side] for side in sides])
    weight = np.sqrt(np.concatenate([measured.rows[side] for side in sides]))
    inverse = inverse_normal(matrix * weight[:, None])

    def solved(left: Array) -> Array:
        return np.asarray(inverse @ times(matrix.T, left * weight**2))

    values, model = solved(wanted), None
    for _ in range(MOST_ROUNDS):
        model = _model(measured, terms, values, matrix, constant_part)
        step = solved(wanted - model)
        values = values + step
        if float(np.abs(times(matrix, step)).max()) < STEP_XTOL:
            break
    residual = wanted - _model(measured, terms, values, matrix, constant_part)
    ends = np.cumsum([0, *(len(measured.error[side]) for side in sides)])
    parts = {side: residual[low:high] for side, low, high in zip(sides, ends[:-1], ends[1:], strict=True)}
    variance = _variance(measured, terms, values, parts)
    background = background_of(measured.pair, terms, measured.points, measured.rows, parts, measured.turned, variance)
    return Fit(measured, terms, values, parts, variance, background, inverse)


def _model(measured: Measured, terms: Terms, values: Array, matrix: Array, constant_part: float | None) -> Array:
    """The curve [rad] by the exact geometry, with all that is no eccentricity as in the linear one."""
    place = {name: index for index, name in enumerate(terms.names)}
    offset = float(values[place["offset"]])
    own = float(values[place["constant part"]]) if "constant part" in place else 0.0
    fixed = own if constant_part is None else constant_part
    if terms.sides == ("back",):
        offset -= fixed  # it is what the encoder reads with the back flank in contact
    specimen = specimen_of(measured.pair, values[:4], fixed, offset)
    exact = []
    for side in terms.sides:
        phi1 = measured.points[side].phi1
        ahead = 0.0 if side == "drive" else fixed
        exact.append(driven_angle(specimen, phi1, side) - measured.pair.rate * phi1 - ahead)
    return np.asarray(np.concatenate(exact) + times(matrix[:, 4:], values[4:]))


def _variance(measured: Measured, terms: Terms, values: Array, residual: Mapping[Side, Array]) -> float:
    """Variance of one row's noise [rad^2]: between bins and within them, the curve's slope within a bin taken away."""
    total = 0.0
    for side in terms.sides:
        at, rows = measured.points[side], measured.rows[side]
        slope = _slope(measured.pair, terms, side, at, values)
        phi1, both, error = measured.spreads[side]
        total += float(np.sum(rows * residual[side] ** 2) + np.sum(error - 2 * slope * both + slope**2 * phi1))
    return total / max(measured.count(terms.sides) - len(values), 1.0)


def _slope(pair: RigPair, terms: Terms, side: Side, at: Points, values: Array) -> Array:
    """Slope of the fitted curve over phi1 [rad/rad]."""
    step = 1e-4  # rad, of a curve whose orders lie below a few hundred
    ends = []
    for sign in (-1.0, 1.0):
        moved = replace(at, phi1=at.phi1 + sign * step, phi2=at.phi2 + sign * step * pair.rate)
        ends.append(times(columns(pair, terms, side, moved), values))
    return np.asarray((ends[1] - ends[0]) / (2 * step))
