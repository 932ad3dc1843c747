"""Posed gears as one STEP assembly."""

from collections.abc import Sequence
from pathlib import Path

from tol3d.solids.door import cad
from tol3d.solids.posed_gear import PosedGear


def export_step(parts: Sequence[PosedGear], path: Path) -> None:
    """Write the parts as a STEP assembly [mm] with their names, each in a colour of its own.

    Solids are built from each gear as it is, its tooth thickness deviation included. The file
    appears whole or not at all.

    Raises:
        RunError: the file cannot be written.
    """
    cad().write_step(parts, path)
