"""Symbols of a part's features as one surface: joined by rods, or on the part's solid."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Feature
from tol3d.assembly.presenting.symbols import Surface, mark, rod, symbol, together

Array = NDArray[np.float64]
Framed = Sequence[tuple[Feature, Array]]
"""Features, and their frames (4, 4)."""


def joined_symbols(features: Framed, thickness: float) -> Surface:
    """Symbols of several features, and rods from their middle to each."""
    places = np.array([frame[:3, 3] for _, frame in features])
    middle = places.mean(axis=0)
    rods = [rod(middle, place, thickness / 6) for place in places if np.linalg.norm(place - middle) > thickness]
    return together([*rods, *(_moved(symbol(own.shape, thickness), frame) for own, frame in features)])


def marks_on_solid(features: Framed, thickness: float) -> Surface:
    """What stands for several features on the solid of their part."""
    return together([_moved(mark(own.shape, thickness), frame) for own, frame in features])


def _moved(surface: Surface, frame: Array) -> Surface:
    vertices, triangles = surface
    return vertices @ frame[:3, :3].T + frame[:3, 3], triangles
