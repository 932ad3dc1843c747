"""Positions in a datum frame on gauges, which take the best place in their common clearance.

The least growth of the ends' cones is that of the offsets at a pose. They are then read anew at that place,
until nothing moves.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tol3d.assembly.model import Measured
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.gauged_frames import MET, ROUNDS, GaugedFrame
from tol3d.assembly.placing.poses import IDENTITY, Pose, column, dot, full
from tol3d.assembly.placing.seen_motions import point_row
from tol3d.assembly.placing.world import World
from tol3d.contact.programme import SPARE, Programme, least_growth
from tol3d.numerics.arrays import Array, times


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
