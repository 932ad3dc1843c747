"""The difference 3D simulation − analytic of every trial of a run, gathered block by block."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.report.bars import Bars
from tol3d.runs.run import Run
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.system.outcome import ROADS, outcome_of, status_column, value_column

Array = NDArray[np.float64]

BARS = 40
POINTS_SHOWN = 4000  # dots in a picture; more hide each other
TURN = 360.0  # deg
SMALLEST_SPAN = 1e-6  # um or arc minutes; for roads that agree to the last bit


@dataclass(frozen=True, eq=False)
class Difference:
    """How the two roads of one measure differ.

    Args:
        bars: histogram of the differences, in the measure's unit.
        at: (n,) where the first trials were read: the driver's position [deg] within a turn, or the
            analytic value where a measure has many positions; n at most POINTS_SHOWN.
        values: (n,) their differences.
        by_position: whether `at` is a position.
        largest, rms: of all trials, in the measure's unit.
    """

    bars: Bars
    at: Array
    values: Array
    by_position: bool
    largest: float
    rms: float


def difference_of(run: Run, measure: str) -> Difference | None:
    """The difference of the two roads of a scalar or curve measure; None without a 3D simulation, or without trials.

    Memory does not grow with the number of trials: one block of columns is held at a time.
    """
    summary = run.found.measures[measure]
    if not {f"analytic:{measure}", f"geometric:{measure}"} <= set(run.column_names):
        return None
    position = summary.position_column if summary.position_column in run.column_names else None
    ends = np.array([_ends(analytic, geometric) for analytic, geometric, _ in _blocks(run, measure, position)])
    low, high = float(ends.min()), float(ends.max())
    edges = np.linspace(low, max(high, low + SMALLEST_SPAN), BARS + 1)
    counts, total, squares = np.zeros(BARS), 0, 0.0
    at, values = np.empty(0), np.empty(0)
    for analytic, geometric, places in _blocks(run, measure, position):
        difference = (geometric - analytic).ravel()
        known = ~np.isnan(difference)
        counts += np.histogram(difference[known], edges)[0]
        total += int(known.sum())
        squares += float(np.sum(difference[known] ** 2))
        room = POINTS_SHOWN - len(at)
        at = np.append(at, _abscissa(summary, analytic, places)[known][:room])
        values = np.append(values, difference[known][:room])
    count = max(total, 1)
    return Difference(
        bars=Bars(edges, counts, count),
        at=at,
        values=values,
        by_position=position is not None or summary.take == "curve",
        largest=max(high, -low),
        rms=float(np.sqrt(squares / count)),
    )


def _abscissa(summary: MeasureSummary, analytic: Array, places: Array | None) -> Array:
    if summary.take == "curve":
        return np.broadcast_to(summary.position_deg or [], analytic.shape).ravel()
    return analytic if places is None else places % TURN


def _ends(analytic: Array, geometric: Array) -> tuple[float, float]:
    """Smallest and largest difference of a block, and 0."""
    difference = geometric - analytic
    known = difference[~np.isnan(difference)]
    return float(np.min(known, initial=0.0)), float(np.max(known, initial=0.0))


def _blocks(run: Run, measure: str, position: str | None) -> Iterator[tuple[Array, Array, Array | None]]:
    """Analytic and geometric values and positions, one file of trials at a time; nan where a trial did not seat."""
    wanted = (*(value_column(road, measure) for road in ROADS), status_column(measure))
    asked = tuple(name for name in wanted if name in run.column_names)
    lacking = run.found.lacking
    for columns in run.pieces(*asked, *((position,) if position else ())):
        analytic, geometric = (outcome_of(columns, road, measure, lacking).values for road in ROADS)
        yield analytic, geometric, np.asarray(columns[position], dtype=np.float64) if position else None
