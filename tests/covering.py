"""Combinations of parameters: each value by default, all combinations as slow tests."""

import itertools
from collections.abc import Callable, Iterable
from typing import Any

import pytest
from _pytest.mark import ParameterSet


def covering(**values: Iterable[Any]) -> Callable[..., Any]:
    """Parametrize a test by all combinations: as many by default as the longest list has values, with each value in it.

    Args:
        values: of each parameter, by its name; a pytest.param of one value brings its own name for it.
    """
    lists = [[_named(name, k, value) for k, value in enumerate(own)] for name, own in values.items()]
    by_default = {tuple(k % len(own) for own in lists) for k in range(max(len(own) for own in lists))}
    cases = []
    for places in itertools.product(*(range(len(own)) for own in lists)):
        chosen = [own[k] for own, k in zip(lists, places, strict=True)]
        marks = () if places in by_default else (pytest.mark.slow,)
        cases.append(
            pytest.param(*(value for _, value in chosen), id="-".join(said for said, _ in chosen), marks=marks)
        )
    return pytest.mark.parametrize(tuple(values), cases)


def _named(name: str, place: int, value: Any) -> tuple[str, Any]:
    """A value and how pytest would name it."""
    if isinstance(value, ParameterSet):
        return str(value.id), value.values[0]
    plain = value is None or isinstance(value, str | int | float)
    return (str(value) if plain else f"{name}{place}"), value
