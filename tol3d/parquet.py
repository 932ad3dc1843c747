"""Columns as Parquet, in memory: what a block's file holds. The only place that knows Parquet."""

from collections.abc import Mapping, Sequence

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

Columns = dict[str, NDArray[np.generic]]

# Measured on 65 536 trials of 25 random columns: 20 ms to write, 9 ms to read, 6 % smaller than plain; dictionaries
# of doubles that hardly repeat cost four times that, and zstd gains 4 % more for half as long again.
COMPRESSION = "lz4"


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


def columns_of(content: bytes, names: Sequence[str] | None = None) -> Columns:
    """Columns of a Parquet file's content; all of them by default.

    Raises:
        ParquetError: it is damaged.
    """
    try:
        table = pq.read_table(pa.BufferReader(content), columns=None if names is None else list(names))
    except (OSError, pa.ArrowException) as error:
        raise ParquetError(str(error).splitlines()[0]) from None
    return {name: _to_numpy(table.column(name)) for name in table.column_names}


def names_of(content: bytes) -> tuple[str, ...]:
    """Names of the columns of a Parquet file's content.

    Raises:
        ParquetError: it is damaged.
    """
    try:
        return tuple(pq.read_schema(pa.BufferReader(content)).names)
    except (OSError, pa.ArrowException) as error:
        raise ParquetError(str(error).splitlines()[0]) from None


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
