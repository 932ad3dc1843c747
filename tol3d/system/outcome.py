"""Outcome of each trial of a measure: which ones seated, which ones lack what is measured and by how much.

Statistics of values are of the assembled trials. What is out of limits is counted of all of them, and a build that
lacks what is measured (its parts overlap) is below every lower limit.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array

Mask = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]

SEATED: Final = "ok"
ANALYTIC: Final = "analytic"
GEOMETRIC: Final = "geometric"
METHODS: Final = (ANALYTIC, GEOMETRIC)
"""Names of the methods in columns and in summary.json: the stack-up, and the 3D simulation by any engine."""


def value_column(method: str, measure: str) -> str:
    """Name of the column with a method's values of a measure."""
    return f"{method}:{measure}"


def status_column(measure: str) -> str:
    """Name of the column with the status of each trial of a measure."""
    return f"status:{measure}"


def reason_column(measure: str) -> str:
    """Name of the column with the cause of a measure's failed trials, in words of its system.

    One of the details of a method, "" where nothing decided it; not every measure has it.
    """
    return f"reason:{measure}"


@dataclass(frozen=True, eq=False)
class Outcome:
    """A method's values of a measure in some trials.

    Args:
        values: (trials,), or (trials, positions) of a curve, in the measure's unit; nan for trials that failed.
        lacking: (trials,), those whose parts overlap; None where every trial seated.
        deepest: the largest overlap of those that is known, as a value below 0; inf if none is.
    """

    values: Array
    lacking: Mask | None = None
    deepest: float = math.inf


def outcome_of(columns: Columns, method: str, measure: str, lacking: Collection[str]) -> Outcome:
    """A method's column of a measure; the analytic method seats every trial.

    Args:
        columns: trial on axis 0.
        method, measure: whose column.
        lacking: the statuses of trials with less than nothing of the measured quantity.
    """
    column = np.asarray(columns[value_column(method, measure)], dtype=np.float64)
    status = columns.get(status_column(measure))
    if method != GEOMETRIC or status is None:
        return Outcome(column)
    seated = status == SEATED
    if seated.all():
        return Outcome(column)
    lacks = np.zeros(len(status), dtype=bool)
    for text in lacking:
        lacks |= status == text
    values = column.copy()
    values[~seated] = np.nan
    return Outcome(values, lacks, float(np.nanmin(column[lacks], initial=math.inf)))
