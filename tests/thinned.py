"""Parameters of which the default takes a few; the slow tests take them all."""

from collections.abc import Iterable
from typing import Any

import pytest


def thinned(cases: Iterable[Any], every: int) -> list[Any]:
    """The first case and each `every`th after it as they are, those between as slow ones; a tuple is one case."""
    return [
        own if not index % every else pytest.param(*(own if isinstance(own, tuple) else (own,)), marks=pytest.mark.slow)
        for index, own in enumerate(cases)
    ]
