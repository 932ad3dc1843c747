"""Virtual clearance: the largest straight bolt through holes as they lie in their trials."""

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Measured
from tol3d.assembly.placing.actual_feature import actual_size
from tol3d.assembly.placing.common_opening import common_openings
from tol3d.assembly.placing.poses import column, dot, rotated
from tol3d.assembly.placing.world import World

Array = NDArray[np.float64]


def virtual_clearance(measured: Measured, world: World) -> Array:
    """Diameters (n,) [mm]; below 0 where the holes have no line in common.

    The bolt stands along the nominal axis of the first hole, as its part or a datum frame carries it. Each hole leaves
    the circles of its diameter about both its ends; that they are ellipses where it leans is of second order.
    """
    first = measured.features[0]
    part = world.part_of(first)
    turn = world.poses[part].turn
    carried = world.own[part].displacement(measured.frame).turn
    across = [rotated(turn, rotated(carried, column(own))) for own in world.assembly.features[first].frame[:3, :2].T]
    ends = [end for name in measured.features for end in world.placed(name).ends]
    sizes = [actual_size(world.assembly.features[name], world.columns) for name in measured.features]
    middle = ends[0]  # about it, numbers are small
    x, y = ([dot(own, end - middle) for end in ends] for own in across)
    radii = [0.5 * size for size in sizes for _ in range(2)]
    rows = np.stack(np.broadcast_arrays(*x, *y, *radii))
    openings, centres = np.empty(rows.shape[1]), np.empty((2, rows.shape[1]))
    discs = (np.ascontiguousarray(own) for own in np.split(rows, 3))
    common_openings(*discs, openings, centres)
    return openings
