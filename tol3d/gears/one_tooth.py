"""One tooth in its space: both of its flanks are looked at, and no other tooth's."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.gears.flank import RIGHT, Flank

Array = NDArray[np.float64]
Owner = Literal["driver", "driven"]


def driver_teeth_at_one_tooth(
    driver_angle: Array, angular_pitch: float, flank: Flank, owner: Owner
) -> NDArray[np.int64]:
    """The driver's tooth that touches, with that flank, the one tooth (or is it), (rows, 1).

    The one tooth is the owner's nearest to the line of centres, which the driver sees at azimuth 0. A driven
    tooth stands in a space of the driver: the space's right wall is the right flank of the tooth above it.

    >>> driver_teeth_at_one_tooth(np.array([0.1]), 1.0, RIGHT, "driver").tolist()
    [[0]]
    >>> [driver_teeth_at_one_tooth(np.array([0.1]), 1.0, flank, "driven").tolist() for flank in (1, -1)]
    [[[0]], [[-1]]]
    """
    place = driver_angle / angular_pitch
    above = 1 if flank == RIGHT else 0
    tooth = -np.round(place) if owner == "driver" else above - np.round(place + 0.5)
    return np.asarray(tooth.astype(np.int64)[:, None])
