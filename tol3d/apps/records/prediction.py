"""Backlash over the whole long period from a fit, with its 95 % intervals."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from tol3d.apps.records.fit import Fit, fitted, specimen_of
from tol3d.apps.records.pair import TURN, RigPair, Side, angular_backlash, driven_angle
from tol3d.apps.records.terms import ECCENTRIC, ENCODERS, Terms, backlash_columns
from tol3d.numerics.arrays import Array

CONFIDENCE = 0.95
NEAR_ZERO = 4.0  # standard errors of a length, within which it may be that of a vector in any direction
POSITIONS_A_TURN = 72  # of the driver; eccentricities alone have orders up to 1
START_ROUNDS = 3  # each gains a factor e/a
LINEAR = 0.2  # rad, up to which the error of an extreme's place is taken from its bend
LEAST_BEND = 1e-9  # rad/rad^2; a curve flatter than that has no place of its extremes


@dataclass(frozen=True)
class Figure:
    """A number with the half-width of its 95 % interval, both in mm or rad."""

    value: float
    half_width: float


@dataclass(frozen=True)
class Extreme:
    """Smallest or largest backlash over the long period.

    Args:
        backlash: [rad].
        place: phi1 [rad].
    """

    backlash: Figure
    place: Figure


@dataclass(frozen=True, eq=False)
class BacklashModel:
    """Backlash with all that is known of it.

    Args:
        pair: nominal numbers.
        eccentric: x1, y1, x2, y2 [mm].
        offset: see specimen_of.
        constant_part: j_c [rad].
        covariance: of x1, y1, x2, y2 and the constant part (5, 5).
        quantile: half-widths over standard errors.
        anchored: error [rad] of the backlash at phi1 = 0 where that was given, and the constant part with it.
    """

    pair: RigPair
    eccentric: Array
    offset: float
    constant_part: float
    covariance: Array
    quantile: float
    anchored: float | None = None

    def starting_with(self, start: float) -> "BacklashModel":
        """The same with another constant part, so that the backlash at phi1 = 0 is `start` [rad]."""
        own = self
        for _ in range(START_ROUNDS):
            own = replace(own, constant_part=own.constant_part + start - float(own.backlash(np.zeros(1))[0]))
        return own

    def backlash(self, phi1: Array) -> Array:
        """j [rad]."""
        return angular_backlash(specimen_of(self.pair, self.eccentric, self.constant_part, self.offset), phi1)

    def rates(self, phi1: Array) -> Array:
        """Derivatives (n, 5) by x1, y1, x2, y2 and the constant part, to first order."""
        specimen = specimen_of(self.pair, self.eccentric, self.constant_part, self.offset)
        own = backlash_columns(self.pair, phi1, driven_angle(specimen, phi1, "drive") + self.offset)
        if self.anchored is None:
            return own
        start = driven_angle(specimen, np.zeros(1), "drive") + self.offset
        own[:, :4] -= backlash_columns(self.pair, np.zeros(1), start)[:, :4]
        return own

    def half_width(self, phi1: Array) -> Array:
        """Half-width of the 95 % interval at single positions [rad]."""
        rates = self.rates(phi1)
        return np.asarray(self.quantile * np.sqrt(np.einsum("ni,ij,nj->n", rates, self.covariance, rates)))

    @property
    def constant_half_width(self) -> float:
        """Half-width of the 95 % interval of the constant part [rad]."""
        rates = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
        if self.anchored is not None:
            rates[:4] = self.rates(np.zeros(1))[0, :4] - replace(self, anchored=None).rates(np.zeros(1))[0, :4]
        return self.quantile * float(np.sqrt(max(float(rates @ self.covariance @ rates), 0.0)))

    @property
    def positions(self) -> Array:
        """phi1 over the long period, its end included [rad]."""
        return np.linspace(0.0, self.pair.long_period, POSITIONS_A_TURN * self.pair.long_period_turns + 1)

    def extreme(self, sense: int) -> Extreme:
        """The smallest (-1) or largest (+1) backlash over the long period."""
        place = self._place(sense)
        half_width = float(self.half_width(np.array([place]))[0])
        step = TURN / 360
        low, middle, high = self.backlash(place + step * np.array([-1.0, 0.0, 1.0])).tolist()
        bend = (low - 2 * middle + high) / step**2
        rates = (self.rates(np.array([place + step])) - self.rates(np.array([place - step])))[0] / (2 * step)
        slack = self.quantile * float(np.sqrt(max(float(rates @ self.covariance @ rates), 0.0)))
        wide = slack / abs(bend) if abs(bend) > LEAST_BEND else self.pair.long_period
        wide = max(wide, self._elsewhere(sense, place, everywhere=wide > LINEAR))
        return Extreme(Figure(middle, half_width), Figure(place, min(wide, self.pair.long_period / 2)))

    def _elsewhere(self, sense: int, place: float, *, everywhere: bool) -> float:
        """Distance of the farthest peak or trough, or place, that may be the highest or lowest one as well [rad]."""
        phi1, period = self.positions[:-1], self.pair.long_period
        own = sense * self.backlash(phi1)
        phi1 = phi1[everywhere | ((own >= np.roll(own, 1)) & (own >= np.roll(own, -1)))]
        short = sense * (self.backlash(np.array([place])) - self.backlash(phi1))
        rates = self.rates(phi1) - self.rates(np.array([place]))
        error = np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", rates, self.covariance, rates), 0.0))
        off = np.abs(np.mod(phi1 - place + period / 2, period) - period / 2)
        return float(np.max(off, where=(short <= self.quantile * error) & (off > TURN / POSITIONS_A_TURN), initial=0.0))

    def _place(self, sense: int) -> float:
        phi1 = self.positions[:-1]
        step = float(phi1[1])
        place = float(phi1[np.argmax(sense * self.backlash(phi1))])
        for _ in range(3):
            around = place + step * np.linspace(-1.0, 1.0, 21)
            place = float(around[np.argmax(sense * self.backlash(around))])
            step /= 10
        return place % self.pair.long_period


OF_TWO = float(np.sqrt(stats.chi2.ppf(CONFIDENCE, 2)) / stats.norm.ppf(0.5 + CONFIDENCE / 2))  # a disc's, a line's


def quantile_of(freedom: float) -> float:
    """Half-width of a 95 % interval over the standard error, by Student's law."""
    return float(stats.t.ppf(0.5 + CONFIDENCE / 2, max(freedom, 1.0)))


def length_and_phase(vector: Array, covariance: Array, quantile: float) -> tuple[Figure, Figure]:
    """Length and phase [rad] of x, y; the phase is not known where the length may be zero."""
    x, y = (float(value) for value in vector)
    length = float(np.hypot(x, y))
    if length == 0.0:
        wide = quantile * float(np.sqrt(np.trace(covariance) / 2))
        return Figure(0.0, wide), Figure(0.0, np.pi)
    along, across = np.array([x, y]) / length, np.array([-y, x]) / length
    first, second = (float(np.sqrt(max(float(u @ covariance @ u), 0.0))) for u in (along, across))
    phase = float(np.arctan2(y, x))
    if length > NEAR_ZERO * max(first, second):
        return Figure(length, quantile * first), Figure(phase, min(quantile * second / length, np.pi))
    disc = quantile * OF_TWO * max(first, second)  # round the end of the vector, with the true one in it
    return Figure(length, disc), Figure(phase, float(np.arcsin(disc / length)) if disc < length else np.pi)


DISAGREEING = 3.0  # standard errors of the difference


@dataclass(frozen=True)
class OneSided:
    """Findings from one side alone.

    Args:
        figures: e1, theta1, e2, theta2 [mm, rad].
        least, largest: the backlash over the long period that it predicts from the joint fit's at phi1 = 0.
        apart: largest difference of the four figures from the joint fit's, in standard errors of the difference.
    """

    figures: Mapping[str, Figure]
    least: Extreme
    largest: Extreme
    apart: float

    @property
    def disagrees(self) -> bool:
        """True if its eccentricities cannot be the same."""
        return self.apart > DISAGREEING


def one_sided(side: Side, fit: Fit, model: BacklashModel) -> OneSided:
    """One side's own fit.

    Args:
        side: which.
        fit: the joint one.
        model: the joint fit's backlash.
    """
    terms = Terms((side,), encoders=False, drift=fit.terms.drift, teeth=fit.terms.teeth)
    own = fitted(fit.measured, terms, constant_part=model.constant_part)
    vector, covariance = own.of(ECCENTRIC)
    start = float(model.backlash(np.zeros(1))[0])
    full = np.zeros((5, 5))
    full[:4, :4], full[4, 4] = covariance, (float(model.half_width(np.zeros(1))[0]) / model.quantile) ** 2
    alone = replace(model, eccentric=vector, covariance=full, anchored=0.0).starting_with(start)
    figures = dict(zip(("e1", "theta1"), length_and_phase(vector[:2], covariance[:2, :2], model.quantile), strict=True))
    figures |= zip(("e2", "theta2"), length_and_phase(vector[2:], covariance[2:, 2:], model.quantile), strict=True)
    return OneSided(figures, alone.extreme(-1), alone.extreme(+1), _apart(side, fit, vector))


def _apart(side: Side, fit: Fit, alone: Array) -> float:
    """Largest difference from the joint fit in its standard errors.

    A side alone reads the encoders' part p + i q of Im((p + i q) exp(i phi)) as an eccentricity: the difference is
    r_b2 (p + i q) turned by the working angle, whatever the noise of the side; so is its covariance.
    """
    joint = fit.of(ECCENTRIC)[0]
    _, covariance = fit.of(ENCODERS)
    sense = 1.0 if side == "drive" else -1.0
    alpha, arm = fit.measured.pair.working_angle, fit.measured.pair.driven_base_radius
    found = 0.0
    for gear, angle in ((0, -sense * alpha), (2, sense * alpha)):
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        spread = arm**2 * turn @ covariance[gear : gear + 2, gear : gear + 2] @ turn.T
        difference = alone[gear : gear + 2] - joint[gear : gear + 2]
        length = float(np.hypot(*joint[gear : gear + 2]))
        along = joint[gear : gear + 2] / length if length > 0.0 else np.array([1.0, 0.0])
        for axis in (along, np.array([-along[1], along[0]])):
            error = math.sqrt(max(float(axis @ spread @ axis), 1e-300))
            found = max(found, abs(float(axis @ difference)) / error)
    return found
