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

NIGHTLY: Mapping[str, dict[str, Any]] = {entry["test"]: entry for entry in SETS["nightly"]}
"""Tests that CI leaves out, or of whose slow cases it runs the first, each nth after it (`every`) and some more."""


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
        if test in NIGHTLY and item.get_closest_marker("slow"):
            seen["nightly", test] += 1
            if _left_out(seen["nightly", test] - 1, NIGHTLY[test].get("every", 0)) and not _is_kept(item):
                item.own_markers = [mark for mark in item.own_markers if mark.name != "slow"]
                item.add_marker(pytest.mark.nightly)


def _is_kept(item: pytest.Item) -> bool:
    """True for a case that CI keeps besides, by its name in brackets."""
    test, _, case = item.nodeid.partition("[")
    return case.removesuffix("]") in NIGHTLY[test].get("cases", ())


def _left_out(place: int, every: int) -> bool:
    return every == 0 or place % every > 0


def _marked(case: Any, mark: pytest.MarkDecorator) -> Any:
    known = isinstance(case, type(pytest.param()))
    values, marks, name = (case.values, case.marks, case.id) if known else (case, (), None)
    listed = values if isinstance(values, tuple | list) else (values,)
    return pytest.param(*listed, marks=(*marks, mark), id=name)
