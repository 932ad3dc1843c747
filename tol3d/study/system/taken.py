"""Value that a measure takes over several positions."""

from collections.abc import Iterable

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.study.system.measure import Measure
from tol3d.study.system.positions import Positions

ROWS_AT_ONCE = 65_536  # trials x positions; keeps poses and gaps of a turn's curves in some tens of megabytes
VALUES_AT_ONCE = 2**22  # the same where positions are read in turn and only their values are held: 32 MB


def trials_at_once(measures: Iterable[Measure]) -> int:
    """Number of trials asked of a method at once, as the positions of the measures let it."""
    return max(1, min(_rows(measure.positions) // measure.positions.in_a_trial for measure in measures))


def _rows(positions: Positions) -> int:
    return VALUES_AT_ONCE if positions.in_turn else ROWS_AT_ONCE


def taken(measure: Measure, values: Array) -> Array:
    """Value that a measure takes of its values (trials, positions): (trials,), or all of them for a curve.

    Extremes are those of a parabola through the extreme sample and its neighbours, on a closed period those
    round its end too: 1.1e-4 of the once-per-turn part at 24 positions a turn, where the sample is 9e-3 off. Of values
    that jump they are those of the samples: a parabola beside a jump would lie above both. A harmonic is the first
    order of the measure's spectrum, from peak to peak as ranges are.
    """
    if measure.take == "curve":
        return values
    if measure.take == "value":
        return values[:, 0]
    if measure.take == "harmonic":
        assert measure.spectrum is not None
        return 2 * measure.spectrum.amplitudes(measure.positions, values)[:, 0]
    if measure.positions.jumps:
        highest, lowest = np.asarray(values.max(axis=1)), np.asarray(values.min(axis=1))
    else:
        closed = measure.positions.closed
        highest = _parabola_peak(values, closed=closed)
        lowest = -_parabola_peak(-values, closed=closed)
    return np.asarray({"max": highest, "min": lowest, "range": highest - lowest}[measure.take])


def weights_taken(measure: Measure, curves: Array) -> Array:
    """Weights near curves (trials, positions): the value taken of curves is the sum of their values times these.

    Curves are read from their first position on. A harmonic is read along its own phase, extremes at positions.
    """
    found, rows = np.zeros_like(curves), np.arange(len(curves))
    if measure.take == "harmonic":
        assert measure.spectrum is not None
        count = measure.positions.count
        cycles = float(measure.spectrum.orders[0]) * np.arange(count) / count
        waves = np.stack([np.cos(2 * np.pi * cycles), np.sin(2 * np.pi * cycles)])
        sums = np.einsum("tp,wp->tw", curves[:, :count], waves)  # no BLAS, whose bits and threads follow shapes
        sizes = np.sqrt((sums * sums).sum(axis=1, keepdims=True))
        phases = sums / np.where(sizes > 0.0, sizes, 1.0)
        found[:, :count] = 4 / count * (phases[:, :1] * waves[0] + phases[:, 1:] * waves[1])
        return found
    if measure.take in ("max", "range"):
        found[rows, curves.argmax(axis=1)] += 1.0
    if measure.take in ("min", "range"):
        found[rows, curves.argmin(axis=1)] += -1.0 if measure.take == "range" else 1.0
    if measure.take != "range":
        found[:, 0] -= 1.0
    return found


def _parabola_peak(values: Array, *, closed: bool) -> Array:
    """Highest point of the parabola through the highest sample and its neighbours, within those three.

    At an end of an open span the parabola is the one through the three samples there.
    """
    count = values.shape[1]
    if count < 3:
        return np.asarray(values.max(axis=1))
    rows = np.arange(len(values))
    peak = np.argmax(values, axis=1)
    centre = peak if closed else np.clip(peak, 1, count - 2)
    at = values[rows, centre]
    before, after = values[rows, centre - 1], values[rows, (centre + 1) % count]
    bend, slope = 2 * at - before - after, (after - before) / 2
    offset = np.clip(slope / np.where(bend > 0.0, bend, 1.0), -1.0, 1.0)
    between = at + offset * slope - offset**2 * bend / 2
    return np.asarray(np.where(bend > 0.0, between, values[rows, peak]))
