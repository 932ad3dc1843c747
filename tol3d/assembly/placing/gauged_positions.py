"""Positions in a datum frame on gauges, which take the best place in their common clearance.

The least growth of the ends' cones is that of the offsets at a pose. They are then read anew at that place,
until nothing moves.

A pattern over a gauge that may shift and turn: offset of its worst hole at the best pose, trial by trial.

For each turn the shift is that of a common opening. The remaining function of the turn alone is the minimum of convex
ones, with a slope from the discs that decide.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tol3d.assembly.model import Measured
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.gauged_frames import MET, ROUNDS, GaugedFrame
from tol3d.assembly.placing.poses import IDENTITY, Pose, column, dot, full
from tol3d.assembly.placing.seen_motions import point_row
from tol3d.assembly.placing.world import World
from tol3d.contact.openings import LEAST, least_in_rooms, least_over_turns, opening
from tol3d.contact.programme import SPARE, Programme, least_growth
from tol3d.numerics.arrays import Array, Places, times


@dataclass(frozen=True, eq=False)
class Inspected:
    """A feature that is inspected on gauges.

    Args:
        gauged: the frame.
        directions: in which its ends count (1 or 2, 3).
        places: its ends nominally (ends, 3) [mm].
        rows: how they move with the freedoms of the part (ends, 2, freedoms).
    """

    gauged: GaugedFrame
    directions: Array
    places: Array
    rows: Array

    def offsets(self, pose: Pose, actual: ActualFeature, trials: int) -> Array:
        """Offsets of its ends from their true positions (ends, 2, n) [mm]."""
        found = np.zeros((len(self.places), 2, trials))
        for k, (end, place) in enumerate(zip(actual.moved(pose).ends, self.places, strict=True)):
            for r, direction in enumerate(self.directions):
                found[k, r] = dot(column(direction), end - column(place))
        return found


def inspected(measured: Measured, world: World) -> Inspected:
    """Nominal data of a position on gauges."""
    (name,) = measured.features
    gauged = world.own[world.part_of(name)].seats(measured.frame).gauged
    assert isinstance(gauged, GaugedFrame)
    feature = world.assembly.features[name]
    frame, shape = feature.frame, feature.shape
    if measured.direction is not None:
        directions = np.linalg.svd(measured.direction[None])[2][1:]
    else:
        directions = frame[:3, shape.located].T
    places = shape.ends @ frame[:3, :3].T + frame[:3, 3]
    rows = np.zeros((len(places), 2, gauged.freedoms.shape[1]))
    for k, place in enumerate(places):
        for r, direction in enumerate(directions):
            rows[k, r] = point_row(place - gauged.middle, direction, gauged.reach) @ gauged.motions
    return Inspected(gauged, directions, places, rows)


def on_gauges(measured: Measured, world: World, bonuses: Sequence[Array]) -> Array:
    """Twice the least by which any end lies off, over places of the gauges, less what its feature has (n,) [mm].

    NaN where the datums do not fit their gauges.

    Args:
        measured: features, in a frame of gauges.
        world: as it is read.
        bonuses: what each feature has, its zone too if that counts, (n,) or (1,).
    """
    each = [inspected(replace(measured, features=(name,)), world) for name in measured.features]
    found = replace(each[0], rows=np.concatenate([own.rows for own in each]))
    gauged, own = found.gauged, world.own[world.part_of(measured.features[0])]
    seats = own.seats(measured.frame).of(own.feature)
    features = [own.feature(room.feature) for room in gauged.gauges.rooms]
    room = gauged.clearances(features, world.columns)
    radii = np.concatenate(
        [np.broadcast_to(0.5 * has, (len(its.places), world.trials)) for its, has in zip(each, bonuses, strict=True)]
    )
    after = [own.feature(name) for name in gauged.later.features]
    pose, _ = gauged.as_kept(seats, full(IDENTITY, world.trials))
    left, every = gauged.later.left, np.ones(world.trials, dtype=bool)
    least, going = np.full(world.trials, np.nan), every
    for _ in range(ROUNDS):
        ends = np.concatenate(
            [
                its.offsets(pose, world.on_part(name), world.trials)
                for its, name in zip(each, measured.features, strict=True)
            ]
        )
        offsets = gauged.offsets(pose, features, world.trials)
        centred = Programme.of(len(room), gauged.rows.shape[2], world.trials)
        if after:
            centred.solve(offsets, room, gauged.rows[..., None])
        steps = gauged.later.nearest(pose, after, offsets, room, gauged.rows, every)
        rows, spare = np.concatenate([found.rows, gauged.rows]), np.concatenate([radii, room + len(after) * SPARE])
        offsets = np.concatenate([ends, offsets]) + times(rows, steps)
        grown, some, empty = least_growth(offsets, spare, rows @ left, len(ends))
        fits = ~empty & (centred.slack >= 0.0)
        steps, least = steps + times(left, some), np.where(going, np.where(fits, grown, np.nan), least)
        going = going & (np.abs(steps).max(axis=0, initial=0.0) >= MET)
        if not going.any():
            break
        moved, _ = gauged.as_kept(seats, gauged.moved(pose, steps))
        pose = Pose(np.where(going, moved.turn, pose.turn), np.where(going, moved.shift, pose.shift))
    return 2.0 * least


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
            dot(column(own), end - column(feature.feature.frame[:3, :3] @ place + feature.feature.frame[:3, 3]))
            for feature in features
            for end, place in zip(feature.ends, _ends(feature), strict=True)
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
