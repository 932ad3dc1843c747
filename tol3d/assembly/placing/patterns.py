"""Positions of a whole pattern, over a gauge that finds its best pose; what sizes take from positions."""

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Measured
from tol3d.assembly.placing.actual_feature import total
from tol3d.assembly.placing.common_opening import common_openings
from tol3d.assembly.placing.gauging import gauged_patterns
from tol3d.assembly.placing.poses import column, dot
from tol3d.assembly.placing.world import World

Array = NDArray[np.float64]


def bonuses(measured: Measured, world: World) -> list[Array]:
    """What the size of each measured feature adds to its zone, each (n,) or (1,) [mm]."""
    found = []
    for name, own in zip(measured.features, measured.bonuses, strict=True):
        size = total(world.assembly.features[name].size_by, 1, world.columns)[0]
        found.append(np.clip(size - own.low if own.grows else own.high - size, 0.0, own.high - own.low))
    return found


def pattern(measured: Measured, world: World) -> Array:
    """The largest of 2 distance - bonus at the best pose of the nominal places (n,) or (1,) [mm].

    Each feature counts at both its ends; the places turn about their middle.
    """
    part = world.part_of(measured.features[0])
    into = world.own[part].displacement(measured.frame).inverse
    frames = [world.assembly.features[name].frame for name in measured.features]
    across = frames[0][:3, :2]
    middle = np.mean([frame[:3, 3] for frame in frames], axis=0)
    ends = [[end - column(middle) for end in world.on_part(name).moved(into).ends] for name in measured.features]
    x, y = ([dot(column(own), end) for each in ends for end in each] for own in across.T)
    own_bonuses = bonuses(measured, world) if measured.bonuses else [np.zeros(1)] * len(ends)
    radii = [0.5 * own for own, each in zip(own_bonuses, ends, strict=True) for _ in each]
    nominal = np.array(
        [(frame[:3, 3] - middle) @ across for frame, each in zip(frames, ends, strict=True) for _ in each]
    )
    rows = np.stack(np.broadcast_arrays(*x, *y, *radii))
    x_rows, y_rows, radius_rows = (np.ascontiguousarray(own) for own in np.split(rows, 3))
    worst = np.empty(rows.shape[1])
    if measured.gauge == "shift":
        centres = np.empty((2, len(worst)))
        x_rows -= nominal[:, :1]
        y_rows -= nominal[:, 1:]
        common_openings(x_rows, y_rows, radius_rows, worst, centres)
        return -worst
    gauged_patterns(x_rows, y_rows, radius_rows, nominal, worst)
    return 2.0 * worst
