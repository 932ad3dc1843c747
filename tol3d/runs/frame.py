"""Trials as a table of pandas, where it is installed. The only module that imports pandas."""

import importlib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.runs.summary.measure import MeasureSummary

if TYPE_CHECKING:
    import pandas as pd

Columns = Mapping[str, NDArray[np.generic]]
Curves = Literal["split", "drop"]


class MissingPackageError(InputError, ImportError):
    """An optional package, loaded on demand."""


def frame_of(columns: Columns, measures: Mapping[str, MeasureSummary], curves: Curves = "split") -> "pd.DataFrame":
    """Columns as a DataFrame, a row a trial.

    Args:
        columns: trial on axis 0, positions of a curve on axis 1.
        measures: their summaries, which know the positions of curves.
        curves: "split" gives every position a column, `geometric:curve:45 deg`; "drop" leaves curves out.

    Raises:
        MissingPackageError: pandas is not installed.
    """
    if curves not in ("split", "drop"):
        raise InputError(f'curves: expected "split" or "drop", got {curves!r}')
    try:
        pandas = importlib.import_module("pandas")
    except ImportError:
        raise MissingPackageError("a frame needs pandas: pip install pandas") from None
    flat = {name: values for name, values in _flat(columns, measures) if curves == "split" or name in columns}
    count = len(next(iter(columns.values()), ()))
    return pandas.DataFrame(flat, index=pandas.RangeIndex(count, name="trial"))


def _flat(columns: Columns, measures: Mapping[str, MeasureSummary]) -> Iterator[tuple[str, NDArray[np.generic]]]:
    """Columns of one value a trial; a curve as one at each of its positions."""
    for name, values in columns.items():
        if values.ndim == 1:
            yield name, values
            continue
        positions = measures[name.split(":", 1)[1]].position_deg
        yield from ((f"{name}:{angle:.10g} deg", values[:, k]) for k, angle in enumerate(positions or ()))
