"""Clearances of whole parts to first order: the least distance of pairs of points, one on each."""

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Measured
from tol3d.assembly.torsors.columns import without_rounding
from tol3d.assembly.torsors.terms import Ends
from tol3d.assembly.torsors.torsor import height_at
from tol3d.assembly.torsors.world import World

Array = NDArray[np.float64]


def clearance(measured: Measured, world: World) -> Array:
    """A row (columns,) [mm]: the least of lengths that change as the points of each pair move along its normal.

    Which pairs there are is known of the nominal geometry. That faces roll on each other, and that points slide past
    ends, is of second order.
    """
    if measured.facing is None:
        raise ValueError(f"clearance of {', '.join(measured.parts)}: it is not known where they are nearest")
    start, end = measured.parts
    facing = measured.facing
    here, there = _in_world(facing.starts, start, world), _in_world(facing.ends, end, world)
    normals = world.turned(facing.normals, start)
    rows = world.columns.zeros(len(here))
    for row, point, other, normal, length in zip(rows, here, there, normals, facing.lengths, strict=True):
        row += height_at(other, normal)[0] @ world.parts[end] - height_at(point, normal)[0] @ world.parts[start]
        row[world.columns.constant] += length
    rows = without_rounding(rows)
    least: Array = rows[0] if len(rows) == 1 else world.columns.made_by(Ends(rows, is_largest=False))[0]
    return least


def _in_world(points: Array, part: str, world: World) -> Array:
    """Points (pairs, 3) of a part, nominally in the world [mm]."""
    pose = world.assembly.part[part].pose
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3])
