"""Trials and tables as frames of pandas, where it is installed. The only module that imports pandas."""

import importlib
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.study.runs.summary.measure import MeasureSummary

if TYPE_CHECKING:
    from pandas import DataFrame as DataFrame  # those who name the type take it from here

Columns = Mapping[str, NDArray[np.generic]]
Curves = Literal["split", "drop"]


class MissingPackageError(InputError, ImportError):
    """An optional package, loaded on demand."""


def frame_of(columns: Columns, measures: Mapping[str, MeasureSummary], curves: Curves = "split") -> "DataFrame":
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
    pandas = _pandas()
    flat = {name: values for name, values in _flat(columns, measures) if curves == "split" or name in columns}
    count = len(next(iter(columns.values()), ()))
    return pandas.DataFrame(flat, index=pandas.RangeIndex(count, name="trial"))


def frame_of_rows(headings: Sequence[str], rows: Sequence[Sequence[str | float | None]]) -> "DataFrame":
    """Rows of texts and numbers as a DataFrame; a column without texts is one of numbers, nan where one is not known.

    Raises:
        MissingPackageError: pandas is not installed.
    """
    columns = {own: [row[k] for row in rows] for k, own in enumerate(headings)}
    for name, cells in columns.items():
        if not any(isinstance(cell, str) for cell in cells):
            columns[name] = [np.nan if cell is None else cell for cell in cells]
    return _pandas().DataFrame(columns)


def _pandas() -> Any:
    try:
        return importlib.import_module("pandas")
    except ImportError:
        raise MissingPackageError("a frame needs pandas: pip install pandas") from None


def _flat(columns: Columns, measures: Mapping[str, MeasureSummary]) -> Iterator[tuple[str, NDArray[np.generic]]]:
    """Columns of one value a trial; a curve as one at each of its positions."""
    for name, values in columns.items():
        if values.ndim == 1:
            yield name, values
            continue
        positions = measures[name.split(":", 1)[1]].position_deg
        yield from ((f"{name}:{angle:.10g} deg", values[:, k]) for k, angle in enumerate(positions or ()))
