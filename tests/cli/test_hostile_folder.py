"""Neither commands nor the processes they start run a stranger's modules or read his settings in the current folder."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hostile_folder import SETTINGS, hostile, opened_in, run_from
from places import SCENES

TOL3D = (str(Path(sys.executable).with_name("tol3d")),)
AS_A_MODULE = (sys.executable, "-m", "tol3d.cli")
PYTHON_FINDS_IT_FIRST = frozenset({"tol3d"})  # by `python -m tol3d.…`, before a line of ours is run
HANGS = 300.0  # s

POOL = """
from tol3d.study.execution.pools import Concurrency, pool_of
with pool_of(2, None, Concurrency.PROCESSES) as pool:
    print(*(pool.submit(pow, k, 2).result() for k in range(6)))
"""

LIBRARIES = """
import tol3d
import matplotlib, numba.core.config, ezdxf._options
numba.core.config.reload_config()
print(matplotlib.rcParams["text.usetex"], numba.core.config.CPU_NAME, numba.core.config.HTML or "-")
"""
COMPILING = """
from tol3d.study.execution.pools import Concurrency, pool_of
exec("from tol3d.contact.openings import common_openings; common_openings.make()")
with pool_of(2, None, Concurrency.PROCESSES) as pool:
    pool.submit(exec, "from tol3d.numerics.programme import ranges; ranges.make()").result()
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
    ("features", "part.stp"),
)
"""Workers and what watches over them; the picture's process; one that reads a kept solid before the command does; that
of STEP files."""
NAMED = {"cube.yaml", "cube.py", "part.stp"}


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    folder = hostile(tmp_path)
    with opened_in(folder) as opened:
        yield folder
        assert run_from(folder) == []
        assert opened() - NAMED == set()


def output(folder: Path, *command: str, **named: str) -> str:
    environment = dict(os.environ) | named
    environment.pop("PYTHONSAFEPATH", None)
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=HANGS)
    assert done.returncode == 0, (command, done.stderr, run_from(folder))
    return done.stdout


def test_worker_processes_run_no_module_of_the_folder_they_are_started_in(folder: Path) -> None:
    assert output(folder, sys.executable, "-P", "-c", POOL) == "0 1 4 9 16 25\n"


def test_libraries_that_tol3d_uses_find_no_settings_in_the_folder(folder: Path) -> None:
    assert output(folder, sys.executable, "-P", "-c", LIBRARIES) == "False None -\n"


@pytest.mark.slow
def test_settings_that_the_user_names_hold_as_before(tmp_path: Path) -> None:
    folder = hostile(tmp_path / "strange")
    own = tmp_path / "own"
    own.mkdir()
    for name, text in SETTINGS.items():
        (own / name).write_text(text if name == "matplotlibrc" else "[core]\n", "utf-8")
    named = {"MATPLOTLIBRC": str(own), "NUMBA_CPU_NAME": "generic", "EZDXF_CONFIG_FILE": str(own / "ezdxf.ini")}
    assert output(folder, sys.executable, "-P", "-c", LIBRARIES, **named) == "True generic -\n"


@pytest.mark.slow
def test_settings_that_libraries_read_before_tol3d_was_imported_hold(tmp_path: Path) -> None:
    (tmp_path / "matplotlibrc").write_text(SETTINGS["matplotlibrc"], "utf-8")
    code = "import matplotlib, numba\n" + LIBRARIES
    (tmp_path / ".numba_config.yaml").write_text("cpu_name: generic\n", "utf-8")
    code += "from tol3d.numerics.processor import processor; print(processor()['processor'])"
    assert output(tmp_path, sys.executable, "-P", "-c", code) == "True generic -\ngeneric\n"


@pytest.mark.slow
def test_kernels_compile_by_no_settings_of_the_folder_here_and_in_workers(folder: Path) -> None:
    output(folder, sys.executable, "-P", "-c", COMPILING, TOL3D_CACHE=str(folder / "an empty cache"))


def test_tol3d_as_a_module_of_python_runs_no_module_of_the_folder(tmp_path: Path) -> None:
    folder = hostile(tmp_path, but=PYTHON_FINDS_IT_FIRST)
    assert output(folder, *AS_A_MODULE, "--version").startswith("tol3d ")
    assert run_from(folder) == []


@pytest.mark.slow
def test_no_command_runs_or_reads_a_file_of_the_folder_it_is_called_in(folder: Path) -> None:
    (folder / "cube.yaml").write_text(CUBE, "utf-8")
    (folder / "cube.py").write_text(BUILDER, "utf-8")
    shutil.copy(SCENES / "nist_ctc_01.stp", folder / "part.stp")
    for words in STARTS_PROCESSES:
        output(folder, *TOL3D, *words)
        assert run_from(folder) == [], words


@pytest.mark.slow
def test_workers_of_tol3d_as_a_module_of_python_run_nothing_of_the_folder(tmp_path: Path) -> None:
    folder = hostile(tmp_path, but=PYTHON_FINDS_IT_FIRST)
    output(folder, *AS_A_MODULE, *STARTS_PROCESSES[0])
    assert run_from(folder) == []
