"""A value that must be of one kind of several: both an assertion and what a type checker needs to know."""

from typing import TypeVar

Kind = TypeVar("Kind")


def of_kind(kind: type[Kind], value: object) -> Kind:
    """The value itself, which must be of that kind."""
    assert isinstance(value, kind), f"expected {kind.__name__}, got {value!r}"
    return value
