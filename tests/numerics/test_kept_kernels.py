"""Kernels on disk: a later process takes them, a copy of the tree too; they run where nothing can be kept."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from places import ROOT

from tol3d.assembly.placing import common_opening

pytestmark = pytest.mark.slow

OPENINGS = """
import sys
sys.path[:0] = sys.argv[1:]
import numpy as np
from tol3d.assembly.placing import common_opening
assert all(common_opening.__file__.startswith(tree) for tree in sys.argv[1:])
x, y = np.random.default_rng(1).normal(size=(2, 4, 50))
openings, centres = np.empty(50), np.empty((2, 50))
common_opening.common_openings(x, y, np.full((4, 50), 3.0), openings, centres)
print(openings.tobytes().hex())
"""


def found(cache: Path, *tree: Path) -> str:
    """Output of another process, its kernels kept in `cache`; of a copy of the tree elsewhere if one is given."""
    command = [sys.executable, "-c", OPENINGS, *map(str, tree)]
    environment = os.environ | {"TOL3D_CACHE": str(cache)}
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.strip()


def kept(folder: Path) -> dict[str, tuple[int, int]]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): (path.stat().st_mtime_ns, path.stat().st_size) for path in files}


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A cache in which a first process has left its kernel, and what it found."""
    cache = tmp_path_factory.mktemp("cache")
    return cache, found(cache)


def test_a_second_process_takes_the_kernels_of_the_first(filled: tuple[Path, str]) -> None:
    cache, first = filled
    before = kept(cache)
    assert any(name.startswith("kernel-common_openings-") for name in before)
    assert found(cache) == first
    # what it had compiled anew it would have written anew
    assert kept(cache) == before


def test_a_copy_of_the_tree_elsewhere_takes_the_kernels_of_the_first(filled: tuple[Path, str], tmp_path: Path) -> None:
    cache, first = filled
    before = kept(cache)
    shutil.copytree(ROOT / "tol3d", tmp_path / "tol3d", ignore=shutil.ignore_patterns("__pycache__"))
    assert found(cache, tmp_path) == first
    assert kept(cache) == before


def test_kernels_run_where_nothing_can_be_kept(filled: tuple[Path, str], tmp_path: Path) -> None:
    blocked = tmp_path / "a file, no folder"
    blocked.write_text("")
    beside = Path(common_opening.__file__).parent / "__pycache__"
    before = {path.name for path in beside.glob("*.nb?")}
    assert found(blocked) == filled[1]
    # beside the sources they would be known by the date of one of them only
    assert {path.name for path in beside.glob("*.nb?")} == before
