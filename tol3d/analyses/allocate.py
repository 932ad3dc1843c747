"""Tolerances at least cost for a share out of limits: by gradients of the first order, corrected until trials confirm.

How often limits are left is told by design points (FORM), with its change with each factor, and the least cost under
that is found by sequential quadratic programming in the logarithms of the factors. First order may be off by a factor:
importance sampling says by how much at what was found, the target is moved by that, and so on until it confirms the
result. What it says last, with another seed, is the result.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.optimize import minimize
from scipy.special import ndtr

from tol3d.analyses.changes import told
from tol3d.analyses.costs import Costs, Discrete
from tol3d.analyses.form import Points, concerned, points_of
from tol3d.analyses.limit_state import Side
from tol3d.analyses.rare import rare_event
from tol3d.analyses.response import Response
from tol3d.analyses.what_if import limits_of
from tol3d.distributions.base import Stays
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.runs.summary.values import Count, Known, Label, NotNegative, Number, Ppm, PpmRange, Section, Sentence, made
from tol3d.scene.nearest import hint

BOUNDS: Final = (0.5, 3.0)
ROUNDS: Final = 8
AIM: Final = 0.995
"""Of the target: what is aimed at, so that what is found is rather below."""
NEAR: Final = 0.97
"""Of the target: nearer than that is near enough."""
DAMPING: Final = 0.8
DRAWS: Final = 12_000
DIGITS: Final = 4
"""Of factors, which are rounded down."""
BISECTIONS: Final = 40
ACCURACY: Final = 1e-6
ITERATIONS: Final = 60
CURVE: Final = (0.1, 0.3, 3.0, 10.0)
"""Of the target: where else the cost is told."""
LOOKS: Final = 3
"""Last looks; after each that is not content the search goes on below."""
SURE: Final = 1.03
"""Of the target: what the last look may say at most."""
BRACKET: Final = 0.2
HALVINGS: Final = 10
FAR: Final = 0.02
"""Of a target: what first order has below that is within reach, however far it is off."""
TINY: Final = 1e-300
MOST_PPM: Final = 500_000.0
STRAIGHT: Final = 1e-3


@dataclass(frozen=True)
class Target:
    """A measure, which of its limits count, and what share of the builds may leave them.

    Args:
        measure: its name.
        sides: those of its limits; all if empty.
        ppm: of builds beyond them together.
    """

    measure: str
    sides: tuple[Side, ...]
    ppm: float


@dataclass(frozen=True)
class Question:
    """What is asked besides targets.

    Args:
        costs: of tolerances.
        bounds: of factors.
        own_bounds: of some contributors' factors.
        frozen: contributors that stay as they are.
        stays: of some contributors, which limit does.
        groups: contributors that have one factor together, by the name of their tolerance; each its own if not given.
        beyond_least: whether deviations may be drawn below what is physical, as normal laws do anyway.
    """

    costs: Costs = field(default_factory=Costs)
    bounds: tuple[float, float] = BOUNDS
    own_bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    frozen: frozenset[str] = frozenset()
    stays: Mapping[str, Stays] = field(default_factory=dict)
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    beyond_least: bool = False


class Allocated(Section):
    """A tolerance: its factor, what it costs, and why it is not another one."""

    factor: NotNegative
    cost: Number
    before: Label
    after: Label
    held: Sentence = Field(description='"", or what holds it: a bound, what is physical, frozen, cannot be scaled')


class TargetFound(Section):
    """How often limits are left [ppm], as it was asked for and as it was found."""

    measure: Label
    sides: list[Label]
    wanted: Ppm
    scene: Ppm
    first_order: Ppm
    ppm: Ppm
    interval: PpmRange


class CostAt(Section):
    """The least cost for a share out of limits [ppm], by first order as corrected; None where no factors reach it."""

    ppm: Ppm
    cost: Known


class Allocation(Section):
    """Factors of least cost, and what simulation says of them."""

    targets: list[TargetFound]
    tolerances: dict[Label, Allocated]
    cost: Number
    scene_cost: Number
    equal_factor: Known
    equal_cost: Known
    trade_off: list[CostAt]
    rounds: Count
    draws: Count
    evaluations: Count

    @property
    def factors(self) -> dict[str, float]:
        """By tolerance."""
        return {name: own.factor for name, own in self.tolerances.items()}


@dataclass(eq=False)
class _Search:
    """What is looked for, and design points on the way."""

    response: Response
    targets: Sequence[Target]
    question: Question
    groups: Mapping[str, tuple[str, ...]]
    low: Array
    high: Array
    points: dict[tuple[str, Side], Points]

    @property
    def names(self) -> list[str]:
        """Of what has a factor."""
        return list(self.groups)

    def factors(self, x: Array) -> dict[str, float]:
        """Of their logarithms."""
        return dict(zip(self.names, np.exp(np.clip(x, self.low, self.high)).tolist(), strict=True))

    def cost(self, x: Array) -> float:
        """Of all of them."""
        return math.fsum(self.question.costs.of(name).of(own) for name, own in self.factors(x).items())

    def cost_slopes(self, x: Array) -> Array:
        """Change with the logarithms."""
        return np.array([self.question.costs.of(name).slope(own) for name, own in self.factors(x).items()])

    def scaled(self, x: Array) -> Response:
        """With their tolerances."""
        each = {own: factor for name, factor in self.factors(x).items() for own in self.groups[name]}
        return self.response.scaled(each, self.question.stays, physical=False)

    def probabilities(self, x: Array, *, slopes: bool = True) -> tuple[Array, Array]:
        """Logarithms of what is beyond each target's limits (targets,), and their slopes (targets, factors)."""
        other, asked = self.scaled(x), slopes
        logs, rates = [], []
        for target in self.targets:
            own = [key for key in self.points if key[0] == target.measure and key[1] in target.sides]
            total, slope = 0.0, np.zeros(len(x))
            for key in own:
                followed = self.points[key].followed(other.of(target.measure))
                part = float(followed.each.sum())
                total += part
                slope += part * self._slopes(followed, x) if asked else 0.0
            logs.append(math.log(max(total, TINY)))
            rates.append(slope / max(total, TINY))
        return np.array(logs), np.array(rates)

    def move_to(self, x: Array) -> None:
        """Follow the design points to other factors, from where they are followed next."""
        other = self.scaled(x)
        self.points = {key: own.followed(other.of(key[0])) for key, own in self.points.items()}

    def _slopes(self, points: Points, x: Array) -> Array:
        def at(logarithms: Array) -> Response:
            each = np.exp(logarithms)
            factors = {n: float(f) for name, f in zip(self.names, each, strict=True) for n in self.groups[name]}
            return self.response.scaled(factors, self.question.stays, physical=False).of(*points.state.response.names)

        return points.slopes(np.clip(x, self.low, self.high), at)


def allocation(
    response: Response,
    targets: Sequence[Target],
    question: Question | None = None,
    *,
    draws: int = DRAWS,
    seed: int = 1,
    activity: Callable[[str], None] = lambda text: None,
) -> Allocation:
    """The least cost for shares out of limits.

    Args:
        response: with the tolerances of the scene.
        targets: one a measure.
        question: costs, bounds, what stays.
        draws: of importance sampling, each time.
        seed: of it; the last look has another one.
        activity: callback that gets what goes on, in words.

    Raises:
        InputError: no target, a measure without such limits, nothing to scale, or a target that no factors reach.
    """
    asked, before = question or Question(), response.evaluations
    targets = [_with_sides(response, own) for own in targets]
    if not targets:
        raise InputError("expected a measure with limits, got none")
    if response.rough:
        words = "expected contributors with a smooth map from normals, from which slopes of the ppm are known"
        raise InputError(f"{words}, got {', '.join(response.rough)}; ask tol3d what-if of single changes")
    search, held = _begun(response, targets, asked)
    wanted = np.log([1e-6 * own.ppm for own in targets])
    activity("the tightest tolerances")
    _refuse_out_of_reach(search, draws, seed)
    zero = np.zeros(len(search.low))
    scene = _sampled(search, zero, draws, seed)
    rounds = _Rounds(search, draws, seed, activity, np.zeros(len(targets)))
    activity("equal factors")
    equal = rounds.solved(_equal, zero, wanted)
    x, last = equal, []
    goal = wanted
    for _ in range(LOOKS):
        x = _rounded(search, rounds.solved(_least, x, goal))
        activity("confirmation")
        last = _looked(search, x, 2 * draws, seed + 1)
        off = np.log([max(own.probability, TINY) for own in last]) - wanted
        if float(off.max()) <= math.log(SURE):
            break
        goal = goal - np.maximum(off, 0.0)
    first = np.exp(search.probabilities(x)[0])
    curve = _trade_off(search, rounds.shift, x)
    return made(
        Allocation,
        targets=[
            made(
                TargetFound,
                measure=own.measure,
                sides=list(own.sides),
                wanted=own.ppm,
                scene=_ppm(float(at_scene)),
                first_order=_ppm(float(formed)),
                ppm=_ppm(found.probability),
                interval=[_ppm(end) for end in found.interval],
            )
            for own, at_scene, formed, found in zip(targets, scene, first, last, strict=True)
        ],
        tolerances=_told(search, x, held),
        cost=search.cost(x),
        scene_cost=search.cost(zero),
        equal_factor=float(np.exp(equal.max())),
        equal_cost=search.cost(equal),
        trade_off=curve,
        rounds=rounds.count,
        draws=draws,
        evaluations=response.evaluations - before,
    )


def _rounded(search: _Search, x: Array) -> Array:
    """Factors of a few digits, rounded down; grades stay."""
    down = np.log(np.floor(10**DIGITS * np.exp(x) + STRAIGHT) / 10**DIGITS)
    return np.where(_is_graded(search), x, np.maximum(down, search.low))


def _ppm(probability: float) -> float:
    return min(max(1e6 * probability, 0.0), 1e6)


def _with_sides(response: Response, target: Target) -> Target:
    (measure,) = response.of(target.measure).measures
    known = limits_of(measure)
    sides = target.sides or tuple(known)
    if not known or not set(sides) <= set(known):
        which = " and ".join(sides) or "lower or upper"
        raise InputError(
            f"{target.measure}: expected a measure with a limit ({which}), got "
            f"{' and '.join(known) or 'none'}; state lower_limit or upper_limit in the scene"
        )
    if not 0.0 < target.ppm < MOST_PPM:
        raise InputError(f"{target.measure}: expected a ppm above 0 and below {MOST_PPM:g}, got {target.ppm:g}")
    return Target(target.measure, sides, target.ppm)


def _begun(
    response: Response, targets: Sequence[Target], question: Question
) -> tuple[_Search, dict[str, tuple[str, str]]]:
    """The search, and by name of what is not searched the contributor whose tolerance it tells, and why."""
    asked = {name for own in targets for name in concerned(response, response.of(own.measure).measures[0])}
    grouped = {own: name for name, each in question.groups.items() for own in each}
    groups: dict[str, tuple[str, ...]] = {}
    for own in response.contributors:
        if own.name in asked:
            name = grouped.get(own.name, own.name)
            groups[name] = question.groups.get(name, (own.name,))
    for names, words in ((question.frozen, "--freeze"), (question.own_bounds, "--bound"), (question.stays, "--stays")):
        _refuse_strangers(names, response, question, words)
    free: dict[str, tuple[str, ...]] = {}
    held: dict[str, tuple[str, str]] = {}
    low, high = [], []
    for name, each in groups.items():
        if name in question.frozen or any(own in question.frozen for own in each):
            held[name] = (each[0], "frozen")
            continue
        try:
            for one in each:
                response.scaled({one: 1.0 + STRAIGHT / 10}, question.stays, physical=False)
        except InputError as error:
            held[name] = (each[0], str(error).partition("; ")[0].partition(": ")[2])
            continue
        bounds = question.own_bounds.get(name, question.bounds)
        graded = question.costs.of(name)
        if isinstance(graded, Discrete):
            bounds = (graded.factors[0], graded.factors[-1])
        free[name] = each
        low.append(math.log(_reached(response, question, each, bounds[0])))
        high.append(math.log(_reached(response, question, each, bounds[1])))
    if not free:
        why = "; ".join(f"{name}: {words}" for name, (_, words) in held.items())
        raise InputError(f"expected contributors whose tolerances can be scaled, got none ({why or 'none acts'})")
    search = _Search(response, targets, question, free, np.array(low), np.array(high), {})
    for target in targets:
        for side in target.sides:
            limit = limits_of(response.of(target.measure).measures[0])[side]
            for x in (np.zeros(len(low)), search.high, (search.low + search.high) / 2):
                at = search.scaled(np.clip(x, search.low, search.high)).of(target.measure)
                if (found := points_of(at, side, limit)) is not None:
                    search.points[target.measure, side] = found
                    break
    return search, held


def _refuse_strangers(
    names: Mapping[str, object] | frozenset[str], response: Response, question: Question, option: str
) -> None:
    known = {own.name for own in response.contributors} | set(question.groups)
    for name in names:
        if name not in known:
            raise InputError(f"{option}: expected a contributor, got {name!r}{hint(name, sorted(known))}")


def _reached(response: Response, question: Question, each: Sequence[str], bound: float) -> float:
    """A bound, or how far from 1 towards it deviations are physical and zones hold what refines them."""

    def fits(factor: float) -> bool:
        try:
            response.scaled(dict.fromkeys(each, factor), question.stays, physical=not question.beyond_least)
        except InputError:
            return False
        return True

    if fits(bound):
        return bound
    inside, outside = 1.0, bound
    for _ in range(BISECTIONS):
        middle = (inside + outside) / 2
        inside, outside = (middle, outside) if fits(middle) else (inside, middle)
    return inside


@dataclass(frozen=True)
class _Seen:
    probability: float
    interval: tuple[float, float]


def _sampled(search: _Search, x: Array, draws: int, seed: int) -> Array:
    """How often limits are left (targets,) by importance sampling about the design points, always from a seed."""
    other = search.scaled(x)
    found = np.zeros(len(search.targets))
    for k, target in enumerate(search.targets):
        for key, points in search.points.items():
            if key[0] == target.measure and key[1] in target.sides:
                found[k] += points.followed(other.of(target.measure)).sampled(draws, seed)[0]
    return found


def _looked(search: _Search, x: Array, draws: int, seed: int) -> list[_Seen]:
    """The same of each target by itself, whatever is known of it; of both limits the sum."""
    other = search.scaled(x)
    found = []
    for target in search.targets:
        alone = other.of(target.measure)
        limits = limits_of(alone.measures[0])
        events = [rare_event(alone, side, limits[side], draws=draws, seed=seed) for side in target.sides]
        total = math.fsum(own.probability for own in events)
        ends = [math.hypot(*(own.interval[end] - own.probability for own in events)) for end in (0, 1)]
        found.append(_Seen(total, (max(0.0, total - ends[0]), min(1.0, total + ends[1]))))
    return found


def _refuse_out_of_reach(search: _Search, draws: int, seed: int) -> None:
    formed = np.exp(search.probabilities(search.low)[0])
    if all(own < FAR * 1e-6 * target.ppm for own, target in zip(formed, search.targets, strict=True)):
        return
    for target, found in zip(search.targets, _looked(search, search.low, draws, seed), strict=True):
        if found.probability > 1e-6 * target.ppm:
            sides = " and ".join(target.sides)
            raise InputError(
                f"{target.measure}: expected a ppm that factors within their bounds reach, got {target.ppm:g}; the "
                f"nearest beyond the {sides} limit is {1e6 * found.probability:.3g} ppm, with every factor at its "
                f"lower bound; lower the bounds, ask for more ppm, or freeze fewer"
            )


Solve = Callable[[_Search, Array, Array], Array]


@dataclass(eq=False)
class _Rounds:
    """Solutions by first order whose target is moved until sampling confirms them.

    Args:
        search: what is looked for.
        draws, seed: of importance sampling.
        tell: callback that gets what goes on, in words.
        shift: by how much first order is off (targets,), in logarithms.
        count: of rounds.
    """

    search: _Search
    draws: int
    seed: int
    tell: Callable[[str], None]
    shift: Array
    count: int = 0

    def solved(self, solve: Solve, x: Array, wanted: Array) -> Array:
        """Factors of which sampling says that they reach what is wanted (targets,), in logarithms."""
        best: tuple[float, Array] | None = None
        for _ in range(ROUNDS):
            self.count += 1
            x = solve(self.search, wanted + math.log(AIM) - self.shift, x)
            self.search.move_to(x)
            seen = np.log(np.maximum(_sampled(self.search, x, self.draws, self.seed), TINY))
            off, cost = float((seen - wanted).max()), self.search.cost(x)
            self.tell(f"round {self.count}: cost {cost:.4g}, {math.exp(off):.3g} of the ppm")
            if off <= STRAIGHT and (best is None or cost < best[0]):
                best = cost, x
            if off <= STRAIGHT and (off >= math.log(NEAR) or bool((x >= self.search.high - ACCURACY).all())):
                break
            formed = self.search.probabilities(x)[0]
            self.shift = self.shift + DAMPING * (seen - formed - self.shift)
        return x if best is None else best[1]


def _equal(search: _Search, wanted: Array, begun: Array) -> Array:
    """One factor of all, each as far as its bounds let it."""

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


def _least(search: _Search, wanted: Array, begun: Array) -> Array:
    """The least cost, by sequential quadratic programming; grades by exchanges after that."""
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
    return _graded(search, wanted, x) if _is_graded(search).any() else x


def _pulled_in(search: _Search, wanted: Array, x: Array) -> Array:
    """Factors a little tighter, all alike, where the programme ended outside."""
    for _ in range(ROUNDS):
        logs, slopes = search.probabilities(x)
        off = logs - wanted
        worst = int(np.argmax(off))
        if off[worst] <= STRAIGHT:
            return x
        rate = float(slopes[worst].sum())
        x = np.clip(x - (off[worst] / rate if rate > 0.0 else 0.1), search.low, search.high)
    return x


def _is_graded(search: _Search) -> NDArray[np.bool_]:
    return np.array([isinstance(search.question.costs.of(name), Discrete) for name in search.names], dtype=bool)


def _graded(search: _Search, wanted: Array, x: Array) -> Array:
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
        return bool((search.probabilities(other, slopes=False)[0] <= wanted + STRAIGHT).all())

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


def _trade_off(search: _Search, shift: Array, x: Array) -> list[CostAt]:
    """The least cost for other shares, all targets' alike, by first order as it was corrected at the target."""
    wanted = np.log([1e-6 * own.ppm for own in search.targets])
    first = search.targets[0].ppm
    found = [made(CostAt, ppm=first, cost=search.cost(x))]
    for times in CURVE:
        if first * times >= MOST_PPM:
            continue
        goal = wanted + math.log(times) - shift
        own = _least(search, goal, x)
        reached = bool((search.probabilities(own)[0] <= goal + 10 * STRAIGHT).all())
        found.append(made(CostAt, ppm=first * times, cost=search.cost(own) if reached else None))
    return sorted(found, key=lambda own: own.ppm)


def _told(search: _Search, x: Array, held: Mapping[str, tuple[str, str]]) -> dict[str, Allocated]:
    response, other = search.response, search.scaled(x)
    by_name = {own.name: own for own in response.contributors}
    found = {}
    for k, (name, factor) in enumerate(search.factors(x).items()):
        first = search.groups[name][0]
        bounds = search.question.own_bounds.get(name, search.question.bounds)
        words = ""
        if x[k] >= search.high[k] - STRAIGHT:
            words = "upper bound" if factor >= bounds[1] - STRAIGHT else "at its physical least"
        elif x[k] <= search.low[k] + STRAIGHT:
            words = "lower bound" if factor <= bounds[0] + STRAIGHT else "refined: no tighter"
        found[name] = made(
            Allocated,
            factor=factor,
            cost=search.question.costs.of(name).of(factor),
            before=told(by_name[first], response.drawn_by(first)),
            after=told(by_name[first], other.drawn_by(first)),
            held=words,
        )
    for name, (first, words) in held.items():
        law = told(by_name[first], response.drawn_by(first))
        found[name] = made(Allocated, factor=1.0, cost=0.0, before=law, after=law, held=words)
    return found


def ppm_of_ppk(ppk: float) -> float:
    """The share beyond one limit [ppm] that a Ppk stands for: Φ(-3 Ppk).

    >>> round(ppm_of_ppk(1.33), 1)
    33.0
    """
    return 1e6 * float(ndtr(-3.0 * ppk))
