"""Builders of the user: programs that make the solid of a part, and the reading of their results."""

import io
import json
import os
import pickle
import signal
import subprocess
import sys
import traceback
from collections.abc import Mapping
from typing import Any, Final

import cadquery as cq

from tol3d.cad.solids.kept_shape import KeptShape, made_here
from tol3d.errors import GeometryError
from tol3d.files import FileContent
from tol3d.parts.named_solid import NamedSolid

DAMAGED: Final = "the solid that was kept is damaged"
PATIENCE: Final = 120.0
"""s: time limit of the process that reads a kept solid."""


def main(answer: int) -> None:
    """Run the program that comes on standard input, pickled, and write its result; see kept_shape.

    That is a line of JSON, with the names of the faces and the number of bytes that follow, which are the solid; or
    with the reason why there is none.

    Args:
        answer: descriptor to write to.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal interrupts both processes; the command says what is done
    order = io.BytesIO(sys.stdin.buffer.read())
    sys.path += [path for path in pickle.load(order) if path and path not in sys.path]
    file, function, dimensions = pickle.load(order)
    try:
        brep, faces = run_program(file, function, dimensions)
        head: dict[str, Any] = {"faces": faces, "bytes": len(brep)}
    except GeometryError as error:
        brep, head = b"", {"refused": str(error)}
    with os.fdopen(answer, "wb") as stream:
        stream.write(json.dumps(head).encode() + b"\n" + brep)


def run_program(file: FileContent, function: str, dimensions: Mapping[str, float]) -> tuple[bytes, tuple[str, ...]]:
    """Solid that a function of a Python file makes: OCC's text of it, and names of its faces in their order.

    The function takes the dimensions as keyword arguments [mm, rad] and returns a `NamedSolid`, a `cadquery.Workplane`
    (faces are called by its tags) or a `cadquery.Solid`; faces without a name are "face 1" and so on.

    Raises:
        GeometryError: it cannot be read, fails, or makes no valid solid; with the line of the file.
    """
    names: dict[str, Any] = {"__name__": "tol3d_builder", "__file__": str(file.path)}
    try:
        exec(compile(file.content, str(file.path), "exec"), names)
        if not callable(names.get(function)):
            there = ", ".join(sorted(name for name, own in names.items() if callable(own) and name[0] != "_"))
            raise GeometryError(f"{file.path}: expected a function {function!r}, found: {there or 'none'}")
        made = names[function](**dimensions)
    except GeometryError:
        raise
    except BaseException as error:  # one that ends itself too
        raise GeometryError(f"{_line(error, file)}: {type(error).__name__}: {error}") from None
    solid, named = _solid_and_names(made, file)
    if not solid.isValid():
        raise GeometryError(f"{file.path}: {function} makes a solid that is not valid")
    faces = solid.Faces()
    called = tuple(
        next((name for name, own in named.items() if own.isSame(face)), f"face {number}")
        for number, face in enumerate(faces, 1)
    )
    if missing := [name for name in named if name not in called]:
        words = f"the face {missing[0]!r} is not on the solid that {function} returns"
        raise GeometryError(f"{file.path}: {words}; tag it after all cuts")
    stream = io.BytesIO()
    solid.exportBrep(stream)
    return stream.getvalue(), called


def read(shape: KeptShape) -> NamedSolid:
    """The solid that was kept; of another process it is read in one of its own first, for it may be a stranger's.

    Raises:
        GeometryError: it is none, or its reader crashes or hangs.
    """
    if shape.sha256 not in made_here:
        _try_apart(shape.brep)
        made_here.add(shape.sha256)
    solid = _read(shape.brep)
    if len(solid.Faces()) != len(shape.faces):
        raise GeometryError(f"{DAMAGED}: expected {len(shape.faces)} faces, found {len(solid.Faces())}")
    return NamedSolid(solid, dict(zip(shape.faces, solid.Faces(), strict=True)))


def _read(brep: bytes) -> cq.Solid:
    try:
        solid = cq.Shape.importBrep(io.BytesIO(brep))
    except Exception as error:  # whatever CadQuery and OCC raise of a file that they do not understand
        raise GeometryError(f"{DAMAGED}: {error}") from None
    if not isinstance(solid, cq.Solid):
        raise GeometryError(f"{DAMAGED}: expected one solid, found {type(solid).__name__}")
    return solid


def _try_apart(brep: bytes) -> None:
    """Read a solid in a process of its own: a crash or a hang does no harm."""
    program = f"import sys\nfrom {__name__} import _read\n_read(sys.stdin.buffer.read())"
    command = [sys.executable, "-P", "-c", program]  # -P: nothing is imported from the folder it is called in
    try:
        found = subprocess.run(command, input=brep, capture_output=True, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise GeometryError(f"{DAMAGED}: it cannot be read within {PATIENCE:g} s") from None
    if found.returncode != 0:
        last = (found.stderr.decode(errors="replace").strip().splitlines() or [f"exit code {found.returncode}"])[-1]
        raise GeometryError(
            f"{DAMAGED}: {last.removeprefix('tol3d.errors.GeometryError: ').removeprefix(DAMAGED + ': ')}"
        )


def _solid_and_names(made: Any, file: FileContent) -> tuple[cq.Solid, Mapping[str, cq.Face]]:
    if isinstance(made, NamedSolid):
        return made.solid, made.faces
    named: dict[str, cq.Face] = {}
    if isinstance(made, cq.Workplane):
        for tag, plane in made.ctx.tags.items():
            if len(plane.objects) == 1 and isinstance(plane.objects[0], cq.Face):
                named[tag] = plane.objects[0]
        made = made.val()
    solids = made.Solids() if isinstance(made, cq.Shape) else []
    if len(solids) != 1:
        got = f"{len(solids)} solids" if isinstance(made, cq.Shape) else type(made).__name__
        raise GeometryError(f"{file.path}: expected one solid (NamedSolid, cadquery Workplane or Solid), got {got}")
    return solids[0], named


def _line(error: BaseException, file: FileContent) -> str:
    """Line of the file at which an error came up."""
    if isinstance(error, SyntaxError):
        return f"{file.path}:{error.lineno}"
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file.path)]
    return f"{file.path}:{lines[-1]}" if lines else str(file.path)
