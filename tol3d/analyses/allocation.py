"""Tolerances of least cost for a fraction out of limits: by first-order gradients, corrected until trials confirm.

Fractions out of limits and their slopes by each factor come from design points (FORM), and the least cost from
sequential quadratic programming in the logarithms of the factors, with tangents in place of the mechanism. At the
solution, design points and tangents are computed again. First order may be off by a factor: importance sampling
estimates it and the target is corrected, until the result is confirmed. The last sampling, with another seed, is
reported.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from tol3d.analyses.allocation_section import Allocated, Allocation, CostAt, TargetFound
from tol3d.analyses.before_after import limits_of
from tol3d.analyses.least_cost import equal_factors, is_graded, least_cost
from tol3d.analyses.rare_events import rare_event
from tol3d.analyses.response import Response
from tol3d.analyses.stated_changes import told
from tol3d.analyses.tolerance_search import MOST_PPM, TINY, Question, Search, Target, begun, with_sides
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.study.runs.summary.values import made

ROUNDS: Final = 8
"""Most solutions by first order, each corrected by sampling."""
TRIMS: Final = 8
"""Most samplings of a round, by which its solution is trimmed."""
NARROW: Final = 1e-3
"""Width of a bracket of trims that is narrow enough, in logarithms of factors."""
BETWEEN: Final = (0.15, 0.85)
"""Fractions of a bracket between which the next trim lies."""
MIDDLE: Final = 0.993
"""Fraction of the target that trims aim at."""
LONGEST: Final = 0.3
"""Largest trim, in logarithms of factors."""
LESS: Final = 2e-3
"""Fraction of the cost that another round has to save."""
AIM: Final = 0.995
"""Fraction of the target to aim at, so that the result is rather below."""
NEAR: Final = 0.97
"""Fraction of the target that is near enough."""
DAMPING: Final = 0.8
"""Part of the error of first order that a round corrects."""
DRAWS: Final = 12_000
DIGITS: Final = 4
"""Decimals of factors, which are rounded down."""
AT_BOUND: Final = 1e-6
"""Distance from a bound below which a factor lies at it, in logarithms."""
CURVE: Final = (0.1, 0.3, 3.0, 10.0)
"""Fractions of the target at which the cost is reported too."""
PASSES: Final = 2
"""Solutions for each point of the curve, each with new tangents."""
LOOKS: Final = 3
"""Final checks; after each that fails the search goes on below the target."""
SURE: Final = 1.03
"""Largest accepted result of a final check, over the target."""
FAR: Final = 0.02
"""Fraction of a target: if first order is below it at the lower bounds, the target can be reached."""
STRAIGHT: Final = 1e-3
"""Slack of comparisons of fractions and of factors, in logarithms; of rounding, in units of the last decimal."""


def allocation(
    response: Response,
    targets: Sequence[Target],
    question: Question | None = None,
    *,
    draws: int = DRAWS,
    seed: int = 1,
    activity: Callable[[str], None] = lambda text: None,
) -> Allocation:
    """Tolerances of least cost for fractions out of limits.

    Args:
        response: with the tolerances of the scene.
        targets: one per measure.
        question: costs, bounds, limits that stay.
        draws: of each importance sampling; the final checks have twice as many.
        seed: of importance sampling; the final checks have the next one.
        activity: progress callback.

    Raises:
        InputError: no target, a measure without such limits, nothing to scale, or a target that no factors reach.
    """
    before = response.evaluations
    targets = [with_sides(response, target) for target in targets]
    if not targets:
        raise InputError("expected a measure with limits, got none")
    if response.rough:
        words = "expected contributors with a smooth map from normals, from which slopes of the ppm are known"
        raise InputError(f"{words}, got {', '.join(response.rough)}; ask tol3d what-if of single changes")
    search, held = begun(response, targets, question or Question())
    wanted = np.log([1e-6 * target.ppm for target in targets])
    activity("the tightest tolerances")
    _refuse_out_of_reach(search, draws, seed)
    zero = np.zeros(len(search.low))
    at_scene = _sampled(search, zero, draws, seed)
    rounds = _Rounds(search, draws, seed, activity, np.zeros(len(targets)))
    activity("equal factors")
    equal = rounds.solved(equal_factors, zero, wanted, 2)
    x, checked = equal, []
    goal = wanted
    for _ in range(LOOKS):
        x = _rounded(search, rounds.solved(least_cost, x, goal))
        activity("confirmation")
        checked = _checked(search, x, 2 * draws, seed + 1)
        off = np.log([max(fraction.probability, TINY) for fraction in checked]) - wanted
        if float(off.max()) <= math.log(SURE):
            break
        goal = goal - np.maximum(off, 0.0)
    search.move_to(x)
    first_order = np.exp(search.probabilities(x, slopes=False)[0])
    curve = _trade_off(search, rounds.shift, x)
    return made(
        Allocation,
        targets=[
            made(
                TargetFound,
                measure=target.measure,
                sides=list(target.sides),
                wanted=target.ppm,
                scene=_ppm(float(scene)),
                first_order=_ppm(float(formed)),
                ppm=_ppm(fraction.probability),
                interval=[_ppm(end) for end in fraction.interval],
            )
            for target, scene, formed, fraction in zip(targets, at_scene, first_order, checked, strict=True)
        ],
        tolerances=_allocated(search, x, held),
        cost=search.cost(x),
        scene_cost=search.cost(zero),
        equal_factor=float(np.exp(equal.max())),
        equal_cost=search.cost(equal),
        trade_off=curve,
        rounds=rounds.count,
        draws=draws,
        evaluations=response.evaluations - before,
    )


def _rounded(search: Search, x: Array) -> Array:
    """Logarithms of factors rounded down to DIGITS decimals; grades stay."""
    down = np.log(np.floor(10**DIGITS * np.exp(x) + STRAIGHT) / 10**DIGITS)
    return np.where(is_graded(search), x, np.maximum(down, search.low))


def _ppm(probability: float) -> float:
    return min(max(1e6 * probability, 0.0), 1e6)


@dataclass(frozen=True)
class _Fraction:
    """Fraction out of limits by sampling, with its 95 % interval."""

    probability: float
    interval: tuple[float, float]


def _sampled(search: Search, x: Array, draws: int, seed: int) -> Array:
    """Fractions out of limits (targets,) by importance sampling about the design points, with the same seed."""
    search.move_to(x)
    fractions = {key: points.sampled(draws, seed)[0] for key, points in search.points.items()}
    return np.array([math.fsum(fractions[key] for key in search.keys(target)) for target in search.targets])


def _checked(search: Search, x: Array, draws: int, seed: int) -> list[_Fraction]:
    """Fraction out of limits of each target, by design points searched anew; of both limits the sum."""
    scaled = search.scaled(x)
    fractions = []
    for target in search.targets:
        alone = scaled.of(target.measure)
        limits = limits_of(alone.measures[0])
        events = [rare_event(alone, side, limits[side], draws=draws, seed=seed) for side in target.sides]
        total = math.fsum(event.probability for event in events)
        ends = [math.hypot(*(event.interval[end] - event.probability for event in events)) for end in (0, 1)]
        fractions.append(_Fraction(total, (max(0.0, total - ends[0]), min(1.0, total + ends[1]))))
    return fractions


def _refuse_out_of_reach(search: Search, draws: int, seed: int) -> None:
    """Refuse targets that are not reached with every factor at its lower bound.

    Raises:
        InputError: with the nearest fraction.
    """
    search.move_to(search.low)
    formed = np.exp(search.probabilities(search.low, slopes=False)[0])
    search.move_to(np.zeros(len(search.low)))
    if all(fraction < FAR * 1e-6 * target.ppm for fraction, target in zip(formed, search.targets, strict=True)):
        return
    for target, nearest in zip(search.targets, _checked(search, search.low, draws, seed), strict=True):
        if nearest.probability > 1e-6 * target.ppm:
            sides = " and ".join(target.sides)
            raise InputError(
                f"{target.measure}: expected a ppm that factors within their bounds reach, got {target.ppm:g}; the "
                f"nearest beyond the {sides} limit is {1e6 * nearest.probability:.3g} ppm, with every factor at its "
                f"lower bound; lower the bounds, ask for more ppm, or freeze fewer"
            )


Solve = Callable[[Search, Array, Array], Array]
"""From the logarithms of fractions wanted (targets,) and of factors to begin with, those of the solution."""


@dataclass(eq=False)
class _Rounds:
    """Solutions by first order, whose target is moved until sampling confirms them.

    Args:
        search: the search.
        draws, seed: of importance sampling.
        tell: progress callback.
        shift: logarithm of the sampled fraction over that of first order (targets,).
        count: number of samplings so far.
    """

    search: Search
    draws: int
    seed: int
    tell: Callable[[str], None]
    shift: Array
    count: int = 0

    def solved(self, solve: Solve, x: Array, wanted: Array, most: int = ROUNDS) -> Array:
        """Logarithms of factors that reach the wanted logarithms of fractions (targets,) by sampling.

        It ends if another round saves no cost, or after `most`.
        """
        best: tuple[float, Array] | None = None
        for _ in range(most):
            x = solve(self.search, wanted + math.log(AIM) - self.shift, x)
            x, sampled = self._trimmed(x, wanted)
            cost = self.search.cost(x)
            if float((sampled - wanted).max()) <= STRAIGHT:
                if best is not None and cost > best[0] - LESS * abs(best[0]):
                    break
                best = cost, x
            formed = self.search.probabilities(x, slopes=False)[0]
            self.shift = self.shift + DAMPING * (sampled - formed - self.shift)
        return x if best is None else best[1]

    def _trimmed(self, x: Array, wanted: Array) -> tuple[Array, Array]:
        """Factors a little tighter or looser, by one factor for all at no bound, and their fractions by sampling.

        By secants; as soon as a fraction that is too large and one that is not are known, between these, because the
        fraction drops abruptly where laws have limits.
        """
        begun, at, free = x, 0.0, np.zeros(0, dtype=bool)
        sides: dict[bool, tuple[float, float, Array, Array]] = {}
        graded = bool(is_graded(self.search).any())
        for _ in range(TRIMS):
            self.count += 1
            sampled = np.log(np.maximum(_sampled(self.search, x, self.draws, self.seed), TINY))
            off = float((sampled - wanted).max())
            self.tell(f"round {self.count}: cost {self.search.cost(x):.4g}, {math.exp(off):.3g} of the ppm")
            before = sides.get(off <= STRAIGHT)
            sides[off <= STRAIGHT] = at, off, x, sampled
            loosest = off <= 0.0 and bool((x >= self.search.high - AT_BOUND).all())
            if graded or loosest or math.log(NEAR) <= off <= STRAIGHT:
                break
            if not free.size:
                free = self._free(x, off)
            if len(sides) > 1:
                (low, low_off, *_), (high, high_off, *_) = sides[True], sides[False]
                if abs(high - low) < NARROW:
                    break
                share = (math.log(MIDDLE) - low_off) / (high_off - low_off)
                at = low + float(np.clip(share, *BETWEEN)) * (high - low)
            else:
                rate = self._rate(x, sampled - wanted, free) if before is None else (off - before[1]) / (at - before[0])
                if rate <= 0.0:
                    break
                at += float(np.clip((math.log(MIDDLE) - off) / rate, -LONGEST, LONGEST))
            x = np.clip(np.where(free, begun + at, begun), self.search.low, self.search.high)
        _, _, x, sampled = sides[True] if True in sides else sides[False]
        return x, sampled

    def _free(self, x: Array, off: float) -> NDArray[np.bool_]:
        """True for factors at no bound; if all are at one, for those that can move the right way."""
        below, above = x > self.search.low + AT_BOUND, x < self.search.high - AT_BOUND
        between = below & above
        return between if between.any() else above if off < 0.0 else below

    def _rate(self, x: Array, off: Array, free: NDArray[np.bool_]) -> float:
        """First-order slope of the logarithm of the fraction that is most off, by that of all free factors together."""
        slopes = self.search.probabilities(x)[1][int(np.argmax(off))]
        return float(slopes[free].sum())


def _trade_off(search: Search, shift: Array, x: Array) -> list[CostAt]:
    """The least cost for other fractions, all targets scaled alike, by first order as corrected at the target."""
    wanted = np.log([1e-6 * target.ppm for target in search.targets])
    first = search.targets[0].ppm
    costs = [made(CostAt, ppm=first, cost=search.cost(x))]
    for times in CURVE:
        if first * times >= MOST_PPM:
            continue
        goal = wanted + math.log(times) - shift
        factors = x
        for _ in range(PASSES):
            factors = least_cost(search, goal, factors)
            search.move_to(factors)
        reached = bool((search.probabilities(factors, slopes=False)[0] <= goal + 10 * STRAIGHT).all())
        costs.append(made(CostAt, ppm=first * times, cost=search.cost(factors) if reached else None))
    return sorted(costs, key=lambda cost_at: cost_at.ppm)


def _allocated(search: Search, x: Array, held: Mapping[str, tuple[str, str]]) -> dict[str, Allocated]:
    """Factors, costs and laws of all tolerances, those held by their words, too."""
    response, scaled = search.response, search.scaled(x)
    by_name = {contributor.name: contributor for contributor in response.contributors}
    allocated = {}
    for k, (name, factor) in enumerate(search.factors(x).items()):
        first = search.groups[name][0]
        bounds = search.question.own_bounds.get(name, search.question.bounds)
        words = ""
        if x[k] >= search.high[k] - STRAIGHT:
            words = "upper bound" if factor >= bounds[1] - STRAIGHT else "at its physical least"
        elif x[k] <= search.low[k] + STRAIGHT:
            words = "lower bound" if factor <= bounds[0] + STRAIGHT else "refined: no tighter"
        allocated[name] = made(
            Allocated,
            factor=factor,
            cost=search.question.costs.of(name).of(factor),
            before=told(by_name[first], response.drawn_by(first)),
            after=told(by_name[first], scaled.drawn_by(first)),
            held=words,
        )
    for name, (first, words) in held.items():
        law = told(by_name[first], response.drawn_by(first))
        allocated[name] = made(Allocated, factor=1.0, cost=0.0, before=law, after=law, held=words)
    return allocated


def ppm_of_ppk(ppk: float) -> float:
    """Fraction beyond one limit [ppm] of a normal distribution with that Ppk: Φ(-3 Ppk).

    >>> round(ppm_of_ppk(1.33), 1)
    33.0
    """
    return 1e6 * float(ndtr(-3.0 * ppk))
