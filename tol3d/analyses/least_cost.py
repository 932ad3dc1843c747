"""Factors of least cost under tangents: one factor of all, a programme for each its own, and grades."""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from tol3d.analyses.costs import Discrete
from tol3d.analyses.tolerance_search import TINY, Search
from tol3d.numerics.arrays import Array

ACCURACY: Final = 1e-6
ITERATIONS: Final = 60
BRACKET: Final = 0.2
HALVINGS: Final = 10
PULLS: Final = 8
NEARLY: Final = 1e-3
"""In logarithms of a share."""


def equal_factors(search: Search, wanted: Array, begun: Array) -> Array:
    """One factor for all, each within its bounds.

    Args:
        search: the search.
        wanted: logarithms of the shares that may be beyond limits (targets,).
        begun: logarithms of factors to start from.
    """

    def at(value: float) -> Array:
        return np.asarray(np.clip(np.full(len(search.low), value), search.low, search.high))

    def beyond(value: float) -> float:
        return float((search.probabilities(at(value), slopes=False)[0] - wanted).max())

    low, high = float(search.low.min()), float(search.high.max())
    inside = outside = float(np.clip(begun.max(), low, high))
    sign = -1.0 if beyond(inside) > 0.0 else 1.0
    while low < outside < high or outside == inside:
        inside, outside = outside, min(max(outside + sign * BRACKET, low), high)
        if outside == inside:
            return at(outside)
        if (beyond(outside) > 0.0) == (sign > 0.0):
            break
    else:
        return at(outside)
    for _ in range(HALVINGS):
        middle = (inside + outside) / 2
        inside, outside = (inside, middle) if (beyond(middle) > 0.0) == (sign > 0.0) else (middle, outside)
    return at(min(inside, outside))


def least_cost(search: Search, wanted: Array, begun: Array) -> Array:
    """The least cost, by sequential quadratic programming; grades by exchanges after that.

    Args:
        search, wanted, begun: as of `equal_factors`.
    """
    kept: dict[bytes, tuple[Array, Array]] = {}

    def known(x: Array) -> tuple[Array, Array]:
        key = x.tobytes()
        if key not in kept:
            kept.clear()
            kept[key] = search.probabilities(x)
        return kept[key]

    scale = max(abs(search.cost(np.zeros(len(search.low)))), TINY)
    found = minimize(
        lambda x: search.cost(x) / scale,
        np.clip(begun, search.low, search.high),
        jac=lambda x: search.cost_slopes(x) / scale,
        bounds=list(zip(search.low, search.high, strict=True)),
        constraints=[{"type": "ineq", "fun": lambda x: wanted - known(x)[0], "jac": lambda x: -known(x)[1]}],
        method="SLSQP",
        options={"ftol": ACCURACY, "maxiter": ITERATIONS},
    )
    x = np.clip(np.asarray(found.x, dtype=np.float64), search.low, search.high)
    x = _pulled_in(search, wanted, x)
    return _graded(search, wanted, x) if is_graded(search).any() else x


def _pulled_in(search: Search, wanted: Array, x: Array) -> Array:
    """Factors a little tighter, all alike, where the programme ended outside."""
    for _ in range(PULLS):
        logs, slopes = search.probabilities(x)
        off = logs - wanted
        worst = int(np.argmax(off))
        if off[worst] <= NEARLY:
            return x
        rate = float(slopes[worst].sum())
        x = np.clip(x - (off[worst] / rate if rate > 0.0 else 0.1), search.low, search.high)
    return x


def is_graded(search: Search) -> NDArray[np.bool_]:
    """Which factors have a table of grades."""
    return np.array([isinstance(search.question.costs.of(name), Discrete) for name in search.names], dtype=bool)


def _graded(search: Search, wanted: Array, x: Array) -> Array:
    """Grades near a solution: the next tighter ones, then looser ones and exchanges as long as they cost less."""
    tables = {}
    for k, name in enumerate(search.names):
        cost = search.question.costs.of(name)
        if isinstance(cost, Discrete):
            logs = np.log(cost.factors)
            tables[k] = logs[(logs >= search.low[k] - ACCURACY) & (logs <= search.high[k] + ACCURACY)]
    x = x.copy()
    for k, logs in tables.items():
        below = logs[logs <= x[k] + ACCURACY]
        x[k] = below[-1] if len(below) else logs[0]

    def fits(other: Array) -> bool:
        return bool((search.probabilities(other, slopes=False)[0] <= wanted + NEARLY).all())

    def moved(own: Array, k: int, by: int) -> Array | None:
        place = int(np.argmin(np.abs(tables[k] - own[k]))) + by
        if not 0 <= place < len(tables[k]):
            return None
        other = own.copy()
        other[k] = tables[k][place]
        return other

    while True:
        looser = [own for k in tables if (own := moved(x, k, 1)) is not None]
        exchanged = [
            own
            for k in tables
            for steps in (1, 2)
            if (one := moved(x, k, steps)) is not None
            for n in tables
            if n != k and (own := moved(one, n, -1)) is not None
        ]
        cheaper = [own for own in looser + exchanged if search.cost(own) < search.cost(x) - ACCURACY]
        better = next((own for own in sorted(cheaper, key=search.cost) if fits(own)), None)
        if better is None:
            return x
        x = better
