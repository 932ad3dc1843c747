"""Statistics of the first blocks of a run, kept so that an interrupted run goes on from there.

Written all or nothing and with its own checksum; reading one executes nothing of it: the file names classes, and only
those that the statistics' own type is made of are known.
"""

import hashlib
import io
import json
import typing
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from io import BufferedRandom
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from tol3d.study.runs.atomic_write import write_by

T = TypeVar("T")
Arrays = dict[str, NDArray[np.generic]]

TREE = "tree"  # the array that holds the structure, as JSON


class CheckpointWarning(UserWarning):
    """A checkpoint is damaged and is not used."""


@dataclass(frozen=True)
class Checkpoint(Generic[T]):
    """A file with the statistics of a run's first blocks.

    Args:
        path: the file.
        kind: type of the statistics: frozen dataclasses, mappings, tuples, arrays, numbers, texts and None.
    """

    path: Path
    kind: type[T]

    def write(self, blocks: int, statistics: T) -> None:
        """Keep the statistics of the first `blocks` blocks, to the last bit."""
        arrays: Arrays = {}
        tree = {"blocks": blocks, "statistics": _written(statistics, arrays, classes_of(self.kind))}
        arrays[TREE] = np.frombuffer(json.dumps(tree).encode(), np.uint8)

        def write(stream: BufferedRandom) -> None:  # to the disk array by array: statistics of a large model are large
            np.savez(stream, allow_pickle=False, **arrays)
            stream.seek(0)
            digest = hashlib.file_digest(stream, hashlib.sha256).digest()
            stream.seek(0, io.SEEK_END)
            stream.write(digest)

        write_by(self.path, write)

    def read(self) -> tuple[int, T] | None:
        """Number of blocks and their statistics; None if there is none. A damaged one is reported and not used."""
        try:
            content = self.path.read_bytes()
        except FileNotFoundError:
            return None
        size = len(content) - hashlib.sha256().digest_size
        if hashlib.sha256(content[:size]).digest() != content[size:]:
            self._not_used("damaged")
            return None
        with np.load(io.BytesIO(content[:size]), allow_pickle=False) as kept:
            arrays = dict(kept)
        tree = json.loads(arrays.pop(TREE).tobytes())
        try:
            return tree["blocks"], _read(tree["statistics"], arrays, classes_of(self.kind))
        except (KeyError, TypeError):
            self._not_used("of other statistics")
            return None

    def _not_used(self, reason: str) -> None:
        warnings.warn(f"{self.path}: {reason}, so statistics are made again", CheckpointWarning, stacklevel=3)


def classes_of(kind: type) -> Mapping[str, type]:
    """The dataclasses that values of a type may be made of, by their names."""
    found: dict[str, type] = {}
    waiting: list[Any] = [kind]
    while waiting:
        hint = waiting.pop()
        waiting += typing.get_args(hint)
        if is_dataclass(hint) and isinstance(hint, type) and hint.__name__ not in found:
            found[hint.__name__] = hint
            waiting += typing.get_type_hints(hint).values()
    return found


def _written(value: Any, arrays: Arrays, classes: Mapping[str, type]) -> Any:
    """A value as JSON, its arrays in `arrays`; numbers read back to the same bits, for so Python writes them."""
    if isinstance(value, np.ndarray | np.generic):
        name = f"array{len(arrays)}"
        arrays[name] = np.asarray(value)
        return {"array" if isinstance(value, np.ndarray) else "scalar": name}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, tuple | list):
        return {type(value).__name__: [_written(item, arrays, classes) for item in value]}
    if isinstance(value, Mapping):
        return {"map": [[key, _written(item, arrays, classes)] for key, item in value.items()]}
    name = type(value).__name__
    if classes.get(name) is not type(value):
        raise TypeError(f"a checkpoint cannot keep a {name}")
    return {"class": name, "fields": dict(_fields(value, arrays, classes))}


def _fields(value: Any, arrays: Arrays, classes: Mapping[str, type]) -> Iterator[tuple[str, Any]]:
    for field in fields(value):
        yield field.name, _written(getattr(value, field.name), arrays, classes)


def _read(tree: Any, arrays: Mapping[str, NDArray[np.generic]], classes: Mapping[str, type]) -> Any:
    if not isinstance(tree, dict):
        return tree
    if "class" in tree:
        values = {name: _read(item, arrays, classes) for name, item in tree["fields"].items()}
        return classes[tree["class"]](**values)
    ((key, item),) = tree.items()
    if key == "array":
        return arrays[item]
    if key == "scalar":
        return arrays[item][()]
    if key == "map":
        return {name: _read(value, arrays, classes) for name, value in item}
    items = [_read(value, arrays, classes) for value in item]
    return tuple(items) if key == "tuple" else items
