"""The worst trial of a run: the one nearest to a limit, or furthest beyond it."""

from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import RunError
from tol3d.numerics.arrays import Array
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.system.outcome import SEATED, outcome_of, status_column, value_column

LACKS_BY = -1e9  # sigmas; no build that seats is so far beyond a limit


class KeptTrials(Protocol):
    """Interface of a run as it is read: its summary, and columns as numpy arrays with the trial on axis 0."""

    @property
    def path(self) -> Path:
        """Its folder."""
        ...

    @property
    def found(self) -> RunSummary:
        """Its summary, typed."""
        ...

    @property
    def trials(self) -> int:
        """Number of trials that were run."""
        ...

    @property
    def column_names(self) -> tuple[str, ...]:
        """Names of the columns of its trials."""
        ...

    def columns(self, *names: str) -> dict[str, NDArray[Any]]:
        """Columns as numpy arrays, trial on axis 0."""
        ...


def worst_trial(run: KeptTrials, measure: str | None = None, *, seated_only: bool = False) -> int:
    """Index of the worst trial of a run.

    Where any trial lacks what is measured it is the one that lacks most; else, among the assembled, the one nearest
    to a limit, or furthest beyond it. Nearness and depth are counted in standard deviations of each measure; a curve
    counts by its extremes. Without any limit it is the trial at the worse end of the first measure. A trial of which
    nothing is known cannot be shown, and is never the worst.

    Args:
        run: one that kept its trials.
        measure: the only one that is judged; all that have limits by default.
        seated_only: leave out trials with status "lacking".

    Raises:
        RunError: no such measure, or the run kept no trials.
    """
    measures = run.found.measures
    if measure is not None and measure not in measures:
        raise RunError(f"{run.path}: no measure {measure!r}; there are: {', '.join(measures)}")
    method = run.found.best_method
    limited = {name: own for name, own in measures.items() if own.has_limits}
    judged = {measure: measures[measure]} if measure else limited or dict([*measures.items()][:1])
    least = np.min([_margin(run, method, name, own) for name, own in judged.items()], axis=0)
    if seated_only:
        least = np.where(_seated(run), least, np.inf)
    return int(np.argmin(least))


def _seated(run: KeptTrials) -> NDArray[np.bool_]:
    """True for trials that have every measure (trials,)."""
    seated = np.ones(run.trials, dtype=bool)
    for column in {status_column(name) for name in run.found.measures} & {*run.column_names}:
        seated &= run.columns(column)[column] == SEATED
    return seated


def _margin(run: KeptTrials, method: str, name: str, measure: MeasureSummary) -> Array:
    """Margin of each trial inside the limits, in sigmas; infinite if it gave no value, far below all if lacking."""
    wanted = (value_column(method, name), status_column(name))
    columns = run.columns(*(column for column in wanted if column in run.column_names))
    found = outcome_of(columns, method, name, run.found.lacking)
    values = found.values.reshape(run.trials, -1)
    lower, upper = measure.limits
    below, above = values.min(axis=1), values.max(axis=1)  # nan where a position of a curve could not be assembled
    if not measure.has_limits:
        margin = -above if measure.worse == "high" else below
    else:
        margin = below - lower if lower is not None else np.full(run.trials, np.inf)
        margin = np.minimum(margin, upper - above) if upper is not None else margin
    spread = (float(np.nanstd(margin)) if np.isfinite(margin).any() else 1.0) or 1.0
    margin = np.where(np.isnan(margin), np.inf, margin / spread)
    if found.lacking is not None:
        margin[found.lacking] = LACKS_BY + _overlaps(run, method, name)[found.lacking] / spread
    return margin


def _overlaps(run: KeptTrials, method: str, name: str) -> Array:
    """The smallest value of each trial (trials,); below all where an overlap is too deep to measure."""
    column = value_column(method, name)
    smallest = np.asarray(run.columns(column)[column], dtype=np.float64).reshape(run.trials, -1).min(axis=1)
    return np.where(np.isnan(smallest), LACKS_BY, smallest)
