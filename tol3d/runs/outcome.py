"""What became of each trial of a measure: which ones seated, which ones are jammed and by how much.

Statistics of values are of the trials that seated. What is out of limits is counted of all of them, and a jammed build
is below every lower limit: it has less than no backlash.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Columns = Mapping[str, NDArray[np.generic]]

SEATED: Final = "ok"
JAMMED: Final = "interferes"


def status_column(measure: str) -> str:
    """Name of the column with what became of each trial of a measure."""
    return f"status:{measure}"


@dataclass(frozen=True, eq=False)
class Told:
    """What a road tells of a measure in some trials.

    Args:
        values: (trials,), or (trials, positions) of a curve, in the measure's unit; nan for trials that did not seat.
        jammed: (trials,), those whose teeth or parallel ways overlap; None where every trial seated.
        deepest: the largest overlap of those that is known, as a value below 0; inf where none is.
    """

    values: Array
    jammed: Mask | None = None
    deepest: float = math.inf


def told(columns: Columns, road: str, measure: str) -> Told:
    """A road's column of a measure; the analytic road seats every trial."""
    column = np.asarray(columns[f"{road}:{measure}"], dtype=np.float64)
    status = columns.get(status_column(measure))
    if road != "geometric" or status is None:
        return Told(column)
    seated = status == SEATED
    if seated.all():
        return Told(column)
    jammed = status == JAMMED
    values = column.copy()
    values[~seated] = np.nan
    return Told(values, jammed, float(np.nanmin(column[jammed], initial=math.inf)))
