"""STEP files with solids of strangers, written by a process of its own: this one never has their shapes."""

import pickle
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from tol3d.cad.solids.lazy import cad
from tol3d.cad.solids.posed_gear import PosedPart
from tol3d.errors import RunError, Tol3dError

PATIENCE: Final = 600.0
"""s; in which an assembly is written."""
PROGRAM: Final = "from tol3d.cad.solids.written_apart import main; main()"
REFUSED: Final = 2


def write_apart(parts: Sequence[PosedPart], path: Path, colours: Sequence[str]) -> None:
    """See tol3d.cad.solids.export_step.

    Raises:
        RunError: the file cannot be written, or a solid not be read again.
    """
    order = pickle.dumps(sys.path) + pickle.dumps((tuple(parts), path.resolve(), tuple(colours)))
    command = [sys.executable, "-P", "-c", PROGRAM]  # -P: nothing is imported from the folder it is called in
    try:
        done = subprocess.run(command, input=order, capture_output=True, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise RunError(f"{path}: not written within {PATIENCE:g} s; choose stl, ply or glb") from None
    if done.returncode == REFUSED:
        raise RunError(done.stderr.decode(errors="replace").strip())
    if done.returncode != 0:
        raise RunError(f"{path}: the process that writes it ended ({done.returncode}); choose stl, ply or glb")


def main() -> None:
    """Write the assembly that comes on standard input, pickled by `write_apart`."""
    stream = sys.stdin.buffer
    sys.path += [own for own in pickle.load(stream) if own and own not in sys.path]
    parts, path, colours = pickle.load(stream)
    try:
        cad().write_step(parts, path, colours)
    except Tol3dError as error:
        sys.stderr.write(str(error))
        sys.exit(REFUSED)
