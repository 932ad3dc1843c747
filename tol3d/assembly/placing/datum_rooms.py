"""Positions in a datum frame whose gauge may shift in its datum feature: the least over all shifts in its room.

The gauge's axis stays within circles of its clearance about both ends of the datum feature. A value w is reached if
these and the circles of radius w about the places have a point in common. The size of the common opening is concave in
w and grows with it, so that Newton's steps from below never pass the least w.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Axis, Measured
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.common_opening import new_rooms, opened
from tol3d.assembly.placing.gauging import weights_of
from tol3d.assembly.placing.poses import Pose, column, dot
from tol3d.assembly.placing.world import World
from tol3d.numerics.compiled import kernel

Array = NDArray[np.float64]

MET: Final = 1e-12
"""mm, by which circles miss a common point at most."""
STEPS: Final = 100
"""In practice 1 to 6."""
FREE: Final = 1e-12
"""Weight of places under which the room alone decides: it is empty."""


@kernel(arrays="float64[:,::1], float64[:,::1], float64[:,::1], int64, float64[::1]")
def least_in_rooms(x: Any, y: Any, radii: Any, places: Any, least: Any) -> None:
    """The least by which circles about places grow until all circles have a point in common; nan where none do.

    Args:
        x, y: centres, of the places, then of the room (circles, n) [mm].
        radii: of the places without growth, less than 0 or not, then of the room (circles, n) [mm].
        places: how many of them are places.
        least: found (n,) [mm].
    """
    size = x.shape[0]
    alone = (np.empty((places, 1)), np.empty((places, 1)), np.empty((places, 1)))
    discs = (np.empty((size, 1)), np.empty((size, 1)), np.empty((size, 1)))
    found, deciding, pulls, rooms = np.empty(2), np.empty(3, dtype=np.int64), np.empty((3, 3)), new_rooms()
    for i in range(least.shape[0]):
        for k in range(size):
            discs[0][k, 0], discs[1][k, 0], discs[2][k, 0] = x[k, i], y[k, i], radii[k, i]
        for k in range(places):
            alone[0][k, 0], alone[1][k, 0], alone[2][k, 0] = x[k, i], y[k, i], radii[k, i]
        grown = opened(alone, 0, found, deciding, rooms)
        least[i] = np.nan
        for _ in range(STEPS):
            for k in range(places):
                discs[2][k, 0] = radii[k, i] + grown
            missing = opened(discs, 0, found, deciding, rooms)
            if missing <= MET:
                least[i] = grown
                break
            count, weight = weights_of(discs, deciding, found, pulls), 0.0
            own = 0
            for c in range(3):
                if deciding[c] >= 0:
                    if deciding[c] < places:
                        weight += pulls[own, 2]
                    own += 1
            if count < 1 or not weight > FREE:
                break
            grown += missing / weight


def _ends(axis: ActualFeature) -> Array:
    """Nominal ends (2, 3) in its frame [mm]."""
    assert isinstance(axis.feature.shape, Axis)
    return axis.feature.shape.ends


def position_in_room(measured: Measured, world: World, actual: ActualFeature, into: Pose, bonus: Array) -> Array:
    """Twice the least distance of the worse end, less the bonus (n,) or (1,) [mm]; nan where no gauge fits.

    Args:
        measured: what, with a room.
        world: as it is read.
        actual: the feature as its datum frame sees it.
        into: of that frame, from the part's.
        bonus: of its size.
    """
    room = measured.room
    assert room is not None
    datum = world.on_part(room.feature).moved(into)
    across = world.assembly.features[room.feature].frame[:3, :2].T
    features = (actual, datum)
    x, y = (
        [
            dot(column(own), end - column(each.feature.frame[:3, :3] @ place + each.feature.frame[:3, 3]))
            for each in features
            for end, place in zip(each.ends, _ends(each), strict=True)
        ]
        for own in across
    )
    sign = 1.0 if room.grows else -1.0
    size = actual_size(world.assembly.features[room.feature], world.columns)
    clearance = 0.5 * sign * (size - room.virtual)
    places = len(actual.ends)
    radii = [0.5 * bonus] * places + [clearance] * len(datum.ends)
    rows = np.stack(np.broadcast_arrays(*x, *y, *radii))
    x_rows, y_rows, radius_rows = (np.ascontiguousarray(own) for own in np.split(rows, 3))
    least = np.empty(rows.shape[1])
    least_in_rooms(x_rows, y_rows, radius_rows, places, least)
    return 2.0 * least
