"""What measures make of what their meshes leave free: a turn, what that moves, or how it changes."""

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Kind, LostMotion, TransmissionError

Array = NDArray[np.float64]


def moved(kind: Kind, free: Array) -> Array:
    """A measure's values of what its backlashes leave free.

    A tip goes round its shaft's axis: the chord 2 L sin(turn/2) [mm]. Over a swing it errs where the other flanks work
    than at the start, by whose rest it is counted. A transmission error is counted from that at the first position.

    Args:
        kind: what is measured.
        free: backlash [mm], or turn of the shaft that is read [rad]; (trials, positions).
    """
    if isinstance(kind, TransmissionError):
        return free - free[:, :1]
    if not isinstance(kind, LostMotion) or kind.tip is None:
        return free
    displacement = 2 * kind.tip.lever * np.sin(free / 2)
    return displacement * np.array(kind.turned, dtype=float) if kind.turned else displacement


def moved_rates(kind: Kind, free: Array, rates: Array) -> Array:
    """Its derivatives (trials, positions, components) by those of what is free."""
    if isinstance(kind, TransmissionError):
        return np.asarray(rates - rates[:, :1])
    if not isinstance(kind, LostMotion) or kind.tip is None:
        return rates
    rate = kind.tip.lever * np.cos(free / 2)
    return np.asarray(rates * (rate * np.array(kind.turned, dtype=float) if kind.turned else rate)[..., None])
