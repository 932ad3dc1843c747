"""First order at many tolerances: design points that are followed from one set of tolerances to the next.

A design point moves little where tolerances change little, so that a step or two of Hasofer, Lind, Rackwitz and
Fiessler take it along. The effect of a factor on a distance β follows at the design point itself: the limit state's
change with the factor, the normals held, over the size of its gradient there. About a design point the limit state is
nearly linear in the deviations, whatever the laws are: with that tangent no build is evaluated until the factors are
found.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp, ndtr

from tol3d.analyses.design_points import DesignPoint, design_points
from tol3d.analyses.limit_state import LimitState, Positions, Side
from tol3d.analyses.places import FEWEST_PLACES, FEWEST_STARTS, affordable
from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array
from tol3d.study.system.dependent import Dependent

PLACES: Final = 16
STARTS: Final = 2
ALONE: Final = 8
"""Starts where there is one position."""
STEP: Final = 1e-3
"""Step of central differences, in standard normals and in logarithms of factors."""
STEPS: Final = 12
MET: Final = 1e-3
"""Remaining step, in standard normals: a distance is then known to its square."""
LONGEST: Final = 3.0
"""Length of a step, in standard normals."""
SHARES: Final = (0.1, 1.5)
"""Least and largest share of a step that is gone."""
SEEN: Final = 0.01
"""Fraction of the probability: design points that contribute less are left out."""
PLAIN: Final = 0.1
"""Share of the draws that are about no design point."""
LEAST: Final = 1e-300


@dataclass(frozen=True, eq=False)
class Points:
    """Design points of a limit, and where they are read.

    Args:
        state: the limit state.
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
        """The design points with other tolerances.

        Steps that swing or creep are made shorter or longer, each point's by its last two (Irons and Tuck 1969).
        """
        state = replace(self.state, response=response)
        z, gradients = self.normals.copy(), self.gradients.copy()
        signs, shares, last = self.signs.copy(), np.ones(len(z)), np.zeros_like(z)
        for k in range(STEPS):
            inside, gradients = state.at(z, self.positions)[0], state.gradient(z, self.positions)
            square = (gradients * gradients).sum(axis=1)
            known = np.isfinite(inside) & (square > LEAST)
            gradients, inside = np.where(known[:, None], gradients, 0.0), np.where(known, inside, 0.0)
            square = np.where(known, square, 1.0)
            aim = (((gradients * z).sum(axis=1) - inside) / square)[:, None] * gradients
            step = np.where(known[:, None], aim - z, 0.0)
            size = np.linalg.norm(step, axis=1)
            if k:
                change = step - last
                shares *= -(last * change).sum(axis=1) / np.maximum((change * change).sum(axis=1), LEAST)
                shares = np.clip(shares, *SHARES)
            last = step
            z = z + step * np.minimum(shares, LONGEST / np.maximum(size, LEAST))[:, None]
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

    def tangent(self) -> "Points":
        """The same of a limit state that goes on from each of them linearly in the deviations."""
        state = self.state
        builds = state.response.deviations(self.normals)
        rates = state.response.gradient(builds, self.positions)[:, 0] * (1.0 if state.side == "low" else -1.0)
        inside = np.nan_to_num(state.at(self.normals, self.positions)[0])
        rates = np.nan_to_num(rates)
        return replace(self, state=Tangent(state.response, state.limit, state.side, builds, inside, rates))

    def slopes(self, nudged: Sequence[tuple[Response, Response]]) -> Array:
        """Change of the logarithm of the probability with the logarithm of each factor (factors,).

        Args:
            nudged: for each factor the response of one measure with it larger, and smaller, by `STEP`.

        Raises:
            TypeError: these are no design points of a tangent.
        """
        if not isinstance(self.state, Tangent):
            raise TypeError(f"expected design points of a tangent, got {type(self.state).__name__}")
        sizes = np.maximum(np.linalg.norm(self.gradients, axis=1), LEAST)
        weights = np.exp(-0.5 * self.betas**2) / math.sqrt(2 * math.pi) / self.count
        changes = [self.state.change(self.normals, *ends) / (2 * STEP) / sizes for ends in nudged]  # of β
        return np.array([-float((weights * change).sum()) for change in changes]) / max(float(self.each.sum()), LEAST)


@dataclass(frozen=True, eq=False)
class Tangent(LimitState):
    """A limit state that goes on linearly in the deviations from some builds: no mechanism is asked.

    Args:
        builds: deviations (points, components).
        inside: the limit state there (points,).
        rates: its change with the deviations (points, components).
    """

    builds: Array
    inside: Array
    rates: Array

    @cached_property
    def names(self) -> frozenset[str]:
        """Contributors with which it changes."""
        moves = (self.rates != 0.0).any(axis=0)
        return frozenset(name for name, own in self.response.slices.items() if moves[own].any())

    def at(self, normals: Array, positions: Positions | None) -> tuple[Array, NDArray[np.bool_]]:
        """As of a limit state; of as many rows for each of its builds, one build after the other."""
        rows = self.response.deviations(normals, self.names).reshape(len(self.builds), -1, self.builds.shape[1])
        found = self.inside[:, None] + ((rows - self.builds[:, None]) @ self.rates[:, :, None])[:, :, 0]
        return found.ravel(), np.ones(found.size, dtype=bool)

    def gradient(self, normals: Array, positions: Positions) -> Array:
        """As of a limit state; where draws read no others, the first normals of all are shifted at once, and so on."""
        response = self.response
        if response.copula.blocks or any(isinstance(response.draws[name], Dependent) for name in self.names):
            return super().gradient(normals, positions)
        own = [(response.normals[name], response.slices[name]) for name in self.names]
        most = max((its.stop - its.start for its, _ in own), default=0)
        shifts = np.zeros((2, most, normals.shape[1]))
        for its, _ in own:
            count = its.stop - its.start
            shifts[0, np.arange(count), its.start + np.arange(count)] = STEP
        shifts[1] = -shifts[0]
        builds = (normals[:, None] + shifts.reshape(-1, normals.shape[1])).reshape(-1, normals.shape[1])
        found = response.deviations(builds, self.names).reshape(len(normals), 2, most, self.builds.shape[1])
        moved = (found[:, 0] - found[:, 1]) / (2 * STEP) * self.rates[:, None]
        gradient = np.zeros(normals.shape)
        for its, columns in own:
            gradient[:, its] = moved[:, : its.stop - its.start, columns].sum(axis=2)
        return gradient

    def change(self, normals: Array, more: Response, less: Response) -> Array:
        """From one set of tolerances to another, the normals held (points,)."""
        names = {name for name, own in more.draws.items() if own is not less.draws[name]} & self.names
        moved = more.deviations(normals, names) - less.deviations(normals, names)
        return np.asarray((moved * self.rates).sum(axis=1))


def points_of(response: Response, side: Side, limit: float, *, seed: int = 1) -> Points | None:
    """The design points of a limit of one measure; None where there is none.

    Args:
        response: of that measure alone.
        side, limit: which, in its unit.
        seed: of positions and starts.
    """
    generator = np.random.default_rng(seed)
    state = LimitState(response, limit, side)
    moves = state.reads_positions
    count = affordable(state, PLACES, FEWEST_PLACES) if moves else 1
    positions = response.positions(count, "drawn" if moves else "rest", int(generator.integers(2**31)))
    starts = STARTS if moves else affordable(state, ALONE, FEWEST_STARTS)
    found = design_points(state, positions, count, starts, generator)
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
