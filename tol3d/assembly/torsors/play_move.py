"""Moves with play: freedoms left by relations, limited by the clearances of pins, tabs, holes and slots."""

from collections.abc import Sequence

import numpy as np

from tol3d.assembly.model import Bolt, Engage, Engagement, Floating, Mate
from tol3d.assembly.torsors.columns import without_rounding
from tol3d.assembly.torsors.gauges import counted
from tol3d.assembly.torsors.mate_move import freedoms_after
from tol3d.assembly.torsors.room import Room
from tol3d.assembly.torsors.torsor import cross_matrix, height_at, shift_at
from tol3d.assembly.torsors.world import World
from tol3d.numerics.arrays import Array

SEEN = 1e-6
"""Change of all offsets [mm] per unit freedom that counts as none."""


def engaged(move: Engage, world: World, whither: Array | None = None) -> World:
    """The world after a move with play.

    Args:
        move: the move.
        world: before it.
        whither: direction of its freedoms in which it is pushed to the limit; default by its float.

    Raises:
        InputError: as `mated`.
    """
    relations = freedoms_after(Mate(move.name, move.part, move.relations), world)
    left, rest = relations.left, relations.rest()
    before = world.with_part_at(move.part, rest)
    places = np.concatenate([_points(own, world) for own in move.engagements])
    middle = places.mean(axis=0)
    reach = max(float(np.linalg.norm(places - middle, axis=1).max()), 1.0)
    to_torsor = np.eye(6)  # shift of the middle and turn times reach -> torsor
    to_torsor[:3, 3:] = cross_matrix(middle) / reach
    to_torsor[3:, 3:] /= reach
    free = np.linalg.qr(np.linalg.solve(to_torsor, left))[0] if left.shape[1] else left
    offsets, clearances, ways = [], [], []
    bolt_of, bolt_rows, bolts = list[int](), list[Array](), 0
    for engagement in move.engagements:
        found = (
            _places(engagement, before, move.part)
            if engagement.bolt is None
            else _bolted(engagement, engagement.bolt, before, move.part)
        )
        for rows, values, clearance, own_bolt in found:
            ways.append(rows @ to_torsor)
            offsets.append(values)
            clearances.append(clearance)
            bolt_rows.append(own_bolt)
            bolt_of.append(-1 if engagement.bolt is None else bolts)
        bolts += engagement.bolt is not None
    whole = np.array(ways)
    _, strengths, right = np.linalg.svd((whole @ free).reshape(2 * len(whole), free.shape[1]))
    free = free @ right[: int(np.sum(strengths > SEEN))].T
    forms = without_rounding(np.concatenate([np.concatenate(offsets), np.array(clearances), _drawn(move, world)]))
    push = _push(move, world) @ to_torsor @ free if move.floating.kind == "toward" else np.zeros(free.shape[1])
    floating = move.floating if free.shape[1] else Floating("centred")  # held by its relations it floats nowhere
    if whither is not None and free.shape[1]:
        push, floating = whither, Floating("toward" if np.abs(whither).max() > SEEN else "centred")
    push = push / max(float(np.linalg.norm(push)), 1e-300)
    seen = np.concatenate([whole @ free, np.zeros((len(whole), 2, 4 * bolts))], axis=2)
    for row, own_bolt, number in zip(seen, bolt_rows, bolt_of, strict=True):
        if number >= 0:
            row[:, free.shape[1] + 4 * number : free.shape[1] + 4 * number + 4] = own_bolt
    push = np.concatenate([push, np.zeros(4 * bolts)])
    made = world.columns.made_by(Room(forms, seen, floating, free.T, push, tuple(bolt_of) if bolts else ()))
    torsor = rest + to_torsor @ free @ made[:-1]
    return before.with_part_at(move.part, torsor).with_slack(move.name, made[-1])


def _points(engagement: Engagement, world: World) -> Array:
    """Nominal points of engagement in the world (places, 3)."""
    frame, outer = world.frame(engagement.inner), world.frame(engagement.outer)
    points = engagement.places @ frame[:3, :3].T + frame[:3, 3]
    if engagement.bolt is None:
        return points
    return np.concatenate([points, engagement.outer_places @ outer[:3, :3].T + outer[:3, 3]])


def _bolted(engagement: Engagement, bolt: Bolt, world: World, part: str) -> Sequence[tuple[Array, Array, Array, Array]]:
    """As `_places`, of all ends of both holes of a bolt; last the rows (2, 4) of its two shifts and two leans.

    An offset is of the bolt from the hole.
    """
    found, radius = [], world.columns.zeros(1)[0]
    for contribution in bolt.size_by:
        radius[contribution.columns] += contribution.matrix[0] / 2.0
    for name, places in ((engagement.inner, engagement.places), (engagement.outer, engagement.outer_places)):
        frame, moves = world.frame(name), world.is_of_body(name, part)
        directions = frame[:3, :2].T
        spare = ((world.assembly.features[name].shape.nominal_size or 0.0) - bolt.diameter) / 2.0
        clearance = world.mating_size(name) / 2.0 - radius + world.columns.constants(np.array([spare]))[0]
        for place in places:
            point = frame[:3, :3] @ place + frame[:3, 3]
            at, height = directions @ shift_at(point), (point - bolt.frame[:3, 3]) @ bolt.frame[:3, 2]
            on_axis = bolt.frame[:3, 3] + height * bolt.frame[:3, 2]
            values = world.columns.constants(directions @ (on_axis - point)) - at @ world.placed(name)
            across = directions @ bolt.frame[:3, :2]
            its_rows = np.concatenate([across, height / bolt.reach * across], axis=1)
            found.append((-at if moves else np.zeros(at.shape), values, clearance, its_rows))
    return found


def _places(engagement: Engagement, world: World, part: str) -> Sequence[tuple[Array, Array, Array, Array]]:
    """Rows (2, 6) of the part's torsor, offsets (2, columns), clearance (columns,) of each place; none for a bolt."""
    frame, features = world.frame(engagement.inner), world.assembly.features
    directions = counted(frame, features[engagement.inner].shape)
    relative = world.placed(engagement.outer) - world.placed(engagement.inner)
    sign = 1.0 if world.is_of_body(engagement.outer, part) else -1.0
    inner, outer = (features[name].shape.nominal_size or 0.0 for name in (engagement.inner, engagement.outer))
    outer *= _leaning(engagement, world)
    clearance = (world.mating_size(engagement.inner) - world.mating_size(engagement.outer)) / 2.0
    clearance = clearance + world.columns.constants(np.array([(inner - outer) / 2.0]))[0]
    its_frame = world.frame(engagement.outer)
    found = []
    for point, place in zip(_points(engagement, world), engagement.outer_places, strict=True):
        at = directions @ shift_at(point)
        apart = its_frame[:3, :3] @ place + its_frame[:3, 3] - point
        values = at @ relative + world.columns.constants(directions @ apart)
        found.append((sign * at, values, clearance, np.zeros((2, 0))))
    return found


def _leaning(engagement: Engagement, world: World) -> float:
    """Factor of the inner feature's size in the width that it takes in a slot where it leans nominally; 1 in a hole."""
    inner, outer = (world.assembly.features[name].shape.located for name in (engagement.inner, engagement.outer))
    along = world.frame(engagement.inner)[:3, inner].T @ world.frame(engagement.outer)[:3, outer]
    return float(np.linalg.norm(along)) if len(along) == 1 else 1.0


def _push(move: Engage, world: World) -> Array:
    """Displacement of the part's point along the direction of a float, per torsor component (6,)."""
    assert move.floating.along is not None
    direction = world.turned(move.floating.along, world.part_of(move.floating.at))
    row: Array = height_at(world.origin(move.floating.at), direction)[0]
    return row


def _drawn(move: Engage, world: World) -> Array:
    """Draws of the float, unchanged (draws, columns)."""
    columns = range(move.floating.columns.start, move.floating.columns.stop)
    return np.eye(world.columns.count)[list(columns)]
