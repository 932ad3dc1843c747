"""How often a measure leaves a limit, where that is too rare to wait for: design points, and importance sampling.

In standard normals the most likely build that fails is the design point: the one of the limit nearest to the origin. By
the first order (FORM) the probability is Φ(-β), β its distance. A measure that is read at random positions has a design
point at each, and deviations with directions may have several: they are sought from many starts, at several positions.
Importance sampling then draws about all of them, positions as the study does, and weighs each build by how much
likelier it was made: whatever the design points are worth, its mean is the probability.

Sources: Hasofer and Lind 1974; Rackwitz and Fiessler 1978; Zhang and Der Kiureghian 1995 (the step's length).
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp, ndtr
from scipy.stats import t as student

from tol3d.analyses.response import Response
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.system.measure import Measure

Side = Literal["low", "high"]

STEP: Final = 1e-3
"""Of central differences, in standard normals."""
ROUNDS: Final = 60
MET: Final = 1e-4
"""What is left of the limit, as a share of its distance from the mean build, and of the way across it."""
FURTHEST: Final = 9.0
"""From the origin, where nothing is looked for."""
HALVINGS: Final = 30
SHRINKS: Final = 6
"""How often a step is halved that leads nowhere."""
PENALTY: Final = 2.0
"""By how much more than needed the merit of a step counts the limit."""
LEAST: Final = 1e-300
AT_ORIGIN: Final = 1e-3
"""Of each normal, where a start is at the origin: there a length has no direction."""
SAME: Final = 0.1
"""Design points nearer to each other are one."""
PLAIN: Final = 0.1
"""Share of the draws that are not about any design point: no build that fails is then left out."""
FARTHER: Final = 1.5
"""How much farther than the nearest design point another one may be to be drawn about."""
CONFIDENCE: Final = 0.95


@dataclass(frozen=True, eq=False)
class LimitState:
    """Below 0 where a measure is beyond a limit; a build that does not seat fails.

    Args:
        response: of that measure alone.
        limit: in its unit.
        side: low, where less than the limit fails; high, where more does.
    """

    response: Response
    limit: float
    side: Side

    @property
    def measure(self) -> Measure:
        """Which."""
        return self.response.measures[0]

    def at(self, normals: Array, positions: Mapping[str, Array] | None) -> tuple[Array, NDArray[np.bool_]]:
        """How far builds (n, dimension) are within the limit (n,), and which seat; what does not seat has no number."""
        found = self.response.values(self.response.deviations(normals), positions)
        values = found.values[:, 0]
        return (values - self.limit if self.side == "low" else self.limit - values), found.seated[:, 0]

    def fails(self, normals: Array, positions: Mapping[str, Array] | None) -> NDArray[np.bool_]:
        """Whether builds are beyond the limit, or do not seat."""
        inside, seated = self.at(normals, positions)
        with np.errstate(invalid="ignore"):
            return np.asarray(~seated | ~(inside >= 0.0))


@dataclass(frozen=True, eq=False)
class DesignPoint:
    """The most likely build that fails, nearby.

    Args:
        normals: it (dimension,).
        positions: at which it is read, of one row.
        gradient: of the limit state there (dimension,).
        beyond: whether the build at the origin fails, and this one is the most likely that does not.
    """

    normals: Array
    positions: Mapping[str, Array]
    gradient: Array
    beyond: bool = False

    @property
    def beta(self) -> float:
        """Its distance from the origin; below 0 where the build there fails."""
        return float(np.linalg.norm(self.normals)) * (-1.0 if self.beyond else 1.0)

    @property
    def sensitivities(self) -> Array:
        """Direction cosines of the design point (dimension,): their squares are shares of the failures."""
        size = float(np.linalg.norm(self.normals))
        return self.normals / (size if size > 0.0 else 1.0)


@dataclass(frozen=True, eq=False)
class RareEvent:
    """How often a measure leaves a limit.

    Args:
        measure: its name.
        limit, side: see LimitState.
        points: design points, the nearest first.
        first_order: Φ(-β), the mean of the positions at which one was found; None where none was.
        probability: by importance sampling.
        error: of that, one standard error: by how much positions differ, or draws where there is one position.
        freedoms: of that error.
        draws: of importance sampling.
        evaluations: builds that it took.
    """

    measure: str
    limit: float
    side: Side
    points: tuple[DesignPoint, ...]
    first_order: float | None
    probability: float
    error: float
    freedoms: int
    draws: int
    evaluations: int

    @property
    def interval(self) -> tuple[float, float]:
        """That holds the probability with 95 % confidence, by its logarithm."""
        if not self.probability > 0.0:  # as of as many trials in which nothing fails
            return 0.0, -math.log((1 - CONFIDENCE) / 2) / self.draws
        quantile = float(student.ppf((1 + CONFIDENCE) / 2, self.freedoms))
        factor = math.exp(quantile * self.error / self.probability)
        return self.probability / factor, min(1.0, self.probability * factor)


def rare_event(
    response: Response,
    side: Side,
    limit: float,
    *,
    draws: int = 5600,
    places: int = 16,
    starts: int = 2,
    alone: int = 8,
    seed: int = 1,
) -> RareEvent:
    """How often a measure is beyond a limit.

    Args:
        response: of that measure alone.
        side, limit: which, in its unit.
        draws: of importance sampling.
        places: positions at which design points are sought, evenly spread as the study draws them.
        starts: at each position, from how many builds.
        alone: the same where there is one position.
        seed: of both.

    Raises:
        InputError: several measures, or a contributor without a smooth map from normals, by name.
    """
    if len(response.measures) != 1:
        raise InputError(f"expected one measure, got {', '.join(response.names)}")
    if response.rough:
        words = "expected contributors with a smooth map from normals; subset simulation does without"
        raise InputError(f"{words}: {', '.join(response.rough)} {'have' if len(response.rough) > 1 else 'has'} none")
    state, before = LimitState(response, limit, side), response.evaluations
    generator = np.random.default_rng(seed)
    count = places if response.simulation.system.streams else 1
    starts = starts if count > 1 else max(starts, alone)
    positions = response.positions(count, "drawn" if count > 1 else "rest", int(generator.integers(2**31)))
    points = design_points(state, positions, count, starts, generator)
    first = [float(ndtr(-its[0].beta)) for its in points if its]
    found = np.array(
        [_sampled(state, its, _at(positions, k), max(2, draws // count), generator) for k, its in enumerate(points)]
    )
    error = float(found[:, 0].std(ddof=1) / math.sqrt(count)) if count > 1 else float(found[0, 1])
    nearest = tuple(sorted((own for its in points for own in its), key=lambda own: own.beta))
    return RareEvent(
        state.measure.name,
        limit,
        side,
        nearest,
        float(np.mean(first)) if first else None,
        float(found[:, 0].mean()),
        error,
        count - 1 if count > 1 else draws,
        draws,
        response.evaluations - before,
    )


def limits_left(
    response: Response,
    measure: str | None = None,
    *,
    draws: int = 5600,
    seed: int = 1,
    activity: Callable[[str], None] = lambda text: None,
) -> tuple[RareEvent, ...]:
    """How often each limit of a response's measures is left, or of one of them.

    Raises:
        InputError: no such measure, or none with a limit; see `rare_event`.
    """
    asked = response if measure is None else response.of(measure)
    found = []
    for own in asked.measures:
        sides: tuple[tuple[Side, float | None], ...] = (("low", own.lower_limit), ("high", own.upper_limit))
        for side, limit in sides:
            if limit is not None:
                activity(f"{own.name}, {side} limit")
                alone = response.of(own.name)
                found.append(rare_event(alone, side, limit * own.per_internal, draws=draws, seed=seed))
    if not found:
        whose = repr(measure) if measure is not None else "any measure that is one number a trial"
        raise InputError(f"expected a limit (lower_limit, upper_limit) of {whose}, got none")
    return tuple(found)


def _at(positions: Mapping[str, Array], place: int) -> Mapping[str, Array]:
    return {name: own[place : place + 1] for name, own in positions.items()}


def design_points(
    state: LimitState, positions: Mapping[str, Array], places: int, starts: int, generator: np.random.Generator
) -> tuple[tuple[DesignPoint, ...], ...]:
    """Design points at each of several positions, from several starts, all in batches; the nearest ones first."""
    rows = {name: np.repeat(own, starts, axis=0) for name, own in positions.items()}
    begun = 0.5 * generator.standard_normal((places * starts, state.response.dimension))
    begun[::starts] = AT_ORIGIN
    walk = _Walk.begun(state, begun, rows)
    beyond = np.repeat(walk.inside[::starts] < 0.0, starts)
    for _ in range(ROUNDS):
        if not walk.step():
            break
    walk.end_on_rays(beyond)
    found = []
    for place in range(places):
        mine: list[int] = []
        ends = [k for k in range(place * starts, (place + 1) * starts) if walk.met[k]]
        for k in sorted(ends, key=lambda end: float(walk.sizes[end])):
            near = any(np.linalg.norm(walk.normals[k] - walk.normals[other]) < SAME for other in mine)
            if not near and walk.sizes[k] <= walk.sizes[mine[0] if mine else k] + FARTHER:
                mine.append(k)
        found.append(
            tuple(DesignPoint(walk.normals[k], _at(rows, k), walk.gradients[k], bool(beyond[k])) for k in mine)
        )
    return tuple(found)


@dataclass(eq=False)
class _Walk:
    """Rows on their way to design points, each by the steps of Rackwitz and Fiessler as far as they lead somewhere.

    Args:
        state: whose.
        positions: at which each row is read.
        normals: where they are (n, dimension).
        inside: the limit state there (n,).
        gradients: where they were found last (n, dimension).
        scale: of the limit state.
        met, ended: which are there, and which go no further (n,).
    """

    state: LimitState
    positions: Mapping[str, Array]
    normals: Array
    inside: Array
    gradients: Array
    scale: float
    met: NDArray[np.bool_]
    ended: NDArray[np.bool_]

    @classmethod
    def begun(cls, state: LimitState, normals: Array, positions: Mapping[str, Array]) -> "_Walk":
        """At their starts; those that do not seat go nowhere."""
        inside, _ = state.at(normals, positions)
        scale, none = float(np.nanmax(np.abs(inside), initial=0.0)) or 1.0, np.zeros(len(normals), dtype=bool)
        return cls(state, positions, normals, inside, np.zeros_like(normals), scale, none, ~np.isfinite(inside))

    @property
    def sizes(self) -> Array:
        """Distances from the origin (n,)."""
        return np.asarray(np.linalg.norm(self.normals, axis=1))

    def _rows(self, rows: NDArray[np.int64]) -> Mapping[str, Array]:
        return {name: own[rows] for name, own in self.positions.items()}

    def step(self) -> bool:
        """One step of all that are on their way; whether any is left."""
        rows = np.flatnonzero(~self.ended)
        if not rows.size:
            return False
        z, inside = self.normals[rows], self.inside[rows]
        gradient = _gradient(self.state, z, self._rows(rows))
        self.gradients[rows] = gradient
        square = np.maximum((gradient * gradient).sum(axis=1), LEAST)
        aim = ((gradient * z).sum(axis=1) - inside) / square
        steps = aim[:, None] * gradient - z
        left = np.linalg.norm(steps, axis=1)
        there = (np.abs(inside) <= MET * self.scale) & (left <= 10 * MET * (1.0 + np.linalg.norm(z, axis=1)))
        self.met[rows[there]] = self.ended[rows[there]] = True
        going = ~there
        weights = PENALTY * (1.0 + np.linalg.norm(z, axis=1)) / np.sqrt(square)
        self._go(rows[going], steps[going], weights[going])
        return True

    def end_on_rays(self, beyond: NDArray[np.bool_]) -> None:
        """Take rows that found no rest, such as at an edge of the limit, to it along their rays, if it is there."""
        rows = np.flatnonzero(~self.met & np.isfinite(self.inside) & (self.sizes > 0.0))
        if not rows.size:
            return
        own, sign = self._rows(rows), np.where(beyond[rows], -1.0, 1.0)
        low, high = np.zeros(len(rows)), FURTHEST / self.sizes[rows]
        crossed = sign * self.state.at(high[:, None] * self.normals[rows], own)[0] < 0.0
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            inside = sign * self.state.at(middle[:, None] * self.normals[rows], own)[0] >= 0.0
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        near = crossed & (high < 2.0)
        self.normals[rows[near]] *= high[near, None]
        self.met[rows[near]] = True

    def _go(self, rows: NDArray[np.int64], steps: Array, weights: Array) -> None:
        """As much of each step as makes rows better: nearer to the origin, or to the limit."""
        merits = 0.5 * self.sizes[rows] ** 2 + weights * np.abs(self.inside[rows])
        waiting, share = np.arange(len(rows)), 1.0
        for _ in range(SHRINKS):
            if not waiting.size:
                return
            own = rows[waiting]
            there = self.normals[own] + share * steps[waiting]
            inside, _ = self.state.at(there, self._rows(own))
            good = 0.5 * (there * there).sum(axis=1) + weights[waiting] * np.abs(inside) < merits[waiting]
            self.normals[own[good]], self.inside[own[good]] = there[good], inside[good]
            waiting, share = waiting[~good], share / 2
        self.ended[rows[waiting]] = True  # they lead nowhere


def _gradient(state: LimitState, z: Array, positions: Mapping[str, Array]) -> Array:
    """Of the limit state by the normals (n, dimension), by central differences in one batch."""
    dimension = z.shape[1]
    shifts = STEP * np.concatenate([np.eye(dimension), -np.eye(dimension)])
    builds = (z[:, None] + shifts).reshape(-1, dimension)
    rows = {name: np.repeat(own, 2 * dimension, axis=0) for name, own in positions.items()}
    found = state.at(builds, rows)[0].reshape(len(z), 2, dimension)
    return np.nan_to_num((found[:, 0] - found[:, 1]) / (2 * STEP))


def _sampled(
    state: LimitState,
    points: tuple[DesignPoint, ...],
    position: Mapping[str, Array],
    draws: int,
    generator: np.random.Generator,
) -> tuple[float, float]:
    """Probability at a position and its standard error, of normals about the design points and some that are not."""
    dimension, points = state.response.dimension, tuple(own for own in points if not own.beyond)
    centres = np.array([own.normals for own in points]).reshape(-1, dimension)
    shares = np.exp(-0.5 * np.array([own.beta**2 - points[0].beta ** 2 for own in points])) if points else np.zeros(0)
    weights = np.concatenate([[PLAIN if points else 1.0], (1 - PLAIN) * shares / shares.sum() if points else []])
    centres = np.vstack([np.zeros((1, dimension)), centres])
    z = centres[generator.choice(len(weights), size=draws, p=weights)] + generator.standard_normal((draws, dimension))
    fails = state.fails(z, {name: np.repeat(own, draws, axis=0) for name, own in position.items()})
    # φ(z) / Σ w φ(z - c), in logarithms: φ(z - c) / φ(z) = exp(z·c - c²/2)
    tilt = z[fails] @ centres.T - 0.5 * (centres * centres).sum(axis=1)
    ratio = np.zeros(draws)
    ratio[fails] = np.exp(-logsumexp(tilt, axis=1, b=weights))
    return float(ratio.mean()), float(ratio.std(ddof=1) / math.sqrt(draws))
