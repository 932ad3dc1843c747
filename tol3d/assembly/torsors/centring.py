"""Position of a part with play within its clearance: freedoms of many trials at once, by second-order cone programmes.

A place k asks |b_k + B_k q| <= c_k - s. The largest s is found by primal and dual interior points along scaled
directions; then the places that decide it, by their multipliers, keep their offsets, and the remaining freedoms are
searched for the largest s of the others, and so on.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.torsors.interior_points import climbed
from tol3d.assembly.torsors.quick_centring import quickly_centred
from tol3d.assembly.torsors.torsor import ordered_sum
from tol3d.numerics.arrays import Array

Mask = NDArray[np.bool_]

DECIDES: Final = 1e-6
"""Least multiplier, of 1 in all, of a place that decides."""
LOST: Final = 1e-6
"""Length of a row below which it depends on no freedom."""


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
    def freedoms(self) -> int:
        """Number of freedoms."""
        return int(self.rows.shape[2])

    @property
    def parts(self) -> int:
        """Number of the part's own freedoms."""
        return self.freedoms - 4 * (max(self.bolt_of, default=-1) + 1)

    def of(self, trials: Mask | NDArray[np.intp]) -> "Cones":
        """Those of some of the trials."""
        return Cones(self.offsets[:, :, trials], self.clearances[:, trials], self.rows, self.bolt_of)

    def at(self, q: Array) -> Array:
        """Offsets (places, 2, trials) after freedoms (freedoms, trials)."""
        return self.offsets + _times(self.rows[..., None], q)

    def slack(self, q: Array) -> Array:
        """The least of all places (trials,) [mm]."""
        own = self.at(q)
        return np.asarray((self.clearances - np.sqrt(own[:, 0] ** 2 + own[:, 1] ** 2)).min(axis=0))


def centred(cones: Cones) -> Array:
    """The freedoms (freedoms, trials) of the largest least slack, then of the largest least of the rest, and so on."""
    count, trials = cones.freedoms, cones.offsets.shape[2]
    everything = np.eye(count)[:, :, None] * np.ones(trials)
    return refined(cones, np.zeros((count, trials)), everything, np.zeros(cones.clearances.shape, dtype=bool))


def refined(cones: Cones, q: Array, free: Array, decided: Mask) -> Array:
    """Centre what is open.

    Args:
        cones: the limits.
        q: from where (freedoms, trials).
        free: projectors to what is open (freedoms, freedoms, trials).
        decided: places whose offsets stay (places, trials).
    """
    q, free, decided = q.copy(), free.copy(), decided.copy()
    going = np.arange(q.shape[1])
    for _ in range(cones.freedoms):
        own, rows = Cones(cones.offsets[:, :, going], cones.clearances[:, going], cones.rows), _open(cones, free, going)
        closed = np.eye(len(free))[:, :, None] - free
        sees = (np.abs(rows).max(axis=(1, 2)) > LOST) & ~decided[:, going]
        any_left = sees.any(axis=0)
        if cones.bolt_of and cones.parts:  # of a part that is held, bolts alone are centred
            any_left &= np.abs(free[: cones.parts, :, going]).max(axis=(0, 1)) > LOST
        going, own, rows, sees = going[any_left], own.of(any_left), rows[..., any_left], sees[:, any_left]
        if not len(going):
            break
        offsets = own.at(q[:, going])
        step, multipliers = largest_slack(offsets, own.clearances, rows, sees, closed[..., going])
        q[:, going] += ordered_sum(free[:, i, going] * step[i] for i in range(len(step)))
        decides = sees & (multipliers > DECIDES)
        decided[:, going] |= decides
        free[:, :, going] = narrowed(free[:, :, going], rows, decides)
    return q


def _open(cones: Cones, free: Array, going: NDArray[np.intp]) -> Array:
    """Rows (places, 2, freedoms, trials) of what is open."""
    own = free[:, :, going]
    count = range(len(own))
    return np.stack([ordered_sum(cones.rows[:, :, j, None] * own[j, i] for j in count) for i in count], axis=2)


def narrowed(free: Array, rows: Array, held: Mask) -> Array:
    """Projectors less what held places take.

    Args:
        free: (freedoms, freedoms, trials).
        rows: of the places in what is open (places, 2, freedoms, trials).
        held: which places (places, trials).
    """
    free, taken = free.copy(), list[Array]()
    for place in range(len(rows)):
        for row in rows[place]:
            left = row * held[place]
            for _ in (1, 2):
                for own in taken:
                    left = left - ordered_sum(own * left) * own
            size = np.sqrt(ordered_sum(left**2))
            own = np.where(size > LOST, left / np.where(size > LOST, size, 1.0), 0.0)
            if own.any():
                taken.append(own)
                free -= own[:, None] * own[None]
    return free


def largest_slack(offsets: Array, clearances: Array, rows: Array, counts: Mask, closed: Array) -> tuple[Array, Array]:
    """Steps (freedoms, trials) to the largest common slack, and multipliers of the places (places, trials).

    Args:
        offsets: (places, 2, trials).
        clearances: (places, trials).
        rows: (places, 2, freedoms, trials).
        counts: which places do (places, trials).
        closed: projectors to what is not open (freedoms, freedoms, trials).
    """
    trials = rows.shape[3]
    step, multipliers, found = np.empty(rows.shape[2:]), np.empty(counts.shape), np.zeros(trials, dtype=bool)
    counts = np.ascontiguousarray(counts)
    offsets, clearances, rows, closed = (np.ascontiguousarray(own) for own in (offsets, clearances, rows, closed))
    quickly_centred(offsets, clearances, rows, counts, closed, np.zeros(step.shape), 1, step, multipliers, found)
    if not found.all():
        left, counts = ~found, np.ascontiguousarray(counts[:, ~found])
        offsets, clearances, rows, closed = (
            np.ascontiguousarray(own[..., left]) for own in (offsets, clearances, rows, closed)
        )
        near, its = _by_cones(offsets, clearances, rows, counts, closed)
        near_all, no_goal = np.ones(len(counts[0]), dtype=bool), np.zeros(near.shape)
        quickly_centred(offsets, clearances, rows, counts, closed, no_goal, 1, near, its, near_all)
        step[:, left], multipliers[:, left] = near, its
    return step, multipliers


def _by_cones(offsets: Array, clearances: Array, rows: Array, counts: Mask, closed: Array) -> tuple[Array, Array]:
    """See `largest_slack`."""
    lengths = np.sqrt(offsets[:, 0] ** 2 + offsets[:, 1] ** 2)
    least = np.where(counts, clearances - lengths, np.inf).min(axis=0)
    start = least - 0.5 * (np.where(counts, lengths, 0.0).max(axis=0) + 1e-3)
    primal = np.concatenate([np.where(counts, clearances - start, 1.0)[:, None], offsets], axis=1)
    dual = np.zeros(primal.shape)
    dual[:, 0] = np.where(counts, 1.0 / counts.sum(axis=0), 1.0)
    step, multipliers, no_goal = np.empty(rows.shape[2:]), np.empty(counts.shape), np.zeros(rows.shape[2:])
    climbed(primal, dual, rows, counts, closed, no_goal, 1, step, multipliers)
    return step, multipliers


def _times(rows: Array, q: Array) -> Array:
    """(places, 2, trials) of rows (places, 2, freedoms, trials or 1) and freedoms (freedoms, trials)."""
    return ordered_sum(rows[:, :, i] * q[i] for i in range(len(q)))
