"""CSV files of a rig, read block by block: they may be larger than memory. The only place here that knows pyarrow."""

import re
import stat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import pyarrow as pa
import pyarrow.csv as pc

from tol3d.cli.quantity import ANGLES, TORQUES
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

NAMED: Final = re.compile(r"\s*(?P<name>[^\[\]()]+?)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?\s*")
BLOCK_BYTES: Final = 2**21  # 75 000 rows of two angles; pyarrow reads up to 32 blocks ahead
LONGEST_HEADER: Final = 2**16  # bytes
MOST_ROWS: Final = 10**8
WANTED: Final = ("phi1", "phi2")
OPTIONAL: Final = ("torque", "repeat")
ROW_OF_ERROR: Final = re.compile(r"Row #(\d+)")
BAD_CELL: Final = re.compile(r"invalid value '(.*)'")
BAD_WIDTH: Final = re.compile(r"Expected (\d+) columns, got (\d+)")
LONG_LINE: Final = "straddl"  # pyarrow's word for a line that ends in none of two blocks
MOST_NAMED: Final = 12  # columns that a message names
SHOWN: Final = 60  # characters of what a file holds that a message repeats


@dataclass(frozen=True)
class Block:
    """Consecutive rows of a file.

    Args:
        first: number of data rows before it.
        phi1, phi2: encoder angles [rad], as they stand in the file.
        torque: [N m], or None.
        repeat: its number, or None.
    """

    first: int
    phi1: Array
    phi2: Array
    torque: Array | None
    repeat: Array | None


@dataclass(frozen=True)
class Header:
    """The first line of a file.

    Args:
        path: the file.
        names: of all columns.
        factors: of the columns that are read: name to (index, one of its unit in rad or N m).
        delimiter: between cells.
        comments: lines before it that begin with #.
        decimal_comma: whether numbers have one.
    """

    path: Path
    names: tuple[str, ...]
    factors: Mapping[str, tuple[int, float]]
    delimiter: str
    comments: int
    decimal_comma: bool


def blocks_of(path: Path, unit: str | None) -> Iterator[Block]:
    """The rows of a file, block by block.

    Args:
        path: CSV with the columns `phi1` and `phi2`, each with its unit (`phi1 [deg]`); `torque [N m]` and `repeat`
            may be there too; others are not read.
        unit: of the angles, where the header gives none.

    Raises:
        InputError: with file and line.
    """
    header = _header(path, unit)
    rows = 0
    try:
        for batch in _opened(header):
            if rows + batch.num_rows > MOST_ROWS:
                raise InputError(
                    f"{path}: more than {MOST_ROWS:.0e} rows; thin it: 1000 rows per turn of the driver are plenty"
                )
            yield _block(header, batch, rows)
            rows += batch.num_rows
    except pa.ArrowInvalid as error:
        raise _refused(header, str(error)) from None
    if rows == 0:
        raise InputError(f"{path}: no rows of data below the header")


def _opened(header: Header) -> pc.CSVStreamingReader:
    columns = {f"c{index}": pa.float64() for index, _ in header.factors.values()}
    return pc.open_csv(
        header.path,
        read_options=pc.ReadOptions(
            use_threads=False,  # only then messages name the row
            block_size=BLOCK_BYTES,
            skip_rows=header.comments + 1,
            column_names=[f"c{index}" for index in range(len(header.names))],
        ),
        parse_options=pc.ParseOptions(delimiter=header.delimiter),
        convert_options=pc.ConvertOptions(
            column_types=columns, include_columns=list(columns), decimal_point="," if header.decimal_comma else "."
        ),
    )


def _block(header: Header, batch: pa.RecordBatch, first: int) -> Block:
    found: dict[str, Array] = {}
    for name, (index, factor) in header.factors.items():
        values = batch.column(f"c{index}").to_numpy(zero_copy_only=False)
        if not np.isfinite(values).all():
            row = int(np.flatnonzero(~np.isfinite(values))[0])
            raise InputError(
                f"{header.path}:{line_of(header.path, first + row)}: column {header.names[index]!r}: "
                f"expected a finite number, got {'an empty cell or NaN' if np.isnan(values[row]) else values[row]}"
            )
        found[name] = values * factor if factor != 1.0 else values
    return Block(first, found["phi1"], found["phi2"], found.get("torque"), found.get("repeat"))


def line_of(path: Path, row: int) -> int:
    """The line, counted from 1, of a row of data, counted from 0: comments, header and blank lines are none."""
    seen = -2  # the header is one
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            if line.strip() and not (seen == -2 and line.lstrip().startswith(b"#")):
                seen += 1
                if seen == row:
                    return number
    return row + 2


# the header ---------------------------------------------------------------------------------------


def _header(path: Path, unit: str | None) -> Header:
    comments, text, after = _first_lines(path)
    delimiter = next((sign for sign in (";", "\t") if sign in text), ",")
    names = tuple(name.strip().strip('"') for name in text.split(delimiter))
    return Header(path, names, _factors(path, names, unit), delimiter, comments, delimiter == ";" and "," in after)


def _first_lines(path: Path) -> tuple[int, str, str]:
    """Number of comment lines that a file begins with, its header, and the line below."""
    try:
        if not stat.S_ISREG(path.stat().st_mode) and not path.is_dir():  # a pipe would be waited for
            raise InputError(f"{path}: expected a file, got a pipe or a device; the file is read more than once")
        with path.open("rb") as file:
            lines = file.read(LONGEST_HEADER).splitlines()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    comments = next((i for i, line in enumerate(lines) if not line.lstrip().startswith(b"#")), len(lines))
    if comments == len(lines) or not b"".join(lines).strip():
        raise InputError(f"{path}: empty; expected a header such as `phi1 [deg],phi2 [deg]` and rows of numbers")
    try:
        text, *after = (line.decode("utf-8-sig") for line in lines[comments : comments + 2])
    except UnicodeDecodeError:
        raise InputError(f"{path}:{comments + 1}: expected a CSV file in UTF-8, got other bytes") from None
    return comments, text, "".join(after)


def _factors(path: Path, names: tuple[str, ...], unit: str | None) -> dict[str, tuple[int, float]]:
    found: dict[str, tuple[int, float]] = {}
    for index, text in enumerate(names):
        match = NAMED.fullmatch(text)
        name = match["name"].lower() if match else ""
        if match is None or name not in (*WANTED, *OPTIONAL):
            continue
        if name in found:
            raise InputError(f"{path}: two columns named {name!r} in the header")
        found[name] = index, 1.0 if name == "repeat" else _factor(path, name, match["unit"], unit)
    for name in WANTED:
        if name not in found:
            got = ", ".join(repr(text[:SHOWN]) for text in names[:MOST_NAMED]) + (
                " …" if len(names) > MOST_NAMED else ""
            )
            raise InputError(f"{path}: missing column {name!r}: expected `{name} [deg]` in the header, got {got}")
    return found


def _factor(path: Path, name: str, stated: str | None, unit: str | None) -> float:
    table, example = (TORQUES, "N m") if name == "torque" else (ANGLES, "deg")
    own = stated if stated or name == "torque" else unit
    if not own:
        also = " or --unit" if name != "torque" else ""
        raise InputError(f"{path}: column {name!r} has no unit: expected `{name} [{example}]` in the header{also}")
    if own not in table:
        raise InputError(f"{path}: column {name!r}: unknown unit {own[:SHOWN]!r}; expected one of {', '.join(table)}")
    return table[own]


# what pyarrow refuses -----------------------------------------------------------------------------


def _refused(header: Header, text: str) -> InputError:
    path, row = header.path, ROW_OF_ERROR.search(text)
    line = header.comments + 2 if row is None else line_of(path, int(row[1]) - header.comments - 2)
    if cell := BAD_CELL.search(text):
        return InputError(f"{path}:{line}: expected a number, got {cell[1][:SHOWN]!r}")
    if width := BAD_WIDTH.search(text):
        return InputError(f"{path}:{line}: expected {width[1]} cells, as in the header, got {width[2]}")
    if "Empty CSV" in text:
        return InputError(f"{path}: no rows of data below the header")
    if LONG_LINE in text:
        return InputError(f"{path}: cannot be read as CSV: a line is longer than {BLOCK_BYTES // 2**20} MB")
    return InputError(f"{path}: cannot be read as CSV: {text.splitlines()[0][:200]}")
