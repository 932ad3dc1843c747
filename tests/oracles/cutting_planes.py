"""The oracle of parts with play: cones cut by planes, in HiGHS, about the directions of the best pose so far."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

Array = NDArray[np.float64]
FAN = np.array([0.0, *(sign * 10.0**-k for k in range(1, 6) for sign in (1, -1))])
"""Angles [rad] beside a direction in which the oracle cuts too: steps along a flat end stay short at every scale."""


def cut(offsets: Array, clearances: Array, rows: Array, goal: Array | None = None) -> float:
    """The largest goal . q, or the largest s with |o + B q| <= c - s, to 1e-10 between both bounds; nan if lost."""
    size, lifts = rows.shape[2], goal is None
    costs = np.append(np.zeros(size), -1.0) if goal is None else np.append(-goal, 0.0)
    q = base = np.zeros(size)
    best, most, cuts = -float("inf"), float("inf"), list[tuple[Array, Array]]()
    for _ in range(60):
        at = offsets + rows @ q
        slack = float((clearances - np.hypot(*at.T)).min())
        if goal is None:
            best, base = (slack, q) if slack > best else (best, base)
        else:
            best, base = float(goal @ q) if slack > -1e-10 else best, q
        if most - best < 1e-10:
            return best
        angles = np.arctan2(at[:, 1], at[:, 0])[:, None] + FAN
        angles[np.hypot(*at.T) < 1e-6] = np.arange(len(FAN)) * 2 * np.pi / len(FAN)
        ways = np.stack([np.cos(angles), np.sin(angles)], axis=2)  # (places, fan, 2)
        planes = np.einsum("kar,krj->kaj", ways, rows).reshape(-1, size)
        room = (clearances[:, None] - np.einsum("kar,kr->ka", ways, offsets)).ravel()
        cuts = [*cuts[-8:], (np.column_stack([planes, np.full(len(planes), float(lifts))]), room)]
        for kept in (9, 3, 1):  # fewer where HiGHS is lost among planes that are nearly parallel
            matrix, limits = (np.concatenate([own[n] for own in cuts[-kept:]]) for n in (0, 1))
            found = linprog(
                costs, A_ub=matrix, b_ub=1e4 * (limits - matrix[:, :size] @ base), method="highs",
                bounds=[(-1e4, 1e4)] * size + [(None, None) if lifts else (0, 0)],
                options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
            ).x  # fmt: skip
            if found is not None:
                break
        else:
            break
        most = float(found[-1]) / 1e4 if goal is None else float(goal @ (base + found[:size] / 1e4))
        q = base + found[:size] / 1e4
    return best if abs(most - best) < 1e-9 else np.nan
