"""Posed parts as one STEP assembly."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from tol3d.solids.lazy import cad
from tol3d.solids.posed_gear import PosedPart

COLOURS: Final = ("steelblue", "darkorange", "seagreen", "goldenrod", "slategray", "indianred")


def export_step(parts: Sequence[PosedPart], path: Path, colours: Sequence[str] = COLOURS) -> None:
    """Write the parts as a STEP assembly [mm] with their names and colours.

    Solids are built from each gear as it is, its tooth thickness deviation included. The file
    appears whole or not at all.

    Args:
        parts: names differ and hold no colon at their beginnings.
        path: the file.
        colours: of the parts in order, names or "#RRGGBB"; begun again when there are more parts.

    Raises:
        RunError: the file cannot be written.
    """
    cad().write_step(parts, path, colours)
