"""Probability that a measure is out of a limit, where that is rare: design points and sampling.

In standard normals the most likely build that fails is the design point: the one of the limit nearest to the origin. By
the first order (FORM) the probability is Φ(-β), β its distance; the second order (SORM) knows curvatures too.
A measure that is read at random positions has a design point at each, and deviations with directions may have several:
they are sought from many starts, at several positions. Importance sampling draws about all of them; subset simulation
needs none.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, get_args

import numpy as np

from tol3d.analyses.design_points import DesignPoint
from tol3d.analyses.importance import importance_sampled
from tol3d.analyses.limit_state import Estimate, LimitState, Side
from tol3d.analyses.places import searched
from tol3d.analyses.response import Response
from tol3d.analyses.second_order import SecondOrder, second_order
from tol3d.analyses.subset import subset_simulated
from tol3d.errors import InputError

Method = Literal["importance", "subset", "form", "sorm"]

DRAWS: Final = 4800
"""Draws of importance sampling."""
LEVEL_DRAWS: Final = 14_000
"""Draws of each level of subset simulation: 10 % of error at 1e-7 or so, from 1e5 builds."""


@dataclass(frozen=True, eq=False)
class RareEvent:
    """Probability that a measure is out of a limit.

    Args:
        measure: name.
        limit, side: see LimitState.
        method: by which the probability was found.
        points: design points, the nearest first.
        first_order: Φ(-β), the mean of the positions; None where no design point was found.
        second_order: the same with curvatures; None where they were not asked for, or are not known.
        estimate: of the probability.
        evaluations: builds that it took.
    """

    measure: str
    limit: float
    side: Side
    method: Method
    points: tuple[DesignPoint, ...]
    first_order: float | None
    second_order: SecondOrder | None
    estimate: Estimate
    evaluations: int

    @property
    def probability(self) -> float:
        """By its method; NaN where first or second order have none."""
        found = self.estimate.probability
        return float("nan") if found is None else found

    @property
    def error(self) -> float:
        """One standard error of it; NaN for first and second order."""
        found = self.estimate.error
        return float("nan") if found is None else found

    @property
    def interval(self) -> tuple[float, float]:
        """That holds the probability with 95 % confidence; from 0 to 1 of first and second order."""
        return self.estimate.interval or (0.0, 1.0)


def rare_event(
    response: Response,
    side: Side,
    limit: float,
    *,
    method: Method | Literal["auto"] = "auto",
    draws: int | None = None,
    places: int = 16,
    starts: int = 2,
    alone: int = 8,
    seed: int = 1,
    activity: Callable[[str], None] = lambda text: None,
) -> RareEvent:
    """Probability that a measure is beyond a limit.

    Args:
        response: of that measure alone.
        side, limit: which, in its unit.
        method: auto takes importance sampling where every contributor has a smooth map from normals, else subset
            simulation.
        draws: of importance sampling, or of a level of subset simulation.
        places: positions at which design points are sought, drawn as the study draws them.
        starts: number of starting builds at each position.
        alone: the same if there is one position.
        seed: of all draws.
        activity: progress callback.

    Raises:
        InputError: no contributors, several measures, no such method, or a contributor without a smooth map from
            normals, by name.
    """
    response.refuse_no_contributors()
    if len(response.measures) != 1:
        raise InputError(f"expected one measure, got {', '.join(response.names)}")
    if method not in (*get_args(Method), "auto"):
        raise InputError(f"expected a method of auto, {', '.join(get_args(Method))}, got {method!r}")
    if method == "auto":
        method = "subset" if response.rough else "importance"
    if response.rough and method != "subset":
        have = "have" if len(response.rough) > 1 else "has"
        words = "expected contributors with a smooth map from normals; subset simulation (--method subset) does without"
        raise InputError(f"{words}: {', '.join(response.rough)} {have} none")
    state, before = LimitState(response, limit, side), response.evaluations
    generator = np.random.default_rng(seed)
    first, second = None, None
    points: tuple[DesignPoint, ...]
    if method == "subset":
        found = subset_simulated(state, draws or LEVEL_DRAWS, generator, activity)
        estimate = found.estimate
        points = (found.point,) if found.point else ()
    else:
        activity("design points")
        where = searched(state, places, starts, alone, generator)
        if method == "importance":
            activity("draws")
            estimate, where = importance_sampled(state, where, draws or DRAWS, generator)
        elif method == "sorm":
            second, why = second_order(state, where.points, where.weights, where.out)
            value = second.hohenbichler if second else None
            estimate = Estimate(value, None, None, warnings=_unsure(where.points, (why,) if why else ()))
        else:
            estimate = Estimate(where.first_order, None, None, warnings=_unsure(where.points, ()))
        first = where.first_order
        points = tuple(sorted((own for point in where.points for own in point), key=lambda own: own.beta))
    if idle := response.nothing_acts(state.measure):
        estimate = replace(estimate, warnings=(f"{idle}; the bound is that of plain draws",))
    evaluations = response.evaluations - before
    return RareEvent(state.measure.name, limit, side, method, points, first, second, estimate, evaluations)


def _unsure(points: Sequence[Sequence[DesignPoint]], more: tuple[str, ...]) -> tuple[str, ...]:
    """Warnings of what the approximation does not see."""
    lists = [point for point in points if point]
    if not lists:
        return ("no design point was found within 9 standard deviations: nothing is known (--method subset)", *more)
    notes = list(more)
    if any(len(own) > 1 for own in lists):
        several = max(map(len, lists))
        notes.append(f"up to {several} design points at a position, of which only the nearest counts here")
    if any(not own[0].smooth for own in lists):
        notes.append(
            "a design point lies at an edge, or where builds cannot be assembled: its first order means little"
        )
    return tuple(notes)


def limits_left(
    response: Response,
    measure: str | None = None,
    *,
    method: Method | Literal["auto"] = "auto",
    draws: int | None = None,
    seed: int = 1,
    activity: Callable[[str], None] = lambda text: None,
) -> tuple[RareEvent, ...]:
    """Probability of leaving each limit of a response's measures, or of one of them.

    Raises:
        InputError: no such measure, or none with a limit; see `rare_event`.
    """
    asked = response if measure is None else response.of(measure)
    found = []
    for own in asked.measures:
        sides: tuple[tuple[Side, float | None], ...] = (("low", own.lower_limit), ("high", own.upper_limit))
        for side, limit in sides:
            if limit is not None:
                name = f"{own.name}, {side} limit"

                def tell(text: str, name: str = name) -> None:
                    activity(f"{name}: {text}")

                alone, value = response.of(own.name), limit * own.per_internal
                found.append(rare_event(alone, side, value, method=method, draws=draws, seed=seed, activity=tell))
    if not found:
        whose = repr(measure) if measure is not None else "any measure that is one number a trial"
        raise InputError(f"expected a limit (lower_limit, upper_limit) of {whose}, got none")
    return tuple(found)
