"""Offsets and clearances at a part's engagements, and their changes with its pose, in kernels.

Poses are about the middle of all places: R p + t with p from the middle in the part, t from where that lies nominally.
"""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Axis, Engage, Engagement
from tol3d.assembly.placing.actual_feature import ActualFeature, mating_size, total
from tol3d.assembly.placing.one_sided_gaps import wrench
from tol3d.assembly.placing.poses import column, dot
from tol3d.assembly.placing.world import World
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import nested
from tol3d.numerics.loops import copy_matrix

PIN_IN_HOLE: Final = 0
PIN_IN_SLOT: Final = 1
TAB_IN_SLOT: Final = 2
BOLT_IN_HOLE: Final = 3
LEFT: Final = 1e-9
"""Part of a motion that relations may see: its effect on rows is of second order in the slack."""


@nested
def taken(pose: Any, moves: bool, vector: Any, i: int, found: Any) -> None:
    """A direction (3, n) in the world (3,): turned with the part if it is of the one that moves."""
    for r in range(3):
        found[r] = vector[r, i]
    if moves:
        for r in range(3):
            found[r] = pose[r, 0] * vector[0, i] + pose[r, 1] * vector[1, i] + pose[r, 2] * vector[2, i]


@nested
def places_at(pose: Any, engaged: Any, i: int, reach: float, place: Any, all_rows: Any, nominal: bool) -> None:
    """Offsets and clearances at a pose; if rows are not nominal, their changes with turn by reach and shift."""
    moving, fixed, axes, _, halves, inner_moves, kinds, _, _ = engaged
    offsets, clearances, _, (apart, arm, normal, _, _, _), _ = place
    for k in range(kinds.shape[0]):
        clearances[k] = halves[k, 0, i] - halves[k, 1, i]
        if kinds[k] == BOLT_IN_HOLE:
            bolt_in_hole(pose, engaged, k, i, reach, place, all_rows[k], nominal)
            continue
        sign = -1.0 if inner_moves[k] else 1.0  # an offset is of the outer one
        for r in range(3):
            turned = pose[r, 0] * moving[k, 0, i] + pose[r, 1] * moving[k, 1, i] + pose[r, 2] * moving[k, 2, i]
            apart[r] = sign * (turned + pose[r, 3] - fixed[k, r, i])
            arm[r] = fixed[k, r, i] - pose[r, 3] if inner_moves[k] else turned
        for c in range(2):
            offsets[k, c] = 0.0
            if c == 1 and kinds[k] != PIN_IN_HOLE:
                all_rows[k, c, :] = 0.0
                continue
            taken(pose, inner_moves[k], axes[k, c], i, normal)
            for r in range(3):
                offsets[k, c] += normal[r] * apart[r]
                normal[r] *= sign
            if not nominal:
                wrench(arm, normal, reach, all_rows[k, c])
        if kinds[k] != PIN_IN_HOLE:
            leaning(pose, engaged, k, i, reach, place, all_rows[k, 0])


@nested
def bolt_in_hole(
    pose: Any, engaged: Any, k: int, i: int, reach: float, place: Any, all_rows: Any, nominal: bool
) -> None:
    """The offset of a bolt's axis from that of a hole, across it where it passes the hole's end, and its changes.

    A bolt's axis passes base + h n + (p + h l / its reach) across n, h along its nominal direction n.
    """
    moving, fixed, axes, others, _, inner_moves, _, bolt_of, bolts = engaged
    offsets, _, rows, (apart, arm, normal, along, way, _), state = place
    b, first = bolt_of[k], rows.shape[2] - 4 * bolts.shape[0]
    taken(pose, inner_moves[k], others[k], i, along)
    height = 0.0
    for r in range(3):
        apart[r] = fixed[k, r, i]
        if inner_moves[k]:
            turned = pose[r, 0] * moving[k, 0, i] + pose[r, 1] * moving[k, 1, i] + pose[r, 2] * moving[k, 2, i]
            apart[r] = turned + pose[r, 3]
        height += bolts[b, 3, r] * (apart[r] - bolts[b, 0, r])
    share, lean = height / bolts[b, 4, 0], 0.0
    for r in range(3):
        across = bolts[b, 1, r] * (state[b, 0] + share * state[b, 2])
        across += bolts[b, 2, r] * (state[b, 1] + share * state[b, 3])
        point = bolts[b, 0, r] + height * bolts[b, 3, r] + across
        way[r] = bolts[b, 3, r] + (bolts[b, 1, r] * state[b, 2] + bolts[b, 2, r] * state[b, 3]) / bolts[b, 4, 0]
        apart[r], arm[r] = point - apart[r], point - pose[r, 3]
        lean += along[r] * way[r]
    for c in range(2):
        taken(pose, inner_moves[k], axes[k, c], i, normal)
        cut = (normal[0] * way[0] + normal[1] * way[1] + normal[2] * way[2]) / lean
        offsets[k, c], u, v = 0.0, 0.0, 0.0
        for r in range(3):
            normal[r] -= cut * along[r]
            offsets[k, c] += normal[r] * apart[r]
            u += normal[r] * bolts[b, 1, r]
            v += normal[r] * bolts[b, 2, r]
            normal[r] = -normal[r]
        if not nominal:
            j = first + 4 * b
            rows[k, c, j], rows[k, c, j + 1], rows[k, c, j + 2], rows[k, c, j + 3] = u, v, share * u, share * v
            all_rows[c, :] = 0.0
            if inner_moves[k]:
                wrench(arm, normal, reach, all_rows[c])


@nested
def leaning(pose: Any, engaged: Any, k: int, i: int, reach: float, place: Any, row: Any) -> None:
    """The clearance of a tilted body in a slot, and its change, which is added to the row of the near side.

    |o + B q| <= c + C q is on the side of o the same as |o + (B - C o / |o|) q| <= c.
    """
    _, _, axes, others, halves, inner_moves, kinds, _, _ = engaged
    offsets, clearances, _, (_, _, normal, other, _, _), _ = place
    taken(pose, inner_moves[k], axes[k, 0], i, normal)
    taken(pose, not inner_moves[k], others[k], i, other)
    along = normal[0] * other[0] + normal[1] * other[1] + normal[2] * other[2]
    if kinds[k] == PIN_IN_SLOT:
        share = np.sqrt(max(1.0 - along * along, 0.0))
        slope = -along / share if share > 0.0 else 0.0
    else:
        share, slope = abs(along), 1.0 if along > 0.0 else -1.0
    clearances[k] = halves[k, 0, i] - halves[k, 1, i] * share
    gain = -halves[k, 1, i] * slope / reach  # of the clearance by `along`
    if inner_moves[k] != (offsets[k, 0] < 0.0):
        gain = -gain
    for r in range(3):  # a turn w of the one that moves changes `along` by w . (other x normal), or by less that
        s, t = (r + 1) % 3, (r + 2) % 3
        row[r] -= gain * (other[s] * normal[t] - other[t] * normal[s])


@nested
def kept_tangents(pose: Any, kept: Any, i: int, steps: Any, reach: float, tangents: Any, rooms: Any) -> None:
    """Motions (6, freedoms) that keep the constraints, to LEFT; as `one_sided_gaps.tangents_at`."""
    vectors, normals, shifts, undo, _ = kept
    _, arm, normal, _, row, change = rooms
    copy_matrix(tangents, steps)
    largest, before = 0.0 if shifts.shape[0] == 0 else 1.0, np.inf
    while largest > LEFT and largest < before:
        before, largest = largest, 0.0
        for e in range(shifts.shape[0]):
            p, q = min(i, vectors.shape[2] - 1), min(i, normals.shape[2] - 1)
            for r in range(3):
                normal[r] = normals[e, r, q]
                arm[r] = pose[r, 0] * vectors[e, 0, p] + pose[r, 1] * vectors[e, 1, p] + pose[r, 2] * vectors[e, 2, p]
            wrench(arm, normal, reach, row)
            for f in range(steps.shape[1]):
                total = 0.0
                for r in range(3):
                    total += row[r] * tangents[r, f] + shifts[e] * row[3 + r] * tangents[3 + r, f]
                change[e, f] = total
                largest = max(largest, abs(total))
        for r in range(6):
            for f in range(steps.shape[1]):
                for e in range(shifts.shape[0]):
                    tangents[r, f] -= undo[r, e] * change[e, f]


@nested
def rows_here(
    pose: Any, trial: Any, reach: float, place: Any, all_rows: Any, tangents: Any, nominal: bool, turned: bool
) -> None:
    """Offsets, clearances and rows B of the motions that keep the constraints, at a pose.

    Args:
        pose, trial, reach, place, all_rows: of what; to work in.
        tangents: those motions (6, freedoms); changed where it has turned enough.
        nominal: whether rows and motions are as they are nominally.
        turned: whether it has.
    """
    engaged, i, kept, steps, nominal_rows = trial
    rows, parts = place[2], steps.shape[1]
    for k in range(rows.shape[0]):
        for c in range(2):
            for f in range(parts, rows.shape[2]):
                rows[k, c, f] = nominal_rows[k, c, f] if nominal else 0.0
    places_at(pose, engaged, i, reach, place, all_rows, nominal)
    if nominal:
        copy_matrix(tangents, steps)
    elif turned:
        kept_tangents(pose, kept, i, steps, reach, tangents, place[3])
    for k in range(rows.shape[0]):
        for c in range(2):
            for f in range(parts):
                rows[k, c, f] = nominal_rows[k, c, f] if nominal else 0.0
                if not nominal:
                    for r in range(6):
                        rows[k, c, f] += all_rows[k, c, r] * tangents[r, f]


def at_places(
    own: Engagement, inner: ActualFeature, outer: ActualFeature, columns: Array
) -> list[tuple[list[Array], Array]]:
    """Offsets (one or two) and clearance at each place (n,) or (1,)."""
    inside, outside = mating_size(inner.feature, columns), mating_size(outer.feature, columns)
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
    """First inputs of `engaged_poses_found`: points, directions and sizes of a move's engagements, by trial.

    Args:
        move: the move.
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
                    halves.append([mating_size(hole.feature, world.columns) / 2, half])
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
            halves.append([mating_size(each.feature, world.columns) / 2 for each in (inner, outer)])
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
    """Arrays (..., n) or (..., 1) of all places, stacked."""
    made = np.empty((len(arrays), *arrays[0].shape[:-1], trials))
    for own, target in zip(arrays, made, strict=True):
        target[...] = own
    return made
