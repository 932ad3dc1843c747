"""Question and search of an allocation: factors of tolerances, with design points on the way."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from tol3d.analyses.before_after import limits_of
from tol3d.analyses.costs import Costs, Discrete
from tol3d.analyses.form import STEP, Points, points_of
from tol3d.analyses.limit_state import Side, concerned
from tol3d.analyses.response import Response
from tol3d.analyses.stated_changes import shared
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.scene.nearest import hint
from tol3d.statistics.distributions.base import Stays

BOUNDS: Final = (0.5, 3.0)
BISECTIONS: Final = 40
TINY: Final = 1e-300
MOST_PPM: Final = 500_000.0
A_LITTLE: Final = 1e-4


@dataclass(frozen=True)
class Target:
    """A measure, the limits that count, and the fraction of builds that may be out of them.

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
    """Question of an allocation, besides its targets.

    Args:
        costs: of tolerances.
        bounds: of factors.
        own_bounds: of some contributors' factors.
        frozen: contributors that stay as they are.
        stays: of some contributors, which limit does.
        groups: contributors with a common factor, by the name of their tolerance; by default each line of the scene.
        beyond_least: True to allow draws below the physical minimum, as normal laws do anyway.
    """

    costs: Costs = field(default_factory=Costs)
    bounds: tuple[float, float] = BOUNDS
    own_bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    frozen: frozenset[str] = frozenset()
    stays: Mapping[str, Stays] = field(default_factory=dict)
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    beyond_least: bool = False


@dataclass(eq=False)
class Search:
    """Search of an allocation, and design points on the way.

    Args:
        response: with the tolerances of the scene.
        targets, question: of the allocation.
        groups: contributors by what has a factor.
        low, high: bounds of the logarithms of the factors.
        points: design points by measure and limit, at the factors that were moved to last.
        tangents: the same of limit states that are linear from there.
        at: logarithms of the factors that were moved to last.
    """

    response: Response
    targets: Sequence[Target]
    question: Question
    groups: Mapping[str, tuple[str, ...]]
    low: Array
    high: Array
    points: dict[tuple[str, Side], Points]
    tangents: dict[tuple[str, Side], Points] = field(default_factory=dict)
    at: Array | None = None

    @property
    def names(self) -> list[str]:
        """Names of groups that have a factor."""
        return list(self.groups)

    def factors(self, x: Array) -> dict[str, float]:
        """Factors from their logarithms."""
        return dict(zip(self.names, np.exp(np.clip(x, self.low, self.high)).tolist(), strict=True))

    def cost(self, x: Array) -> float:
        """Total cost."""
        return math.fsum(self.question.costs.of(name).of(own) for name, own in self.factors(x).items())

    def cost_slopes(self, x: Array) -> Array:
        """Change with the logarithms."""
        return np.array([self.question.costs.of(name).slope(own) for name, own in self.factors(x).items()])

    def scaled(self, x: Array) -> Response:
        """With their tolerances."""
        each = {own: factor for name, factor in self.factors(x).items() for own in self.groups[name]}
        return self.response.scaled(each, self.question.stays, physical=False)

    def probabilities(self, x: Array, *, slopes: bool = True) -> tuple[Array, Array]:
        """Logarithms of what is beyond each target's limits (targets,), and their slopes (targets, factors).

        By tangents at the factors that were moved to last.
        """
        other = self.scaled(x)
        nudged = self._nudged(other) if slopes else []
        logs, rates = [], []
        for target in self.targets:
            total, slope = 0.0, np.zeros(len(x))
            for key in self.keys(target):
                self.tangents[key] = followed = self.tangents[key].followed(other.of(target.measure))
                part = float(followed.each.sum())
                total += part
                slope += part * followed.slopes(nudged) if slopes else 0.0
            logs.append(math.log(max(total, TINY)))
            rates.append(slope / max(total, TINY))
        return np.array(logs), np.array(rates)

    def keys(self, target: Target) -> list[tuple[str, Side]]:
        """Its limits of which a design point is known."""
        return [key for key in self.points if key[0] == target.measure and key[1] in target.sides]

    def move_to(self, x: Array) -> None:
        """Follow the design points to other factors, and lay tangents there."""
        if self.at is not None and np.array_equal(self.at, x):
            return
        self.at, other = x.copy(), self.scaled(x)
        self.points = {key: own.followed(other.of(key[0])) for key, own in self.points.items()}
        self.tangents = {key: own.tangent() for key, own in self.points.items()}

    def _nudged(self, other: Response) -> list[tuple[Response, Response]]:
        """For each factor the response with it larger and smaller, by two steps to one side where a bound is near."""

        def at(name: str, steps: int) -> Response:
            factors = dict.fromkeys(self.groups[name], math.exp(steps * STEP))
            return other.scaled(factors, self.question.stays, physical=False)

        found = []
        for name in self.names:
            try:
                found.append((at(name, 1), at(name, -1)))
            except InputError:  # a zone no wider than what refines it
                found.append((at(name, 2), other))
        return found


def with_sides(response: Response, target: Target) -> Target:
    """A target that names its limits.

    Raises:
        InputError: the measure has no such limits, or no share can be that large.
    """
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


def begun(
    response: Response, targets: Sequence[Target], question: Question
) -> tuple[Search, dict[str, tuple[str, str]]]:
    """The search, and by name the contributors that are not searched, with the reason.

    Raises:
        InputError: a contributor that does not exist, or none whose tolerance can be scaled.
    """
    asked = {name for own in targets for name in concerned(response, response.of(own.measure).measures[0])}
    known = question.groups or response.lines
    grouped = {own: name for name, each in known.items() for own in each}
    groups: dict[str, tuple[str, ...]] = {}
    for contributor in response.contributors:
        if contributor.name in asked:
            name = grouped.get(contributor.name, contributor.name)
            groups[name] = known.get(name, (contributor.name,))
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
                response.scaled({one: 1.0 + A_LITTLE}, question.stays, physical=False)
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
        measures = [response.of(own.measure).measures[0] for own in targets]
        idle = (f"{measure.name}: {words}" for measure in measures if (words := response.nothing_acts(measure)))
        why = why or "; ".join(idle) or "none acts"
        raise InputError(f"expected contributors whose tolerances can be scaled, got none ({why})")
    search = Search(response, targets, question, free, np.array(low), np.array(high), {})
    for target in targets:
        for side in target.sides:
            limit = limits_of(response.of(target.measure).measures[0])[side]
            for x in (np.zeros(len(low)), search.high, (search.low + search.high) / 2):
                at = search.scaled(np.clip(x, search.low, search.high)).of(target.measure)
                if (found := points_of(at, side, limit)) is not None:
                    search.points[target.measure, side] = found
                    break
    search.move_to(np.zeros(len(low)))
    return search, held


def _refuse_strangers(
    names: Mapping[str, object] | frozenset[str], response: Response, question: Question, option: str
) -> None:
    groups = question.groups or response.lines
    known = {contributor.name for contributor in response.contributors} | set(groups)
    for name in names:
        for line, each in groups.items():
            if name in each and name not in groups and line not in names:
                raise InputError(f"{option}: {shared(name, line, each)}")
        if name not in known:
            raise InputError(f"{option}: expected a contributor, got {name!r}{hint(name, sorted(known))}")


def _reached(response: Response, question: Question, each: Sequence[str], bound: float) -> float:
    """A bound, or the factor nearest to it at which deviations are physical and zones contain their refinements."""

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
