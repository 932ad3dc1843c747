"""Columns as Parquet, in memory: the content of a block's file. Only this module imports Parquet."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

Columns = dict[str, NDArray[np.generic]]

# Measured on 65 536 trials of 25 random columns: 20 ms to write, 9 ms to read, 6 % smaller than plain; dictionaries
# of doubles that hardly repeat cost four times that, and zstd gains 4 % more for half as long again.
COMPRESSION = "lz4"
MOST_ROWS = 2**20  # trials in a file; blocks have 65 536 at most
MOST_POSITIONS = 2**22  # of a curve; a block of one trial
BYTES_A_VALUE = 24  # unpacked: a double, its levels and some waste
BYTES_A_COLUMN = 2**16  # headers and words


class ParquetError(Exception):
    """Bytes that are not the Parquet file they should be."""


def parquet_of(columns: Columns, units: Mapping[str, str]) -> memoryview:
    """The Parquet file of some columns, trial on axis 0 (a curve: positions on axis 1), with the unit of each."""
    arrays = {name: _to_arrow(values) for name, values in columns.items()}
    fields = [pa.field(name, array.type, metadata={"unit": units.get(name, "")}) for name, array in arrays.items()]
    stream = pa.BufferOutputStream()
    pq.write_table(
        pa.Table.from_arrays(list(arrays.values()), schema=pa.schema(fields)),
        stream,
        compression=COMPRESSION,
        use_dictionary=[name for name, values in columns.items() if values.dtype.kind == "U"],
        use_byte_stream_split=[
            name if values.ndim == 1 else f"{name}.list.element"
            for name, values in columns.items()
            if values.dtype.kind == "f"
        ],
        write_statistics=False,
    )
    return memoryview(stream.getvalue())


@dataclass(frozen=True)
class Shape:
    """Expected shape of a block of trials, known before any of it is read.

    Args:
        rows: number of trials.
        width: number of positions of a column, 1 except for curves.
    """

    rows: int
    width: Callable[[str], int]


def columns_of(content: bytes, names: Sequence[str] | None = None, shape: Shape | None = None) -> Columns:
    """Columns of a Parquet file's content; all of them by default.

    Args:
        content: of the file, which a stranger may have made.
        names: of the columns that are wanted.
        shape: of the block, where it is known; a file that states another one is not unpacked.

    Raises:
        ParquetError: it is damaged, has another shape, lacks a column, or holds a column that no run has.
    """
    try:
        file = pq.ParquetFile(pa.BufferReader(content))
        wanted = list(file.schema_arrow.names if names is None else names)
        _refuse_surprises(file, wanted, shape)
        table = file.read(columns=wanted)
    except (OSError, ValueError, pa.ArrowException) as error:
        raise ParquetError((str(error).splitlines() or ["unreadable"])[0]) from None
    return {name: _to_numpy(table.column(name)) for name in wanted}


def _refuse_surprises(file: pq.ParquetFile, wanted: Sequence[str], shape: Shape | None) -> None:
    """Refuse anything but a block of trials before unpacking it: a few MB may hold as many GB of zeros."""
    stated = file.metadata.num_rows
    if shape is not None and stated != shape.rows:
        raise ParquetError(f"{stated} trials where there should be {shape.rows}")
    if stated > MOST_ROWS:
        raise ParquetError(f"{stated} trials, expected at most {MOST_ROWS} in one file")
    schema = file.schema_arrow
    if len(set(schema.names)) != len(schema.names):
        raise ParquetError("two columns of one name")
    for name in wanted:
        if name not in schema.names:
            raise ParquetError(f"no column {name!r:.100}")
        if not _is_of_runs(schema.field(name).type):
            raise ParquetError(f"column {name!r:.100} holds {schema.field(name).type!s:.60}, which no run keeps")
        width = _width_of(schema.field(name).type)
        if shape is not None and width != shape.width(name):
            raise ParquetError(f"column {name!r:.100} has {width} positions where there should be {shape.width(name)}")
    widths = sum(_width_of(field.type) for field in schema)
    groups = [file.metadata.row_group(index) for index in range(file.metadata.num_row_groups)]
    chunks = [group.column(index) for group in groups for index in range(group.num_columns)]
    values, size = sum(chunk.num_values for chunk in chunks), sum(chunk.total_uncompressed_size for chunk in chunks)
    if sum(group.num_rows for group in groups) != stated or values > stated * widths:
        raise ParquetError("more values than its trials have")
    if size > BYTES_A_VALUE * values + BYTES_A_COLUMN * max(1, len(chunks)):
        raise ParquetError(f"{size} bytes for {values} values")


def _width_of(kind: pa.DataType) -> int:
    return int(kind.list_size) if pa.types.is_fixed_size_list(kind) else 1


def _is_of_runs(kind: pa.DataType) -> bool:
    """True if a column of a run may be of a type: numbers, lists of as many numbers each, words."""
    if pa.types.is_fixed_size_list(kind):
        return bool(pa.types.is_floating(kind.value_type)) and 0 < kind.list_size <= MOST_POSITIONS
    if pa.types.is_dictionary(kind):
        return bool(pa.types.is_string(kind.value_type))
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_string(kind))


def names_of(content: bytes) -> tuple[str, ...]:
    """Names of the columns of a Parquet file's content.

    Raises:
        ParquetError: it is damaged.
    """
    try:
        return tuple(pq.read_schema(pa.BufferReader(content)).names)
    except (OSError, ValueError, pa.ArrowException) as error:
        raise ParquetError((str(error).splitlines() or ["unreadable"])[0]) from None


def _to_numpy(column: pa.ChunkedArray) -> NDArray[np.generic]:
    if pa.types.is_fixed_size_list(column.type):
        flat = column.combine_chunks().flatten().to_numpy(zero_copy_only=False)
        return np.asarray(flat).reshape(len(column), -1)
    if pa.types.is_dictionary(column.type):
        words = column.combine_chunks()
        return np.asarray(np.array(words.dictionary.to_pylist())[words.indices.to_numpy()])
    if pa.types.is_string(column.type):
        return np.array(column.to_pylist())
    return np.asarray(column.to_numpy())


def _to_arrow(values: NDArray[np.generic]) -> pa.Array:
    """Made of buffers: pa.array would load pandas, where it is installed, to ask whether this is of pandas."""
    if values.ndim == 2:
        return pa.FixedSizeListArray.from_arrays(_numbers(values.ravel()), values.shape[1])
    if values.dtype.kind == "U":
        words, codes = np.unique(values, return_inverse=True)
        return pa.DictionaryArray.from_arrays(_numbers(codes.astype(np.int32)), _words(words.tolist()))
    return _numbers(values)


def _numbers(values: NDArray[np.generic]) -> pa.Array:
    """Arrow keeps numbers as numpy does; booleans it packs, and no column is of those."""
    flat = np.ascontiguousarray(values)
    return pa.Array.from_buffers(pa.from_numpy_dtype(flat.dtype), len(flat), [None, pa.py_buffer(flat)])


def _words(words: Sequence[str]) -> pa.Array:
    encoded = [word.encode() for word in words]
    ends = np.cumsum([0, *map(len, encoded)], dtype=np.int32)
    return pa.Array.from_buffers(pa.string(), len(words), [None, pa.py_buffer(ends), pa.py_buffer(b"".join(encoded))])
