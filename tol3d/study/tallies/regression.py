"""Sums of measures with their regressors, block by block, for shares and explanations."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import IndependentSums, RegressorSums
from tol3d.statistics.estimates.lazy import quick_products, sparse_products
from tol3d.statistics.estimates.variance_shares import Products, TargetSums
from tol3d.study.effects.regressors import RegressorSet, regressor_sets
from tol3d.study.system.measure import Measure
from tol3d.study.system.outcome import METHODS
from tol3d.study.system.system import Columns
from tol3d.study.trials.simulation import Simulation

Sums = RegressorSums | IndependentSums
Key = tuple[str, str]
"""Method, or DIFFERENCE, and name of a measure."""
Among = Mapping[tuple[Key, ...], TargetSums]
"""Sums of columns among each other, by their methods and names."""

DIFFERENCE = "difference"  # of both methods, beside them
MANY_REGRESSORS = 64  # from here on compiling what multiplies them pays


def merged(sums: Sums, other: Sums) -> Sums:
    """Sums of the same measure, of both blocks."""
    if isinstance(sums, RegressorSums) and isinstance(other, RegressorSums):
        return sums.merge(other)
    if isinstance(sums, IndependentSums) and isinstance(other, IndependentSums):
        return sums.merge(other)
    raise TypeError("sums of different kinds belong to different measures")


def target_sums(
    simulation: Simulation,
    measures: Sequence[Measure],
    columns: Columns,
    values: Mapping[Key, Array],
    products: Products,
) -> tuple[dict[Key, Sums], Among]:
    """Sums of each method's column of each measure with its regressors, by method and name.

    And with those columns that have the same regressors and that no trial lacks.

    Args:
        simulation, measures: to be measured; scalar measures.
        columns: of a block.
        values: of methods and their difference, nan where a trial lacks one.
        products: of all pairs of rows.
    """
    sums: dict[Key, Sums] = {}
    among: dict[tuple[Key, ...], TargetSums] = {}
    for own in regressor_sets(simulation):
        keys = [(r, m.name) for m in own.measures for r in (*METHODS, DIFFERENCE) if (r, m.name) in values]
        block = _Block(
            own, own.rows(simulation.system, columns), quick_products() if len(own) > MANY_REGRESSORS else products
        )
        whole = [key for key in keys if not np.isnan(np.min(values[key], initial=0.0))]
        if whole:
            found, known = block.sums(whole, np.stack([values[key] for key in whole]))
            sums |= found
            if known is not None:
                among[tuple(whole)] = known
        lacking: dict[bytes, list[Key]] = {}
        for key in (key for key in keys if key not in sums):  # what failed is often the same trials
            lacking.setdefault(np.packbits(_good(key, keys, values)).tobytes(), []).append(key)
        for alike in lacking.values():
            good = _good(alike[0], keys, values)
            sums |= block.part(good).sums(alike, np.stack([values[key][good] for key in alike]))[0]
    return sums, among


def _good(key: Key, keys: Sequence[Key], values: Mapping[Key, Array]) -> NDArray[np.bool_]:
    """Trials that a method of a measure has; of one that lacks some, those that its difference has too."""
    rows = [values[method, name] for method, name in keys if name == key[1]]
    lacking = np.stack([row for row in rows if np.isnan(row).any()])
    return np.asarray(~np.isnan(lacking).any(axis=0))


class _Block:
    """The regressors (regressors, trials) of a set in one block."""

    def __init__(self, regressor_set: RegressorSet, rows: Array, products: Products) -> None:
        self.own, self.rows, self.products = regressor_set, rows, products

    def part(self, good: NDArray[np.bool_]) -> "_Block":
        """Block of some of its trials."""
        return _Block(self.own, self.rows[:, good], self.products)

    def sums(self, keys: Sequence[Key], targets: Array) -> tuple[dict[Key, Sums], TargetSums | None]:
        """Sums of targets (targets, trials), and those of the targets among each other where they are known."""
        known = {measure.name: measure for measure in self.own.measures}
        regressed = [self.own.of(known[name]) for _, name in keys]
        if not self.own.apart:
            rows = [own.rows for own in regressed]
            together, among = RegressorSums.with_targets(self.rows, targets, self.products, rows)
            return dict(zip(keys, together, strict=True)), among
        picked = [own.picked for own in regressed if own.picked is not None]
        apart = IndependentSums.of_each(self.rows, targets, self.own.clusters, picked, sparse_products())
        return dict(zip(keys, apart, strict=True)), None
