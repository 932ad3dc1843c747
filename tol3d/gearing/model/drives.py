"""Where shafts stand in each trial: one uniform for each tree of shafts, spread over its long period."""

import math
from collections.abc import Mapping
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model.layout import Drive, Layout
from tol3d.gearing.model.mesh import Mesh

Array = NDArray[np.float64]

DRIVER_POSITION = "driver position"
MOST_PERIODS = Fraction(2**30)  # of 52 bits of a draw 22 are left to say where in one of them a mesh stands


def driver_angles(
    layout: Layout, meshes: Mapping[str, Mesh], uniforms: Mapping[tuple[str, str], Array]
) -> Mapping[str, Array]:
    """Driver angle of each trial [rad] (count,) by mesh.

    The first shaft of a tree stands uniform over its long period, so that each mesh stands uniform over its own.

    Args:
        layout: how shafts turn with each other.
        meshes: by name.
        uniforms: (count,) of each tree's stream, (its name, DRIVER_POSITION).
    """
    angles: dict[str, Array] = {}
    for drive in layout.drives:
        own = uniforms[drive.name, DRIVER_POSITION]
        periods = _periods(layout, meshes, drive)
        angles |= {mesh: _of_long_period(layout, meshes[mesh], count, own) for mesh, count in periods.items()}
    return angles


def _periods(layout: Layout, meshes: Mapping[str, Mesh], drive: Drive) -> Mapping[str, Fraction]:
    """How many long periods of its own each mesh goes through in that of its tree, or in its first MOST_PERIODS."""
    periods = {
        mesh: drive.turns * abs(layout.mesh_turn[mesh].rate) / meshes[mesh].pair.long_period_turns
        for mesh in drive.meshes
    }
    share = min(Fraction(1), MOST_PERIODS / max(periods.values()))
    return {mesh: own * share for mesh, own in periods.items()}


def _of_long_period(layout: Layout, mesh: Mesh, periods: Fraction, uniforms: Array) -> Array:
    """The driver's angle of a mesh where its tree stands at a share (count,) of so many of its long periods."""
    turning, turns = layout.mesh_turn[mesh.name], mesh.pair.long_period_turns
    share = uniforms if periods == 1 else np.mod(float(periods) * uniforms, 1.0)
    return turning.offset + math.copysign(2 * math.pi * turns, turning.rate) * share
