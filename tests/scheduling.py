"""Work shared between test processes: whole files, the dearest first, so that none comes late and alone."""

import sys
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest
from xdist.scheduler import LoadFileScheduling

from tol3d.numerics.compiled import Kernel

SECONDS: Mapping[str, float] = tomllib.loads((Path(__file__).parent / "seconds.toml").read_text("utf-8"))
"""Processor seconds by file, slow tests included, of the dearest files; .ci/dearest.py writes them."""

MANY = 1000
"""Tests that want every kernel."""
GROUP = 10
SPREAD = ("tests/project/test_mutants.py",)
"""Files whose tests are handed out in groups of up to GROUP: no fixture of theirs is dear to make in each process."""


class DearestFirst(LoadFileScheduling):  # type: ignore[misc]  # xdist has no types
    """pytest-xdist's sharing by files, so that a file's fixtures are made once, with SPREAD files in groups."""

    def _split_scope(self, nodeid: str) -> str:
        file = str(super()._split_scope(nodeid))
        return f"{file} {self.collection.index(nodeid) // GROUP}" if file in SPREAD and self.collection else file


def dearest_first(items: Sequence[pytest.Item]) -> list[pytest.Item]:
    """Tests by what their file takes, else as collected; the same order in every process."""
    return sorted(items, key=lambda item: -SECONDS.get(item.nodeid.partition("::")[0], 0.0))


def compile_kernels(process: int, processes: int) -> None:
    """Compile this process's share of all kernels that were imported: else several wait while one compiles for all."""
    modules = [module for name, module in sorted(sys.modules.items()) if name.startswith("tol3d.")]
    kernels = dict.fromkeys(own for module in modules for own in vars(module).values() if isinstance(own, Kernel))
    for kernel in [*kernels][process::processes]:
        kernel.make()
