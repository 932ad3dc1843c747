"""A disk that refuses a write: exit code 2, the file named, nothing half written, and nobody else blamed."""

import errno
import math
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cadquery as cq
import pytest
from fixtures import Command
from matplotlib.figure import Figure
from places import SPUR_PAIR

from tol3d import InputError, Overrides, Run, RunError, open_run, run_scene
from tol3d.errors import DiskError, refused_by_disk, unwritable
from tol3d.gears import SpurGear
from tol3d.parts import named_solid, spur_gear
from tol3d.report import export_run

FEW = Overrides(trials=40, engine="analytic", witness=0)
REFUSALS = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS)
LARGEST = 8  # blocks of 1024 bytes that a process of the test below may write to one file; a block of trials has more


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run_scene(SPUR_PAIR, overrides=Overrides(trials=40, witness=0), out=tmp_path_factory.mktemp("runs") / "run")


def refused(number: int) -> Callable[..., None]:
    def call(*arguments: object, **more: object) -> None:
        raise OSError(number, os.strerror(number))

    return call


@pytest.mark.parametrize("number", REFUSALS)
def test_a_refused_write_of_a_run_names_its_file_and_exits_with_2(
    number: int, tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "fsync", refused(number))
    with pytest.raises(DiskError):
        run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "python")
    code, _, err = tol3d("run", str(SPUR_PAIR), "--engine", "analytic", "--no-picture", "--out", str(tmp_path / "run"))
    assert code == 2
    assert str(tmp_path / "run.partial") in err
    assert os.strerror(number) in err
    assert "fault in tol3d" not in err
    assert not list(tmp_path.rglob("*.writing"))


@pytest.mark.parametrize("number", REFUSALS)
def test_a_refused_picture_or_export_names_its_file_and_exits_with_2(
    number: int, tol3d: Command, finished: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Figure, "savefig", refused(number))
    monkeypatch.setattr(Path, "write_bytes", refused(number))
    for command, place in (
        (("compare", str(finished.path), "--out", str(tmp_path / "picture.png")), tmp_path / "picture.png"),
        (("export", str(finished.path), "--trial", "3", "--out", str(tmp_path)), tmp_path / "trial-3.glb"),
    ):
        code, _, err = tol3d(*command)
        assert code == 2, err
        assert err.startswith(f"{place}: cannot be written ({os.strerror(number)}); the input is not at fault")


@pytest.mark.slow
def test_a_place_that_is_not_ours_to_write_is_wrong_input(tol3d: Command, tmp_path: Path, finished: Run) -> None:
    for number in (errno.EACCES, errno.ENOENT, errno.ENOTDIR, errno.EPERM):
        error = unwritable(tmp_path, OSError(number, os.strerror(number)), "choose another")
        assert not isinstance(error, DiskError)
        assert str(error) == f"{tmp_path}: cannot be written ({os.strerror(number)}); choose another"
        assert not refused_by_disk(OSError(number, ""))
    (tmp_path / "file").write_text("", "utf-8")
    code, _, err = tol3d("compare", str(finished.path), "--out", str(tmp_path / "file" / "picture.png"))
    assert code == 2
    assert "choose another file" in err
    assert issubclass(DiskError, RunError)  # who catches errors of runs catches these


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no limits on the size of files")
def test_a_limit_on_the_size_of_files_is_told_and_the_same_command_goes_on(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tol3d.cli", "run", str(SPUR_PAIR), "--engine", "analytic", "--trials", "2000"]
    command += ["--no-picture", "--out", str(tmp_path / "run")]
    limited = ["bash", "-c", f'ulimit -f {LARGEST}; exec "$@"', "bash", *command]
    unwritten = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}  # bytecode that is cut short would break later tests
    told = subprocess.run(limited, capture_output=True, text=True, env=unwritten)
    assert told.returncode == 2, told.stderr
    block = tmp_path / "run.partial" / "trials" / "block-000000.parquet"
    assert f"{block}: cannot be written (File too large): 0 of 2000 trials are kept" in told.stderr
    subprocess.run(command, check=True, capture_output=True)
    assert open_run(tmp_path / "run").trials == 2000


@pytest.mark.slow
def test_a_step_file_that_the_kernel_cut_short_is_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # OCC says nothing of a disk that is full: its file ends somewhere
    part = spur_gear.build(SpurGear(teeth=20, module=2.0, face_width=10.0, pressure_angle=math.radians(20.0)))
    real = cq.Solid.exportStep

    def cut(solid: cq.Solid, name: str) -> None:
        real(solid, name)
        os.truncate(name, 8192)

    named_solid.to_step(part, tmp_path / "whole.step")
    assert (tmp_path / "whole.step").read_bytes().rstrip().endswith(named_solid.STEP_END)
    monkeypatch.setattr(cq.Solid, "exportStep", cut)
    with pytest.raises(DiskError, match=r"cut\.step: cannot be written \(the CAD kernel wrote a part of it only\)"):
        named_solid.to_step(part, tmp_path / "cut.step")
    assert [path.name for path in tmp_path.iterdir()] == ["whole.step"]


@pytest.mark.slow
def test_an_assembly_that_the_kernel_cut_short_is_not_there(
    finished: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = cq.Assembly.export

    def cut(assembly: cq.Assembly, name: str, **more: Any) -> None:
        real(assembly, name, **more)
        os.truncate(name, 8192)

    monkeypatch.setattr(cq.Assembly, "export", cut)
    with pytest.raises(InputError, match=r"trial-3\.step: cannot be written \(the CAD kernel wrote a part"):
        export_run(finished, 3, "step", out=tmp_path)
    assert not list(tmp_path.iterdir())
