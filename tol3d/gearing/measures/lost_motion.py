"""What backlashes leave free at the end of a train: a turn, or what that moves."""

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Kind, LostMotion

Array = NDArray[np.float64]


def moved(kind: Kind, free: Array) -> Array:
    """A measure's values of what its backlashes leave free.

    A tip goes round its shaft's axis: the chord 2 L sin(turn/2) [mm]. Over a swing it errs where the other flanks work
    than at the start, by whose rest it is counted.

    Args:
        kind: what is measured.
        free: backlash [mm], or turn of the shaft that is read [rad]; (trials, positions).
    """
    if not isinstance(kind, LostMotion) or kind.tip is None:
        return free
    displacement = 2 * kind.tip.lever * np.sin(free / 2)
    return displacement * np.array(kind.turned, dtype=float) if kind.turned else displacement


def moved_rate(kind: Kind, free: Array) -> Array:
    """Its derivative by what is free, (trials, positions)."""
    if not isinstance(kind, LostMotion) or kind.tip is None:
        return np.ones_like(free)
    rate = kind.tip.lever * np.cos(free / 2)
    return rate * np.array(kind.turned, dtype=float) if kind.turned else rate
