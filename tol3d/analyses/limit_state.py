"""The limit state of a measure: how far a build in standard normals is within a limit.

An estimated probability, with its confidence interval and warnings.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.stats import beta as beta_law
from scipy.stats import t as student

from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array
from tol3d.study.system.measure import Measure

Side = Literal["low", "high"]
Positions = Mapping[str, Array]

STEP: Final = 1e-3
"""Central differences, in standard normals."""
BUILDS, POSITIONS = 4, 5
"""Numbers of builds and positions that show whether a limit state reads positions."""


@dataclass(frozen=True, eq=False)
class LimitState:
    """A measure and one of its limits: below 0 where the measure is beyond it. A build that cannot be assembled fails.

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
        """The measure."""
        return self.response.measures[0]

    @property
    def dimension(self) -> int:
        """Number of standard normals."""
        return self.response.dimension

    @cached_property
    def acting(self) -> NDArray[np.int64]:
        """Normals of contributors that act on the measure, and of those that these read or are correlated with."""
        names = concerned(self.response, self.measure)
        kept = [own for name, own in self.response.normals.items() if name in names]
        return np.array([k for own in kept for k in range(own.start, own.stop)], dtype=np.int64)

    @cached_property
    def reads_positions(self) -> bool:
        """True where it differs with the position, by a few builds at a few of them, or where none of these seats."""
        if not self.response.simulation.system.streams:
            return False
        builds = np.random.default_rng(1).standard_normal((BUILDS, self.dimension))
        positions = self.response.positions(POSITIONS, "drawn")
        found, _ = self.at(np.repeat(builds, POSITIONS, axis=0), tiled(positions, BUILDS))
        each = found.reshape(BUILDS, POSITIONS)
        alike = np.array_equal(each, np.repeat(each[:, :1], POSITIONS, axis=1), equal_nan=True)
        return not alike or not np.isfinite(each).any()

    def at(self, normals: Array, positions: Positions | None) -> tuple[Array, NDArray[np.bool_]]:
        """Distance of builds (n, dimension) within the limit (n,), and which seat; one that does not has no number."""
        found = self.response.values(self.response.deviations(normals), positions)
        values = found.values[:, 0]
        return (values - self.limit if self.side == "low" else self.limit - values), found.seated[:, 0]

    def failing(self, normals: Array, positions: Positions | None) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Builds that are beyond the limit or cannot be assembled (n,), and those that cannot be assembled (n,)."""
        inside, seated = self.at(normals, positions)
        with np.errstate(invalid="ignore"):
            unseated = ~seated & ~(inside < 0.0)
            return np.asarray(~seated | ~(inside >= 0.0)), unseated

    def gradient(self, normals: Array, positions: Positions) -> Array:
        """Change of the limit state with the normals (n, dimension), by central differences in one batch."""
        acting, count = self.acting, len(self.acting)
        shifts = np.zeros((2 * count, normals.shape[1]))
        shifts[np.arange(count), acting] = STEP
        shifts[count + np.arange(count), acting] = -STEP
        builds = (normals[:, None] + shifts).reshape(-1, normals.shape[1])
        found = self.at(builds, repeated(positions, 2 * count))[0].reshape(len(normals), 2, count)
        gradient = np.zeros(normals.shape)
        gradient[:, acting] = np.nan_to_num((found[:, 0] - found[:, 1]) / (2 * STEP))
        return gradient


def concerned(response: Response, measure: Measure) -> frozenset[str]:
    """Contributors that act on a measure, those that these read, and those that are correlated with them."""
    names = response.read_by({own.name for own in response.acting(measure)})
    return names.union(*(block.names for block in response.copula.blocks if names & set(block.names)))


def repeated(positions: Positions, times: int) -> Positions:
    """Each position so many times in a row."""
    return {name: np.repeat(own, times, axis=0) for name, own in positions.items()}


def tiled(positions: Positions, times: int) -> Positions:
    """All positions so many times, one after the other."""
    return {name: np.tile(own, (times,) + (1,) * (own.ndim - 1)) for name, own in positions.items()}


def taken(positions: Positions, rows: NDArray[np.int64]) -> Positions:
    """Positions of some rows."""
    return {name: own[rows] for name, own in positions.items()}


def at_place(positions: Positions, place: int) -> Positions:
    """One of several positions, as a row."""
    return {name: own[place : place + 1] for name, own in positions.items()}


def beside(first: Positions, then: Positions) -> Positions:
    """Positions one after the other."""
    return {name: np.concatenate([own, then[name]]) for name, own in first.items()}


CONFIDENCE: Final = 0.95
MOST_UNSEEN: Final = -math.log(0.025)  # (1 - CONFIDENCE) / 2
"""Largest expected number of events of which none was drawn."""
MOST_FACTOR: Final = 1e6
"""Factor of an interval of which next to nothing is known."""


@dataclass(frozen=True)
class Estimate:
    """A probability by one method.

    Args:
        probability: of the failure.
        error: one standard error of it; None where it is not known.
        interval: that holds it with 95 % confidence; None where it is not known.
        unseated: share of the failing builds that cannot be assembled.
        draws: builds that were drawn for it.
        warnings: sentences.
    """

    probability: float | None
    error: float | None
    interval: tuple[float, float] | None
    unseated: float = 0.0
    draws: int = 0
    warnings: tuple[str, ...] = ()


def weighted_interval(probability: float, error: float, freedoms: float, unseen: float) -> tuple[float, float]:
    """By Student's law for the logarithm, on the rarer side.

    Args:
        probability, error: estimated.
        freedoms: of the error.
        unseen: upper bound if nothing was found.
    """
    if probability > 0.5:
        low, high = weighted_interval(1.0 - probability, error, freedoms, unseen)
        return 1.0 - high, 1.0 - low
    if not probability > 0.0:
        return 0.0, unseen
    quantile = float(student.ppf((1 + CONFIDENCE) / 2, max(freedoms, 1.0)))
    factor = min(math.exp(min(quantile * error / probability, 700.0)), MOST_FACTOR)
    return probability / factor, min(1.0, probability * factor)


def counted_interval(failed: int, draws: int) -> tuple[float, float]:
    """Clopper and Pearson's interval for a count of independent draws."""
    half = (1 - CONFIDENCE) / 2
    low = float(beta_law.ppf(half, failed, draws - failed + 1)) if failed else 0.0
    high = float(beta_law.ppf(1 - half, failed + 1, draws - failed)) if failed < draws else 1.0
    return low, high


def counted(fails: NDArray[np.bool_], unseated: NDArray[np.bool_], warnings: tuple[str, ...] = ()) -> Estimate:
    """The estimate of plain draws (n,)."""
    failed, draws = int(fails.sum()), len(fails)
    share = failed / draws
    error = math.sqrt(max(share * (1.0 - share), 1.0 / draws) / draws)
    among = float(unseated.sum()) / failed if failed else 0.0
    return Estimate(share, error, counted_interval(failed, draws), among, draws, warnings)


def effective(weights: Array) -> float:
    """Number of equal weights that say as much (Kish 1965)."""
    square = float((weights * weights).sum())
    return float(weights.sum()) ** 2 / square if square > 0.0 else 0.0
