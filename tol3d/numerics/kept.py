"""Results that are computed once: of methods of frozen objects, and of rows of numbers.

Things as keys of caches: themselves, not their likes.
"""

from collections.abc import Callable, Hashable, Sequence
from functools import update_wrapper
from hashlib import blake2b
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array

Asked = ParamSpec("Asked")
Result = TypeVar("Result")


def kept(method: Callable[Concatenate[Any, Asked], Result]) -> Callable[Concatenate[Any, Asked], Result]:
    """Decorate a method of an object that does not change: what it returns is kept in the object, by its arguments.

    The object needs a `__dict__`; a copy made by `dataclasses.replace` begins anew.
    """
    name = f"_kept {method.__name__}"

    def asked(self: Any, /, *args: Asked.args, **words: Asked.kwargs) -> Result:
        known: dict[Hashable, Result] = vars(self).setdefault(name, {})
        key = args, tuple(sorted(words.items()))
        if key not in known:
            known[key] = method(self, *args, **words)
        return known[key]

    update_wrapper(asked, method)
    return asked


class KnownRows(Generic[Result]):
    """Results of rows of numbers by keys such as those of `row_keys`; of more than `most` the older ones go.

    Pickled, it is empty.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._found: dict[Hashable, Result] = {}

    def __reduce__(self) -> tuple[type, tuple[int]]:
        return type(self), (self._most,)

    def of(self, keys: Sequence[Hashable], find: Callable[[NDArray[np.intp]], Sequence[Result]]) -> list[Result]:
        """A result a key.

        Args:
            keys: of the rows.
            find: results of rows, by their indices; each row that is not known is asked for once.
        """
        found = self._found
        if len(found) + len(keys) > self._most:
            found = self._found = {}  # another thread may still read the other one
        new = {key: row for row, key in reversed([*enumerate(keys)]) if key not in found}
        if new:
            found |= zip(new, find(np.array([*new.values()], dtype=np.intp)), strict=True)
        return [found[key] for key in keys]


def row_keys(rows: Array) -> list[bytes]:
    """Digests of rows (n, ...), of their bytes."""
    return [blake2b(row, digest_size=16).digest() for row in np.ascontiguousarray(rows)]


class Itself:
    """A thing as a key; hashing its content may take longer than computing the value kept under it."""

    def __init__(self, thing: Any) -> None:
        self.thing = thing

    def __hash__(self) -> int:
        return id(self.thing)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Itself) and other.thing is self.thing
