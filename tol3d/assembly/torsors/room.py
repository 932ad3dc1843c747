"""Position of a body with play within its clearance, as a term: a part on its pins, or gauges of a datum frame.

A place k asks |b_k + B_k q| <= c_k - s. The largest s of freedoms q, the farthest q along a direction, and what they
leave open are convex programmes, see contact/.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Floating
from tol3d.assembly.torsors.terms import Form
from tol3d.assembly.torsors.torsor import ordered_product, ordered_sum
from tol3d.contact.programme import Programme
from tol3d.numerics.arrays import Array

HALVINGS: Final = 55
"""Halvings of the height of a segment, 1 at first: rounding is reached."""
SOME: Final = 1e-4
"""Share of a shift or turn of length 1 that freedoms let it have, and counts as some."""
NONE: Final = 1e-9
"""Change of an offset per unit freedom that counts as none."""


@dataclass(frozen=True, eq=False)
class Cones:
    """Limits of the freedoms, in some trials.

    Args:
        offsets: b (places, 2, trials) [mm].
        clearances: c (places, trials) [mm].
        rows: B (places, 2, freedoms), of all trials.
        bolt_of: bolt held at each place, -1 for none; empty if there are no bolts. The last freedoms are four of each
            bolt, centred as long as the others are.
    """

    offsets: Array
    clearances: Array
    rows: Array
    bolt_of: tuple[int, ...] = ()

    @property
    def bolts(self) -> int:
        """Their number."""
        return max(self.bolt_of, default=-1) + 1

    @property
    def parts(self) -> int:
        """Number of the part's own freedoms."""
        return int(self.rows.shape[2]) - 4 * self.bolts

    def of(self, trials: NDArray[np.bool_]) -> "Cones":
        """Those of some of the trials."""
        return Cones(self.offsets[:, :, trials], self.clearances[:, trials], self.rows, self.bolt_of)

    def at(self, q: Array) -> Array:
        """Offsets (places, 2, trials) after freedoms (freedoms, trials)."""
        return self.offsets + changes(self.rows, q)

    def solved(self, push: Array | None = None) -> Programme:
        """Freedoms of the largest least slack, then of the largest least of the rest, and so on.

        Pushed where there is slack: as far along a direction of the freedoms (freedoms,) as it goes, the rest centred.
        """
        places, _, freedoms = self.rows.shape
        programme, goal = Programme.of(places, freedoms, self.offsets.shape[2]), None if push is None else push[:, None]
        programme.solve(self.offsets, self.clearances, self.rows[..., None], goal=goal, parts=self.parts)
        return programme


def changes(rows: Array, steps: Array) -> Array:
    """Change of offsets (places, 2, trials) by rows (places, 2, freedoms) and steps (freedoms, trials)."""
    return np.stack([ordered_product(rows[:, r], steps) for r in (0, 1)], axis=1)


def least_slack(offsets: Array, clearances: Array) -> Array:
    """That of offsets (places, 2, trials) in clearances (places, trials), in each trial [mm]."""
    return np.asarray((clearances - np.sqrt(offsets[:, 0] ** 2 + offsets[:, 1] ** 2)).min(axis=0))


def anywhere(cones: Cones, q: Array, floating: Floating, directions: Array, drawn: Array) -> Array:
    """Anywhere in the room, from centred poses, by the sweeps of a random float.

    Args:
        cones: the limits.
        q: centred (freedoms, trials).
        floating: the float.
        directions: of the part's freedoms as a shift and a turn (freedoms, 6).
        drawn: (7, trials).
    """
    parts, at = cones.parts, cones.at(q)
    order = [k for k in range(6) if _rank(directions[:, : k + 1]) > _rank(directions[:, :k])]
    basis, corner = np.linalg.qr(directions[:, order])
    axes = basis * np.sign(np.diagonal(corner))
    uniforms = floating.sweeps(drawn, order, cones.bolts)
    stated = np.isnan(uniforms[0])
    gone = ordered_product(axes, 2.0 * uniforms[-parts:] - 1.0)
    if not stated.all():
        gone[:, ~stated] = _swept(cones.of(~stated), at[:, :, ~stated], axes, uniforms[:, ~stated])
    length = np.sqrt(ordered_sum(gone**2))
    moves = length > 0.0
    ray = gone / np.where(moves, length, 1.0)
    way = _way(cones, at, ray)
    moved = q.copy()
    moved[:parts] = q[:parts] + np.where(moves, np.minimum(np.where(stated, length * way, length), way), 0.0) * ray
    return moved


def _rank(directions: Array) -> int:
    return int(np.linalg.matrix_rank(directions, SOME)) if directions.size else 0


def _swept(cones: Cones, at: Array, axes: Array, uniforms: Array) -> Array:
    """Steps (freedoms, trials) from offsets of centred poses after all sweeps.

    A sweep goes along directions conjugate in the curvature of -log(c^2 - |o|^2), summed over all places, which rounds
    the room.
    """
    parts = cones.parts
    rows = cones.rows[:, :, :parts]
    room = cones.clearances**2 - ordered_sum(at[:, r] ** 2 for r in (0, 1))
    out = ordered_sum(rows[:, r, :, None] * at[:, r, None] for r in (0, 1))
    curvature = [
        [
            ordered_sum(
                2.0 * float(rows[k, :, i] @ rows[k, :, j]) / room[k] + 4.0 * out[k, i] * out[k, j] / room[k] ** 2
                for k in range(len(rows))
            )
            for j in range(parts)
        ]
        for i in range(parts)
    ]

    def product(one: Array, other: Array) -> Array:
        return ordered_sum(one[i] * curvature[i][j] * other[j] for i in range(parts) for j in range(parts))

    ways = list[Array]()
    for axis in axes.T:
        own = axis[:, None] * np.ones(at.shape[2])
        for before in ways:
            own = own - product(before, own) * before
        ways.append(own / np.sqrt(product(own, own)))
    gone = np.zeros((parts, at.shape[2]))
    for k, share in enumerate(uniforms):
        along = ways[k % parts]
        back, ahead = _way(cones, at, -along), _way(cones, at, along)
        step = (share * (back + ahead) - back) * along
        gone, at = gone + step, at + changes(rows, step)
    return gone


def _way(cones: Cones, at: Array, along: Array) -> Array:
    """Distance from offsets along directions (freedoms, trials) up to where the room ends (trials,)."""
    gone = changes(cones.rows[:, :, : cones.parts], along)
    held = np.array(cones.bolt_of or (-1,) * len(at)) < 0
    # the larger root of |at + t gone|^2 = clearance^2
    a, half_b, c = (
        ordered_sum(one[:, r] * other[:, r] for r in (0, 1)) for one, other in ((gone, gone), (at, gone), (at, at))
    )
    bent = a > (NONE * ordered_sum(along**2) ** 0.5) ** 2
    root = np.sqrt(np.maximum(half_b**2 - a * (c - cones.clearances**2), 0.0))
    way = np.where(bent, (root - half_b) / np.where(bent, a, 1.0), np.inf)[held].min(axis=0, initial=np.inf)
    for bolt in range(cones.bolts):
        way = np.minimum(way, _bolt_way(cones, bolt, at, gone))
    return np.where(np.isinf(way), 0.0, np.maximum(way, 0.0))


def _bolt_way(cones: Cones, bolt: int, at: Array, gone: Array) -> Array:
    """Distance along rays up to which a bolt fits both its holes (trials,), inf if nothing stops it.

    A programme of that distance and of the bolt's own four freedoms.
    """
    own = np.flatnonzero(np.array(cones.bolt_of) == bolt)
    first, trials = cones.parts + 4 * bolt, at.shape[2]
    speed = np.sqrt((gone[own] ** 2).sum(axis=1)).max(axis=0)
    moves = speed > NONE
    speed = np.where(moves, speed, 1.0)
    its = np.repeat(cones.rows[own][:, :, first : first + 4, None], trials, axis=3)
    rows = np.concatenate([gone[own][:, :, None] / speed, its], axis=2)
    programme, ahead = Programme.of(len(own), 5, trials), np.eye(5)[:, :1]
    programme.solve(at[own], cones.clearances[own], rows, goal=ahead, parts=1, asked=moves, rounds=1)
    return np.where(moves, np.where(programme.slack <= 0.0, 0.0, programme.steps[0] / speed), np.inf)


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


@dataclass(frozen=True, eq=False)
class Room:
    """The freedoms of a part with play, and its slack, trial by trial.

    Args:
        forms: offsets (places * 2), clearances (places), then what is drawn of the float.
        rows: change of the offsets by the freedoms (places, 2, freedoms).
        floating: its position within the clearance.
        directions: of what is drawn as a shift and a turn, the freedoms (freedoms, 6).
        push: direction in which it is pushed to the limit (freedoms,); 0 for none.
        bolt_of: see Cones; the freedoms of bolts come after the part's.
    """

    forms: Array
    rows: Array
    floating: Floating
    directions: Array
    push: Array
    bolt_of: tuple[int, ...] = ()
    form: Form = "place in a room"

    @property
    def count(self) -> int:
        """Freedoms of the part, and the slack."""
        return len(self.directions) + 1

    def values(self, read: Array) -> Array:
        """(freedoms + 1, trials) [mm]."""
        offsets, clearances, drawn = np.split(read, np.cumsum([2 * len(self.rows), len(self.rows)]))
        cones = Cones(offsets.reshape(-1, 2, read.shape[1]), clearances, self.rows, self.bolt_of)
        if not self.rows.shape[2]:  # held by relations: at its one pose
            return least_slack(cones.offsets, clearances)[None]
        programme = cones.solved(self.push if self.floating.kind == "toward" else None)
        q, inside = programme.steps, programme.slack > 0.0
        if inside.any() and self.floating.kind == "random":
            own = cones.of(inside)
            if self.floating.by_pairs:
                q[:, inside] = by_pairs(own, q[:, inside], drawn[:, inside])
            else:
                q[:, inside] = anywhere(own, q[:, inside], self.floating, self.directions, drawn[:, inside])
        return np.concatenate([q[: len(self.directions)], programme.slack[None]])
