"""Where shafts stand in each trial: one uniform for each tree of shafts, spread over its long period."""

import math
from collections.abc import Mapping
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model.drive import Drive
from tol3d.gearing.model.layout import Layout

Array = NDArray[np.float64]

DRIVER_POSITION = "driver position"
MOST_PERIODS = Fraction(2**30)  # of 52 bits of a draw 22 are left to say where in one of them a mesh stands


def driver_angles(
    layout: Layout, periods: Mapping[str, Fraction], uniforms: Mapping[tuple[str, str], Array]
) -> Mapping[str, Array]:
    """Driver angle of each trial [rad] (count,) by mesh, or by another link whose play depends on it.

    The first shaft of a tree stands uniform over its long period, so that each mesh stands uniform over its own.

    Args:
        layout: how shafts turn with each other.
        periods: turns of each one's driver until it stands as before.
        uniforms: (count,) of each tree's stream, (its name, DRIVER_POSITION).
    """
    angles: dict[str, Array] = {}
    for drive in layout.drives:
        own = uniforms[drive.name, DRIVER_POSITION]
        counts = _counts(layout, periods, drive)
        angles |= {move: _of_long_period(layout, (move, periods[move]), count, own) for move, count in counts.items()}
    return angles


def _counts(layout: Layout, periods: Mapping[str, Fraction], drive: Drive) -> Mapping[str, Fraction]:
    """How many long periods of its own each mesh goes through in that of its tree, or in its first MOST_PERIODS."""
    counts = {move: drive.turns * abs(layout.mesh_turn[move].rate) / periods[move] for move in drive.moves}
    share = min(Fraction(1), MOST_PERIODS / max(counts.values()))
    return {move: own * share for move, own in counts.items()}


def _of_long_period(layout: Layout, move: tuple[str, Fraction], count: Fraction, uniforms: Array) -> Array:
    """The driver's angle of a mesh where its tree stands at a share (count,) of so many of its long periods."""
    (name, turns), share = move, uniforms if count == 1 else np.mod(float(count) * uniforms, 1.0)
    turning = layout.mesh_turn[name]
    return turning.offset + math.copysign(2 * math.pi * turns, turning.rate) * share
