"""Where in its room a part lies that is not centred, in trials whose centred pose has slack: see model.Floating."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.torsors.centring import DECIDES, Cones, narrowed, refined
from tol3d.assembly.torsors.interior_points import climbed
from tol3d.assembly.torsors.ordered import ordered_product, ordered_sum
from tol3d.assembly.torsors.quick_centring import quickly_centred

Array = NDArray[np.float64]

HALVINGS: Final = 55
"""Of the height of a segment, 1 at first: rounding is reached."""
NONE: Final = 1e-9
"""Change of an offset by a freedom of length 1 that is none."""


def pushed(cones: Cones, q: Array, push: Array) -> Array:
    """As far along a direction of the freedoms (freedoms,) as the room goes; what that leaves open is centred."""
    trials = q.shape[1]
    rows = cones.rows[..., None] * np.ones(trials)
    counts = np.repeat((np.abs(cones.rows).max(axis=(1, 2)) > NONE)[:, None], trials, axis=1)
    primal = np.concatenate([cones.clearances[:, None], cones.at(q)], axis=1)
    dual = np.zeros(primal.shape)
    dual[:, 0] = 1.0 / counts.sum(axis=0)
    closed = np.zeros((len(q), len(q), trials))
    step, multipliers, goal = np.empty(q.shape), np.empty(counts.shape), push[:, None] * np.ones(trials)
    climbed(primal, dual, rows, counts, closed, goal, 0, step, multipliers)
    near = np.ones(trials, dtype=bool)
    offsets, clearances = np.ascontiguousarray(cones.at(q)), np.ascontiguousarray(cones.clearances)
    quickly_centred(offsets, clearances, rows, counts, closed, goal, 0, step, multipliers, near)
    decides = counts & (multipliers > DECIDES)
    everything = np.eye(len(q))[:, :, None] * np.ones(trials)
    return refined(cones, q + step, narrowed(everything, rows, decides), decides)


def along_rays(cones: Cones, q: Array, directions: Array, share: Array) -> Array:
    """From centred poses along directions (freedoms, trials), share^(1 / freedoms) of the way that the room has."""
    length = np.sqrt(ordered_sum(directions**2))
    moves = length > 0.0
    ray = directions / np.where(moves, length, 1.0)
    at = cones.at(q)
    gone = np.stack([ordered_product(cones.rows[:, r], ray) for r in (0, 1)], axis=1)
    # the larger root of |at + t gone|^2 = clearance^2
    a, half_b, c = (
        ordered_sum(one[:, r] * other[:, r] for r in (0, 1)) for one, other in ((gone, gone), (at, gone), (at, at))
    )
    bent = a > NONE**2
    root = np.sqrt(np.maximum(half_b**2 - a * (c - cones.clearances**2), 0.0))
    way = np.where(bent, (root - half_b) / np.where(bent, a, 1.0), np.inf).min(axis=0)
    way = np.where(moves & np.isfinite(way), np.maximum(way, 0.0), 0.0)
    inside = np.clip(share, 0.0, 1.0)  # slopes ask beyond its ends
    return q + inside ** (1.0 / len(q)) * way * ray


def by_pairs(cones: Cones, q: Array, drawn: Array) -> Array:
    """A pin anywhere in its hole (both its ends the first places), then the next anywhere in its slot.

    Args:
        cones: the limits.
        q: centred (freedoms, trials).
        drawn: points of the disc of radius 1: of both ends, or of the pin; then of -1 to 1 for the slot, where positive
            is against its normal.
    """
    both = len(drawn) - (len(cones.rows) > 2) == 4
    at = cones.at(q)
    if both:
        rows = cones.rows[:2].reshape(4, -1)
        missing = (cones.clearances[:2, None] * drawn[:4].reshape(2, 2, -1) - at[:2]).reshape(4, -1)
    else:
        rows = cones.rows[:2].mean(axis=0)
        missing = in_lens((at[0] - at[1]) / 2.0, cones.clearances[0], drawn[:2]) - (at[0] + at[1]) / 2.0
    inverse: Array = np.asarray(np.linalg.pinv(rows), dtype=np.float64)
    q = q + ordered_product(inverse, np.asarray(missing))
    if len(cones.rows) == 2:
        return q
    turn = np.linalg.svd(rows)[2][-1]
    if float(cones.rows[2, 0] @ turn) > 0.0:
        turn = -turn  # positive draws let the pin lie on the other side of its slot
    at, gain = cones.at(q)[2:, 0], cones.rows[2:, 0] @ turn
    ends = np.sort(np.stack([(sign * cones.clearances[2:] - at) / gain[:, None] for sign in (-1.0, 1.0)]), axis=0)
    low, high = ends[0].max(axis=0), ends[1].min(axis=0)
    return np.asarray(q + turn[:, None] * (low + (1.0 + drawn[-1]) / 2.0 * np.maximum(high - low, 0.0)))


def in_lens(off: Array, radius: Array, drawn: Array) -> Array:
    """Points of the lens of two discs (2, trials), from points of the disc of radius 1, areas kept.

    Args:
        off: from the middle of the lens to a centre (2, trials) [mm].
        radius: of both discs (trials,) [mm].
        drawn: (2, trials).
    """
    distance = np.hypot(off[0], off[1])
    apart = distance > 0.0
    axis = np.where(apart, off / np.where(apart, distance, 1.0), np.array([[1.0], [0.0]]))
    side = np.stack([-axis[1], axis[0]])
    along, aside = (ordered_sum(drawn * own) for own in (axis, side))
    start = np.minimum(distance / radius, 1.0)
    wanted = _beyond(np.abs(along)) * _beyond(start) / (np.pi / 2.0)
    low, high = start.copy(), np.ones(len(start))
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        deep = _beyond(middle) > wanted
        low, high = np.where(deep, middle, low), np.where(deep, high, middle)
    height = np.where(along == 0.0, start, (low + high) / 2.0)
    chords = [np.sqrt(np.maximum(1.0 - own**2, 0.0)) for own in (along, height)]
    across = aside * chords[1] / np.where(chords[0] > 0.0, chords[0], 1.0)
    return np.asarray(radius * (np.sign(along) * (height - start) * axis + across * side))


def _beyond(height: Array) -> Array:
    """Area of a disc of radius 1 beyond a height."""
    angle = np.arccos(np.minimum(height, 1.0))
    return np.asarray(angle - np.sin(angle) * np.cos(angle))
