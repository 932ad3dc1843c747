"""A pattern over a gauge that may shift and turn: offset of its worst hole at the best pose, trial by trial.

For each turn the shift is that of a common opening. The remaining function of the turn alone is the minimum of convex
ones, with a slope from the discs that decide: turns are bracketed by the signs of slopes, and the next one is in
alternation where the slope would vanish if it were linear, and where the tangents at both ends meet. The programme of
contact/ would do the same by a kernel that takes nine times as long to compile as that of common openings.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.assembly.model import Axis, Measured
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.common_opening import opening
from tol3d.assembly.placing.poses import Pose, column, dot
from tol3d.assembly.placing.world import World
from tol3d.numerics.arrays import Array, Places

MET: Final = 1e-12
"""mm; largest gap below the tangents of both ends of the bracket at the end, and of circles without a common point."""
BEYOND: Final = 1e-3
"""Share of a bracket by which a turn goes beyond the one that is hoped for, so that its nearer end moves as well."""
LEAST: Final = 1e-16
"""Width of a bracket at the end [rad]."""
WIDEST: Final = 0.5
"""Limit of the search for a bracket [rad]."""
TURNS: Final = 200
"""In practice 10 to 30, of the trial that takes the most."""


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
        """Turns of the gauge, the least violation there, and its slope (3, trials).

        Those that decide pull the point with weights that balance; each violation grows as its centre moves away.
        """
        square = turn * turn
        tangent = turn * (1.0 + square / 3.0 * (1.0 + 0.4 * square))  # its series, short of turn^7 / 19
        p, q = self.nominal.T[..., None] / np.sqrt(1.0 + tangent * tangent)
        x, y = p - tangent * q, tangent * p + q
        found = opening(self.x[:, trials] - x, self.y[:, trials] - y, self.radii[:, trials])
        own, its = (np.take_along_axis(each, found.deciding, axis=0) for each in (x, y))
        slopes = found.weights * (found.pulls[1] * own - found.pulls[0] * its)
        return np.stack([turn, found.outside, slopes[0] + slopes[1] + slopes[2]])

    def least(self) -> Array:
        """Largest distance outside its disc of any place, over the best shift and turn (n,) [mm]."""
        off = np.maximum(np.abs(self.x - self.nominal[:, :1]), np.abs(self.y - self.nominal[:, 1:])).max(axis=0)
        step = 0.25 * off / (np.sqrt((self.nominal**2).sum(axis=1)).max() or 1.0) + LEAST
        first = self.turned(np.arange(len(step)), 0.0 * step)
        least, going = first[1], np.flatnonzero(first[2])
        near = first[:, going]
        far = self.turned(going, -np.sign(near[2]) * step[going])
        while (ahead := (far[2] * near[2] > 0.0) & (np.abs(far[0]) < WIDEST)).any():
            near[:, ahead] = far[:, ahead]
            far[:, ahead] = self.turned(going[ahead], 2.0 * far[0, ahead])
        least[going] = np.minimum(least[going], np.minimum(near[1], far[1]))
        for k in range(TURNS):
            width, bend = far[0] - near[0], near[2] - far[2]
            meet = (far[1] - near[1] - far[2] * width) / np.where(bend != 0.0, bend, 1.0)  # from `near`
            on = (far[2] * near[2] < 0.0) & (np.abs(width) > LEAST) & (near[1] + near[2] * meet < least[going] - MET)
            going, near, far = going[on], near[:, on], far[:, on]
            if not len(going):
                break
            share = meet[on] / width[on] if k % 2 else near[2] / bend[on]
            share = np.where((share > 0.0) & (share < 1.0), share, 0.5)
            share += np.where(share < 0.5, BEYOND, -BEYOND)
            middle = self.turned(going, near[0] + share * width[on])
            least[going] = np.minimum(least[going], middle[1])
            follows = middle[2] * near[2] > 0.0
            near, far = np.where(follows, middle, near), np.where(follows, far, middle)
        return np.asarray(least)


STEPS: Final = 100
"""In practice 1 to 6."""
FREE: Final = 1e-12
"""Weight of places below which the clearance alone decides: it is empty."""


def least_in_rooms(x: Array, y: Array, radii: Array, places: int) -> Array:
    """The least growth of circles about places at which all circles have a common point (n,) [mm]; NaN if none has.

    Args:
        x, y: centres, of the places, then of the clearances (circles, n) [mm].
        radii: of the places without growth, of either sign, then of the clearances (circles, n) [mm].
        places: number of places among them.
    """
    least, going = opening(x[:places], y[:places], radii[:places]).outside, np.arange(x.shape[1])
    for _ in range(STEPS):
        wider = radii[:, going]
        wider[:places] += least[going]
        found = opening(x[:, going], y[:, going], wider)
        weight = np.where(found.deciding < places, found.weights, 0.0).sum(axis=0)
        missing, grows = found.outside > MET, weight > FREE
        least[going[missing]] += np.where(grows, found.outside / np.where(grows, weight, 1.0), np.nan)[missing]
        going = going[missing & grows]
        if not len(going):
            return least
    least[going] = np.nan
    return least


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
    x_rows, y_rows, radius_rows = np.split(np.stack(np.broadcast_arrays(*x, *y, *radii)), 3)
    return 2.0 * least_in_rooms(x_rows, y_rows, radius_rows, places)
