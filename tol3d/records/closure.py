"""Whether a side closes: its transmission error a long period later, where the same teeth touch as at its start.

Gears cannot differ by then; what does is drift, or an encoder or coupling that has slipped. The rows of the quarter
turn after the long period lie where those of the first one do, so that their difference knows no model. Where a pass
ends with the long period, the last quarter turn stands in: the fit, its drift aside, bridges both.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tol3d.records.alignment import Aligned
from tol3d.records.bins import Bins
from tol3d.records.exact_play import Side, driven_angle
from tol3d.records.fit import Fit
from tol3d.records.pair import ARCSEC, Specimen
from tol3d.records.prediction import Figure, quantile_of
from tol3d.records.terms import Points, columns

Array = NDArray[np.float64]
Closing = Literal["drive", "back", "backlash"]

OPEN: Final = 3.0  # standard errors from which on a side does not close
LEAST: Final = 1e-3 * ARCSEC  # that matters, where nothing scatters
FEWEST: Final = 10  # degrees of freedom of windows whose own scatter is their noise


def closures(
    fit: Fit, specimen: Specimen, passes: Mapping[Side, Sequence[Aligned]], *, but_drift: bool = False
) -> Mapping[Closing, Figure]:
    """Change over the long period [rad] of each side's transmission error, and of the backlash: back less drive.

    Args:
        fit: the joint one.
        specimen: what it found.
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
    changes, weights = [], []
    for ends in (own.ends for own in passes):
        if ends is None or not len(ends.start.rows) or not len(ends.end.rows):
            continue
        both = [_window(each, _left(fit, specimen, side, each, but_drift=but_drift)) for each in (ends.start, ends.end)]
        changes.append(both[1].mean - both[0].mean)
        weights.append(1.0 / max(_variance(fit, both, same_places=ends.same_places), 1e-300))
    if not changes:
        return None
    half_width = quantile_of(fit.freedom) / math.sqrt(sum(weights))
    return Figure(float(np.average(changes, weights=weights)), half_width)


class _Window(NamedTuple):
    """Mean of what is left in a window [rad], its rows and bins, and the squares about the mean [rad^2]."""

    mean: float
    rows: float
    bins: int
    squares: float


def _window(bins: Bins, left: Array) -> _Window:
    rows = float(bins.rows.sum())
    mean = float(bins.rows @ left) / rows
    return _Window(mean, rows, len(left), float(bins.rows @ (left - mean) ** 2))


def _variance(fit: Fit, windows: Sequence[_Window], *, same_places: bool) -> float:
    """Of the difference of two windows' means [rad^2].

    At the same places noise alone tells them apart, and the scatter within them is that or more. Elsewhere the fit's
    lack at low orders does too. What has drifted or slipped is in the scatter of the whole, not in theirs.
    """
    freedom = sum(own.bins for own in windows) - len(windows)
    one_row = fit.variance * fit.low_orders
    if same_places and freedom >= FEWEST:
        one_row = sum(own.squares for own in windows) / freedom
    return one_row * sum(1.0 / own.rows for own in windows)


def _left(fit: Fit, specimen: Specimen, side: Side, bins: Bins, *, but_drift: bool) -> Array:
    """What the fit leaves of some rows [rad], off a constant of the side."""
    pair = fit.measured.pair
    travel = bins.travel if but_drift else np.zeros_like(bins.travel)
    at = Points(bins.phi1, pair.rate * bins.phi1 + bins.error, travel, bins.torque)
    rest = columns(pair, fit.terms, side, at)[:, 4:] @ fit.values[4:]
    return np.asarray(bins.error - (driven_angle(specimen, bins.phi1, side) - pair.rate * bins.phi1) - rest)
