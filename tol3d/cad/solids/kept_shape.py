"""Solids that a program of the user built, in a process of its own: the result is kept, it never runs again."""

import hashlib
import json
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Final

from tol3d.cad.solids.built_shape import BuiltShape
from tol3d.errors import GeometryError, InputError
from tol3d.files import FileContent

PATIENCE_VARIABLE: Final = "TOL3D_BUILDER_SECONDS"
PATIENCE: Final = 300.0
"""s: default time limit of a program of the user, unless the variable states another."""

PROGRAM: Final = (
    "import os; answer = os.dup(1); os.dup2(2, 1); from tol3d.cad.solids.own_program import main; main(answer)"
)
"""Program of the process: anything printed goes to standard error, even before tol3d is imported."""

made_here: set[str] = set()
"""SHA-256 of solids that were made for this process or tried by it, and need not be tried again."""


@dataclass(frozen=True)
class KeptShape(BuiltShape):
    """A solid as OCC writes it.

    Args:
        sha256: of its output, which identifies the shape.
        faces: names in the order of the solid's faces.
        brep: its output: data, which executes nothing when it is read.
    """

    builder: ClassVar[str] = "tol3d.cad.solids.own_program:read"

    sha256: str
    faces: tuple[str, ...]
    brep: bytes = field(repr=False, compare=False)

    @classmethod
    def of(cls, brep: bytes, faces: Sequence[str]) -> "KeptShape":
        """A solid that was kept."""
        return cls(hashlib.sha256(brep).hexdigest(), tuple(faces), brep)


def run_program(file: FileContent, function: str, dimensions: Mapping[str, float]) -> KeptShape:
    """Run a builder of the user's in a process of its own and keep its result.

    Args:
        file: a Python module.
        function: of it, see tol3d.cad.solids.own_program.
        dimensions: its keyword arguments [mm, rad].

    Raises:
        GeometryError: it fails, makes no solid, ends its process, or takes longer than it may.
        InputError: the variable of its time limit is not a number.
    """
    patience = _patience()
    order = pickle.dumps(sys.path) + pickle.dumps((file, function, dict(dimensions)))
    command = [sys.executable, "-P", "-c", PROGRAM]  # -P: nothing is imported from the folder it is called in
    try:
        done = subprocess.run(command, input=order, stdout=subprocess.PIPE, timeout=patience, check=False)
    except subprocess.TimeoutExpired:
        words = f"{file.path}: {function} made no solid within {patience:g} s and was stopped"
        raise GeometryError(f"{words}; {PATIENCE_VARIABLE}={10 * patience:g} would give it longer") from None
    head, _, brep = done.stdout.partition(b"\n")
    answer: Mapping[str, Any] = json.loads(head or "{}")
    if "refused" in answer:
        raise GeometryError(answer["refused"])
    if len(brep) != answer.get("bytes"):
        raise GeometryError(f"{file.path}: {_ended(done.returncode)} before {function} had returned a solid")
    shape = KeptShape.of(brep, answer["faces"])
    made_here.add(shape.sha256)
    return shape


def _patience() -> float:
    text = os.environ.get(PATIENCE_VARIABLE) or f"{PATIENCE:g}"
    try:
        patience = float(text)
    except ValueError:
        patience = 0.0
    if not 0.0 < patience < 1e9:
        raise InputError(f"{PATIENCE_VARIABLE}: expected a number of seconds, such as {PATIENCE:g}, got {text!r}")
    return patience


def _ended(code: int) -> str:
    """The end of a process in words, by its exit code or the number of a signal below 0."""
    if code >= 0:
        return f"it ended its process (exit code {code})"
    name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    return f"its process was ended by {name}"
