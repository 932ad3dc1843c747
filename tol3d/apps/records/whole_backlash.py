"""The backlash over the long period with all that teeth do to it: its ends, and its value where the driver starts.

Where both sides have rows, the curve is what was measured there: the fit's, and what the rows leave of it. Rows have
noise, and the smallest of many noisy values lies too low. So what is left is split by its spectrum into teeth and noise
(Wiener's filter), and curves are drawn that rows of this noise leave possible; their ends are not biased. Where a side
has no rows, curves are drawn with teeth of the same spectrum at any place. Encoders' errors are alike on both sides.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.apps.records.fit import Fit, times
from tol3d.apps.records.prediction import CONFIDENCE, BacklashModel, Extreme, Figure
from tol3d.apps.records.terms import difference_columns
from tol3d.numerics.arrays import Array

MOST_CELLS_A_TOOTH: Final = 32  # of the driver
FEWEST_CELLS_A_TOOTH: Final = 2
PLACES_A_TOOTH: Final = 32  # at least, at which the curve is read for its ends: 0.1 % of tooth mesh may lie between
BESIDE: Final = 2  # places, over which the filter spreads a step from tooth to tooth
MOST_CELLS: Final = 2**15  # over the long period, where that leaves so many a tooth
LONGEST_GAP: Final = 0.5  # of a tooth without rows, that counts as measured
DRAWS: Final = 400  # curves; a half-width is known to 5 % by them
AT_ONCE: Final = 2**20  # numbers of drawn curves in memory
SEED: Final = 2020
NARROWEST: Final = 25  # lines of the spectrum of which means are taken: known to 20 %
FAR: Final = 4.0  # standard errors from which a mean is stronger than noise, of hundreds of them
MEDIAN: Final = 0.6745  # magnitude that half of all normal values exceed, in standard deviations


@dataclass(frozen=True, eq=False)
class ToothPart:
    """Part of the backlash besides that of eccentricities, over the long period.

    Args:
        phi1: (n,) places [rad], from 0 on.
        measured: (n,) True where both sides have rows.
        mean: (n,) tooth mesh as fitted, and the residual of the rows less their noise [rad].
        known: (lines,) strength of the uncertainty where there are rows, by lines of the spectrum [rad^2].
        unknown: the same where there are none.
        noise: standard deviation of a row about its neighbours [rad].
    """

    phi1: Array
    measured: NDArray[np.bool_]
    mean: Array
    known: Array
    unknown: Array
    noise: float

    @property
    def covered(self) -> bool:
        """True if the whole long period was measured."""
        return bool(self.measured.all())

    @property
    def start(self) -> tuple[float, float]:
        """Its value where the driver starts and the variance of that [rad, rad^2]."""
        strength = self.known if self.measured[0] else self.unknown
        count = len(self.phi1)
        return float(self.mean[0]), float(strength[0] + 2 * strength[1:].sum()) / count


@dataclass(frozen=True)
class WholeBacklash:
    """Ends of the backlash over the long period.

    Args:
        start: where the driver starts [rad].
        least, largest: its ends.
        covered: whether they were measured, not predicted.
    """

    start: Figure
    least: Extreme
    largest: Extreme
    covered: bool


def tooth_part(fit: Fit) -> ToothPart:
    """Split a fit's residual into teeth and noise."""
    pair, sides = fit.measured.pair, fit.terms.sides
    count, noise = _cells(fit), _noise(fit)
    step = pair.long_period / count
    rows, means = [], []
    for side in sides:
        index = np.round(fit.measured.points[side].phi1 / step).astype(np.int64) % count
        own = np.bincount(index, fit.measured.rows[side], minlength=count)
        total = np.bincount(index, fit.measured.rows[side] * fit.residual[side], minlength=count)
        rows.append(own)
        means.append(total / np.maximum(own, 1.0))
    seen = (rows[0] > 0.0) & (rows[1] > 0.0)
    phi1: Array = step * np.arange(count, dtype=np.float64)
    if not seen.any():  # sides have no place in common
        nothing = np.zeros(count // 2 + 1)
        return ToothPart(phi1, seen, _mesh(fit, phi1), nothing, nothing, noise)
    variance = noise**2 * float(np.mean(1.0 / rows[0][seen] + 1.0 / rows[1][seen]))
    left = np.interp(phi1, phi1[seen], (means[1] - means[0])[seen], period=pair.long_period)
    measured = _bridged(seen, max(1, round(LONGEST_GAP * count / (pair.driver_teeth * pair.long_period_turns))))
    spectrum = np.fft.rfft(np.where(measured, left, 0.0))
    teeth = _teeth(np.abs(spectrum) ** 2 / measured.sum(), variance, pair.long_period_turns, float(measured.mean()))
    gain = teeth / np.where(teeth > 0.0, teeth + variance, 1.0)
    mean = np.where(measured, np.fft.irfft(gain * spectrum, count), 0.0) + _mesh(fit, phi1)
    return ToothPart(phi1, measured, mean, gain * variance, teeth, noise)


def whole_backlash(fit: Fit, model: BacklashModel, teeth: ToothPart) -> WholeBacklash:
    """Ends and start of the backlash with their intervals.

    Args:
        fit: of both sides.
        model: the backlash of the eccentricities.
        teeth: the rest.
    """
    count = len(teeth.phi1)
    finer = math.ceil(PLACES_A_TOOTH * fit.measured.pair.driver_teeth * fit.measured.pair.long_period_turns / count)
    step = fit.measured.pair.long_period / (count * finer)
    phi1: Array = np.asarray(np.arange(count * finer) * step, dtype=np.float64)
    smooth: Array = model.backlash(phi1) + _mesh(fit, phi1)
    left: Array = teeth.mean - _mesh(fit, teeth.phi1)
    mean: Array = smooth + _between(left, finer)
    start: list[Array] = []
    ends: dict[int, list[Array]] = {-1: [], 1: []}
    places: dict[int, list[Array]] = {-1: [], 1: []}
    for curves in _drawn(fit, model, teeth, phi1, mean):
        start.append(curves[:, 0])
        for sense in (-1, 1):
            at = np.argmax(sense * curves, axis=1)
            places[sense].append(phi1[at])
            ends[sense].append(curves[np.arange(len(curves)), at])
    every_other = [smooth + np.roll(_between(left[k::2], 2 * finer), k * finer) for k in (0, 1)]
    found = []
    for sense in (-1, 1):
        first, second = (float(np.max(sense * own)) for own in every_other)
        further = abs(first - second)
        drawn = np.concatenate(ends[sense]), np.concatenate(places[sense])
        found.append(_extreme(phi1, mean, teeth, sense, *drawn, further))
    at_start = np.concatenate(start)
    around = left[np.arange(-BESIDE, BESIDE + 1)]  # rows of the first place may lie beyond a step of the teeth
    beside = float(np.abs(around - left[0]).max())
    own = Figure(float(mean[0]), float(np.quantile(np.abs(at_start - mean[0]), CONFIDENCE)) + beside)
    if model.anchored is not None:
        own = Figure(float(mean[0]), model.anchored)
    return WholeBacklash(own, found[0], found[1], teeth.covered)


def _between(values: Array, finer: int) -> Array:
    """Values (..., n) at evenly spaced places of a period, and on straight lines between them: (..., n finer)."""
    step = np.arange(finer) / finer
    own, following = values[..., None], np.roll(values, -1, axis=-1)[..., None]
    return np.asarray((own + (following - own) * step).reshape(*values.shape[:-1], -1))


def _cells(fit: Fit) -> int:
    """Places of the long period: a whole number a tooth, and a row of each side about each where there are enough."""
    measured, pair = fit.measured, fit.measured.pair
    teeth = pair.driver_teeth * pair.long_period_turns
    turned = {side: min(measured.turned[side], pair.long_period_turns) for side in fit.terms.sides}
    a_tooth = min(measured.count([side]) / (pair.driver_teeth * turned[side]) for side in fit.terms.sides)
    fine = min(int(a_tooth * 1.001), MOST_CELLS_A_TOOTH, MOST_CELLS // teeth)
    return 2 * math.ceil(max(fine, FEWEST_CELLS_A_TOOTH) * teeth / 2)


def _noise(fit: Fit) -> float:
    """Standard deviation of a row, by the median difference of neighbours: teeth step seldom.

    From neighbour to neighbour, and from each to the middle of both its neighbours, which slopes do not move; teeth add
    to either. Residuals of a fit of n rows are smaller than their noise by the root of its freedom over n.
    """
    steps, bends = [], []
    for side in fit.terms.sides:
        order = np.argsort(fit.measured.points[side].phi1, kind="stable")
        left, rows = fit.residual[side][order], fit.measured.rows[side][order]
        one = 1.0 / rows
        steps.append(np.abs(np.diff(left)) / np.sqrt(one[1:] + one[:-1]))
        bend = left[1:-1] - (left[2:] + left[:-2]) / 2
        bends.append(np.abs(bend) / np.sqrt(one[1:-1] + (one[2:] + one[:-2]) / 4))
    scatter = min(float(np.median(np.concatenate(own))) for own in (steps, bends)) / MEDIAN
    return scatter * math.sqrt(fit.measured.count(fit.terms.sides) / max(fit.freedom, 1.0))


def _bridged(seen: NDArray[np.bool_], longest: int) -> NDArray[np.bool_]:
    """The same with gaps of a few places closed; the last place has the first as its neighbour."""
    used = np.flatnonzero(seen)
    bridged = seen.copy()
    for low, high in zip(used, np.append(used[1:], used[0] + len(seen)), strict=True):
        if 1 < high - low <= longest + 1:
            bridged[np.arange(low, high) % len(seen)] = True
    return bridged


def _teeth(power: Array, noise: float, turns: int, share: float) -> Array:
    """Strength of teeth, line by line, from means over neighbouring lines; none where noise alone may be there.

    Args:
        power: of each line [rad^2]; `noise` where there is only noise.
        noise: variance of a place's mean [rad^2].
        turns: of the long period: lines of one order of the driver.
        share: of the long period that was measured, and of its lines that are independent.
    """
    half = min(max(math.ceil(NARROWEST / share), 2 * turns + 1), len(power) - 2) // 2
    whole = np.concatenate([power[half:0:-1], power, power[-2 : -half - 2 : -1]])
    mean = np.convolve(whole, np.full(2 * half + 1, 1.0 / (2 * half + 1)), mode="valid")
    stands_out = mean > noise * (1.0 + FAR / math.sqrt((2 * half + 1) * share))
    return np.where(stands_out, np.maximum(mean - noise, 0.0), 0.0)


def _mesh(fit: Fit, phi1: Array) -> Array:
    """Tooth mesh of the backlash as fitted [rad]."""
    names = fit.terms.tooth_columns
    index = fit.terms.index(names)
    return times(_rates(fit, phi1)[:, index], fit.values[index])


def _rates(fit: Fit, phi1: Array) -> Array:
    """Columns (n, terms) of the backlash."""
    pair, ahead = fit.measured.pair, float(fit.of(("offset",))[0][0])
    return difference_columns(pair, fit.terms, phi1, pair.rate * phi1 + ahead)


def _drawn(fit: Fit, model: BacklashModel, teeth: ToothPart, phi1: Array, mean: Array) -> Iterator[Array]:
    """Curves that the rows leave possible, (some, n), each beside one as far on the other side of the mean.

    Places phi1 are those of the teeth's part, or some times as many.
    """
    random = np.random.Generator(np.random.Philox(SEED))
    rates, count, finer = _rates(fit, phi1), len(teeth.phi1), len(phi1) // len(teeth.phi1)
    seen = np.repeat(teeth.measured, finer)
    rooted = [_root(own) for own in (fit.unscaled * teeth.noise**2, fit.told_apart)]
    some = max(1, AT_ONCE // len(phi1))
    for first in range(0, DRAWS // 2, some):
        own = min(some, DRAWS // 2 - first)
        noise = np.fft.rfft(random.standard_normal((own, count)))
        draw = random.standard_normal((own, len(fit.values)))
        fitted = [(draw @ root) @ rates.T for root in rooted[: 1 if teeth.covered else 2]]
        rest = [np.fft.irfft(noise * np.sqrt(strength), count) for strength in (teeth.known, teeth.unknown)]
        beside = fitted[0] if teeth.covered else np.where(seen, *fitted)
        beside = beside + _between(np.where(teeth.measured, *rest), finer)
        if model.anchored is not None:
            beside += model.anchored / model.quantile * random.standard_normal((own, 1)) - beside[:, :1]
        for sign in (1.0, -1.0):
            yield mean + sign * beside


def _root(covariance: Array) -> Array:
    """The symmetric square root R of a covariance, which may be singular: no other is the same on every machine."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)) @ vectors.T)


def _extreme(
    phi1: Array, mean: Array, teeth: ToothPart, sense: int, ends: Array, places: Array, further: float
) -> Extreme:
    """An end of what was measured, with as much on either side as drawn ones lie off; or the middle of drawn ones.

    Drawn ends lie further out than the measured one by as much as noise may have driven that one out. Where not all
    was measured, the interval reaches from drawn ends to that of the mean: real teeth come again, drawn ones do not.
    Between two places of the teeth's part the curve may go `further`: by about what it differs by, if that is read at
    places of even or of odd number alone.
    """
    tail, own = (1.0 - CONFIDENCE) / 2, sense * float(np.max(sense * mean))
    low, high = np.quantile(ends, [tail, 1.0 - tail]).tolist()
    if teeth.covered:
        off = float(np.quantile(np.abs(ends - own), CONFIDENCE))
        low, high = own - off, own + off
    low, high = min(low, own) - further, max(high, own) + further
    at, period = float(phi1[np.argmax(sense * mean)]), float(phi1[1]) * len(mean)
    apart = np.abs(np.mod(places - at + period / 2, period) - period / 2)
    may_be = sense * mean >= sense * own - (high - low)  # other places, whose interval of that width reaches the end's
    elsewhere = np.abs(np.mod(phi1[may_be] - at + period / 2, period) - period / 2)
    wide = max(float(np.quantile(apart, CONFIDENCE)), float(elsewhere.max())) + float(teeth.phi1[1])
    return Extreme(Figure((low + high) / 2, (high - low) / 2), Figure(at, min(wide, period / 2)))
