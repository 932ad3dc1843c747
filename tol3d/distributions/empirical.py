"""A distribution taken from measured values: a column of a CSV file."""

import csv
import io
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, Self

import numpy as np
from pydantic import model_validator

from tol3d.distributions.base import LARGEST_DEVIATION, Array, Distribution, DistributionSpec
from tol3d.errors import SceneError
from tol3d.files import FileContent, Files
from tol3d.strict import refused
from tol3d.units import BARE_NUMBER, MICRO_SIGNS, UNITS, Quantity

if TYPE_CHECKING:
    from _csv import Reader

DECIMAL_COMMA: Final = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
THOUSANDS: Final = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
NUMBER_WORDS: Final = "a number such as 4.5"
COMMA_HINT: Final = "where numbers have decimal commas, put semicolons between the cells"


@dataclass(frozen=True, eq=False)
class Empirical(Distribution):
    """The law whose quantiles run linearly between the order statistics of a sample.

    Q(k / (n - 1)) is the k-th of the n sorted values, k = 0 .. n - 1, and Q is linear in between
    (Hyndman and Fan 1996, type 7, as numpy.quantile). Mean and variance are those of this law,
    exactly; they differ from the sample's own by terms of order 1/n, since the law has the
    sample's smallest and largest value as its ends. Two of them are equal only if they are one object.

    Args:
        values: (n,) the sorted sample, n >= 2.
    """

    values: Array

    def ppf(self, u: Array) -> Array:
        """Q(u): linear between the two order statistics about u (n - 1)."""
        position = u * (len(self.values) - 1)
        below = np.minimum(position.astype(np.int64), len(self.values) - 2)
        start = self.values[below]
        value: Array = start + (position - below) * (self.values[below + 1] - start)
        return value

    def cdf(self, x: Array) -> Array:
        """The inverse of Q; where values repeat it jumps, and takes the upper end."""
        probability: Array = np.interp(x, self.values, np.arange(len(self.values)) / (len(self.values) - 1))
        return np.where(x < self.values[0], 0.0, probability)

    @cached_property
    def _moments(self) -> tuple[float, float]:
        # each segment of Q is uniform between its ends a, b: E = (a + b)/2, E of the square = (a^2 + ab + b^2)/3
        start = self.values[0]
        a, b = self.values[:-1] - start, self.values[1:] - start
        mean = float(np.mean((a + b) / 2))
        a, b = a - mean, b - mean
        return float(start + mean), float(np.mean((a * a + a * b + b * b) / 3))

    @property
    def mean(self) -> float:
        """Mean of the middles of the segments between order statistics."""
        return self._moments[0]

    @property
    def variance(self) -> float:
        """Mean over the segments (a, b) of (a^2 + a b + b^2) / 3, a and b taken from the mean."""
        return self._moments[1]


class EmpiricalSpec(DistributionSpec):
    """`{file, column, unit}`: a CSV file with a header row; commas or semicolons between the cells.

    Numbers have decimal points, or decimal commas where these separate no cells.
    """

    kind: Literal["empirical"]
    file: str
    column: str
    unit: str

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        if not self.file.strip() or "\0" in self.file:
            raise refused("file", "the name of a CSV file", repr(self.file))
        return self

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_unit(cls, data: object) -> object:
        unit = data.get("unit") if isinstance(data, dict) else None
        if isinstance(unit, str) and unit.translate(MICRO_SIGNS) not in UNITS:
            raise refused("unit", f"one of {', '.join(UNITS)}", repr(unit))
        return data

    def quantities(self) -> dict[str, Quantity]:
        """One of the unit, under the field `unit`."""
        return {"unit": Quantity(1.0, self.unit.translate(MICRO_SIGNS))}

    def file_names(self) -> Iterator[tuple[str, str]]:
        """The CSV file."""
        yield "file", self.file

    def resolve(self, files: Files) -> Empirical:
        """Read the column.

        Raises:
            SceneError: the file is no CSV, or a cell is no number; the text names file and line.
        """
        file = files[self.file]
        sample = np.array(_column(file, self.column)) * self.quantities()["unit"].internal
        if not np.all(np.abs(sample) <= LARGEST_DEVIATION):
            raise SceneError(f"{file.path}: expected deviations of less than 1e9 mm, rad or K")
        sample = np.sort(sample)
        sample.flags.writeable = False
        return Empirical(sample)


def _column(file: FileContent, column: str) -> list[float]:
    """The numbers under the header `column`, at least two."""
    path, (table, separator) = file.path, _table(file)
    header_line, header = next(table, (1, []))
    names = [name.strip() for name in header]
    if names.count(column.strip()) != 1:
        found = ", ".join(repr(name) for name in names) or "an empty file"
        raise SceneError(f"{path}:{header_line}: expected one column named {column!r} in the header, got {found}")
    alone, index = len(names) == 1, names.index(column.strip())
    cells: list[_Cell] = []
    for line, row in table:
        if alone:  # a comma in it separates nothing
            row = [separator.join(row)]
        elif any(cell.strip() for cell in row[len(names) :]):
            hint = f"; {COMMA_HINT}" if separator == "," else ""
            raise SceneError(f"{path}:{line}: expected {len(names)} cells, as in the header, got {len(row)}{hint}")
        cells.append((line, row[index].strip() if index < len(row) else ""))
    if len(cells) < 2:
        raise SceneError(f"{path}: expected at least two values in column {column!r}, got {len(cells)}")
    return _Column(path, column, cells).numbers(commas=separator == ";" or alone, sure=separator == ";")


_Cell = tuple[int, str]
"""The line of a cell, and its text."""


@dataclass(frozen=True)
class _Column:
    """A column of a file, and the errors that name a cell of it."""

    path: Path
    name: str
    cells: Sequence[_Cell]

    def numbers(self, *, commas: bool, sure: bool) -> list[float]:
        """Its numbers, with decimal points or with decimal commas.

        Args:
            commas: whether a comma may be a decimal one: not where it separates cells.
            sure: whether it can be nothing else; 1,234 alone may be a thousand.
        """
        with_comma = [cell for cell in self.cells if "," in cell[1] and DECIMAL_COMMA.fullmatch(cell[1])]
        if not with_comma:
            return [self._number(cell, cell[1]) for cell in self.cells]
        first = with_comma[0]
        if not commas:
            raise self._refused(first, NUMBER_WORDS, f"; {COMMA_HINT}")
        if point := next((cell for cell in self.cells if "." in cell[1]), None):
            raise self._refused(point, f"decimal commas as in line {first[0]}, or none in all of the column")
        if not sure and all(THOUSANDS.fullmatch(text) for _, text in with_comma):
            raise self._refused(first, NUMBER_WORDS, ", which may be a thousand: write a decimal point, or no comma")
        return [self._number(cell, cell[1].replace(",", ".")) for cell in self.cells]

    def _number(self, cell: _Cell, text: str) -> float:
        number = float(text) if BARE_NUMBER.fullmatch(text) else math.nan
        if not math.isfinite(number):
            raise self._refused(cell, NUMBER_WORDS)
        return number

    def _refused(self, cell: _Cell, expected: str, hint: str = "") -> SceneError:
        line, text = cell
        shown = repr(text if len(text) <= 60 else text[:57] + "…") if text else "an empty cell"
        return SceneError(f"{self.path}:{line}: column {self.name!r}: expected {expected}, got {shown}{hint}")


def _table(file: FileContent) -> tuple[Iterator[tuple[int, list[str]]], str]:
    """The rows of a CSV file that are not blank, with their line numbers, and what separates the cells."""
    text = _text(file)
    separator = ";" if ";" in text.lstrip().partition("\n")[0] else ","
    return _rows(file, csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)), separator


def _rows(file: FileContent, reader: "Reader") -> Iterator[tuple[int, list[str]]]:
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                yield reader.line_num, row
    except csv.Error as error:
        raise SceneError(f"{file.path}:{reader.line_num}: expected comma-separated values, got {error}") from None


def _text(file: FileContent) -> str:
    try:
        return file.content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = file.content[: error.start].count(b"\n") + 1
        raise SceneError(f"{file.path}:{line}: expected UTF-8 text, got a byte that is none") from None
