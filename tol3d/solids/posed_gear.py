"""A gear and where it stands."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.gears import Gear


@dataclass(frozen=True, eq=False)
class PosedGear:
    """A gear, the name of its part, and its pose: (4, 4), rotation and translation [mm]."""

    name: str
    gear: Gear
    world_from_part: NDArray[np.float64]
