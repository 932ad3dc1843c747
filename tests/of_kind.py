"""Values that must be of one kind of several, or there at all: an assertion, and what a type checker needs to know."""

from typing import TypeVar

Kind = TypeVar("Kind")


def of_kind(kind: type[Kind], value: object) -> Kind:
    """The value itself, which must be of that kind."""
    assert isinstance(value, kind), f"expected {kind.__name__}, got {value!r}"
    return value


def known(value: Kind | None) -> Kind:
    """The value itself, which must not be None."""
    assert value is not None
    return value
