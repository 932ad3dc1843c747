"""Frozen objects compared by their values, bit by bit: what depends on nothing else is kept by them as keys."""

import pickle
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cached_property, lru_cache
from hashlib import blake2b
from typing import Any

import numpy as np


class Valued:
    """Base of frozen dataclasses with `eq=False`: equal to others of their class whose fields all have the same bits.

    Fields are numbers, texts, arrays, dataclasses, and tuples and mappings of them; others count as they pickle.
    A digest is of this process: a class that is defined anew, as in a notebook, is another one.
    """

    @cached_property
    def digest(self) -> bytes:
        """Digest of its class and its fields, in 16 bytes."""
        return blake2b(b"".join((*_fields(self), self.beside)), digest_size=16).digest()

    @property
    def beside(self) -> bytes:
        """By what else it is told from others; by default nothing."""
        return b""

    def __eq__(self, other: object) -> bool:
        return self is other or (type(self) is type(other) and self.digest == other.digest)

    def __getstate__(self) -> dict[str, Any]:
        return {name: own for name, own in self.__dict__.items() if name != "digest"}

    def __hash__(self) -> int:
        return hash(self.digest)


@lru_cache(maxsize=1024)
def _names(kind: type) -> tuple[bytes, tuple[str, ...]]:
    """A dataclass, told from others of its name, and the names of the fields by which it is compared."""
    name = f"{kind.__module__}:{kind.__qualname__}:{id(kind)}"
    return name.encode(), tuple(field.name for field in fields(kind) if field.compare)


def _fields(value: Any) -> Iterator[bytes]:
    own: type = type(value)
    kind, names = _names(own)
    yield b"<%d:%s" % (len(kind), kind)
    for name in names:
        yield from _pieces(getattr(value, name))
    yield b">"


def _pieces(value: Any) -> Iterator[bytes]:
    """Pieces that together are another value's only where all of it is the same; each states its kind and length."""
    if isinstance(value, Valued):
        yield b"v" + value.digest
    elif value is None or isinstance(value, bool | int | float):
        words = repr(value).encode()
        yield b"n%d:%s" % (len(words), words)
    elif isinstance(value, str):
        words = value.encode()
        yield b"s%d:%s" % (len(words), words)
    elif isinstance(value, np.ndarray) and value.dtype != object:
        about, content = f"{value.dtype.str}{value.shape}".encode(), value.tobytes()
        yield b"a%d:%s%d:" % (len(about), about, len(content))
        yield content
    elif is_dataclass(value) and not isinstance(value, type):
        yield from _fields(value)
    elif isinstance(value, tuple | list):
        yield b"t%d:" % len(value)
        for own in value:
            yield from _pieces(own)
    elif isinstance(value, Mapping):
        yield b"m%d:" % len(value)
        for key, own in value.items():
            yield from _pieces(key)
            yield from _pieces(own)
    elif isinstance(value, slice):
        yield b"l"
        yield from _pieces((value.start, value.stop, value.step))
    else:
        words = pickle.dumps(value)
        yield b"p%d:" % len(words)
        yield words
