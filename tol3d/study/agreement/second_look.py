"""Some trials again with a part of their deviations: how the roads' difference grows tells of what order it is.

A first-order stack-up is right if its difference to the geometry goes as the square of the deviations. Along the ray
from the nominal build to a trial's the difference is D(t) = D(0) + t L + t^2 Q + ...: two short steps tell Q, which a
stack-up neglects, and what is left of D(1) is of first order, or jumps. A kink that the stack-up has too, such as the
one-sided loss by a tilt, is of first order as any slope.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines import Engine
from tol3d.gearing.model import Backlash, Measure, Model, Positions
from tol3d.runs.outcome import told
from tol3d.statistics import FeatureSums
from tol3d.study import draws
from tol3d.study.block import Block, Columns, drawn_block, simulate_block
from tol3d.study.regressors import features

Array = NDArray[np.float64]

SHORT_STEPS = (0.25, 0.5)  # of the deviations; of what is of third order three quarters are told as second
LONG_STEPS = (0.5, 1.0)  # for an engine with chord errors, which short steps would magnify
BEND_SIGMAS = 3.0  # where a contributor's second difference is taken
BEND_POSITIONS = 4  # drawn ones, over which it is averaged: what turns acts at each by another component


@dataclass(frozen=True, eq=False)
class SecondLook:
    """Differences (geometric - analytic) of some trials, by measure and in its unit; nan where a build did not seat.

    Args:
        block: the trials.
        whole: of their builds, (trials,).
        nominal: of the nominal build at their positions, (trials,).
        second_order: Q, (trials,).
        regressors: the features of each measure, (features, trials).
    """

    block: Block
    whole: Mapping[str, Array]
    nominal: Mapping[str, Array]
    second_order: Mapping[str, Array]
    regressors: Mapping[str, Array]

    def left(self, measure: str) -> Array:
        """What is neither there at the nominal build nor of second order, (trials,)."""
        return self.whole[measure] - self.nominal[measure] - self.second_order[measure]

    def sums(self, measure: str, target: Array) -> FeatureSums:
        """What a target (trials,) has in common with a measure's features, of the trials that it is known of."""
        good = ~np.isnan(target)
        return FeatureSums.of_each(self.regressors[measure][:, good], target[None, good])[0]


def scalars_of(model: Model) -> tuple[Measure, ...]:
    """The measures of one value a trial."""
    return tuple(measure for measure in model.measures if measure.take != "curve")


def second_look(model: Model, engine: Engine, count: int, others: Sequence[int]) -> SecondLook:
    """Look at a study's first `count` trials again, and behind them at some others."""
    alike, seed = replace(model, measures=scalars_of(model)), model.study.seed
    block = joined([drawn_block(model, seed, 0, count), *(drawn_block(model, seed, trial, 1) for trial in others)])
    near, far = SHORT_STEPS if engine.chord_error == 0.0 else LONG_STEPS
    columns = simulate_block(alike, engine, block)
    whole = _differences(alike, columns)
    nominal, at_near, at_far = (
        whole if step == 1.0 else _differences(alike, simulate_block(alike, engine, _shortened(block, step)))
        for step in (0.0, near, far)
    )
    ratio = far / near  # D(far) - ratio D(near) has no L left
    second_order = {
        name: ((at_far[name] - nominal[name]) - ratio * (at_near[name] - nominal[name])) / (near * far * (ratio - 1))
        for name in whole
    }
    regressors = {measure.name: features(model, measure, columns) for measure in alike.measures}
    return SecondLook(block, whole, nominal, second_order, regressors)


def _shortened(block: Block, step: float) -> Block:
    return Block(step * block.deviations, block.random_angle)


def _differences(model: Model, columns: Columns) -> Mapping[str, Array]:
    """Of builds that seat; a mesh that is jammed tells its backlash all the same, below 0."""

    def geometric(measure: Measure) -> Array:
        if isinstance(measure.kind, Backlash):
            return np.asarray(columns[f"geometric:{measure.name}"], dtype=np.float64)
        return told(columns, "geometric", measure.name).values

    return {m.name: geometric(m) - told(columns, "analytic", m.name).values for m in model.measures}


def bends(model: Model, engine: Engine) -> Mapping[str, Mapping[str, float]]:
    """Second differences of (geometric - analytic) at +-3 sigma of each contributor alone, by measure and contributor.

    Half of f(m + 3 s) - 2 f(m) + f(m - 3 s), averaged over positions, in the measure's unit; a contributor with
    components: their sum. Its ninth is what it shifts the mean by. nan where a build does not seat.
    """
    alike = replace(model, measures=scalars_of(model))
    middle = draws.mean_deviations(model, Positions("random", 1, 1))
    steps = np.diag([BEND_SIGMAS * c.draw.sigma for c in model.contributors for _ in c.draw.components])
    builds = np.concatenate([middle, middle + steps, middle - steps])
    drawn = drawn_block(model, model.study.seed, 0, BEND_POSITIONS)
    each = []
    for position in range(BEND_POSITIONS):  # one by one, for builds go with the square of the contributors
        angles = {mesh: np.full(len(builds), angle[position]) for mesh, angle in drawn.random_angle.items()}
        each.append(_differences(alike, simulate_block(alike, engine, Block(builds, angles))))
    return {m.name: _bends(model, np.stack([found[m.name] for found in each])) for m in alike.measures}


def _bends(model: Model, values: Array) -> Mapping[str, float]:
    """Of the differences (positions, 1 + 2 components) of the middle, of all steps forth and of all steps back."""
    count = model.component_count
    half = ((values[:, 1 : count + 1] + values[:, count + 1 :]) / 2 - values[:, :1]).mean(axis=0)
    return {name: float(half[own].sum()) for name, own in model.component_slices.items()}


def joined(blocks: Sequence[Block]) -> Block:
    """Several blocks as one, in their order."""
    angles = {mesh: np.concatenate([own.random_angle[mesh] for own in blocks]) for mesh in blocks[0].random_angle}
    return Block(np.concatenate([block.deviations for block in blocks]), angles)
