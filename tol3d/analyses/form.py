"""First order at many tolerances: design points that are followed from one set of tolerances to the next.

A design point moves little where tolerances change little, so that a step or two of Hasofer, Lind, Rackwitz and
Fiessler take it along. What a factor does to a distance β follows at the design point itself: the limit state's change
with the factor, the normals held, over the size of its gradient there.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp, ndtr

from tol3d.analyses.design_points import DesignPoint, design_points
from tol3d.analyses.limit_state import LimitState, Side
from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array
from tol3d.system.dependent import Dependent
from tol3d.system.measure import Measure

PLACES: Final = 16
STARTS: Final = 2
ALONE: Final = 8
"""Starts where there is one position."""
STEP: Final = 1e-3
"""Of central differences, in standard normals and in logarithms of factors."""
STEPS: Final = 12
MET: Final = 1e-3
"""A step that is left, in standard normals: a distance is then known to its square."""
LONGEST: Final = 3.0
"""Of a step, in standard normals."""
SEEN: Final = 0.01
"""Of the probability: design points that stand for less are left out."""
PLAIN: Final = 0.1
"""Share of the draws that are about no design point."""
LEAST: Final = 1e-300


@dataclass(frozen=True, eq=False)
class Points:
    """Design points of a limit, and where they are read.

    Args:
        state: whose.
        normals: (points, dimension).
        gradients: of the limit state there (points, dimension).
        positions: of each, a row.
        signs: 1; -1 where the build at the origin fails (points,).
        places: which position each is of (points,).
        count: of positions.
    """

    state: LimitState
    normals: Array
    gradients: Array
    positions: Mapping[str, Array]
    signs: Array
    places: Array
    count: int

    @property
    def betas(self) -> Array:
        """Distances from the origin, below 0 where the build there fails (points,)."""
        return np.asarray(self.signs * np.linalg.norm(self.normals, axis=1))

    @property
    def each(self) -> Array:
        """Probability that each stands for (points,), as a part of the mean over positions."""
        return np.asarray(ndtr(-self.betas) / self.count)

    @property
    def probability(self) -> float:
        """By first order, at most 1: the sum over the design points of a position, the mean over positions."""
        return min(1.0, float(self.each.sum()))

    def followed(self, response: Response) -> "Points":
        """The design points with other tolerances."""
        state = replace(self.state, response=response)
        z, gradients = self.normals.copy(), self.gradients.copy()
        signs = self.signs.copy()
        for _ in range(STEPS):
            inside, gradients = _at(state, z, self.positions)
            square = (gradients * gradients).sum(axis=1)
            known = np.isfinite(inside) & (square > LEAST)
            gradients, inside = np.where(known[:, None], gradients, 0.0), np.where(known, inside, 0.0)
            square = np.where(known, square, 1.0)
            aim = (((gradients * z).sum(axis=1) - inside) / square)[:, None] * gradients
            step = np.where(known[:, None], aim - z, 0.0)
            size = np.linalg.norm(step, axis=1)
            z = z + step * np.minimum(1.0, LONGEST / np.maximum(size, LEAST))[:, None]
            if float(size.max(initial=0.0)) < MET:
                break
        # ∇g · z is below 0 where the limit lies in the way from a good origin, above 0 from one that fails
        outwards = (gradients * z).sum(axis=1)
        signs = np.where(outwards < 0.0, 1.0, np.where(outwards > 0.0, -1.0, signs))
        return replace(self, state=state, normals=z, gradients=gradients, signs=signs)

    def sampled(self, draws: int, seed: int) -> tuple[float, float]:
        """Probability by importance sampling about the design points, and its standard error.

        Positions are those of the design points: what these leave out, `rare_event` finds.

        Args:
            draws: all of them; positions have as many each.
            seed: of the normals.
        """
        generator = np.random.default_rng(seed)
        each, dimension = max(2, draws // self.count), self.normals.shape[1]
        found = []
        for place in range(self.count):
            mine = np.flatnonzero(self.places == place)
            if not mine.size:
                continue
            centres = np.vstack([np.zeros((1, dimension)), self.normals[mine]])
            near = np.square(self.betas[mine])
            shares = np.exp(-0.5 * (near - near.min())) * (self.signs[mine] > 0.0)
            weights = np.concatenate([[PLAIN], (1.0 - PLAIN) * shares / max(float(shares.sum()), LEAST)])
            weights /= weights.sum()
            z = centres[generator.choice(len(weights), size=each, p=weights)]
            z = z + generator.standard_normal((each, dimension))
            row = {name: np.repeat(own[mine[:1]], each, axis=0) for name, own in self.positions.items()}
            inside, seated = self.state.at(z, row)
            with np.errstate(invalid="ignore"):
                fails = ~seated & ~(inside < 0.0) | ~(inside >= 0.0)
            tilt = z[fails] @ centres.T - 0.5 * (centres * centres).sum(axis=1)
            ratio = np.zeros(each)
            ratio[fails] = np.exp(-logsumexp(tilt, axis=1, b=weights))
            found.append((float(ratio.mean()), float(ratio.var(ddof=1)) / each))
        means, variances = np.array(found).T
        return float(means.sum() / self.count), math.sqrt(float(variances.sum())) / self.count

    def slopes(self, x: Array, at: Callable[[Array], Response]) -> Array:
        """Change of the logarithm of the probability with the logarithm of each factor (factors,).

        Args:
            x: logarithms of the factors (factors,).
            at: the response of one measure at any of them.
        """
        sizes = np.maximum(np.linalg.norm(self.gradients, axis=1), LEAST)
        weights = np.exp(-0.5 * self.betas**2) / math.sqrt(2 * math.pi) / self.count
        found = []
        for shift in STEP * np.eye(len(x)):
            ends = [
                replace(self.state, response=at(own)).at(self.normals, self.positions)[0]
                for own in (x + shift, x - shift)
            ]
            change = np.nan_to_num((ends[0] - ends[1]) / (2 * STEP)) / sizes  # of β
            found.append(-float((weights * change).sum()))
        return np.array(found) / max(float(self.each.sum()), LEAST)


def points_of(response: Response, side: Side, limit: float, *, seed: int = 1) -> Points | None:
    """The design points of a limit of one measure; None where there is none.

    Args:
        response: of that measure alone.
        side, limit: which, in its unit.
        seed: of positions and starts.
    """
    generator = np.random.default_rng(seed)
    moves = bool(response.simulation.system.streams)
    count = PLACES if moves else 1
    positions = response.positions(count, "drawn" if moves else "rest", int(generator.integers(2**31)))
    state = LimitState(response, limit, side)
    found = design_points(state, positions, count, STARTS if moves else ALONE, generator)
    own = [(place, point) for place, points in enumerate(found) for point in points]
    if not own:
        return None
    least = SEEN * max(float(ndtr(-point.beta)) for _, point in own)
    firsts = {place: min(points, key=lambda each: each.beta) for place, points in enumerate(found) if points}
    kept = [pair for pair in own if float(ndtr(-pair[1].beta)) >= least or pair[1] is firsts[pair[0]]]
    return _gathered(state, kept, count)


def _gathered(state: LimitState, own: Sequence[tuple[int, DesignPoint]], count: int) -> Points:
    return Points(
        state,
        np.array([point.normals for _, point in own]),
        np.array([point.gradient for _, point in own]),
        {name: np.concatenate([point.positions[name] for _, point in own]) for name in own[0][1].positions},
        np.array([-1.0 if point.beyond else 1.0 for _, point in own]),
        np.array([place for place, _ in own]),
        count,
    )


def _at(state: LimitState, z: Array, positions: Mapping[str, Array]) -> tuple[Array, Array]:
    """The limit state (n,) and its gradient by the normals (n, dimension), in one batch."""
    count, acting = len(z), _acting(state)
    shifts = np.zeros((1 + 2 * len(acting), z.shape[1]))
    shifts[1 + np.arange(len(acting)), acting] = STEP
    shifts[1 + len(acting) + np.arange(len(acting)), acting] = -STEP
    rows = {name: np.repeat(own, len(shifts), axis=0) for name, own in positions.items()}
    found = state.at((z[:, None] + shifts).reshape(-1, z.shape[1]), rows)[0].reshape(count, len(shifts))
    gradient = np.zeros_like(z)
    gradient[:, acting] = (found[:, 1 : len(acting) + 1] - found[:, len(acting) + 1 :]) / (2 * STEP)
    return found[:, 0], gradient


def _acting(state: LimitState) -> NDArray[np.int64]:
    """Normals of contributors that act on the measure, and of those that these read."""
    names = concerned(state.response, state.measure)
    kept = [own for name, own in state.response.normals.items() if name in names]
    return np.array([k for own in kept for k in range(own.start, own.stop)], dtype=np.int64)


def concerned(response: Response, measure: Measure) -> set[str]:
    """Contributors that act on a measure, those that these read, and those that are correlated with them."""
    draws = response.draws
    names = {own.name for own in response.simulation.system.acting(measure)}
    waiting = list(names)
    while waiting:
        own = waiting.pop()
        draw = draws[own]
        more = set(draw.reads) if isinstance(draw, Dependent) else set()
        more |= {name for block in response.copula.blocks if own in block.names for name in block.names}
        waiting += more - names
        names |= more
    return names
