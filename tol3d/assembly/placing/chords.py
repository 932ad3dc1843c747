"""Random floats: sweeps along chords of a room, and rays from its middle on which parts lie.

By Gibbs sampling: freedom by freedom a part is drawn anew along the chord of the room at its offsets, along directions
that a room rounded about its middle has as axes.
"""

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from tol3d.contact.programme import Programme
from tol3d.contact.seat import Place, taken
from tol3d.numerics.arrays import Array, times

STILL: Final = 1e-9
"""Change of all offsets per unit distance that counts as none."""


def way_along(place: Place, along: Array) -> Array:
    """Largest step along directions (freedoms, n) until an offset is as long as its clearance (n,); inf if none is."""
    way = np.full(along.shape[1], np.inf)
    for offsets, clearance, rows in zip(*place, strict=True):
        gone = [_along(row, along) for row in rows]
        square = gone[0] * gone[0] + gone[1] * gone[1]
        slope = offsets[0] * gone[0] + offsets[1] * gone[1]
        room = clearance * clearance - offsets[0] * offsets[0] - offsets[1] * offsets[1]
        root = np.sqrt(np.maximum(slope * slope + square * room, 0.0))  # |offset + t gone| = clearance
        away, moves = slope > 0.0, square > 0.0
        ahead = np.where(away, room, root - slope) / np.where(away, slope + root, np.where(moves, square, 1.0))
        way = np.where(moves, np.minimum(way, ahead), way)
    return way


def bolt_way(place: Place, bolt: Array, along: Array) -> Array:
    """Distance a part can go along directions until a bolt no longer fits (n,); inf where it moves nothing.

    It is the goal of a programme over the distance, and shifts and leans of the bolt.

    Args:
        place: at the ends of the bolt's holes.
        bolt: its change by shifts and leans of the bolt (places, 2, 4, n).
        along: directions (freedoms, n).
    """
    gone = np.stack([np.stack([_along(row, along) for row in rows]) for rows in place.rows])[:, :, None]
    fastest = np.abs(gone).max(axis=(0, 1, 2))
    moves, programme = fastest > STILL, Programme.of(len(bolt), 1 + bolt.shape[2], along.shape[1])
    fastest = np.where(moves, fastest, 1.0)
    rows = np.concatenate([gone / fastest, np.broadcast_to(bolt, (*bolt.shape[:3], along.shape[1]))], axis=2)
    farthest = np.eye(rows.shape[2])[:, :1]
    programme.solve(place.offsets, place.clearances, rows, goal=farthest, parts=1, asked=moves, rounds=1)
    fits = programme.slack > 0.0
    return np.where(moves, np.where(fits, programme.steps[0] / fastest, 0.0), np.inf)


def _along(row: Array, along: Array) -> Array:
    found = np.zeros(along.shape[1])
    for f, own in enumerate(along):
        found += row[f] * own
    return found


def ray(place: Place, axes: Array, uniforms: Array, way: Callable[[Place, Array], Array]) -> tuple[Array, Array]:
    """Directions of the freedoms, of length 1, in which parts lie from the middle (freedoms, n), and shares of the way.

    Args:
        place: in the middle of the room.
        axes: the freedoms in the order of a sweep (freedoms, freedoms).
        uniforms: sweep by sweep (sweeps * freedoms, n); NaN of the first: the last sweep states the ray.
        way: to the limit of the clearances, from a place along directions.
    """
    gone, limit = times(axes.T, 2.0 * uniforms[-len(axes) :] - 1.0), np.ones(uniforms.shape[1])
    drawn = np.flatnonzero(~np.isnan(uniforms[0]))
    its = Place(*(taken(own, drawn) for own in place))
    if len(drawn):  # a stated ray needs no sweeps
        gone[:, drawn] = swept(its, axes, uniforms[:, drawn], way)
    square = np.zeros(uniforms.shape[1])
    for own in gone:
        square += own * own
    length = np.sqrt(square)
    along = gone / np.where(length > 0.0, length, 1.0)
    if len(drawn):
        limit[drawn] = way(its, along[:, drawn])
    some = (length > 0.0) & (limit > 0.0)
    return along, np.where(some, np.minimum(length / np.where(some, limit, 1.0), 1.0), 0.0)


def swept(place: Place, axes: Array, uniforms: Array, way: Callable[[Place, Array], Array]) -> Array:
    """Steps from the middle (freedoms, n) after all sweeps; arguments as in `ray`."""
    gone, directions = np.zeros((len(axes), uniforms.shape[1])), conjugate(place, axes)
    for k, drawn in enumerate(uniforms):
        along = directions[k % len(axes)]
        back = way(place, -along)
        step = ((back + way(place, along)) * drawn - back) * along
        moved = np.stack([[_along(row, step) for row in rows] for rows in place.rows])
        gone, place = gone + step, place._replace(offsets=place.offsets + moved)
    return gone


def conjugate(place: Place, axes: Array) -> Sequence[Array]:
    """Directions of the freedoms (freedoms, n) that a room rounded about its middle has as axes.

    Each axis less its part along those before it, by the curvature of -log(c_k^2 - |o_k + B_k q|^2), summed.

    Args:
        place: in the middle of the room.
        axes: of the room (freedoms, freedoms).
    """
    trials, size = place.offsets.shape[2], len(axes)
    stiffness, found = np.zeros((size, size, trials)), list[Array]()
    with np.errstate(divide="ignore", invalid="ignore"):  # without room, which is not asked for
        for (a, b), clearance, (x, y) in zip(*place, strict=True):
            room = clearance * clearance - a * a - b * b
            out = [a * x[f] + b * y[f] for f in range(size)]
            for f in range(size):
                for g in range(size):
                    both = x[f] * x[g] + y[f] * y[g]
                    stiffness[f, g] += 2.0 * both / room + 4.0 * out[f] * out[g] / (room * room)
        for axis in axes:
            along = axis[:, None] * np.ones(trials)
            for other in found:
                along = along - other * _by_stiffness(other, stiffness, along)
            found.append(along / np.sqrt(_by_stiffness(along, stiffness, along)))
    return found


def _by_stiffness(left: Array, stiffness: Array, right: Array) -> Array:
    """Product (n,) of directions (freedoms, n), by (freedoms, freedoms, n)."""
    size = range(len(left))
    return np.asarray(sum(left[f] * sum(stiffness[f, g] * right[g] for g in size) for f in size))
