"""Positions in a datum frame on gauges, which take the best place in their common clearance.

A value w is reached where the room and cones |p_e + P_e q| <= w + r_e of the ends have a common q. Their largest common
slack is concave in w and grows with it: Newton's steps from below, by the share of the ends in its multipliers, never
pass the least w. Offsets are then read anew at that place, until nothing moves.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tol3d.assembly.model import Axis, Measured, RoundPlane
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.gauged_frames import MET, ROUNDS, GaugedFrame
from tol3d.assembly.placing.poses import IDENTITY, Pose, column, dot, full
from tol3d.assembly.placing.rooms import room_found
from tol3d.assembly.placing.seen_motions import point_row
from tol3d.assembly.placing.world import World
from tol3d.numerics.arrays import Array

STEPS: Final = 60
"""Newton steps at most; in practice 2 to 8."""
SHORT: Final = 1e-12
"""Step [mm] at which they are done."""
FREE: Final = 1e-9
"""Share of the ends below which the clearance alone decides: it is empty."""
UNSEEN: Final = 1e-6
"""Change of an end's offset per unit freedom that counts as none."""


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

    def least(self, offsets: Array, radii: Array, its: Array, room: Array) -> tuple[Array, Array]:
        """The least w (n,) [mm], NaN where the room is empty, and the steps to it (freedoms, n).

        Args:
            offsets: of the ends (ends, 2, n) [mm].
            radii: r_e (ends, n) [mm].
            its: offsets of the datum features (cones, 2, n) [mm].
            room: their clearances (cones, n) [mm].
        """
        ends, trials = len(offsets), offsets.shape[2]
        rows = np.ascontiguousarray(np.concatenate([self.rows, self.gauged.rows]))
        every = np.ascontiguousarray(np.concatenate([offsets, its]))
        clearances = np.concatenate([np.zeros((ends, trials)), room])
        still = np.abs(self.rows).max(axis=(1, 2)) < UNSEEN
        nearest = np.sqrt((offsets * offsets).sum(axis=1)) * still[:, None]
        least, steps, slacks = (nearest - radii).max(axis=0), np.zeros((rows.shape[2], trials)), np.zeros(trials)
        asked, found, deciding = np.ones(trials, bool), np.ones(trials, bool), np.zeros(trials, dtype=np.int64)
        before = np.zeros((len(rows), trials)), np.zeros((len(rows), trials), dtype=np.int64)
        for _ in range(STEPS):
            clearances[:ends] = radii + least
            room_found(every, clearances, rows, np.zeros(rows.shape[2]), asked, steps, slacks, deciding, found, *before)
            share = np.where(before[1][:ends] == 1, before[0][:ends], 0.0).sum(axis=0)
            short = np.where(slacks < 0.0, -slacks, 0.0)
            empty = asked & (~found | ((short > SHORT) & ~(share > FREE)))
            least = np.where(empty, np.nan, least)
            grown = short / np.where(share > FREE, share, 1.0)
            least = np.where(asked & ~empty, least + grown, least)
            asked = asked & ~empty & (grown > SHORT)
            if not asked.any():
                break
        return least, np.where(np.isfinite(least), steps, 0.0)


def inspected(measured: Measured, world: World) -> Inspected:
    """Nominal data of a position on gauges."""
    (name,) = measured.features
    gauged = world.own[world.part_of(name)].seats(measured.frame).gauged
    assert isinstance(gauged, GaugedFrame)
    feature = world.assembly.features[name]
    frame, shape = feature.frame, feature.shape
    assert not isinstance(shape, RoundPlane)  # across a round face nothing is located
    if measured.direction is not None:
        directions = np.linalg.svd(measured.direction[None])[2][1:]
    else:
        directions = frame[:3, :2].T if isinstance(shape, Axis) else frame[:3, 2:3].T
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
    pose, _ = gauged.as_kept(seats, full(IDENTITY, world.trials))
    least = np.full(world.trials, np.nan)
    for _ in range(ROUNDS):
        offsets = [
            its.offsets(pose, world.on_part(name), world.trials)
            for its, name in zip(each, measured.features, strict=True)
        ]
        least, steps = found.least(np.concatenate(offsets), radii, gauged.offsets(pose, features, world.trials), room)
        if np.abs(steps).max(initial=0.0) < MET:
            break
        pose, _ = gauged.as_kept(seats, gauged.moved(pose, steps))
    return 2.0 * least
