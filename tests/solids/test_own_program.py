"""Solids that programs of the user made: kept as they were, damaged ones refused whatever they do to their reader."""

import os
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from hostile_folder import hostile, run_from

from tol3d.cad.solids import display_mesh, own_program
from tol3d.cad.solids.kept_shape import PATIENCE_VARIABLE, KeptShape, made_here, run_program
from tol3d.errors import GeometryError, InputError
from tol3d.files import FileContent

PROGRAM = b"""
import cadquery as cq

def build(size):
    return cq.Workplane().box(size, size, size).faces(">Z").tag("top").end()
"""


@pytest.fixture(scope="module")
def cube() -> KeptShape:
    return made(PROGRAM, size=20.0)


def made(program: bytes, **dimensions: float) -> KeptShape:
    """Solid that a program makes in this process, which is quicker."""
    shape = KeptShape.of(*own_program.run_program(FileContent(Path("cube.py"), program), "build", dimensions))
    made_here.add(shape.sha256)
    return shape


def test_a_solid_is_read_as_it_was_made_in_another_process_that_runs_nothing_of_the_folder_it_is_in(
    cube: KeptShape, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(own_program, "made_here", set())
    monkeypatch.chdir(hostile(tmp_path))
    again = KeptShape.of(cube.brep, cube.faces)
    assert again == cube
    solid = own_program.read(again)
    assert run_from(tmp_path) == []
    assert solid.solid.Volume() == pytest.approx(8000.0, rel=1e-12)
    assert solid.faces["top"].Center().z == pytest.approx(10.0, abs=1e-9)
    assert sorted(solid.faces) == sorted(["top", *(f"face {k}" for k in range(1, 7) if f"face {k}" in cube.faces)])


def test_a_display_mesh_is_that_of_the_solid(cube: KeptShape) -> None:
    mesh = display_mesh(cube, 0.1)
    assert (mesh.vertices.min(), mesh.vertices.max()) == pytest.approx((-10.0, 10.0), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    "content",
    [b"no solid", pytest.param(b"", marks=pytest.mark.slow), pytest.param(b"\x00" * 1000, marks=pytest.mark.slow)],
    ids=["text", "empty", "zeros"],
)
def test_what_is_no_solid_is_refused(content: bytes) -> None:
    with pytest.raises(GeometryError, match="the solid that was kept is damaged"):
        own_program.read(KeptShape.of(content, ("top",)))


def test_a_solid_of_other_faces_is_refused(cube: KeptShape) -> None:
    with pytest.raises(GeometryError, match="damaged: expected 2 faces, found 6"):
        own_program.read(KeptShape.of(cube.brep, ("top", "bottom")))


def test_a_file_that_crashes_or_hangs_its_reader_is_a_message(
    cube: KeptShape, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(own_program, "made_here", set())
    (tmp_path / "sitecustomize.py").write_text("import os, sys\nif '-c' in sys.argv: os.abort()", "utf-8")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")]))
    with pytest.raises(GeometryError, match="damaged: "):
        own_program.read(cube)
    (tmp_path / "sitecustomize.py").write_text("import sys, time\nif '-c' in sys.argv: time.sleep(60)", "utf-8")
    monkeypatch.setattr(own_program, "PATIENCE", 0.5)
    with pytest.raises(GeometryError, match=r"damaged: it cannot be read within 0\.5 s"):
        own_program.read(cube)


@pytest.mark.slow
def test_a_stream_of_another_shape_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = tmp_path / "edge.brep"
    cq.Edge.makeLine(cq.Vector(0, 0, 0), cq.Vector(1, 0, 0)).exportBrep(str(path))
    with pytest.raises(GeometryError, match="expected one solid, found Edge"):
        own_program.read(KeptShape.of(path.read_bytes(), ("top",)))


ENDS = {
    "an exit that nothing can catch": ("import os; os._exit(0)", "it ended its process (exit code 0) before build had"),
    "a crash": ("import os; os.kill(os.getpid(), 11)", "its process was ended by SIGSEGV before build had returned"),
    "no end": ("while True: pass", "build made no solid within 0.5 s and was stopped; TOL3D_BUILDER_SECONDS=5 would"),
}


@pytest.mark.parametrize(
    ("does", "message"),
    [pytest.param(*own, id=name, marks=[pytest.mark.slow] * (name == "a crash")) for name, own in ENDS.items()],
)
def test_a_program_that_ends_its_process_or_never_ends_is_a_message(
    does: str, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(PATIENCE_VARIABLE, "0.5" if "while" in does else "60")
    with pytest.raises(GeometryError) as caught:
        run_program(FileContent(Path("own.py"), does.encode()), "build", {})
    assert str(caught.value).startswith(f"own.py: {message}")


@pytest.mark.slow
def test_what_a_program_makes_in_its_process_is_what_it_makes_in_this_one(
    cube: KeptShape, capfd: pytest.CaptureFixture[str]
) -> None:
    printing = b"print('hello')" + PROGRAM
    assert run_program(FileContent(Path("cube.py"), printing), "build", {"size": 20.0}) == cube
    assert capfd.readouterr() == ("", "hello\n")


@pytest.mark.parametrize("text", ["long", "0", "inf", "nan"])
def test_a_time_that_is_no_number_of_seconds_is_refused(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(PATIENCE_VARIABLE, text)
    with pytest.raises(
        InputError, match=f"{PATIENCE_VARIABLE}: expected a number of seconds, such as 300, got '{text}'"
    ):
        run_program(FileContent(Path("cube.py"), PROGRAM), "build", {"size": 20.0})


DISC = b"""
import cadquery as cq

def build(radius, height):
    return cq.Solid.makeCone(radius, 0, height)
"""


@pytest.mark.parametrize("deflection", [0.5, 0.1, 0.02])
def test_the_chord_error_counts_what_a_thin_edge_lacks(deflection: float) -> None:
    disc = made(DISC, radius=20.0, height=0.7)
    mesh = display_mesh(disc, deflection)
    rim = mesh.vertices[np.abs(mesh.vertices[:, 2]) < 1e-9]
    angles = np.sort(np.arctan2(rim[:, 1], rim[:, 0])[np.linalg.norm(rim[:, :2], axis=1) > 19.999])
    widest = float(np.diff(angles, append=angles[0] + 2 * np.pi).max())
    lacking = 20.0 * (1.0 - np.cos(widest / 2))  # of the rim, in the middle between two corners
    assert mesh.chord_error >= lacking
    assert mesh.chord_error < 1.05 * lacking + 1e-6
