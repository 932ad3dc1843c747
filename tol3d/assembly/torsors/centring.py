"""Where a part with play lies in its room: the freedoms of many trials at once, by convex programmes of cones.

A place k asks |b_k + B_k q| <= c_k - s. The largest s is found by primal and dual interior points along scaled
directions; then the places whose multipliers say that they decide it keep their offsets, the freedoms that those leave
are searched for the largest s of the others, and so on.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.torsors.ordered import ordered_solution, ordered_sum
from tol3d.assembly.torsors.quick_centring import quickly_centred

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

GAP: Final = 1e-12
"""Of the largest room: by how much the slack may be better."""
MOST_STEPS: Final = 80
TARGET: Final = 0.1
"""Of the gap, from one step to the next."""
NEAR: Final = 0.98
"""Of the way to the end of a cone."""
DECIDES: Final = 1e-6
"""Least multiplier, of 1 in all, of a place that decides."""
LOST: Final = 1e-6
"""Length of a row under which it sees no freedom."""


@dataclass(frozen=True, eq=False)
class Cones:
    """What limits the freedoms, in some trials.

    Args:
        offsets: b (places, 2, trials) [mm].
        clearances: c (places, trials) [mm].
        rows: B (places, 2, freedoms), of all trials.
    """

    offsets: Array
    clearances: Array
    rows: Array

    @property
    def freedoms(self) -> int:
        """How many."""
        return int(self.rows.shape[2])

    def of(self, trials: Mask) -> "Cones":
        """Those of some of the trials."""
        return Cones(self.offsets[:, :, trials], self.clearances[:, trials], self.rows)

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
    quickly_centred(offsets, clearances, rows, counts, closed, step, multipliers, found)
    if not found.all():
        left, counts = ~found, np.ascontiguousarray(counts[:, ~found])
        offsets, clearances, rows, closed = (
            np.ascontiguousarray(own[..., left]) for own in (offsets, clearances, rows, closed)
        )
        near, its = _by_cones(offsets, clearances, rows, counts, closed)
        quickly_centred(offsets, clearances, rows, counts, closed, near, its, np.ones(len(counts[0]), dtype=bool))
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
    return climbed(primal, dual, rows, counts, closed, np.zeros(rows.shape[2:]), lifts=True)


def climbed(
    primal: Array, dual: Array, rows: Array, counts: Mask, closed: Array, goal: Array, *, lifts: bool
) -> tuple[Array, Array]:
    """Interior points, until each trial's gap is closed: steps (freedoms, trials), multipliers (places, trials).

    Args:
        primal, dual: cones at the start and multipliers, inside (places, 3, trials).
        rows: (places, 2, freedoms, trials).
        counts: which places do (places, trials).
        closed: projectors to what is not open, where nothing moves (freedoms, freedoms, trials).
        goal: what is to be largest, besides the slack (freedoms, trials).
        lifts: whether the slack is.
    """
    trials = primal.shape[2]
    found, multipliers = np.zeros(rows.shape[2:]), np.zeros(counts.shape)
    scale = np.where(counts, primal[:, 0], 0.0).max(axis=0)
    going, moved, owed = np.arange(trials), np.zeros(rows.shape[2:]), np.ones(trials)
    for number in range(MOST_STEPS):
        gap = ordered_sum(np.where(counts, ordered_sum(primal[:, r] * dual[:, r] for r in range(3)), 0.0))
        done = (gap <= GAP * scale) & (owed <= 1e-9 if not lifts else True) | (number == MOST_STEPS - 1)
        if done.any():
            found[:, going[done]], multipliers[:, going[done]] = moved[:, done], dual[:, 0, done]
            left = ~done
            if not left.any():
                break
            going, moved, owed, scale, gap = going[left], moved[:, left], owed[left], scale[left], gap[left]
            primal, dual, rows, closed, goal = (own[..., left] for own in (primal, dual, rows, closed, goal))
            counts = counts[:, left]
        target = TARGET * gap / counts.sum(axis=0)
        step, changes = _direction(primal, dual, rows, counts, closed, goal if not lifts else None, target)
        up, down = (_way(own, change, counts) for own, change in zip((primal, dual), changes, strict=True))
        moved = moved + up * step
        primal, dual = primal + up * changes[0], dual + down * changes[1]
        owed = owed * (1.0 - down)
    return found, multipliers


def _direction(
    primal: Array, dual: Array, rows: Array, counts: Mask, closed: Array, goal: Array | None, target: Array
) -> tuple[Array, tuple[Array, Array]]:
    """A step (freedoms, trials), and the changes of cones and multipliers; the slack rises where there is no goal."""
    lifts = goal is None
    inside, outside = (own[:, 0] ** 2 - own[:, 1] ** 2 - own[:, 2] ** 2 for own in (primal, dual))
    inside, outside = np.maximum(inside, 1e-300), np.maximum(outside, 1e-300)
    a, b = 1.0 / np.sqrt(inside), 1.0 / np.sqrt(outside)
    joint = ordered_sum(primal[:, r] * dual[:, r] for r in range(3)) * a * b
    mirror = np.array([1.0, -1.0, -1.0])[:, None]
    point = (a[:, None] * primal + mirror * b[:, None] * dual) * (0.5 / np.sqrt(0.5 * (1.0 + joint)))[:, None]
    weight = np.where(counts, a / b, 0.0)
    back = np.where(counts, target / inside, 0.0)
    count = rows.shape[2]
    seen = ordered_sum(rows[:, r] * point[:, 1 + r, None] for r in (0, 1))  # (places, freedoms, trials)
    full = np.concatenate([seen, point[:, :1]], axis=1) if lifts else seen
    size = full.shape[1]
    system, right = np.empty((size, size, primal.shape[2])), np.empty((size, primal.shape[2]))
    for i in range(size):
        for j in range(i + 1):
            own = 2.0 * full[:, i] * full[:, j]
            if i < count:
                own = own + ordered_sum(rows[:, r, i] * rows[:, r, j] for r in (0, 1))
            elif j == i:
                own = own - 1.0
            system[i, j] = system[j, i] = ordered_sum(weight * own)
        if i < count:
            pull = ordered_sum(rows[:, r, i] * primal[:, 1 + r] for r in (0, 1))
            right[i] = (0.0 if goal is None else goal[i]) - ordered_sum(back * pull)
        else:
            right[i] = 1.0 - ordered_sum(back * primal[:, 0])
    stiff = np.max([system[i, i] for i in range(count)], axis=0)
    system[:count, :count] += stiff * closed  # else equations of what is closed would be rounding
    solution = ordered_solution(system, right)
    step, rise = solution[:count], solution[count] if lifts else np.zeros(primal.shape[2])
    change = np.concatenate([np.broadcast_to(-rise, (len(rows), 1, len(rise))), _times(rows, step)], axis=1)
    along = 2.0 * weight * ordered_sum(mirror[r] * point[:, r] * change[:, r] for r in range(3))
    turned = mirror * (along[:, None] * point - weight[:, None] * change)
    other = back[:, None] * mirror * primal - dual - turned
    return step, (np.where(counts[:, None], change, 0.0), np.where(counts[:, None], other, 0.0))


def _way(cone: Array, change: Array, counts: Mask) -> Array:
    """The share of a change that stays inside all cones (trials,), 1 at most."""
    inside = cone[:, 0] ** 2 - cone[:, 1] ** 2 - cone[:, 2] ** 2
    slope = cone[:, 0] * change[:, 0] - cone[:, 1] * change[:, 1] - cone[:, 2] * change[:, 2]
    bend = change[:, 0] ** 2 - change[:, 1] ** 2 - change[:, 2] ** 2
    rest = np.sqrt(np.maximum(slope**2 - bend * inside, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        outward = np.where(bend < 0.0, -(slope + rest) / bend, np.inf)
        falling = np.where((bend >= 0.0) & (slope < 0.0), inside / (rest - slope), np.inf)
    found = np.where(counts, np.minimum(outward, falling), np.inf).min(axis=0)
    return np.asarray(np.minimum(1.0, NEAR * found))


def _times(rows: Array, q: Array) -> Array:
    """(places, 2, trials) of rows (places, 2, freedoms, trials or 1) and freedoms (freedoms, trials)."""
    return ordered_sum(rows[:, :, i] * q[i] for i in range(len(q)))
