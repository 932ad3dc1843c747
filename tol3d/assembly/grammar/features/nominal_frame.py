"""Nominal frames from a scene's entries: a place, an axis or normal, the direction of x."""

from functools import lru_cache
from struct import pack, unpack
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array

Triple = tuple[float, float, float]

KEPT: Final = 4096  # orientations of features; parts have few, shared by their features
ALONG: Final = 1e-6  # sine; a direction nearer to z cannot orient x


def unit(direction: Triple) -> Array:
    """A direction with length 1."""
    vector = np.array(direction, dtype=np.float64)
    scaled = vector / np.abs(vector).max()
    return np.asarray(scaled / np.sqrt((scaled * scaled).sum()))


def is_across(x: Triple, z: Triple) -> bool:
    """True if a direction can orient x: it is not along z."""
    return bool(np.linalg.norm(np.cross(unit(x), unit(z))) > ALONG)


def frame(at: Array, z: Triple, x: Triple | None = None) -> Array:
    """A frame (4, 4) at a place with a z axis; x as near to `x` as it can be, or to the world's x (y where z is x)."""
    made = _turned(pack("3d", *z), None if x is None else pack("3d", *x)).copy()
    made[:3, 3] = at
    return made


@lru_cache(maxsize=KEPT)
def _turned(z: bytes, x: bytes | None) -> Array:
    """That frame at the origin, not to be changed, of directions as bytes: -0.0 is not 0.0."""
    axis = unit(_triple(z))
    wish = unit(_triple(x)) if x is not None else np.eye(3)[0] if abs(axis[0]) < 0.9 else np.eye(3)[1]
    first = wish - axis * (wish @ axis)
    first /= np.linalg.norm(first)
    made = np.eye(4)
    made[:3, 0], made[:3, 1], made[:3, 2] = first, np.cross(axis, first), axis
    return made


def _triple(packed: bytes) -> Triple:
    x, y, z = unpack("3d", packed)
    return x, y, z
