"""Joint results of the measures of a study: the share of trials within all limits, and correlations."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import PairSums, Proportion
from tol3d.statistics.estimates.variance_shares import Products
from tol3d.study.runs.summary import run as summary
from tol3d.study.runs.summary.values import Method, made
from tol3d.study.system.measure import Measure
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC, METHODS, Mask, Outcome
from tol3d.study.tallies.regression import Among
from tol3d.study.tallies.replicated import Rows, interval_of_replicates
from tol3d.study.tallies.sample import finite, in_unit, listed
from tol3d.study.trials.simulation import Simulation

Outcomes = Mapping[tuple[str, str], Outcome]
Key = TypeVar("Key")

MOST_IN_SUMMARY = 64  # measures; of more, matrices in summary.json are of those that are correlated most


METHOD_WORDS: Final[Mapping[str, str]] = {ANALYTIC: "analytic", GEOMETRIC: "3D simulation"}


def limited(measures: Sequence[Measure]) -> list[Measure]:
    """The measures that have a limit, curves among them."""
    return [measure for measure in measures if (measure.lower_limit, measure.upper_limit) != (None, None)]


def correlated(measures: Sequence[Measure]) -> list[Measure]:
    """The measures whose correlations are found: those of one number a trial; none of one alone."""
    scalars = [measure for measure in measures if measure.take != "curve"]
    return scalars if len(scalars) > 1 else []


@dataclass(frozen=True)
class JointTally:
    """Joint results of measures, by method.

    Args:
        within: of all trials, those in which every measure that has a limit is valid and within its limits; empty
            where none has a limit.
        replicates: the same of each replicate; empty for independent trials.
        pairs: of the correlated measures, in their order; empty where there are none.
    """

    within: Mapping[str, Proportion]
    replicates: Mapping[str, Mapping[int, Proportion]]
    pairs: Mapping[str, PairSums]

    @classmethod
    def of(
        cls, measures: Sequence[Measure], outcomes: Outcomes, rows: Rows, products: Products, among: Among
    ) -> "JointTally":
        """Tally of one block.

        Args:
            measures: all of the study.
            outcomes: by method and name, of each method that was gone; of every scalar measure and every limited curve.
            rows: which trials belong to each replicate; empty for independent trials.
            products: see PairSums.of.
            among: what is known already of columns that no trial lacks.
        """
        methods = [method for method in METHODS if any(own == method for own, _ in outcomes)]
        judged, paired = limited(measures), correlated(measures)
        good = {method: _all_within(judged, method, outcomes) for method in methods} if judged else {}
        return cls(
            {method: _share(own) for method, own in good.items()},
            {key: {replicate: _share(own[part]) for replicate, part in rows.items()} for key, own in good.items()},
            {method: _pairs(paired, method, outcomes, products, among) for method in methods} if paired else {},
        )

    def merge(self, other: "JointTally") -> "JointTally":
        """Both tallies as one; fold blocks in their order."""
        return JointTally(
            _merged(self.within, other.within),
            {method: _merged(own, other.replicates[method]) for method, own in self.replicates.items()},
            {method: own.merge(other.pairs[method]) for method, own in self.pairs.items()},
        )


def _all_within(measures: Sequence[Measure], method: str, outcomes: Outcomes) -> Mask:
    """Trials (trials,) in which all of some measures are valid and within their limits."""
    first, *others = (_within(measure, outcomes[method, measure.name]) for measure in measures)
    for other in others:
        first &= other
    return first


def _within(measure: Measure, outcome: Outcome) -> Mask:
    """Trials (trials,) in which a measure is valid and within its limits, a curve at all of its positions.

    A value at a limit is within it; nan, of a trial that failed, is within none.
    """
    values = outcome.values
    lower, upper = in_unit(measure, measure.lower_limit), in_unit(measure, measure.upper_limit)
    inside = np.ones(values.shape, dtype=bool)
    if lower is not None:
        inside &= values >= lower
    if upper is not None:
        inside &= values <= upper
    return inside if inside.ndim == 1 else np.asarray(inside.all(axis=1))


def _pairs(measures: Sequence[Measure], method: str, outcomes: Outcomes, products: Products, among: Among) -> PairSums:
    """Sums of all pairs of measures by a method: those that are known, where no trial lacks any, and the others."""
    names = [measure.name for measure in measures]
    groups, ordered = [], list[str]()
    for keys, own in among.items():
        which = [k for k, (its_method, name) in enumerate(keys) if its_method == method and name in names]
        if which:
            groups.append(own.of(which))
            ordered += [keys[k][1] for k in which]
    if len(ordered) < len(names):
        return PairSums.of([outcomes[method, name].values for name in names], products)
    found = PairSums.of([outcomes[method, name].values for name in ordered], products, groups)
    return found.of_columns([ordered.index(name) for name in names])


def _share(good: Mask) -> Proportion:
    return Proportion(int(np.count_nonzero(good)), len(good))


def _merged(mine: Mapping[Key, Proportion], its: Mapping[Key, Proportion]) -> dict[Key, Proportion]:
    """Both; a replicate may have begun in one and end in the other."""
    both = {key: own.merge(its[key]) if key in its else own for key, own in mine.items()}
    return both | {key: own for key, own in its.items() if key not in mine}


# the summary --------------------------------------------------------------------------------------


def joint_summary(simulation: Simulation, tally: JointTally) -> summary.Joint | None:
    """Joint results of measures, as summary.json shows them; None where none has a limit and there are no two."""
    judged, paired = limited(simulation.system.measures), correlated(simulation.system.measures)
    if not judged and not paired:
        return None
    independent = simulation.study.sampler == "monte_carlo"
    yields = {cast(Method, method): _yield(own, tally.replicates[method]) for method, own in tally.within.items()}
    shown = _most_correlated(tally) if len(paired) > MOST_IN_SUMMARY else range(len(paired))
    pairs = {
        cast(Method, method): _correlations(own.of_columns(shown), independent=independent)
        for method, own in tally.pairs.items()
    }
    return made(
        summary.Joint,
        limited=[measure.name for measure in judged],
        yields=yields or None,
        correlated=[paired[k].name for k in shown],
        correlated_of=len(paired) if len(shown) < len(paired) else None,
        correlations=pairs or None,
    )


def _most_correlated(tally: JointTally) -> list[int]:
    """The MOST_IN_SUMMARY measures with the largest correlations by the best method, in the scene's order."""
    first, second = _ranked_pairs([*tally.pairs.values()][-1])
    found = dict.fromkeys(np.stack([first, second], axis=1).ravel().tolist())
    return sorted([*found][:MOST_IN_SUMMARY])


def _ranked_pairs(pair_sums: PairSums) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Both columns of each pair, the largest |r| first, pairs without one last."""
    first, second = np.triu_indices(len(pair_sums.means), 1)
    size = np.nan_to_num(np.abs(pair_sums.correlations[first, second]), nan=-1.0)
    order = np.argsort(-size, kind="stable")
    return first[order], second[order]


def correlation_rows(simulation: Simulation, tally: JointTally) -> Iterator[list[Any]]:
    """Lines of a table of all pairs of measures, its head first, the largest correlations on top; none of no pairs."""
    if not tally.pairs:
        return
    names = [measure.name for measure in correlated(simulation.system.measures)]
    first, second = _ranked_pairs([*tally.pairs.values()][-1])
    columns: dict[str, list[Any]] = {"measure": [names[i] for i in first], "other": [names[j] for j in second]}
    independent = simulation.study.sampler == "monte_carlo"
    for method, own in reversed([*tally.pairs.items()]):
        words = METHOD_WORDS[method]
        numbers = {f"r, {words}": own.correlations}
        if independent:  # what the bounds are worked out for
            low, high = own.interval()
            numbers |= {f"95 % from, {words}": low, f"95 % to, {words}": high}
        columns |= {key: [finite(value) for value in matrix[first, second].tolist()] for key, matrix in numbers.items()}
        columns[f"trials, {words}"] = own.counts[first, second].tolist()
    yield [*columns]
    yield from map(list, zip(*columns.values(), strict=True))


def _yield(proportion: Proportion, replicates: Mapping[int, Proportion]) -> summary.JointYield:
    interval = interval_of_replicates([*replicates.values()]) if replicates else proportion.interval_ppm()
    return made(
        summary.JointYield,
        trials=proportion.total,
        within=proportion.count,
        yield_ppm=proportion.ppm,
        yield_ppm_95=listed(interval),
    )


def _correlations(pair_sums: PairSums, *, independent: bool) -> summary.Correlations:
    low, high = map(_matrix, pair_sums.interval()) if independent else (None, None)
    return made(
        summary.Correlations,
        r=_matrix(pair_sums.correlations),
        r_low_95=low,
        r_high_95=high,
        trials=pair_sums.counts.tolist(),
    )


def _matrix(values: Array) -> list[list[float | None]]:
    return [[finite(value) for value in row] for row in values.tolist()]
