"""A pattern over a gauge that may shift and turn: offset of its worst hole at the best pose, trial by trial.

For each turn the shift is that of a common opening. The remaining function of the turn alone is the minimum of convex
ones, with a slope from the discs that decide.
"""

from dataclasses import dataclass

import numpy as np

from tol3d.assembly.model import Measured
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.poses import Pose, column, dot
from tol3d.assembly.placing.world import World
from tol3d.contact.openings import LEAST, least_in_rooms, least_over_turns, opening
from tol3d.numerics.arrays import Array, Places


@dataclass(frozen=True, eq=False)
class GaugedPattern:
    """Places over a gauge.

    Args:
        x, y: actual places (places, n) [mm].
        radii: of the discs about the nominal ones (places, n) [mm].
        nominal: places (places, 2), about their middle [mm].
    """

    x: Array
    y: Array
    radii: Array
    nominal: Array

    def turned(self, trials: Places, turn: Array) -> Array:
        """Turns of the gauge, the least violation there, and its slope (3, trials)."""
        square = turn * turn
        tangent = turn * (1.0 + square / 3.0 * (1.0 + 0.4 * square))  # its series, short of turn^7 / 19
        p, q = self.nominal.T[..., None] / np.sqrt(1.0 + tangent * tangent)
        x, y = p - tangent * q, tangent * p + q
        found = opening(self.x[:, trials] - x, self.y[:, trials] - y, self.radii[:, trials])
        return np.stack([turn, found.outside, found.slope(y, -x)])

    def least(self) -> Array:
        """Largest distance outside its disc of any place, over the best shift and turn (n,) [mm]."""
        off = np.maximum(np.abs(self.x - self.nominal[:, :1]), np.abs(self.y - self.nominal[:, 1:])).max(axis=0)
        step = 0.25 * off / (np.sqrt((self.nominal**2).sum(axis=1)).max() or 1.0) + LEAST
        return least_over_turns(self.turned, step)


def _ends(axis: ActualFeature) -> Array:
    """Nominal ends (2, 3) in its frame [mm]."""
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
    x_rows, y_rows, radius_rows = np.split(np.stack(np.broadcast_arrays(*x, *y, *radii)), 3)
    return 2.0 * least_in_rooms(x_rows, y_rows, radius_rows, places)
