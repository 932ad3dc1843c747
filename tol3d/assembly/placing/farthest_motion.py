"""Linear programmes of one-sided contacts, in kernels: the dual simplex method, ties decided by a second direction."""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import nested

OPEN: Final = -1e-11
"""Gap [mm] under which a contact is pierced."""
PIVOTS: Final = 400
"""Exchanges of contacts in one trial; in practice as many as contacts."""
ACTS: Final = 1e-9
"""How far a gap closes as another one opens, under which it does not."""
TIED: Final = 1e-9
"""Part of the force under which a contact carries nothing."""


@nested
def leaving(inverse: Any, loads: Any, row: Any, closes: Any) -> int:
    """Which contact of the basis a new one relieves first; -1 if none. `closes` becomes row . inverse."""
    count = loads.shape[1]
    best = -1
    least, second = np.inf, np.inf
    for b in range(count):
        total = 0.0
        for j in range(count):
            total += row[j] * inverse[j, b]
        closes[b] = total
        if total > ACTS:
            first, other = max(loads[0, b], 0.0) / total, loads[1, b] / total
            if first < least - 1e-12 or (first < least + 1e-12 and other < second):
                best, least, second = b, min(first, least), other
    return best


@nested
def exchange(inverse: Any, loads: Any, closes: Any, out: int) -> None:
    """Let a new contact take the place of one: the inverse of the basis, and the loads on it."""
    count = loads.shape[1]
    pivot = closes[out]
    for j in range(count):
        inverse[j, out] /= pivot
    for b in range(count):
        if b != out:
            for j in range(count):
                inverse[j, b] -= inverse[j, out] * closes[b]
    for level in range(2):
        share = loads[level, out] / pivot
        for b in range(count):
            loads[level, b] -= share * closes[b]
        loads[level, out] = share


@nested
def farthest(rows: Any, gaps: Any, basis: Any, inverse: Any, loads: Any, rooms: Any, pivots: int) -> int:
    """Motion z, into the first room, that goes farthest with rows z + gaps >= 0; the exchanges made, or below 0.

    Returns:
        -1: gaps contradict each other. -2: too many exchanges.
    """
    z, closes = rooms
    count = loads.shape[1]
    while True:
        for j in range(count):
            total = 0.0
            for b in range(count):
                total -= inverse[j, b] * gaps[basis[b]]
            z[j] = total
        entering, deepest = -1, OPEN
        for k in range(rows.shape[0]):
            total = gaps[k]
            for j in range(count):
                total += rows[k, j] * z[j]
            if total < deepest:
                among = False
                for b in range(count):
                    among = among or basis[b] == k
                if not among:
                    entering, deepest = k, total
        if entering < 0:
            return pivots
        if pivots == PIVOTS:
            return -2
        out = leaving(inverse, loads, rows[entering], closes)
        if out < 0:
            return -1
        exchange(inverse, loads, closes, out)
        basis[out] = entering
        pivots += 1
