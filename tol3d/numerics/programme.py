"""Bodies as far along an objective as contacts let: a linear programme per trial, by a compiled dual simplex method.

Every contact pair is a row of two sides, lower <= row @ x <= upper: the flanks of one mesh. As each row has both sides,
any independent rows can be the first basis: the sign of its multiplier says at which side a row is met. A contact with
one side has an infinite other one, and a first basis of those that carry. Of the rows that are not kept the worst
enters, and the dual ratio test says which one leaves; where nothing may leave, the rows contradict each other: there is
no room. Where several points are as far, a second objective may choose among them (a lexicographic programme). All
trials start with the same basis, so that a trial has the same bits alone and among thousands. Source: the dual simplex
method for bounded rows (Lemke 1954; Bland's rule where it stalls).
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.compiled import kernel, part
from tol3d.numerics.loops import fill, fill_matrix

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

OK: Final = 0
NO_ROOM: Final = 1
"""Rows contradict each other."""
STALLED: Final = 2
"""Neither an end nor a contradiction was found: rows that depend on each other, to rounding."""

KEPT: Final = 1e-12  # mm; a row is kept that is exceeded by less: rounding of 50 mm is 1e-14
SMALLEST_PIVOT: Final = 1e-9  # of rows in mm a turn, whose entries are some mm
TIED: Final = 1e-12  # rad/mm; a multiplier of less is none: rounding of 1 rad over 10 mm is 1e-17
MOST_PIVOTS: Final = 400
PATIENT: Final = 60  # pivots until rows enter and leave by their number: neither the worst nor the largest pivot


@part
def inverted(rows: Any, basis: Any, matrix: Any, inverse: Any) -> bool:
    """Write the inverse of the basis' rows; False where they depend on each other. Gauss and Jordan, with pivots."""
    count = basis.shape[0]
    for i in range(count):
        for j in range(count):
            matrix[i, j] = rows[basis[i], j]
            inverse[i, j] = 1.0 if i == j else 0.0
    for k in range(count):
        best = k
        for i in range(k + 1, count):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if not abs(matrix[best, k]) > SMALLEST_PIVOT:
            return False
        for j in range(count):
            matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            inverse[k, j], inverse[best, j] = inverse[best, j], inverse[k, j]
        scale = 1.0 / matrix[k, k]
        for j in range(count):
            matrix[k, j] *= scale
            inverse[k, j] *= scale
        for i in range(count):
            factor = matrix[i, k]
            if i != k and factor != 0.0:
                for j in range(count):
                    matrix[i, j] -= factor * matrix[k, j]
                    inverse[i, j] -= factor * inverse[k, j]
    return True


@part
def met(lower: Any, upper: Any, basis: Any, inverse: Any, sides: Any, ends: Any, x: Any) -> None:
    """Write the point at which the basis' rows are met at their sides, and these."""
    count = basis.shape[0]
    for j in range(count):
        ends[j] = upper[basis[j]] if sides[j] > 0.0 else lower[basis[j]]
    for i in range(count):
        value = 0.0
        for j in range(count):
            value += inverse[i, j] * ends[j]
        x[i] = value


@part
def entering(rows: Any, lower: Any, upper: Any, x: Any, first: bool) -> tuple[int, float]:
    """The row that is violated most, or the first one; its excess, above 0 beyond its upper side; -1 if none is."""
    found, excess = -1, KEPT
    beyond = 0.0
    for r in range(rows.shape[0]):
        value = 0.0
        for j in range(rows.shape[1]):
            value += rows[r, j] * x[j]
        over = max(value - upper[r], lower[r] - value)
        if over > excess:
            found, excess = r, over
            beyond = value - upper[r] if value - upper[r] > lower[r] - value else value - lower[r]
            if first:
                break
    return found, beyond


@part
def leaving(basis: Any, sides: Any, loads: Any, shares: Any, sense: float, first: bool) -> int:
    """The place in the basis that becomes free; -1 for none.

    That is one whose multiplier would change its sign first. Of those that would at once, to rounding, it is the one
    whose second multiplier would; then the one with the largest pivot (Harris 1973), or the first row: a pivot of
    rounding's own size spoils the inverse.
    """
    least = np.inf
    for j in range(basis.shape[0]):
        rate = sides[j] * sense * shares[j]
        if rate > SMALLEST_PIVOT:
            least = min(least, (max(0.0, loads[0, j]) + (0.0 if first else TIED)) / rate)
    found, largest, second = -1, 0.0, np.inf
    for j in range(basis.shape[0]):
        rate = sides[j] * sense * shares[j]
        if rate > SMALLEST_PIVOT and max(0.0, loads[0, j]) / rate <= least:
            other = 0.0 if first else loads[1, j] / rate
            better = basis[j] < basis[found] if first else rate > largest
            if found < 0 or other < second or (other == second and better):
                found, largest, second = j, rate, other
    return found


@part
def new_rooms(count: int) -> Any:
    """Work arrays of a programme (count unknowns): matrix, inverse of the basis, sides, loads, shares."""
    loads = np.empty((2, count))
    fill_matrix(loads, 0.0)
    return np.empty((count, count)), np.empty((count, count)), np.empty(count), loads, np.empty(count)


@part
def exchanged(
    rows: Any, lower: Any, upper: Any, basis: Any, inverse: Any, sides: Any, loads: Any, shares: Any, x: Any
) -> tuple[int, int, float]:
    """Go on from a basis with its inverse, its sides, and its loads of both objectives (2, count); see `solve_lp`."""
    count = basis.shape[0]
    for pivot in range(MOST_PIVOTS):
        met(lower, upper, basis, inverse, sides, shares, x)
        by_number = pivot > PATIENT
        row, beyond = entering(rows, lower, upper, x, by_number)
        if row < 0:
            return OK, -1, 0.0
        side = 1.0 if beyond > 0.0 else -1.0
        fill(shares, 0.0)
        for i in range(count):
            own = rows[row, i]
            if own != 0.0:  # most bodies have no part in a contact
                for j in range(count):
                    shares[j] += own * inverse[i, j]
        together = 1.0
        for j in range(count):
            together += abs(shares[j])
        place = leaving(basis, sides, loads, shares, side, by_number)
        if place < 0:
            return NO_ROOM, row, abs(beyond) / together
        step = 1.0 / shares[place]
        first, second = side * sides[place] * loads[0, place] * step, side * sides[place] * loads[1, place] * step
        for j in range(count):
            if j != place:
                rate = side * sides[j] * shares[j]
                loads[0, j] -= rate * first
                loads[1, j] -= rate * second
        shares[place] = 0.0
        for i in range(count):
            scaled = inverse[i, place] * step
            if scaled != 0.0:
                for j in range(count):
                    inverse[i, j] -= shares[j] * scaled
            inverse[i, place] = scaled
        loads[0, place], loads[1, place] = first, second
        basis[place] = row
        sides[place] = side
    return STALLED, -1, 0.0


@part
def solve_lp(
    rows: Any, lower: Any, upper: Any, objective: Any, basis: Any, rooms: Any, x: Any
) -> tuple[int, int, float]:
    """Write the point with the largest objective.

    Args:
        rows, lower, upper: of the contacts.
        objective: that is maximised.
        basis: rows that are met; from those of the start to those of the end.
        rooms: `new_rooms`, to write in; where no multiplier says at which side a row of the basis is met, it is the
            one that stands in sides.
        x: the point.

    Returns:
        What became of it, the last row that was not kept, and by how much the rows that contradict it would have to
        give way, each as much.
    """
    matrix, inverse, sides, loads, shares = rooms
    count = basis.shape[0]
    if not inverted(rows, basis, matrix, inverse):
        return STALLED, -1, 0.0
    for j in range(count):
        load = 0.0
        for i in range(count):
            load += objective[i] * inverse[i, j]
        if abs(load) > TIED:
            sides[j] = 1.0 if load > 0.0 else -1.0
        loads[0, j] = sides[j] * load
    return exchanged(rows, lower, upper, basis, inverse, sides, loads, shares, x)


@kernel(arrays="f8[:,::1], f8[:,::1], f8[:,::1], f8[::1], f8[:,::1], i8[::1], f8[:,::1], i1[::1], i8[::1], f8[::1]")
def ranges(
    rows: Any, lower: Any, upper: Any, turn: Any, wanted: Any, begun: Any,
    ends: Any, status: Any, decided: Any, amount: Any,
) -> None:  # fmt: skip
    """Both ends of one coordinate in trials.

    Args:
        rows: of the contacts (rows, unknowns), the same in all trials [mm a rad].
        lower, upper: of the rows (trials, rows) [mm].
        turn: the coordinate (unknowns,).
        wanted: objectives (2, unknowns) for the smallest and for the largest coordinate.
        begun: rows of the first basis (unknowns,).
        ends: smallest and largest value (trials, 2), written.
        status: of each trial (trials,), written.
        decided, amount: the row that contradicts others (trials,), -1 for none, and its excess [mm]; written.
    """
    count = rows.shape[1]
    rooms, x, basis = new_rooms(count), np.empty(count), np.empty(count, np.int64)
    for i in range(lower.shape[0]):
        status[i], decided[i], amount[i] = OK, -1, 0.0
        for end in range(2):
            for j in range(count):
                basis[j], rooms[2][j] = begun[j], 1.0
            found, row, lacking = solve_lp(rows, lower[i], upper[i], wanted[end], basis, rooms, x)
            if found != OK:
                status[i], decided[i], amount[i] = found, row, lacking
                ends[i, 0] = ends[i, 1] = np.nan
                break
            ends[i, end] = 0.0
            for j in range(count):
                ends[i, end] += turn[j] * x[j]


def first_basis(rows: Array) -> Rows:
    """Independent rows (unknowns,) among some (rows, unknowns); fewer if there are not enough.

    Each is the one that lies farthest off the span of those before it.
    """
    rest = np.array(rows, dtype=np.float64)
    chosen: list[int] = []
    for _ in range(rows.shape[1]):
        sizes = np.sqrt((rest * rest).sum(axis=1))
        best = int(np.argmax(sizes))
        if sizes[best] <= SMALLEST_PIVOT:
            break
        chosen.append(best)
        along = rest[best] / sizes[best]
        rest = rest - np.outer(rest @ along, along)
    return np.array(chosen, dtype=np.int64)
