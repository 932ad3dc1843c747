"""Kernels on disk: a later process takes them, a copy of the tree too; they run where nothing can be kept."""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from places import ROOT

from tol3d.contact import openings
from tol3d.numerics import compiled

pytestmark = pytest.mark.slow

OPENINGS = """
import sys
sys.path[:0] = sys.argv[1:]
import numpy as np
from tol3d.contact import openings
from tol3d.numerics import compiled
assert all(openings.__file__.startswith(tree) for tree in sys.argv[1:])
x, y = np.random.default_rng(1).normal(size=(2, 4, 50))
print(openings.opening(x, y, np.full((4, 50), 3.0)).outside.tobytes().hex())
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


def test_folders_that_killed_compilers_left_are_cleared_and_no_other_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    ages = {"tol3d-kernel-killed": 7200.0, "tol3d-kernel-in-use": 60.0, "other-kernel": 7200.0}
    for name, age in ages.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "kernel.nbi").write_text("")
        os.utime(tmp_path / name, (time.time() - age,) * 2)
    (tmp_path / "tol3d-kernel-link").symlink_to(tmp_path / "other-kernel")
    compiled._clear_left_folders.cache_clear()
    compiled._clear_left_folders()
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"tol3d-kernel-in-use", "other-kernel", "tol3d-kernel-link"}
    assert (tmp_path / "other-kernel" / "kernel.nbi").exists()


def test_a_copy_of_the_tree_elsewhere_takes_the_kernels_of_the_first(filled: tuple[Path, str], tmp_path: Path) -> None:
    cache, first = filled
    before = kept(cache)
    shutil.copytree(ROOT / "tol3d", tmp_path / "tol3d", ignore=shutil.ignore_patterns("__pycache__"))
    assert found(cache, tmp_path) == first
    assert kept(cache) == before


def test_kernels_run_where_nothing_can_be_kept(filled: tuple[Path, str], tmp_path: Path) -> None:
    blocked = tmp_path / "a file, no folder"
    blocked.write_text("")
    beside = Path(openings.__file__).parent / "__pycache__"
    before = {path.name for path in beside.glob("*.nb?")}
    assert found(blocked) == filled[1]
    # beside the sources they would be known by the date of one of them only
    assert {path.name for path in beside.glob("*.nb?")} == before
