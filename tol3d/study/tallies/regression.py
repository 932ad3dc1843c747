"""Sums of products of measures and their regressors, block by block, for variance shares and explanations."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import IndependentSums, RegressorSums
from tol3d.statistics.estimates.lazy import quick_products, sparse_products
from tol3d.statistics.estimates.variance_shares import Products, TargetSums
from tol3d.study.effects.regressors import RegressorSet, regressor_sets
from tol3d.study.system.outcome import METHODS
from tol3d.study.system.system import Columns
from tol3d.study.trials.simulation import Simulation

Sums = RegressorSums | IndependentSums
Key = tuple[str, str]
"""Method, or DIFFERENCE, and name of a measure."""
Among = Mapping[tuple[Key, ...], TargetSums]
"""Sums of products of columns with each other, by their methods and names."""

DIFFERENCE = "difference"  # of both methods, beside them
MANY_REGRESSORS = 64  # with more, compiling their product pays


def merged(sums: Sums, other: Sums) -> Sums:
    """Sums of the same measure over two blocks together.

    Raises:
        TypeError: they are of different kinds.
    """
    if isinstance(sums, RegressorSums) and isinstance(other, RegressorSums):
        return sums.merge(other)
    if isinstance(sums, IndependentSums) and isinstance(other, IndependentSums):
        return sums.merge(other)
    raise TypeError("sums of different kinds belong to different measures")


def target_sums(
    simulation: Simulation,
    columns: Columns,
    values: Mapping[Key, Array],
    products: Products,
) -> tuple[dict[Key, Sums], Among]:
    """Sums of each method's column of each measure with its regressors, by method and name.

    The second result has the sums of columns with each other, if they have the same regressors and no trial lacks one.

    Args:
        simulation: of the measures.
        columns: of a block.
        values: of methods and their difference (trials,), by method and scalar measure; NaN where a trial lacks one.
        products: of all pairs of rows.
    """
    sums: dict[Key, Sums] = {}
    among: dict[tuple[Key, ...], TargetSums] = {}
    for regressor_set in regressor_sets(simulation):
        keys = [
            (method, measure.name)
            for measure in regressor_set.measures
            for method in (*METHODS, DIFFERENCE)
            if (method, measure.name) in values
        ]
        multiply = quick_products() if len(regressor_set) > MANY_REGRESSORS else products
        block = _Block(regressor_set, regressor_set.rows(simulation.system, columns), multiply)
        whole = [key for key in keys if not np.isnan(np.min(values[key], initial=0.0))]
        if whole:
            of_whole, together = block.sums(whole, np.stack([values[key] for key in whole]))
            sums |= of_whole
            if together is not None:
                among[tuple(whole)] = together
        lacking: dict[bytes, list[Key]] = {}
        for key in (key for key in keys if key not in sums):  # often the same trials failed
            lacking.setdefault(np.packbits(_good(key, keys, values)).tobytes(), []).append(key)
        for alike in lacking.values():
            good = _good(alike[0], keys, values)
            sums |= block.part(good).sums(alike, np.stack([values[key][good] for key in alike]))[0]
    return sums, among


def _good(key: Key, keys: Sequence[Key], values: Mapping[Key, Array]) -> NDArray[np.bool_]:
    """True for trials that no incomplete column of the measure lacks: methods and their difference."""
    rows = [values[method, name] for method, name in keys if name == key[1]]
    lacking = np.stack([row for row in rows if np.isnan(row).any()])
    return np.asarray(~np.isnan(lacking).any(axis=0))


class _Block:
    """Rows (regressors, trials) of a set's regressors in one block."""

    def __init__(self, regressor_set: RegressorSet, rows: Array, products: Products) -> None:
        self.regressor_set, self.rows, self.products = regressor_set, rows, products

    def part(self, good: NDArray[np.bool_]) -> "_Block":
        """Block of some of its trials."""
        return _Block(self.regressor_set, self.rows[:, good], self.products)

    def sums(self, keys: Sequence[Key], targets: Array) -> tuple[dict[Key, Sums], TargetSums | None]:
        """Sums of targets (targets, trials) with their regressors, and of the targets with each other if known."""
        measures = {measure.name: measure for measure in self.regressor_set.measures}
        regressed = [self.regressor_set.of(measures[name]) for _, name in keys]
        if not self.regressor_set.apart:
            rows = [regressors.rows for regressors in regressed]
            together, among = RegressorSums.with_targets(self.rows, targets, self.products, rows)
            return dict(zip(keys, together, strict=True)), among
        picked = [regressors.picked for regressors in regressed if regressors.picked is not None]
        apart = IndependentSums.of_each(self.rows, targets, self.regressor_set.clusters, picked, sparse_products())
        return dict(zip(keys, apart, strict=True)), None
