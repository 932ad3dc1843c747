"""A set of features against their nominal places, which lie as a datum frame has them or find their best place.

That place is where the largest distance is least: cones of a common slack over the freedoms of the set, whose steps
are made as finite motions until nothing moves.
"""

from collections.abc import Iterator
from operator import mul
from typing import Final

import numpy as np

from tol3d.assembly.model import Feature, Measured
from tol3d.assembly.placing.actual_feature import actual_size
from tol3d.assembly.placing.gauged_frames import MET, ROUNDS
from tol3d.assembly.placing.measuring import bonuses
from tol3d.assembly.placing.nominal_constraints import held_by_datums
from tol3d.assembly.placing.poses import Pose, column, dot, full, moved_about
from tol3d.assembly.placing.seen_motions import point_row
from tol3d.assembly.placing.world import World
from tol3d.contact.programme import Programme
from tol3d.numerics.arrays import Array, times

RIM: Final = 24
"""Places around a disc where it is judged: a tilt is read low by 1 - cos(pi / 24), 0.9 %, at most."""
SEEN: Final = 1e-6
"""Change of all offsets by a freedom of length 1 [mm] that is none."""


def judged(feature: Feature) -> tuple[Array, Array]:
    """Places where a feature is judged (places, 3), in its frame [mm], and the directions (directions, 3)."""
    return feature.shape.edge(2.0 * np.pi * np.arange(RIM) / RIM), np.eye(3)[feature.shape.located]


def inspected_set(measured: Measured, world: World) -> Array:
    """Twice the largest distance, with the offset of a surface by its size, at the place that is asked (n,) [mm]."""
    part = world.part_of(measured.features[0])
    start = full(world.own[part].displacement(measured.frame).inverse, world.trials)
    radii = np.array(list(_radii(measured, world, start)))
    if measured.gauge != "oriented":
        return _largest(_offsets(measured, world, start), radii)
    rows, middle, motions, shifts = _freedoms(measured, world)
    by_shift, at = _least(measured, world, start, (radii, rows[..., :shifts], middle, motions[:, :shifts]))
    if shifts == motions.shape[1]:
        return by_shift
    found = [_least(measured, world, own, (radii, rows, middle, motions))[0] for own in (start, at)]
    return np.minimum(by_shift, np.minimum(*found))  # far turned a place may be the least about it, and not of all


def _largest(offsets: Array, radii: Array) -> Array:
    return 2.0 * np.asarray((np.sqrt((offsets * offsets).sum(axis=1)) - radii).max(axis=0))


def _least(measured: Measured, world: World, pose: Pose, seen: tuple[Array, Array, Array, Array]) -> tuple[Array, Pose]:
    """The least value (n,) [mm] over motions from a pose, and where it is.

    Args:
        measured, world: what, and as it is read.
        pose: where to start.
        seen: radii (places, n), rows (places, 2, freedoms), the middle (3,), motions (6, freedoms).
    """
    radii, rows, middle, motions = seen
    programme, asked = Programme.of(len(rows), motions.shape[1], world.trials), np.ones(world.trials, bool)
    offsets = _offsets(measured, world, pose)
    least = _largest(offsets, radii)
    for _ in range(ROUNDS):
        programme.solve(offsets, radii, rows[..., None], asked=asked)
        motion = times(motions, np.where(asked & programme.found, programme.steps, 0.0))
        moved = moved_about(pose, middle, motion[:3], motion[3:])
        offsets = _offsets(measured, world, moved)
        value = _largest(offsets, radii)
        asked = asked & (value < least - MET)
        pose = Pose(np.where(asked, moved.turn, pose.turn), np.where(asked, moved.shift, pose.shift))
        least = np.minimum(least, value)
        if not asked.any():
            break
    return least, pose


def _offsets(measured: Measured, world: World, pose: Pose) -> Array:
    """Offset of every place from the middle of its zone (places, 3 or 2, n) [mm], with the part at a pose."""
    found: list[Array] = []
    for name in measured.features:
        feature, actual = world.assembly.features[name], world.on_part(name).moved(pose)
        places, directions = judged(feature)
        turn, at = feature.frame[:3, :3], feature.frame[:3, 3]
        for place in places:
            aside = actual.at(place) - column(turn @ place + at)
            vector = np.zeros((3 if measured.gauge != "oriented" else 2, world.trials))
            for r, direction in enumerate(directions @ turn.T):
                vector[r] = dot(column(direction), aside)
            if feature.shape.surface == "plane":
                vector[0] -= measured.middle
            found.append(vector)
        if measured.surfaces:
            ends = found[-len(places) :]
            found[-len(places) :] = [sum(map(mul, own, ends)) for own in feature.shape.surface_by_axis]
    return np.array(found)


def _radii(measured: Measured, world: World, pose: Pose) -> Iterator[Array]:
    """Allowance of each place (n,) [mm]: half of a bonus, or the offset of its surface, as less than 0."""
    each = bonuses(measured, world) if measured.bonuses else [np.zeros(1)] * len(measured.features)
    for name, bonus in zip(measured.features, each, strict=True):
        feature = world.assembly.features[name]
        own = np.zeros(world.trials) + 0.5 * bonus
        if measured.surfaces and (by := feature.shape.outward_by) is not None:
            z, nominal = column(feature.frame[:3, 2]), column(feature.frame[:3, 3])
            shift = dot(z, world.on_part(name).moved(pose).origin - nominal)
            larger = actual_size(feature, world.columns) - (feature.shape.nominal_size or 0.0)
            own = own - np.abs(by[0] * shift + by[1] * larger - measured.middle)
        yield from [own] * len(judged(feature)[0])


def _freedoms(measured: Measured, world: World) -> tuple[Array, Array, Array, int]:
    """Change of each place by the freedoms (places, 2, freedoms), the set's middle (3,), and motions (6, freedoms).

    Of the freedoms so many as are told last are shifts, and come first.
    """
    features = [world.assembly.features[name] for name in measured.features]
    places = [own.frame[:3, :3] @ place + own.frame[:3, 3] for own in features for place in judged(own)[0]]
    middle = np.mean(places, axis=0)
    reach = max(1.0, float(np.linalg.norm(np.subtract(places, middle), axis=1).max()))
    ways, k = np.zeros((len(places), 2, 6)), 0
    for feature in features:
        its_places, directions = judged(feature)
        for _ in its_places:
            for r, direction in enumerate(directions @ feature.frame[:3, :3].T):
                ways[k, r] = point_row(places[k] - middle, direction, reach)
            k += 1
    turns = np.eye(3)
    if measured.frame:
        part = world.assembly.part[features[0].part]
        frame = next(datum_frame for datum_frame in part.datum_frames if datum_frame.name == measured.frame)
        turns = held_by_datums(world.assembly, frame).left.turns.T
    shifts = _seen(ways[..., :3])
    by_shift, by_turn = (ways[..., :3] @ shifts).reshape(-1, shifts.shape[1]), ways[..., 3:] @ turns
    beside = by_turn.reshape(len(by_shift), turns.shape[1])
    beside = beside - by_shift @ np.linalg.lstsq(by_shift, beside, rcond=None)[0]
    turns = turns @ _seen(beside)
    motions = np.zeros((6, shifts.shape[1] + turns.shape[1]))
    motions[:3, : shifts.shape[1]], motions[3:, shifts.shape[1] :] = shifts, turns
    scale = np.array([1.0, 1.0, 1.0, reach, reach, reach])[:, None]
    return ways @ motions, middle, motions / scale, shifts.shape[1]


def _seen(ways: Array) -> Array:
    """Orthonormal directions (freedoms, seen) of freedoms by which places move (.., freedoms)."""
    _, sizes, right = np.linalg.svd(ways.reshape(int(np.prod(ways.shape[:-1])), ways.shape[-1]))
    return np.asarray(right[: int(np.sum(sizes > SEEN))].T)
