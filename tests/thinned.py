"""Parameters of which the default takes a few; the slow tests take them all."""

from collections.abc import Iterable
from typing import Any

import pytest


def thinned(cases: Iterable[Any], every: int) -> list[Any]:
    """The first case and each `every`th after it as they are, those between as slow ones; a tuple is one case."""
    return [own if not index % every else _slow(own) for index, own in enumerate(cases)]


def _slow(case: Any) -> Any:
    known = isinstance(case, type(pytest.param()))
    values, marks, name = (case.values, case.marks, case.id) if known else (case, (), None)
    listed = values if isinstance(values, tuple | list) else (values,)
    return pytest.param(*listed, marks=(*marks, pytest.mark.slow), id=name)
