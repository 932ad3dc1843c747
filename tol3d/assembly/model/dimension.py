"""Dimensions: the datum from which a feature is offset nominally, and the direction that makes them longer."""

from collections.abc import Iterable, Sequence
from typing import Final, Protocol

import numpy as np

from tol3d.assembly.model.feature import Shape
from tol3d.numerics.arrays import Array

LEAST: Final = 1e-6
"""Fraction of a distance to the datum, or [mm], whichever is more: less is the rounding of a direction."""


class Placed(Protocol):
    """A feature, of a scene or of a model."""

    @property
    def frame(self) -> Array:
        """Nominally, in its part's frame (4, 4)."""

    @property
    def shape(self) -> Shape:
        """See Shape."""


def longer(at: Array, along: Array, datums: Iterable[Sequence[Placed]]) -> tuple[int, int] | None:
    """The first datum from which a place is offset along a direction, and the sign that leads away.

    Args:
        at: the place (3,), in the part's frame [mm].
        along: the direction (3,), of unit length.
        datums: in order, each a feature, or two whose centres' line is the datum.

    Returns:
        The datum's index and 1, where the direction leads away from it, or -1; None where no distance is along it.
    """
    for k, datum in enumerate(datums):
        off = _off(at, datum)
        distance = float(off @ along)
        if abs(distance) > LEAST * max(1.0, float(np.linalg.norm(off))):
            return k, 1 if distance > 0.0 else -1
    return None


def _off(at: Array, datum: Sequence[Placed]) -> Array:
    """The shortest way (3,) from a datum to a place, nominally [mm]: square to its plane or its axis."""
    off = at - datum[0].frame[:3, 3]
    if len(datum) > 1:
        line = datum[1].frame[:3, 3] - datum[0].frame[:3, 3]
        return np.asarray(off - line * (line @ off) / (line @ line or 1.0))
    sides = datum[0].frame[:3, datum[0].shape.held]
    return np.asarray(sides @ (sides.T @ off))
