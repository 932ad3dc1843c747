"""Parameters of which the default takes a few and CI some more; the nightly tests are all of them."""

import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pytest

SETS: Mapping[str, Any] = tomllib.loads((Path(__file__).parent / "sets.toml").read_text("utf-8"))
SLOW: Mapping[str, int] = SETS["slow"]
"""Tests that the default leaves out (0), or of which it runs the first case and each nth after it."""

CI: Mapping[str, int] = SETS["ci"]
"""Tests of whose slow cases CI runs the first and each nth after it; the others are nightly."""

KEPT: Mapping[str, list[str]] = SETS["kept"]
"""Cases of these, by their names in brackets, that CI runs besides."""

NIGHTLY: Mapping[str, dict[str, str]] = {entry["test"]: entry for entry in SETS["nightly"]}
"""Tests that are nightly whole."""


def thinned(cases: Iterable[Any], every: int) -> list[Any]:
    """The first case and each `every`th after it as they are, those between as slow ones; a tuple is one case."""
    return [own if not index % every else _marked(own, pytest.mark.slow) for index, own in enumerate(cases)]


def sort_into_sets(items: Iterable[pytest.Item]) -> None:
    """Mark tests slow or nightly as tests/sets.toml says."""
    seen: Counter[tuple[str, str]] = Counter()
    for item in items:
        test = item.nodeid.partition("[")[0]
        if test in SLOW and not (item.get_closest_marker("slow") or item.get_closest_marker("nightly")):
            seen["slow", test] += 1
            if _left_out(seen["slow", test] - 1, SLOW[test]):
                item.add_marker(pytest.mark.slow)
        if (test in CI or test in NIGHTLY) and item.get_closest_marker("slow"):
            seen["nightly", test] += 1
            case = item.nodeid.removeprefix(test).strip("[]")
            if _left_out(seen["nightly", test] - 1, CI.get(test, 0)) and case not in KEPT.get(test, ()):
                item.own_markers = [mark for mark in item.own_markers if mark.name != "slow"]
                item.add_marker(pytest.mark.nightly)


def _left_out(place: int, every: int) -> bool:
    return every == 0 or place % every > 0


def _marked(case: Any, mark: pytest.MarkDecorator) -> Any:
    known = isinstance(case, type(pytest.param()))
    values, marks, name = (case.values, case.marks, case.id) if known else (case, (), None)
    listed = values if isinstance(values, tuple | list) else (values,)
    return pytest.param(*listed, marks=(*marks, mark), id=name)
