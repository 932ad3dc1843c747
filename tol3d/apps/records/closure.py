"""Closure of a side: its transmission error a long period later, where the same teeth touch as at its start.

Gears cannot differ by then; what does is drift, or an encoder or coupling that has slipped. The rows of the quarter
turn after the long period lie where those of the first one do, so that their difference, place by place, knows no
model. Where a pass ends with the long period, the last quarter turn stands in: the fit, its drift aside, bridges both.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, Literal, NamedTuple

import numpy as np

from tol3d.apps.records.alignment import Aligned
from tol3d.apps.records.bins import WINDOW, Bins, Ends
from tol3d.apps.records.fit import Fit
from tol3d.apps.records.pair import ARCSEC, Side, Specimen, driven_angle
from tol3d.apps.records.prediction import Figure, quantile_of
from tol3d.apps.records.terms import Points, columns
from tol3d.numerics.arrays import Array

Closing = Literal["drive", "back", "backlash"]

OPEN: Final = 3.0  # standard errors from which on a side does not close
LEAST: Final = 1e-3 * ARCSEC  # that matters, where nothing scatters
FEWEST: Final = 10  # pairs of places, or steps between quarter turns, whose scatter says that of one
MOST_CELLS: Final = 64  # of a quarter turn, at each of which rows are compared
MAD: Final = 1.4826  # standard deviation of normal values over their median magnitude


def closures(
    fit: Fit, specimen: Specimen, passes: Mapping[Side, Sequence[Aligned]], *, but_drift: bool = False
) -> Mapping[Closing, Figure]:
    """Change over the long period [rad] of each side's transmission error, and of the backlash: back less drive.

    Args:
        fit: the joint one.
        specimen: as the fit found it.
        passes: by side.
        but_drift: less the linear drift that was fitted along.

    Returns:
        None of a side all of whose passes are shorter than the long period.
    """
    found: dict[Closing, Figure] = {}
    for side, own in passes.items():
        figure = _closure(fit, specimen, side, own, but_drift=but_drift)
        if figure is not None:
            found[side] = figure
    if len(found) == 2:
        drive, back = found["drive"], found["back"]
        found["backlash"] = Figure(back.value - drive.value, math.hypot(back.half_width, drive.half_width))
    return found


def what_is_open(closures: Mapping[Closing, Figure], fit: Fit) -> Iterator[str]:
    """A warning for each that is no accident of noise."""
    for name, own in closures.items():
        if abs(own.value) > LEAST + OPEN * own.half_width / quantile_of(fit.freedom):
            what = "the backlash" if name == "backlash" else f"the {name} side"
            beside = " besides the drift that is fitted" if fit.terms.drift else ""
            yield (
                f"{what} does not close: after the long period of {fit.measured.pair.long_period_turns} turns it has "
                f"changed by {own.value / ARCSEC:.2f}″ ±{own.half_width / ARCSEC:.2f}″{beside} (drift, or an encoder "
                "or a coupling that slips)"
            )


def _closure(fit: Fit, specimen: Specimen, side: Side, passes: Sequence[Aligned], *, but_drift: bool) -> Figure | None:
    """Mean over the passes that reach it, each with the weight of its error."""
    reaching = [
        own.ends for own in passes if own.ends is not None and len(own.ends.start.rows) and len(own.ends.end.rows)
    ]
    if not reaching:
        return None
    found = []
    for ends in reaching:
        left = [_left(fit, specimen, side, own, but_drift=but_drift) for own in (ends.start, ends.end)]
        change = _at_the_same_places(ends, left, fit.measured.pair.long_period) if ends.same_places else None
        found.append(change or _across_the_end(fit, ends, left, len(reaching)))
    weights = [1.0 / max(own.variance, 1e-300) for own in found]
    half_width = quantile_of(fit.freedom) / math.sqrt(sum(weights))
    return Figure(float(np.average([own.value for own in found], weights=weights)), half_width)


class _Change(NamedTuple):
    """Change from one window to the other [rad], and its variance [rad^2]."""

    value: float
    variance: float


def _at_the_same_places(ends: Ends, left: Sequence[Array], period: float) -> _Change | None:
    """Change by pairs of rows at the same places, so that no shape of the curve is in it; None if there are too few."""
    windows = (ends.start, ends.end)
    cells = min(MOST_CELLS, int(min(window.rows.sum() for window in windows)) // 2)
    if cells <= FEWEST:
        return None
    turned = 2 * math.pi / period
    middle = float(np.angle(np.exp(1j * turned * ends.start.phi1).mean())) / turned
    sums = []
    for own, each in zip(windows, left, strict=True):
        off = np.mod(own.phi1 - middle + period / 2, period) - period / 2
        index = np.clip(((off / WINDOW + 0.5) * cells).astype(np.int64), 0, cells - 1)
        sums.append((np.bincount(index, own.rows, cells), np.bincount(index, own.rows * each, cells)))
    (first, at_first), (last, at_last) = sums
    both = (first > 0) & (last > 0)
    if both.sum() <= FEWEST:
        return None
    weights = 1.0 / (1.0 / first[both] + 1.0 / last[both])
    changes = at_last[both] / last[both] - at_first[both] / first[both]
    mean = float(np.average(changes, weights=weights))
    one_row = float(weights @ (changes - mean) ** 2) / (both.sum() - 1)
    return _Change(mean, one_row / float(weights.sum()))


def _across_the_end(fit: Fit, ends: Ends, left: Sequence[Array], passes: int) -> _Change:
    """Change by the means of adjacent windows, as far apart as those of other quarter turns are in the median.

    It contains noise and the misfit, and nothing of a single slip. Passes share it.
    """
    (first, start), (last, end) = (
        (float(own.rows.sum()), float(own.rows @ each) / float(own.rows.sum()))
        for own, each in zip((ends.start, ends.end), left, strict=True)
    )
    steps = np.concatenate([_steps(fit, side) for side in fit.terms.sides])
    if len(steps) > FEWEST:
        return _Change(end - start, passes * (MAD * float(np.median(steps))) ** 2)
    return _Change(end - start, fit.variance * fit.low_orders * (1.0 / first + 1.0 / last))


def _steps(fit: Fit, side: Side) -> Array:
    """Magnitudes of the steps of the residual from one quarter turn of a side to the next [rad]."""
    rows = fit.measured.rows[side]
    index = (fit.measured.points[side].phi1 / WINDOW).astype(np.int64)
    count = np.bincount(index, rows)
    means = np.bincount(index, rows * fit.residual[side]) / np.where(count > 0, count, np.nan)
    steps = np.abs(np.diff(means))
    return np.asarray(steps[np.isfinite(steps)])


def _left(fit: Fit, specimen: Specimen, side: Side, bins: Bins, *, but_drift: bool) -> Array:
    """Residual of the fit in some rows [rad], off a constant of the side."""
    pair = fit.measured.pair
    travel = bins.travel if but_drift else np.zeros_like(bins.travel)
    at = Points(bins.phi1, pair.rate * bins.phi1 + bins.error, travel, bins.torque)
    rest = columns(pair, fit.terms, side, at)[:, 4:] @ fit.values[4:]
    return np.asarray(bins.error - (driven_angle(specimen, bins.phi1, side) - pair.rate * bins.phi1) - rest)
