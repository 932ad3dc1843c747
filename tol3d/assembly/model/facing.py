"""Where two solids may be nearest to each other."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Facing:
    """Pairs of points of two parts whose distances the distance of the parts is the least of, to first order.

    Args:
        starts: in the frame of the first part (pairs, 3) [mm].
        ends: in the frame of the second (pairs, 3) [mm].
        reach: how far points of one part move against the other, about [mm]: what is farther off is not looked at
            first.
    """

    starts: Array
    ends: Array
    reach: float
