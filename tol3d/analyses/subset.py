"""Subset simulation: failures as the last of nested events, each of which holds one build in ten of the former one.

It needs no gradient and no smooth map; positions are drawn like deviations. Its error is that of ten independent
repetitions, because the formula for one neglects the correlation of its chains.

Sources: Au and Beck 2001; Papaioannou, Betz, Zwirglmaier and Straub 2015 (adaptive conditional sampling).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.design_points import DesignPoint
from tol3d.analyses.limit_state import (
    MOST_UNSEEN,
    Estimate,
    LimitState,
    Positions,
    at_place,
    counted,
    effective,
    weighted_interval,
)
from tol3d.numerics.arrays import Array

SHARE: Final = 0.1
"""Fraction of each event in the former one."""
REPETITIONS: Final = 10
LEVELS: Final = 24
"""Most levels, down to a probability of 1e-24."""
ACCEPTED: Final = 0.44
"""Share of a chain's steps that should be accepted: the step's length is adapted to it."""
FIRST_STEP, LEAST_STEP = 0.6, 0.02
"""Length of a step along the normal in which the seeds spread most: at first, and at least."""
TURNED: Final = 0.2
"""Share of the steps that draw another position and keep the deviations; the others keep the position."""
FREQUENT: Final = 0.05
"""Probability from which on the first level, of plain draws, is enough."""
UNLIKE: Final = 0.6
"""Standard deviation of the repetitions over their mean, above which a warning is given."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Builds of a level: (repetitions, builds of each, ...).

    Args:
        normals: of deviations and then of positions, two for each stream, whose angle is the position.
        inside: the limit state, below 0 where a build fails; -inf where it cannot be assembled.
        unseated: True where a build cannot be assembled.
    """

    normals: Array
    inside: Array
    unseated: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Sampled:
    """Result of subset simulation.

    Args:
        estimate: of the probability.
        point: the nearest failing build to the origin that was drawn; None if none failed.
    """

    estimate: Estimate
    point: DesignPoint | None


def subset_simulated(
    state: LimitState, draws: int, generator: np.random.Generator, activity: Callable[[str], None] = lambda text: None
) -> Sampled:
    """The probability by subset simulation.

    Args:
        state: the limit state.
        draws: builds of each level, all repetitions together.
        generator: source of all draws.
        activity: progress callback, called at each level.
    """
    streams = len(state.response.simulation.system.streams)
    each = max(20, round(draws / REPETITIONS / 10) * 10)
    z = generator.standard_normal((REPETITIONS, each, state.dimension + 2 * streams))
    rows = _evaluated(state, z)
    fails = rows.inside < 0.0
    spent = z.shape[0] * each
    if fails.mean() > FREQUENT:
        return Sampled(counted(fails.ravel(), rows.unseated.ravel()), _nearest(state, rows, fails))
    logs, steps = np.zeros(REPETITIONS), np.full(REPETITIONS, FIRST_STEP)
    ended, last = np.zeros(REPETITIONS, dtype=bool), np.full(REPETITIONS, np.inf)
    shares = np.zeros(REPETITIONS)
    for level in range(LEVELS):
        activity(f"level {level + 1}")
        bounds = np.maximum(np.partition(rows.inside, int(SHARE * each) - 1, axis=1)[:, int(SHARE * each) - 1], 0.0)
        below = np.where(bounds[:, None] > 0.0, rows.inside <= bounds[:, None], rows.inside < 0.0)
        reached, stuck = ~ended & (bounds <= 0.0), ~ended & (bounds > 0.0) & (bounds >= last)
        shares[reached] = below[reached].mean(axis=1)
        ended |= reached | stuck
        if ended.all():
            break
        going = np.flatnonzero(~ended)
        logs[going] += np.log(below[going].mean(axis=1))
        last = bounds
        moved, steps[going] = _chains(state, rows, below, bounds, going, steps[going], generator)
        spent += moved.inside.size
        rows.normals[going], rows.inside[going], rows.unseated[going] = moved.normals, moved.inside, moved.unseated
    probabilities = np.where(shares > 0.0, np.exp(logs) * shares, 0.0)
    return Sampled(_estimate(rows, probabilities, spent, each), _nearest(state, rows, rows.inside < 0.0))


def _estimate(rows: Rows, probabilities: Array, spent: int, each: int) -> Estimate:
    """Mean and spread of the repetitions' probabilities (repetitions,)."""
    probability, error = float(probabilities.mean()), float(probabilities.std(ddof=1)) / math.sqrt(REPETITIONS)
    fails = rows.inside < 0.0
    reached = probabilities > 0.0
    per_build = np.where(reached, probabilities / np.maximum(fails.sum(axis=1), 1), 0.0)
    unseated = float((per_build[:, None] * (rows.unseated & fails)).sum()) / (probability * REPETITIONS or 1.0)
    notes: list[str] = []
    if not reached.all():
        missing = int((~reached).sum())
        which = "no repetition" if missing == REPETITIONS else f"{missing} of {REPETITIONS} repetitions"
        none = " reached the limit; the bound is that of the plain draws of the first level"
        notes.append(which + (none if missing == REPETITIONS else " did not reach the limit"))
    elif probabilities.std(ddof=1) > UNLIKE * probability:
        notes.append("the repetitions differ by much: take more draws a level (--draws)")
    freedoms = effective(probabilities) - 1.0  # fewer where some repetitions make most of the mean
    interval = weighted_interval(probability, error, freedoms, MOST_UNSEEN / (REPETITIONS * each))
    return Estimate(probability, error, interval, unseated, spent, tuple(notes))


def _positions(state: LimitState, z: Array) -> Positions:
    """Positions by the angle of two normals of each stream (n, 2 streams)."""
    system = state.response.simulation.system
    turns = np.arctan2(z[:, 1::2], z[:, 0::2]) / (2 * math.pi) % 1.0
    return system.positions({key: turns[:, k] for k, key in enumerate(system.streams)})


def _evaluated(state: LimitState, z: Array) -> Rows:
    flat, dimension = z.reshape(-1, z.shape[2]), state.dimension
    if state.response.simulation.system.streams:
        positions = _positions(state, flat[:, dimension:])
    else:
        positions = state.response.positions(len(flat), "rest")
    inside, seated = state.at(flat[:, :dimension], positions)
    unseated = ~seated & ~(inside < 0.0)
    inside = np.where(seated | (inside < 0.0), inside, -np.inf)
    inside[np.isnan(inside)] = -np.inf
    return Rows(z, inside.reshape(z.shape[:2]), unseated.reshape(z.shape[:2]))


def _chains(
    state: LimitState,
    rows: Rows,
    below: NDArray[np.bool_],
    bounds: Array,
    going: NDArray[np.int64],
    steps: Array,
    generator: np.random.Generator,
) -> tuple[Rows, Array]:
    """As many builds again within each event, by Markov chains from those in it; and the adapted step lengths."""
    each = rows.inside.shape[1]
    seeds = max(1, int(SHARE * each))
    length = each // seeds
    starts = np.array([_chosen(np.flatnonzero(below[k]), seeds, generator) for k in going])
    z = rows.normals[going[:, None], starts]
    current = Rows(z, rows.inside[going[:, None], starts], rows.unseated[going[:, None], starts])
    spread = np.minimum(z.std(axis=1), 1.0)[:, None]
    moving = bool(state.response.simulation.system.streams)
    kept: list[Rows] = []
    for _ in range(length):
        sigma = np.clip(steps[:, None, None] * spread / max(float(spread.max()), 1e-12), 1e-4, 1.0)
        noise = generator.standard_normal(current.normals.shape)
        stepped = np.sqrt(1.0 - sigma**2) * current.normals + sigma * noise
        turned = (
            generator.random(current.inside.shape) < TURNED if moving else np.zeros(current.inside.shape, dtype=bool)
        )
        proposed = np.where(turned[:, :, None], current.normals, stepped)
        proposed[:, :, state.dimension :] = np.where(turned[:, :, None], noise, current.normals)[
            :, :, state.dimension :
        ]
        moved = _evaluated(state, proposed)
        limits = bounds[going][:, None]
        good = np.where(limits > 0.0, moved.inside <= limits, moved.inside < 0.0)
        current = Rows(
            np.where(good[:, :, None], moved.normals, current.normals),
            np.where(good, moved.inside, current.inside),
            np.where(good, moved.unseated, current.unseated),
        )
        kept.append(current)
        accepted = (good & ~turned).sum(axis=1) / np.maximum((~turned).sum(axis=1), 1)
        steps = np.clip(steps * np.exp(accepted - ACCEPTED), LEAST_STEP, 1.0)
    joined = Rows(
        np.concatenate([chain_rows.normals for chain_rows in kept], axis=1),
        np.concatenate([chain_rows.inside for chain_rows in kept], axis=1),
        np.concatenate([chain_rows.unseated for chain_rows in kept], axis=1),
    )
    return joined, steps


def _chosen(rows: NDArray[np.int64], count: int, generator: np.random.Generator) -> NDArray[np.int64]:
    return generator.permutation(rows)[:count] if len(rows) >= count else generator.choice(rows, count)


def _nearest(state: LimitState, rows: Rows, fails: NDArray[np.bool_]) -> DesignPoint | None:
    """The failing build nearest to the origin, as a design point without a gradient."""
    if not fails.any():
        return None
    z = rows.normals[fails]
    dimension = state.dimension
    nearest = z[np.argmin((z[:, :dimension] ** 2).sum(axis=1))][None]
    positions = (
        _positions(state, nearest[:, dimension:])
        if state.response.simulation.system.streams
        else state.response.positions(1, "rest")
    )
    return DesignPoint(nearest[0, :dimension], at_place(positions, 0), np.zeros(dimension), smooth=False)
