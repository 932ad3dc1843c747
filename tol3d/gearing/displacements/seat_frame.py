"""Vectors of a gear's frame in the frames of its meshes."""

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Seat

Array = NDArray[np.float64]


def in_seat(vector: tuple[float, float, float], seat: Seat, mesh: str | None) -> Array:
    """A vector in a gear's frame at rest in one of its meshes, (3,).

    Args:
        vector: in the gear's frame at rest on its shaft, or in that of the mesh if one is named.
        seat: the gear in its mesh.
        mesh: the one in which the vector is stated, if any.
    """
    if mesh is not None or seat.azimuth == 0.0:
        return np.array(vector)
    (x, y, z), cos, sin = vector, np.cos(seat.azimuth), np.sin(seat.azimuth)
    return np.array([cos * x + sin * y, cos * y - sin * x, z])
