"""Rounds of convex programmes by which a part is centred or pushed within clearances, trial by trial, in a kernel.

Offsets o_k + B_k q of places (two numbers each; of a slot the second is 0) have to stay within clearances c_k. The
centred q maximises the least slack s = min(c_k - |o_k + B_k q|), then the least of those still open, and so on. A
place with a multiplier has the same offset in every solution of its round, so that further rounds keep it. A pushed q
goes as far as it can along a goal first, and is centred in what that leaves open.
"""

from typing import Any, Final

import numpy as np

from tol3d.contact.cones import climbed, ended
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import fill

HELD: Final = 1e-6
"""Multiplier (they sum to 1) above which a cone is tight."""
TIED: Final = 1e-9
"""Slack [mm] over the least one that counts as the same."""
STARTS: Final = 1.0, 0.1, 0.01, 1.0
"""Factors for a programme's first multipliers over those that balance its goal, until it ends."""
UNSEEN: Final = 1e-6
"""Change of an offset by a freedom, over the largest displacement by it, that counts as none."""


@nested
def reduced(rows: Any, basis: Any, size: int, seen: Any) -> None:
    """Rows B_k in the freedoms that are left (cones, 2, size)."""
    for k in range(rows.shape[0]):
        for r in range(2):
            for s in range(size):
                total = 0.0
                for j in range(rows.shape[2]):
                    total += rows[k, r, j] * basis[j, s]
                seen[k, r, s] = total


@nested
def narrowed(seen: Any, tight: Any, basis: Any, size: int, held: Any) -> int:
    """Remove the freedoms held by tight cones; returns the number left.

    Args:
        seen: rows in the freedoms (cones, 2, size).
        tight: which cones are.
        basis: of the freedoms (all, size); changed.
        size: their number.
        held: to work in (all, all).
    """
    count = 0
    for k in range(seen.shape[0]):
        if not tight[k]:
            continue
        for r in range(2):
            if count < size:
                for s in range(size):
                    held[count, s] = seen[k, r, s]
                count += independent(held, count, size)
    first = count
    for s in range(size):  # orthogonal to them: the unit vectors less their projections
        if count < size:
            for t in range(size):
                held[count, t] = 1.0 if t == s else 0.0
            count += independent(held, count, size)
    room = held[size]
    for j in range(basis.shape[0]):
        for s in range(first, count):
            total = 0.0
            for t in range(size):
                total += basis[j, t] * held[s, t]
            room[s - first] = total
        for s in range(count - first):
            basis[j, s] = room[s]
    return count - first


@nested
def independent(held: Any, count: int, size: int) -> int:
    """Make row `count` orthogonal to those before it and of length 1; 0 if nothing is left of it."""
    for _ in range(2):
        for k in range(count):
            share = 0.0
            for s in range(size):
                share += held[k, s] * held[count, s]
            for s in range(size):
                held[count, s] -= share * held[k, s]
    square = 0.0
    for s in range(size):
        square += held[count, s] * held[count, s]
    if not square > UNSEEN * UNSEEN:
        return 0
    length = np.sqrt(square)
    for s in range(size):
        held[count, s] /= length
    return 1


@nested
def seeing(seen: Any, used: Any, done: Any, size: int) -> int:
    """Find the cones that the remaining freedoms change and that are not done; returns their number."""
    count = 0
    for k in range(seen.shape[0]):
        largest = 0.0
        for r in range(2):
            for s in range(size):
                largest = max(largest, abs(seen[k, r, s]))
        used[k] = largest > UNSEEN and not done[k]
        count += used[k]
    return count


@nested
def at_step(offsets: Any, rows: Any, q: Any, k: int) -> Any:
    """The offset of a cone after a step."""
    a, b = offsets[k, 0], offsets[k, 1]
    for j in range(rows.shape[2]):
        a += rows[k, 0, j] * q[j]
        b += rows[k, 1, j] * q[j]
    return a, b


@nested
def started(place: Any, q: Any, used: Any, y: Any, z: Any, count: int, lifts: int, strength: float) -> None:
    """Interior cones and multipliers from which a programme starts: with less slack than available, or with none."""
    offsets, clearances, rows = place
    least, widest = 1e30, 0.0
    for k in range(rows.shape[0]):
        y[k, 1], y[k, 2] = at_step(offsets, rows, q, k)
        if used[k]:
            length = np.sqrt(y[k, 1] * y[k, 1] + y[k, 2] * y[k, 2])
            least, widest = min(least, clearances[k] - length), max(widest, length)
    start = least - 0.5 * (widest + 1e-3) if lifts else 0.0
    for k in range(rows.shape[0]):
        y[k, 0] = clearances[k] - start
        z[k, 0], z[k, 1], z[k, 2] = strength / count, 0.0, 0.0


@nested
def least_slack(place: Any, q: Any, before: Any) -> Any:
    """The least slack, and a cone that has it: if any of them decided the first round, such a one."""
    offsets, clearances, rows = place
    least, which, decided, first = np.inf, 0, np.inf, 0
    for k in range(rows.shape[0]):
        a, b = at_step(offsets, rows, q, k)
        slack = clearances[k] - np.sqrt(a * a + b * b)
        if slack < least:
            least, which = slack, k
        if before[1][k] == 1 and slack < decided:
            decided, first = slack, k
    return least, first if decided <= least + TIED else which


@nested
def opened(basis: Any, done: Any) -> int:
    """Make all freedoms free, and no cone held; returns the number of freedoms."""
    fill(done, False)
    for j in range(basis.shape[0]):
        for s in range(basis.shape[0]):
            basis[j, s] = 1.0 if s == j else 0.0
    return int(basis.shape[0])


@nested
def again(
    cones: Any, size: int, lifts: int, weight: float, push: Any, before: Any, turn: int, found: Any, rooms: Any
) -> bool:
    """Solve by Newton steps with the places that decided this programme at the pose before; True if solved.

    Args:
        cones, size, lifts, push, found, rooms: as in `climbed`.
        weight: of the multipliers.
        before: duals, and their programme (places,).
        turn: number of this programme.
    """
    y, _, _, used = cones
    own, scale, some = rooms[3], 0.0, False
    for k in range(y.shape[0]):
        decided = used[k] and before[1][k] == turn
        own[k, 0] = before[0][k, 0] if decided else 0.0
        own[k, 3], own[k, 4] = -before[0][k, 1], -before[0][k, 2]
        some = some or decided
        scale = max(scale, y[k, 0] if used[k] else 0.0)
    fill(found, 0.0)
    return some and ended(cones, size, lifts, push, scale, weight, found, rooms)


@nested
def reached(
    place: Any, q: Any, cones: Any, size: int, lifts: int, weight: float, push: Any, found: Any, rooms: Any
) -> bool:
    """Find a programme's optimum, anew with smaller multipliers if interior points stall; True if found.

    Args:
        place, q, weight: as in `lain`: the start.
        cones, size, lifts, push, found, rooms: as in `climbed`, started.
    """
    y, z, _, used = cones
    for n in range(len(STARTS)):
        if n > 0:
            started(place, q, used, y, z, used.sum(), lifts, STARTS[n] * weight)
        if climbed(cones, size, lifts, n == len(STARTS) - 1, push, found, rooms):
            return True
    return False


@nested
def moves_part(basis: Any, parts: int, size: int) -> bool:
    """True if some remaining freedom moves the part, not only its bolts."""
    for j in range(parts):
        for s in range(size):
            if abs(basis[j, s]) > UNSEEN:
                return True
    return False


@nested
def lain(place: Any, parts: int, rounds: int, push: Any, before: Any, basis: Any, done: Any, q: Any, rooms: Any) -> Any:
    """Find the step q of a trial: whether it is found, the least slack of the centred pose, a place that has it.

    The last returned value is the number of freedoms left open by the first round (or by the push).

    Args:
        place: o_k (places, 2), c_k (places,), B_k (places, 2, unknowns).
        parts: how many of the unknowns, the first, are the part's; the others are of its bolts, and are centred as long
            as the part is, of a part that relations hold to the end.
        rounds: of centring, at most.
        push: goal (unknowns,); 0 for the centred pose.
        before: of the places that decided at the pose before, duals (places, 3) and in which programme (places,): from
            1 on in rounds of centring, from -1 on in a push and what is centred after it, 0 for none; changed to those
            of this pose. A push that is known from there is not centred first: its slack is NaN.
        basis, done, rooms: work arrays: freedoms (unknowns, unknowns), places that are held (places,), see `new_rooms`.
        q: (unknowns,); changed.
    """
    seen, used, y, z, found, held, inner = rooms
    rows = place[2]
    slack, which, turn, left, strength, near = np.nan, 0, 0, -1, 0.0, False
    for j in range(push.shape[0]):
        strength = max(strength, abs(push[j]))
    for k in range(rows.shape[0]):
        near = near or (strength > 0.0 and before[1][k] < 0)
    pushes = 1 if near else 0  # 1 for the push, 2 after it
    size = opened(basis, done)
    fill(q, 0.0)
    while True:
        reduced(rows, basis, size, seen)
        count = seeing(seen, used, done, size)
        if count == 0 or (parts > 0 and not moves_part(basis, parts, size)) or (pushes == 0 and turn == rounds):
            if pushes > 0:
                return True, slack, which, left
            slack, which = least_slack(place, q, before)
            if strength == 0.0 or not slack > 0.0:
                return True, slack, which, left
            pushes, turn, size = 1, 0, opened(basis, done)
            continue
        lifts = 0 if pushes == 1 else 1
        weight = 1.0 if lifts else strength
        started(place, q, used, y, z, count, lifts, weight)
        cones, turn = (y, z, seen, used), turn + 1
        own = turn if pushes == 0 else -turn
        met = (lifts > 0 or near) and again(cones, size, lifts, weight, push, before, own, found, inner)
        if near and not met and not lifts:  # other places decide: from the middle on
            near, pushes, turn = False, 0, 0
            fill(before[1], 0)
            continue
        if not met and not reached(place, q, cones, size, lifts, weight, push, found, inner):
            return False, slack, which, left
        for j in range(rows.shape[2]):
            for s in range(size):
                q[j] += basis[j, s] * found[s]
        for k in range(rows.shape[0]):
            used[k] = used[k] and z[k, 0] > HELD * weight
            done[k] = done[k] or used[k]
            if used[k]:
                before[0][k, 0], before[0][k, 1], before[0][k, 2], before[1][k] = z[k, 0], z[k, 1], z[k, 2], own
            elif before[1][k] == own:
                before[1][k] = 0
        size = narrowed(seen, used, basis, size, held)
        if pushes == 1 or left < 0:
            left = size if moves_part(basis, parts, size) else 0
        pushes = 2 if pushes == 1 else pushes


@nested
def new_rooms(cones: int, freedoms: int) -> Any:
    """Work arrays for the programmes."""
    size = freedoms + 1
    inner = (
        np.empty((size, size)), np.empty(size), np.empty((cones, 3)), np.empty((cones, 5)), np.empty(size),
        np.empty(size),
    )  # fmt: skip
    return (
        np.empty((cones, 2, size)),
        np.empty(cones, dtype=np.bool_),
        np.empty((cones, 3)),
        np.empty((cones, 3)),
        np.empty(size),
        np.empty((size, size)),
        inner,
    )


@kernel(
    arrays="int64[::1], float64[:,:,::1], float64[:,::1], float64[:,:,:,::1], float64[:,::1], int64, int64, "
    "float64[:,::1], float64[::1], int64[::1], int64[::1], boolean[::1], float64[:,:,::1], int64[:,::1]",
)
def rooms_solved(
    trials: Any, offsets: Any, clearances: Any, rows: Any, goal: Any, parts: int, rounds: int, steps: Any, slacks: Any,
    tightest: Any, left: Any, found: Any, duals: Any, programmes: Any,
) -> None:  # fmt: skip
    """Solve the programmes of some trials; see `Programme`."""
    places, unknowns = rows.shape[0], rows.shape[2]
    rooms = new_rooms(places, unknowns)
    basis, q, own, clear = np.empty((unknowns, unknowns)), np.empty(unknowns), np.empty((places, 2)), np.empty(places)
    here, push, done = np.empty((places, 2, unknowns)), np.empty(unknowns), np.empty(places, dtype=np.bool_)
    before = (np.empty((places, 3)), np.empty(places, dtype=np.int64))
    for j in range(trials.shape[0]):
        i, r, p = trials[j], min(j, rows.shape[3] - 1), min(j, goal.shape[1] - 1)
        for f in range(unknowns):
            push[f] = goal[f, p]
        for k in range(places):
            own[k, 0], own[k, 1], clear[k] = offsets[k, 0, j], offsets[k, 1, j], clearances[k, j]
            for c in range(2):
                for f in range(unknowns):
                    here[k, c, f] = rows[k, c, f, r]
            for c in range(3):
                before[0][k, c] = duals[k, c, i]
            before[1][k] = programmes[k, i]
        found[i], slacks[i], tightest[i], left[i] = lain(
            (own, clear, here), parts, rounds, push, before, basis, done, q, rooms
        )
        for k in range(places):
            for c in range(3):
                duals[k, c, i] = before[0][k, c]
            programmes[k, i] = before[1][k]
        for f in range(unknowns):
            steps[f, i] = q[f] if found[i] else np.nan
