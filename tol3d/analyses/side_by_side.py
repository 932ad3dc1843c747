"""Methods side by side: a measure's worst case, its root sum of squares (RSS), modified RSS, and simulation.

The half tolerance of a contributor is half of its effect between its two ends, by its slopes at the mean build. The
ends are the limits of its law, or without limits its 0.135 % and 99.865 % percentiles, like ± 3 sigma of a normal law.
RSS is the root of the sum of their squares, the worst case by slopes (WC) their sum. Modified RSS is RSS × C_f, with
C_f = 1 + 0.5 (WC − RSS) / (RSS (√n − 1)) for n acting contributors: for n equal ones, whose WC is √n RSS, it is
1.5. Source: Drake, Dimensioning and Tolerancing Handbook, 1999, chapter 9.

The worst case itself is searched for, and is a bound from inside: see study/effects/worst_case.py.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import accumulate
from typing import Final, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.fitted_law import fitted
from tol3d.analyses.methods_section import BuildFound, MeasureMethods, Methods, MethodsSample, WorstFound
from tol3d.analyses.response import Response
from tol3d.analyses.subject import Subject
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import HIGH_PROBABILITY, LOW_PROBABILITY
from tol3d.study.effects.regions import (
    Built,
    Codes,
    Space,
    Standing,
    builds_in,
    gradient_of,
    random_ends,
    repeated,
    space_of,
    within_regions,
)
from tol3d.study.effects.worst_case import (
    SIGMA,
    Starts,
    WorstBuild,
    WorstCase,
    builds_a_row,
    first_starts,
    joined,
    worst_case,
)
from tol3d.study.effects.worst_cases import price
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.values import Unit, made
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC, SEATED, value_column
from tol3d.study.system.region import region_of
from tol3d.study.trials.correlated import value_correlations
from tol3d.study.trials.draws import drawn_ones
from tol3d.study.trials.simulation import Simulation

MOST_TRIALS: Final = 20_000
"""Default number of trials of a scene whose study has more."""
CONTACTS: Final = 6_000_000
"""Contacts evaluated for the worst case of one measure: some seconds."""
AT_ONCE: Final = 65_536
"""Trials evaluated in one batch."""
PLACES: Final = 4
"""Drawn positions at which a search begins from the mean build."""
WORST_TRIALS: Final = 3
"""Worst trials of each side from which a search begins, too."""
RANDOM: Final = 3
"""Builds with every contributor at a random end from which a search begins."""
JUDGED: Final = 256
"""Trials of each side among which the worst are looked for, after they are moved into the regions."""
FEWEST: Final = 6
"""Least rows of a search: the mean build and ends by slopes, of both sides."""
TOO_MANY: Final = 20.0
"""Factor on the affordable number of builds above which no search begins."""
NEGLIGIBLE: Final = 1e-9
"""Fraction of all half tolerances below which a contributor counts as without effect."""
CONSTANT: Final = 1e-12
"""Relative difference of values that count as equal."""
FEWEST_FITTED: Final = 100
"""Values to which a law is fitted, at least."""


class Trials(Protocol):
    """Trials that stand for the simulation."""

    def column(self, measure: str) -> Array:
        """A measure (trials,) in its unit, NaN for failed builds."""
        ...

    def builds(self, numbers: NDArray[np.int64]) -> tuple[Array, Standing]:
        """Deviations (n, components) and positions of some trials."""
        ...


@dataclass(frozen=True, eq=False)
class Drawn:
    """Trials drawn for this analysis, as the study draws them.

    Args:
        names: of the measures.
        values: (trials, measures), in their units; NaN for failed builds.
        deviations: of the trials (trials, components).
        positions: of the trials, by stream.
    """

    names: tuple[str, ...]
    values: Array
    deviations: Array
    positions: Standing

    @classmethod
    def of(cls, response: Response, count: int) -> "Drawn":
        """Trials of a response, `count` of them."""
        deviations, positions = response.drawn(count)
        values = []
        for first in range(0, count, AT_ONCE):
            rows = slice(first, first + AT_ONCE)
            part = response.values(deviations[rows], {name: column[rows] for name, column in positions.items()})
            values.append(np.where(part.seated, part.values, np.nan))
        return cls(response.names, np.concatenate(values), deviations, positions)

    def column(self, measure: str) -> Array:
        """See Trials."""
        return np.asarray(self.values[:, self.names.index(measure)])

    def builds(self, numbers: NDArray[np.int64]) -> tuple[Array, Standing]:
        """See Trials."""
        return self.deviations[numbers], {name: column[numbers] for name, column in self.positions.items()}


@dataclass(frozen=True, eq=False)
class Kept:
    """Trials kept by a run; their builds are drawn again when needed.

    Args:
        simulation: of the run.
        columns: values by measure (trials,), NaN for failed builds.
    """

    simulation: Simulation
    columns: Mapping[str, Array]

    def column(self, measure: str) -> Array:
        """See Trials."""
        return self.columns[measure]

    def builds(self, numbers: NDArray[np.int64]) -> tuple[Array, Standing]:
        """See Trials."""
        trials = drawn_ones(self.simulation, numbers.tolist())
        return trials.deviations, trials.positions


def trials_of(subject: Subject, response: Response, count: int | None = None) -> Trials:
    """The trials of a run, if it has kept those of all measures and no number is given; else drawn ones.

    Args:
        subject: a scene or a run.
        response: of its measures.
        count: number of trials; default: the study's, MOST_TRIALS at most.
    """
    run = subject.run
    if run is not None and count is None and run.keeps_trials:
        method = ANALYTIC if response.method is None else GEOMETRIC
        names = {name: (value_column(method, name), f"status:{name}") for name in response.names}
        if all(value in run.column_names for value, _ in names.values()):
            return Kept(response.simulation, {name: _kept(run, *columns) for name, columns in names.items()})
    return Drawn.of(response, count or min(response.simulation.study.trials, MOST_TRIALS))


def _kept(run: Run, value: str, status: str) -> Array:
    """Values of a run's column (trials,), NaN where its column of statuses has another than seated."""
    names = [value, *([status] if status in run.column_names else [])]
    columns = run.columns(*names)
    values = np.asarray(columns[value], dtype=np.float64)
    return np.where(np.asarray(columns[status]).astype(str) == SEATED, values, np.nan) if status in columns else values


def methods(
    response: Response, trials: Trials | None = None, activity: Callable[[str], None] = lambda text: None
) -> Methods:
    """Worst case, RSS, modified RSS and simulation of each measure of a response.

    Args:
        response: of the scene.
        trials: of the simulation; default: the study's number, MOST_TRIALS at most.
        activity: progress callback.
    """
    before = response.evaluations
    activity("trials")
    trials = trials or Drawn.of(response, min(response.simulation.study.trials, MOST_TRIALS))
    by_measure = {}
    for measure in response.measures:
        activity(measure.name)
        by_measure[measure.name] = _of_measure(response.of(measure.name), measure, trials)
    return made(
        Methods,
        scene=response.simulation.system.name,
        method="analytic" if response.method is None else "geometric",
        contributors={own.name: own.unit for own in response.contributors},
        measures=by_measure,
        evaluations=response.evaluations - before,
    )


def _of_measure(response: Response, measure: Measure, trials: Trials) -> MeasureMethods:
    before = response.evaluations
    source = response.curves.get(measure.name, measure)
    system = response.simulation.system
    space = space_of(system, source, response.draws, response.acting(measure))
    built = _built(response)
    at_rest = response.positions(1, "rest")
    mean = space.mean[None]
    value, _ = built(mean, at_rest)
    slopes = gradient_of(space, built, mean, at_rest, value, SIGMA)[0]
    halves = _half_tolerances(space, slopes)
    column = trials.column(measure.name)
    worst = _worst(response, source, space, built, trials, column)
    total = float(np.sum(halves))
    square = float(np.sum(halves**2)) + _correlated_squares(response, space, slopes)
    rss, count = math.sqrt(max(square, 0.0)), int(np.count_nonzero(halves > NEGLIGIBLE * total))
    factor = modified_factor(total, rss, count)
    sloping = total > 0.0 or not len(space.acting)
    return made(
        MeasureMethods,
        unit=cast(Unit, measure.unit),
        lower_limit=None if measure.lower_limit is None else measure.lower_limit * measure.per_internal,
        upper_limit=None if measure.upper_limit is None else measure.upper_limit * measure.per_internal,
        mean=_known(value[0]),
        contributors=count,
        by_slopes=total if sloping else None,
        rss=rss if sloping else None,
        factor=factor,
        modified_rss=None if factor is None else factor * rss,
        worst=None if worst is None else _worst_found(response, space, worst),
        nothing_acts=response.nothing_acts(measure),
        simulation=_sample(column, worst),
        evaluations=response.evaluations - before,
    )


def modified_factor(worst: float, rss: float, count: int) -> float | None:
    """C_f of modified RSS; None if fewer than two contributors act. Drake's motor of 11 dimensions has 1.326.

    Args:
        worst: the sum of half tolerances.
        rss: the root of the sum of their squares.
        count: number of acting contributors.

    >>> round(modified_factor(0.0955, 0.0381, 11), 3)
    1.325
    """
    if count < 2 or not rss > 0.0:
        return None
    return 1.0 + 0.5 * (worst - rss) / (rss * (math.sqrt(count) - 1.0))


def _built(response: Response) -> Built:
    def built(deviations: Array, positions: Standing) -> tuple[Array, Codes]:
        evaluated = response.values(deviations, positions)
        return evaluated.values[:, 0], evaluated.codes[:, 0]

    return built


def _half_tolerances(space: Space, slopes: Array) -> Array:
    """Half tolerances of acting contributors, one for each feature that is drawn by itself (parts,)."""
    halves = [np.zeros(0)]
    for drawing in space.drawings:
        if drawing.acts and slopes[drawing.columns].any():
            halves.append(region_of(drawing.draw, turning=drawing.turning).halves(slopes[drawing.columns]))
    return np.concatenate(halves)


def _correlated_squares(response: Response, space: Space, slopes: Array) -> float:
    """Addition of correlations to the sum of squares, which may be below 0; correlated contributors are scalars."""
    drawings, total = {drawing.name: drawing for drawing in space.drawings if drawing.acts}, 0.0
    for block in response.copula.blocks:
        signed = np.zeros(len(block.names))
        for k, name in enumerate(block.names):
            if name in drawings:
                drawing = drawings[name]
                slope = slopes[drawing.columns]
                halves = region_of(drawing.draw, turning=drawing.turning).halves(slope)
                signed[k] = float(np.sign(slope[0])) * float(halves.sum())
        others = value_correlations(block, response.draws) - np.eye(len(signed))
        total += float(signed @ others @ signed)
    return total


def _worst(
    response: Response, source: Measure, space: Space, built: Built, trials: Trials, values: Array
) -> WorstCase | None:
    """Worst case searched from the mean build, ends by slopes, the worst trials and other positions, as time allows.

    None if nothing acts, or a single search would take too long.
    """
    method = ANALYTIC_METHOD if response.method is None else response.simulation.study.engine
    builds = CONTACTS / price(response.simulation, method, source)
    rows = builds / max(1, builds_a_row(space))
    at_rest = response.positions(1, "rest")
    if not len(space.acting) or FEWEST * builds_a_row(space) > TOO_MANY * builds:
        return None
    trial_starts, within = [], []
    for sign in (-1.0, 1.0):
        from_trials, worst = _worst_trials(space, built, trials, values, sign)
        trial_starts += from_trials
        within += worst
    starts = [first_starts(space, built, at_rest, 0), *trial_starts]
    if response.simulation.system.streams:
        drawn = response.positions(PLACES, "drawn")
        starts.append(Starts.both_ways(builds_in(space, np.repeat(space.mean[None], PLACES, axis=0)), drawn))
    starts.append(Starts.both_ways(random_ends(space, RANDOM, seed=1), repeated(at_rest, RANDOM)))
    counts = list(accumulate(len(start.signs) for start in starts))
    afforded = [start for start, count in zip(starts, counts, strict=True) if count <= max(rows, FEWEST)]
    return worst_case(space, built, joined(afforded), most=int(builds)).with_builds(within)


def _worst_trials(
    space: Space, built: Built, trials: Trials, values: Array, sign: float
) -> tuple[list[Starts], list[WorstBuild]]:
    """Starts at the worst trials of a side, moved into the regions, and the worst trial that lies within them.

    Trials may lie outside, because laws without limits draw beyond their regions.
    """
    ranked = np.argsort(-sign * values)  # failed builds are last
    ranked = ranked[np.isfinite(values[ranked])][:JUDGED]
    if not ranked.size:
        return [], []
    deviations, positions = trials.builds(ranked)
    rows = builds_in(space, deviations)
    moved, _ = built(rows.deviations, positions)
    worst = np.argsort(np.where(np.isfinite(moved), -sign * moved, np.inf))[:WORST_TRIALS]
    at_worst = {name: column[worst] for name, column in positions.items()}
    starts = Starts(rows.at(worst), at_worst, np.full(len(worst), sign))
    inside = np.flatnonzero(within_regions(space, deviations))
    first = [
        WorstBuild(
            float(values[ranked[k]]), deviations[k], {name: column[k : k + 1] for name, column in positions.items()}
        )
        for k in inside[:1]
    ]
    return [starts], first


def _worst_found(response: Response, space: Space, worst: WorstCase) -> WorstFound:
    def shown(build: WorstBuild | None) -> BuildFound | None:
        if build is None:
            return None
        return made(
            BuildFound,
            measured=_known(build.value),
            status=response.simulation.system.statuses.texts[build.code],
            deviations={
                contributor.name: (build.deviations[space.drawings[k].columns] / contributor.per_unit + 0.0).tolist()
                for k, contributor in enumerate(response.contributors)
                if space.drawings[k].acts
            },
            positions={name: float(column[0]) for name, column in build.positions.items()},
        )

    return made(
        WorstFound,
        low=shown(worst.low),
        high=shown(worst.high),
        unseated=shown(worst.unseated),
        met=worst.met,
        evaluations=worst.evaluations,
    )


def _sample(column: Array, worst: WorstCase | None) -> MethodsSample:
    """Estimates by the values of trials (n,), NaN for failed ones, and the number beyond the worst case."""
    values = column[np.isfinite(column)]
    mean, sigma = (float(values.mean()), float(values.std(ddof=1))) if len(values) > 1 else (math.nan, math.nan)
    centred = values - mean if len(values) > 1 else values
    varies = sigma > CONSTANT * (abs(mean) or 1.0)
    enough = len(values) * LOW_PROBABILITY >= 1.0
    beyond = 0
    if worst is not None and worst.low is not None and worst.high is not None:
        slack = CONSTANT * max(abs(worst.low.value), abs(worst.high.value))
        beyond = int(np.sum((values < worst.low.value - slack) | (values > worst.high.value + slack)))
    return made(
        MethodsSample,
        trials=len(column),
        failed=len(column) - len(values),
        mean=_known(mean),
        sigma=_known(sigma),
        low_3sigma=_known(mean - 3 * sigma),
        high_3sigma=_known(mean + 3 * sigma),
        p0_135=_known(float(np.quantile(values, LOW_PROBABILITY))) if enough else None,
        p99_865=_known(float(np.quantile(values, HIGH_PROBABILITY))) if enough else None,
        sample_min=_known(float(values.min())) if len(values) else None,
        sample_max=_known(float(values.max())) if len(values) else None,
        skewness=_known(float((centred**3).mean() / sigma**3)) if varies else None,
        kurtosis=_known(float((centred**4).mean() / sigma**4 - 3.0)) if varies else None,
        beyond_worst=beyond,
        law=fitted(values) if varies and len(values) >= FEWEST_FITTED else None,
    )


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
