"""Posed gears as one STEP assembly."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tol3d.gears import SpurGear
from tol3d.solids.door import cad


@dataclass(frozen=True, eq=False)
class PosedGear:
    """A gear, the name it bears in the assembly, and where it stands: (4, 4), rotation and translation [mm]."""

    name: str
    gear: SpurGear
    world_from_part: NDArray[np.float64]


def export_step(parts: Sequence[PosedGear], path: Path) -> None:
    """Write the parts as a STEP assembly [mm] with their names, each in a colour of its own.

    Solids are built from each gear as it is, its tooth thickness deviation included. The file
    appears whole or not at all.

    Raises:
        RunError: the file cannot be written.
    """
    cad().write_step(parts, path)
