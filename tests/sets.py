"""Default, slow and nightly tests, and the order in which processes take them, by the durations in sets.toml."""

import itertools
import sys
import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from xdist.scheduler import LoadFileScheduling

from tol3d.numerics.compiled import Kernel

SETS: Mapping[str, Mapping[str, int]] = tomllib.loads((Path(__file__).parent / "sets.toml").read_text("utf-8"))
MANY = 1000
"""Tests that want every kernel."""
GROUP = 10
SPREAD = ("tests/project/test_mutants.py",)
"""Files whose tests are handed out in groups of up to GROUP: no fixture of theirs is dear to make in each process."""


def sort_into_sets(items: Iterable[pytest.Item]) -> None:
    """Mark as slow what leaves the default, and as nightly the slow cases that leave CI."""
    seen: Counter[tuple[str, str]] = Counter()

    def leaves(chosen: str, test: str) -> bool:
        every = SETS[chosen].get(test, 1)
        seen[chosen, test] += 1
        return every == 0 or (seen[chosen, test] - 1) % every > 0

    for item in items:
        test = item.nodeid.partition("[")[0]
        nightly = item.get_closest_marker("nightly")
        if not nightly and not item.get_closest_marker("slow") and leaves("default", test):
            item.add_marker(pytest.mark.slow)
        if not nightly and item.get_closest_marker("slow") and leaves("ci", test):
            item.own_markers = [mark for mark in item.own_markers if mark.name != "slow"]
            item.add_marker(pytest.mark.nightly)


def covering(**values: Iterable[Any]) -> Callable[..., Any]:
    """Parametrize a test by all combinations: by default each value is in one, all combinations are slow tests.

    Args:
        values: of each parameter, by its name; a pytest.param of one value brings its own name for it.
    """
    lists = [[_named(name, k, value) for k, value in enumerate(own)] for name, own in values.items()]
    by_default = {tuple(k % len(own) for own in lists) for k in range(max(len(own) for own in lists))}
    cases = []
    for places in itertools.product(*(range(len(own)) for own in lists)):
        names, chosen = zip(*(own[k] for own, k in zip(lists, places, strict=True)), strict=True)
        marks = () if places in by_default else pytest.mark.slow
        cases.append(pytest.param(*chosen, id="-".join(names), marks=marks))
    return pytest.mark.parametrize(tuple(values), cases)


def _named(name: str, place: int, value: Any) -> tuple[str, Any]:
    """A value and how pytest would name it."""
    if isinstance(value, type(pytest.param())):
        return str(value.id), value.values[0]
    plain = value is None or isinstance(value, str | int | float)
    return (str(value) if plain else f"{name}{place}"), value


class DearestFirst(LoadFileScheduling):  # type: ignore[misc]  # xdist has no types
    """pytest-xdist's sharing by files, so that a file's fixtures are made once, with SPREAD files in groups."""

    def _split_scope(self, nodeid: str) -> str:
        file = str(super()._split_scope(nodeid))
        return f"{file} {self.collection.index(nodeid) // GROUP}" if file in SPREAD and self.collection else file


def dearest_first(items: Sequence[pytest.Item]) -> list[pytest.Item]:
    """Tests by what their file takes, else as collected, so that none comes late and alone."""
    return sorted(items, key=lambda item: -SETS["seconds"].get(item.nodeid.partition("::")[0], 0))


def compile_kernels(process: int, processes: int) -> None:
    """Compile this process's share of all kernels that were imported: else several wait while one compiles for all."""
    modules = [module for name, module in sorted(sys.modules.items()) if name.startswith("tol3d.")]
    kernels = dict.fromkeys(own for module in modules for own in vars(module).values() if isinstance(own, Kernel))
    for kernel in [*kernels][process::processes]:
        kernel.make()
