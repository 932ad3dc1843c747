"""Where two solids may be nearest to each other."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Facing:
    """Pairs of points of two parts; the distance of the parts is the least of theirs, to first order.

    Args:
        starts: in the frame of the first part (pairs, 3) [mm].
        ends: in the frame of the second (pairs, 3) [mm].
        normals: directions along which they come nearer, from the first part to the second, nominally in the frame of
            the first (pairs, 3).
        lengths: distances along these, nominally (pairs,) [mm].
        reach: how far points move, about: of the second part along x, y and z of the first, of the first along those of
            the second (2, 3) [mm]. What moves no farther is read of fewer triangles.
    """

    starts: Array
    ends: Array
    normals: Array
    lengths: Array
    reach: Array
