"""Convergence of a measure's mean and sigma with the number of trials, read piece by piece."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.errors import InputError, RunError
from tol3d.numerics.arrays import Array
from tol3d.runs.run import Run
from tol3d.system.outcome import GEOMETRIC, outcome_of, status_column, value_column

CONFIDENCE: Final = 1.96  # standard errors to either side, 95 %
FEWEST: Final = 10


@dataclass(frozen=True, eq=False)
class Convergence:
    """Mean and sigma of the first so many trials, with their standard errors, all in the measure's unit.

    Args:
        counts: (n,) how many trials, those that could not be assembled left out.
        mean, sigma: (n,) of them.
    """

    counts: Array
    mean: Array
    sigma: Array

    @property
    def mean_error(self) -> Array:
        """Standard errors of the means."""
        return np.asarray(self.sigma / np.sqrt(self.counts))

    @property
    def sigma_error(self) -> Array:
        """Standard errors of the sigmas, of normal values."""
        return np.asarray(self.sigma / np.sqrt(2 * (self.counts - 1)))


def convergence_of(run: Run, name: str, points: int) -> Convergence:
    """Convergence of a measure at so many numbers of trials; memory does not grow with them.

    Raises:
        InputError: a curve, which has no one mean, or too few trials seated. RunError: the run kept no trials.
    """
    measure = run.found.measures[name]
    if measure.take == "curve":
        raise InputError(f"{name}: expected a measure of one number a trial, got a curve")
    if not run.keeps_trials:
        raise RunError(f"{run.path}: this run kept its statistics only (--no-trials); run the scene again with them")
    total = measure.seated if measure.best_method == GEOMETRIC else run.trials
    if total < FEWEST:
        raise InputError(f"{name}: expected {FEWEST} assembled trials, got {total}")
    counts = np.unique(np.geomspace(FEWEST, total, points).round().astype(int))
    return running(_known(run, name), counts)


def running(pieces: Iterable[Array], counts: Array) -> Convergence:
    """Mean and sigma of the first so many values, each; of counts beyond the last value that of all of them.

    >>> found = running([np.array([1.0, 3.0]), np.array([5.0])], np.array([2, 3]))
    >>> found.mean, found.sigma
    (array([2., 3.]), array([1.41421356, 2.        ]))
    """
    there, shift, total, squares = 0, None, 0.0, 0.0
    found = list[tuple[int, float, float]]()
    for values in pieces:
        shift = float(values.mean()) if shift is None and len(values) else shift or 0.0
        off = values - shift
        sums, seconds = total + np.cumsum(off), squares + np.cumsum(off**2)
        wanted = counts[(counts > there) & (counts <= there + len(values))]
        found += [(int(n), float(sums[n - there - 1]), float(seconds[n - there - 1])) for n in wanted]
        if len(values):
            there, total, squares = there + len(values), float(sums[-1]), float(seconds[-1])
    if not found or found[-1][0] < there < counts[-1]:
        found.append((there, total, squares))
    numbers, firsts, seconds = (np.array(column, dtype=np.float64) for column in zip(*found, strict=True))
    means = firsts / numbers
    variance = np.maximum(seconds - numbers * means**2, 0.0) / (numbers - 1)
    return Convergence(numbers, means + (shift or 0.0), np.sqrt(variance))


def _known(run: Run, name: str) -> Iterator[Array]:
    """Values of the trials that have one, of the best method there is, piece by piece."""
    method, lacking = run.found.measures[name].best_method, run.found.lacking
    wanted = (value_column(method, name), status_column(name))
    for columns in run.pieces(*(own for own in wanted if own in run.column_names)):
        values = outcome_of(columns, method, name, lacking).values
        yield np.asarray(values[np.isfinite(values)])
