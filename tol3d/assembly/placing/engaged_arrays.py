"""Where pins, tabs, holes and slots engage in their trials: their offsets and clearances, and what kernels read."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Axis, Engage, Engagement
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size, total
from tol3d.assembly.placing.engaged_places import BOLT_IN_HOLE, PIN_IN_HOLE, PIN_IN_SLOT, TAB_IN_SLOT
from tol3d.assembly.placing.poses import column, dot
from tol3d.assembly.placing.world import World

Array = NDArray[np.float64]


def at_places(
    own: Engagement, inner: ActualFeature, outer: ActualFeature, columns: Array
) -> list[tuple[list[Array], Array]]:
    """Offsets (one or two) and clearance at each place (n,) or (1,)."""
    inside, outside = actual_size(inner.feature, columns), actual_size(outer.feature, columns)
    found = []
    if isinstance(inner.feature.shape, Axis):
        x, y = inner.pose.turn[:, 0], inner.pose.turn[:, 1]
        for place, its in zip(own.places, own.outer_places, strict=True):
            apart = outer.at(its) - inner.at(place)
            found.append(([dot(x, apart), dot(y, apart)], (inside - outside) / 2))
        return found
    along = dot(inner.direction, outer.direction)
    leaning = np.sqrt(np.maximum(1.0 - along * along, 0.0)) if isinstance(outer.feature.shape, Axis) else np.abs(along)
    for its in own.outer_places:
        apart = outer.at(its) - inner.origin
        found.append(([dot(inner.direction, apart)], (inside - outside * leaning) / 2))
    return found


def engaged_arrays(
    move: Engage, world: World, origin: Array, middle: Array
) -> tuple[Array, Array, Array, Array, Array, NDArray[np.bool_], NDArray[np.int64], NDArray[np.int64], Array]:
    """What `engaged_poses_found` reads first: points, directions and sizes where a move engages, in their trials.

    Args:
        move: which.
        world: before it.
        origin: the middle of all places in the part's frame (3,) [mm].
        middle: that in the world (3,) [mm].
    """
    moving, fixed, axes, others, halves, inner_moves, kinds = [], [], [], [], [], [], []
    none, bolt_of, bolts = np.zeros((3, 1)), list[int](), list[Array]()
    for own in move.engagements:
        if own.bolt is not None:
            half = (own.bolt.diameter + total(own.bolt.size_by, 1, world.columns)[0]) / 2
            for name, places in ((own.inner, own.places), (own.outer, own.outer_places)):
                moves = world.part_of(name) in world.bodies[move.part]
                hole = world.on_body(name, move.part) if moves else world.placed(name)
                for place in places:
                    moving.append(hole.at(place) - column(origin) if moves else none)
                    fixed.append(none if moves else hole.at(place) - column(middle))
                    axes.append((hole.pose.turn[:, 0], hole.pose.turn[:, 1]))
                    others.append(hole.pose.turn[:, 2])
                    halves.append([actual_size(hole.feature, world.columns) / 2, half])
                    inner_moves.append(moves)
                    kinds.append(BOLT_IN_HOLE)
                    bolt_of.append(len(bolts))
            at, turn = own.bolt.frame[:3, 3] - middle, own.bolt.frame[:3, :3]
            bolts.append(np.stack([at, turn[:, 0], turn[:, 1], turn[:, 2], np.array([own.bolt.reach, 0.0, 0.0])]))
            continue
        moves = world.part_of(own.inner) in world.bodies[move.part]
        inner, outer = (
            world.on_body(name, move.part) if own_moves else world.placed(name)
            for name, own_moves in ((own.inner, moves), (own.outer, not moves))
        )
        round_, pin = isinstance(inner.feature.shape, Axis), isinstance(outer.feature.shape, Axis)
        frame = inner.pose.turn
        for place, its in zip(own.places, own.outer_places, strict=True):
            points = inner.at(place) if round_ else inner.origin, outer.at(its)
            moving.append(points[0 if moves else 1] - column(origin))
            fixed.append(points[1 if moves else 0] - column(middle))
            axes.append((frame[:, 0], frame[:, 1]) if round_ else (inner.direction, none))
            others.append(none if round_ else outer.direction)
            halves.append([actual_size(each.feature, world.columns) / 2 for each in (inner, outer)])
            inner_moves.append(moves)
            kinds.append(PIN_IN_HOLE if round_ else PIN_IN_SLOT if pin else TAB_IN_SLOT)
            bolt_of.append(-1)
    return (
        _filled(moving, world.trials),
        _filled(fixed, world.trials),
        np.stack([_filled(own, world.trials) for own in axes]),
        _filled(others, world.trials),
        np.stack([_filled(own, world.trials) for own in halves]),
        np.array(inner_moves),
        np.array(kinds, dtype=np.int64),
        np.array(bolt_of, dtype=np.int64),
        np.array(bolts).reshape(-1, 5, 3),
    )


def _filled(arrays: Sequence[Array], trials: int) -> Array:
    """Arrays (..., n) or (..., 1) of all places, with a trial of its own each."""
    made = np.empty((len(arrays), *arrays[0].shape[:-1], trials))
    for own, target in zip(arrays, made, strict=True):
        target[...] = own
    return made
