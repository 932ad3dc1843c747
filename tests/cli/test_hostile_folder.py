"""Neither commands nor the processes that they start run a stranger's modules in the folder where they are called."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hostile_folder import hostile, run_from

TOL3D = (str(Path(sys.executable).with_name("tol3d")),)
AS_A_MODULE = (sys.executable, "-m", "tol3d.cli")
PYTHON_FINDS_IT_FIRST = frozenset({"tol3d"})  # by `python -m tol3d.…`, before a line of ours is run
HANGS = 300.0  # s

POOL = """
from tol3d.execution.pools import Concurrency, pool_of
with pool_of(2, None, Concurrency.PROCESSES) as pool:
    print(*(pool.submit(pow, k, 2).result() for k in range(6)))
"""

BUILDER = """
import cadquery as cq

def build(size):
    return cq.Workplane().box(size, size, size).faces(">Z").tag("top").end()
"""
CUBE = """
scene: own builder
parts:
  cube:
    kind: solid
    builder: {kind: file, file: cube.py, dimensions: {size: 20 mm}}
    features: {top: {kind: plane, face: {name: top}}, floor: {kind: plane, face: {near: [1 mm, 2 mm, -11 mm]}}}
tolerances:
  size: {kind: plus_minus, of: cube.top, datums: [floor], distribution: {kind: uniform, lower: -1 um, upper: 1 um}}
moves:
  clamp: {kind: fix, part: cube}
measures:
  height: {kind: gap, from: cube.floor, to: cube.top, along: [0, 0, 1]}
study: {trials: 40, seed: 1, engine: exact}
"""

STARTS_PROCESSES: tuple[tuple[str, ...], ...] = (
    ("run", "spur_pair", "--engine", "fcl", "--workers", "2", "--trials", "4", "--out", "pair"),
    ("run", "cube.yaml", "--run-builders", "--out", "cube"),
    ("export", "cube", "--trial", "3", "--format", "step", "--out", "steps"),
)
"""Workers and what watches over them; the picture's process; one that reads a kept solid before the command does."""


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    folder = hostile(tmp_path)
    yield folder
    assert run_from(folder) == []


def output(folder: Path, *command: str) -> str:
    environment = dict(os.environ)
    environment.pop("PYTHONSAFEPATH", None)
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=HANGS)
    assert done.returncode == 0, (command, done.stderr, run_from(folder))
    return done.stdout


def test_worker_processes_run_no_module_of_the_folder_they_are_started_in(folder: Path) -> None:
    assert output(folder, sys.executable, "-P", "-c", POOL) == "0 1 4 9 16 25\n"


def test_tol3d_as_a_module_of_python_runs_no_module_of_the_folder(tmp_path: Path) -> None:
    folder = hostile(tmp_path, but=PYTHON_FINDS_IT_FIRST)
    assert output(folder, *AS_A_MODULE, "--version").startswith("tol3d ")
    assert run_from(folder) == []


@pytest.mark.slow
def test_no_command_runs_a_module_of_the_folder_it_is_called_in(folder: Path) -> None:
    (folder / "cube.yaml").write_text(CUBE, "utf-8")
    (folder / "cube.py").write_text(BUILDER, "utf-8")
    for words in STARTS_PROCESSES:
        output(folder, *TOL3D, *words)
        assert run_from(folder) == [], words


@pytest.mark.slow
def test_workers_of_tol3d_as_a_module_of_python_run_nothing_of_the_folder(tmp_path: Path) -> None:
    folder = hostile(tmp_path, but=PYTHON_FINDS_IT_FIRST)
    output(folder, *AS_A_MODULE, *STARTS_PROCESSES[0])
    assert run_from(folder) == []
