"""A pattern over a gauge that may shift and turn: offset of its worst hole at the best pose, trial by trial.

For each turn the shift is that of a common opening. The remaining function of the turn alone is the minimum of convex
ones, with a slope from the discs that decide: turns are bracketed by the signs of slopes, and the next one is where the
tangents at both ends meet, or the middle if they gain less than half.
"""

from math import cos, sin, sqrt
from typing import Any, Final

import numpy as np

from tol3d.assembly.model import Axis, Measured
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.common_opening import new_rooms, opened
from tol3d.assembly.placing.poses import Pose, column, dot
from tol3d.assembly.placing.world import World
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import kernel, nested

MET: Final = 1e-12
"""mm; largest gap below the tangents of both ends of the bracket at the end."""
LEAST: Final = 1e-16
"""rad; width of a bracket at the end."""
WIDEST: Final = 0.5
"""rad; limit of the search for a bracket."""
TURNS: Final = 200
"""In practice 5 to 15."""


@nested
def weights_of(discs: Any, deciding: Any, found: Any, pulls: Any) -> int:
    """Number of deciding discs; fills pulls (3, 3) with directions from centre to point and balancing weights.

    Args:
        discs: one trial.
        deciding: indices of those that decide (3,).
        found: the point (2,).
        pulls: filled; 0 if a single one decides, in its centre.
    """
    count = 0
    for c in range(3):
        k = deciding[c]
        if k < 0:
            continue
        a, b = found[0] - discs[0][k, 0], found[1] - discs[1][k, 0]
        length = sqrt(a * a + b * b)
        share = 1.0 / length if length > 0.0 else 0.0
        pulls[count, 0], pulls[count, 1], pulls[count, 2] = a * share, b * share, 1.0
        count += 1
    if count == 2:
        pulls[0, 2], pulls[1, 2] = 0.5, 0.5
    if count == 3:
        total = 0.0
        for c in range(3):
            d, e = (c + 1) % 3, (c + 2) % 3
            pulls[c, 2] = pulls[d, 0] * pulls[e, 1] - pulls[d, 1] * pulls[e, 0]
            total += pulls[c, 2]
        for c in range(3):
            pulls[c, 2] = pulls[c, 2] / total if total != 0.0 else 1.0 / 3.0
    return count


@nested
def slope_of(discs: Any, deciding: Any, found: Any, rises: Any, pulls: Any) -> Any:
    """Change of the least violation with the turn.

    Those that decide pull the point with weights that balance; each violation grows as its centre moves away.

    Args:
        discs: one trial.
        deciding: which decide (3,).
        found: the point (2,).
        rises: how the centres move with the turn (discs, 2).
        pulls: work array for directions and weights (3, 3).
    """
    if weights_of(discs, deciding, found, pulls) < 2:
        return 0.0
    slope, count = 0.0, 0
    for c in range(3):
        k = deciding[c]
        if k >= 0:
            slope -= pulls[count, 2] * (pulls[count, 0] * rises[k, 0] + pulls[count, 1] * rises[k, 1])
            count += 1
    return slope


@nested
def turned(pattern: Any, i: int, turn: float, rooms: Any) -> Any:
    """The least violation with the gauge turned, and its slope."""
    x, y, radii, nominal = pattern
    discs, rises, found, deciding, pulls, others = rooms
    c, s = cos(turn), sin(turn)
    for k in range(x.shape[0]):
        p, q = nominal[k, 0], nominal[k, 1]
        discs[0][k, 0], discs[1][k, 0] = x[k, i] - (c * p - s * q), y[k, i] - (s * p + c * q)
        discs[2][k, 0] = radii[k, i]
        rises[k, 0], rises[k, 1] = s * p + c * q, s * q - c * p
    least = opened(discs, 0, found, deciding, others)
    return least, slope_of(discs, deciding, found, rises, pulls)


@nested
def gauged(pattern: Any, i: int, step: float, rooms: Any) -> Any:
    """The least violation over all turns."""
    least, slope = turned(pattern, i, 0.0, rooms)
    if slope == 0.0:
        return least
    near, near_value, near_slope = 0.0, least, slope
    far = -step if slope > 0.0 else step
    far_value, far_slope = turned(pattern, i, far, rooms)
    while far_slope * slope > 0.0 and abs(far) < WIDEST:
        near, near_value, near_slope = far, far_value, far_slope
        far = 2.0 * far
        far_value, far_slope = turned(pattern, i, far, rooms)
    least = min(least, near_value, far_value)
    for _ in range(TURNS):
        width = far - near
        if far_slope == 0.0 or abs(width) <= LEAST:
            break
        meet = (far_value - near_value - far_slope * width) / (near_slope - far_slope)  # from `near`
        if not near_value + near_slope * meet < least - MET:
            break
        if not 0.0 < meet / width < 1.0:
            meet = 0.5 * width
        middle = near + meet
        value, slope = turned(pattern, i, middle, rooms)
        least = min(least, value)
        if slope * near_slope > 0.0:
            near, near_value, near_slope = middle, value, slope
        else:
            far, far_value, far_slope = middle, value, slope
        if abs(far - near) > 0.5 * abs(width):
            middle = 0.5 * (near + far)
            value, slope = turned(pattern, i, middle, rooms)
            least = min(least, value)
            if slope * near_slope > 0.0:
                near, near_value, near_slope = middle, value, slope
            else:
                far, far_value, far_slope = middle, value, slope
    return least


@kernel(arrays="float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[::1]")
def gauged_patterns(x: Any, y: Any, radii: Any, nominal: Any, worst: Any) -> None:
    """Largest distance outside its disc of any place, over the best shift and turn of the nominal places.

    Args:
        x, y: actual places (places, n) [mm].
        radii: of the discs about the nominal ones (places, n) [mm].
        nominal: places (places, 2), about their middle [mm].
        worst: found (n,) [mm]; 0 or less where each is within its disc.
    """
    size = x.shape[0]
    reach = 0.0
    for k in range(size):
        reach = max(reach, sqrt(nominal[k, 0] ** 2 + nominal[k, 1] ** 2))
    discs = (np.empty((size, 1)), np.empty((size, 1)), np.empty((size, 1)))
    rooms = (discs, np.empty((size, 2)), np.empty(2), np.empty(3, dtype=np.int64), np.empty((3, 3)), new_rooms())
    pattern = (x, y, radii, nominal)
    for i in range(worst.shape[0]):
        off = 0.0
        for k in range(size):
            off = max(off, abs(x[k, i] - nominal[k, 0]), abs(y[k, i] - nominal[k, 1]))
        worst[i] = gauged(pattern, i, 0.25 * off / reach + LEAST, rooms)


STEPS: Final = 100
"""In practice 1 to 6."""
FREE: Final = 1e-12
"""Weight of places below which the clearance alone decides: it is empty."""


@kernel(arrays="float64[:,::1], float64[:,::1], float64[:,::1], int64, float64[::1]")
def least_in_rooms(x: Any, y: Any, radii: Any, places: Any, least: Any) -> None:
    """The least growth of circles about places at which all circles have a common point; NaN if there is none.

    Args:
        x, y: centres, of the places, then of the clearances (circles, n) [mm].
        radii: of the places without growth, of either sign, then of the clearances (circles, n) [mm].
        places: number of places among them.
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
    """Twice the least distance of the worse end, less the bonus (n,) or (1,) [mm]; NaN if no gauge fits.

    Args:
        measured: what, with a room.
        world: as it is read.
        actual: the feature in its datum frame.
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
