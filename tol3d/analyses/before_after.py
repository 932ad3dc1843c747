"""Effect of another tolerance: sigma by rates and ppm by FORM at once, then by simulation with the same draws.

Rates are slopes at the mean build, taken once; other tolerances change the spreads alone. Design points are sought anew
with the other laws. The simulation draws the same uniforms before and after, so that only the tolerance differs;
probabilities are found by importance sampling about the design points, from the same seed. Kept trials are not
reweighted: in the tails that would be off by a factor.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Final

import numpy as np
from pydantic import Field
from scipy.special import ndtr

from tol3d.analyses.compared_builds import limits_of as both_limits
from tol3d.analyses.design_points import design_points
from tol3d.analyses.limit_state import LimitState, Side
from tol3d.analyses.rare_events import DRAWS, rare_event
from tol3d.analyses.rates import rates_of
from tol3d.analyses.response import Response
from tol3d.analyses.results import results_of
from tol3d.analyses.stated_changes import Change, changed, known, told
from tol3d.analyses.stated_limits import OtherLimits, limited
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.report.number import limits_text
from tol3d.statistics.estimates.limits import CONFIDENCE, Proportion
from tol3d.study.effects.acting_contributors import looked_at
from tol3d.study.runs.summary.judged import JudgedMeasure, demand_of
from tol3d.study.runs.summary.sample import Sample
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import (
    LEFT_OUT,
    Count,
    Known,
    KnownNumbers,
    KnownRange,
    Label,
    Maybe,
    Number,
    Numbers,
    Ppm,
    PpmRange,
    Section,
    made,
)
from tol3d.study.system.dependent import reads_of
from tol3d.study.system.measure import Measure

PLACES: Final = 16
STARTS: Final = 2
BINS: Final = 40
MOST_TRIALS: Final = 100_000

SIDES: Final[tuple[Side, Side]] = ("low", "high")


class ChangeMade(Section):
    """A tolerance before and after, in words."""

    contributor: Label
    before: Annotated[Label, Shows("before", "words")]
    after: Annotated[Label, Shows("after", "words")]


class LimitNumbers(Section):
    """Probability of leaving a limit [ppm]: by the first order, and by importance sampling.

    Trials that leave it are counted where draws have no map from normals; None of a simulation that was not asked for.
    The first order is None where the measure jumps at the mean build, and where no build beyond the limit is found.
    """

    first_order: Ppm | None
    ppm: Ppm | None
    interval: PpmRange | None
    beta: Known
    below: Ppm | None = Field(default=None, description="95 % upper bound by counting alone, where none was beyond")


class StateNumbers(Section):
    """A measure with some tolerances, in its unit.

    `low` and `high` are the quantiles 0.135 % and 99.865 % of the trials; `counts` are trials a bin. What is of the
    trials is what a run of them has.
    """

    sigma_by_rates: Annotated[Known, Shows("sigma by rates")]
    sigma: Annotated[Known, Shows("sigma")]
    mean: Annotated[Known, Shows("mean")]
    low: Annotated[Known, Shows("low 0.135 %")]
    high: Annotated[Known, Shows("high 99.865 %")]
    failed: Count
    counts: Numbers
    limits: dict[str, LimitNumbers] = Field(description="low, high: those that the measure has")
    ppk: Annotated[Maybe[Number], Shows("Ppk", ".2f")] = Field(
        default=LEFT_OUT, description="of the trials, by the rule of a run"
    )
    out_ppm: Maybe[Ppm] = Field(default=LEFT_OUT, description="out of limits or failed, of the trials")
    out_ppm_95: Annotated[Maybe[PpmRange], Shows("out of limits, 95 %", "share range")] = Field(
        default=LEFT_OUT, description="bounds of the true share, 95 % confidence"
    )
    verdict: Annotated[Maybe[Label], Shows("verdict", "words")] = Field(
        default=LEFT_OUT, description="of the trials, by what the study accepts"
    )


class MeasureWhatIf(Section):
    """A measure before and after."""

    unit: Label
    lower_limit: Known = Field(description="after, as the other one")
    upper_limit: Known
    limits_before: Maybe[KnownRange] = Field(
        default=LEFT_OUT, description="lower and upper limit of the scene, where others are tried"
    )
    edges: KnownNumbers
    before: StateNumbers
    after: StateNumbers


class WhatIf(Section):
    """Effect of other tolerances on measures."""

    changes: list[ChangeMade]
    trials: Count
    draws: Count
    rough: list[Label] = Field(description="contributors without a smooth map from normals: limits are counted")
    measures: dict[Label, MeasureWhatIf]
    evaluations: Count


def first_order_ppm(
    response: Response, side: Side, limit: float, *, seed: int = 1
) -> tuple[float | None, float | None]:
    """Probability of leaving a limit by FORM [ppm], averaged over positions, and the least distance β.

    Args:
        response: of one measure.
        side, limit: which, in its unit.
        seed: of the positions and starts.

    Returns:
        None for both where no design point is found, or a contributor has no smooth map from normals.
    """
    if response.rough:
        return None, None
    generator = np.random.default_rng(seed)
    count = PLACES if response.simulation.system.streams else 1
    positions = response.positions(count, "drawn" if count > 1 else "rest", int(generator.integers(2**31)))
    found = design_points(LimitState(response, limit, side), positions, count, STARTS, generator)
    betas = [own[0].beta for own in found if own]
    if not betas:
        return None, None
    return 1e6 * float(np.mean(ndtr(-np.array(betas)))), min(betas)


def limits_of(measure: Measure) -> dict[Side, float]:
    """The limits of a measure by their sides, in its unit."""
    both = zip(SIDES, (measure.lower_limit, measure.upper_limit), strict=True)
    return {side: limit * measure.per_internal for side, limit in both if limit is not None}


def what_if(
    response: Response,
    changes: Sequence[Change],
    measure: str | None = None,
    *,
    limits: Sequence[OtherLimits] = (),
    trials: int | None = None,
    draws: int = DRAWS,
    seed: int = 1,
    activity: Callable[[str], None] = lambda text: None,
) -> WhatIf:
    """Effect of other tolerances on measures that depend on them.

    Args:
        response: with the tolerances of the scene.
        changes: one per line of the scene.
        measure: its name; default all that depend on them, and those with other limits.
        limits: other limits of measures, by which values after are judged.
        trials: of the simulation; default the study's, 100 000 at most; 0 for none.
        draws: of importance sampling, for each limit before and after; 0 for none.
        seed: of importance sampling; trials have the study's.
        activity: progress callback.

    Raises:
        InputError: no change, one that cannot be, or no measure that depends on them.
    """
    if not changes and not limits:
        raise InputError("expected a change such as --set NAME=±10um or --factor NAME=0.5, got none")
    asked = response.of(*_concerned(response, changes, limits, measure))
    before, count = asked.evaluations, min(asked.simulation.study.trials if trials is None else trials, MOST_TRIALS)
    states = {"before": asked, "after": changed(asked, changes)}
    judged = {"before": asked.measures, "after": limited(asked.measures, limits)}
    activity("rates")
    rates = rates_of(asked)
    sampled, results = dict[str, Array](), dict[str, Mapping[str, Sample]]()
    for word, own in states.items():
        activity(f"{count} trials {word}")
        sampled[word], results[word] = np.zeros((0, len(asked.measures))), {}
        if count:
            drawn = own.drawn(count)
            read = own.values(*drawn)
            sampled[word] = np.where(read.seated, read.values, np.nan)
            results[word] = results_of(own, *drawn, read, measures=judged[word])
    found = {}
    for k, one in enumerate(asked.measures):
        values = {word: own[:, k] for word, own in sampled.items()}
        edges = _edges(values)
        both = {}
        for word, own in states.items():
            activity(f"{one.name}, limits {word}")
            alone, sigma = own.of(one.name), float(rates.sigmas(own)[k])
            sides = limits_of(judged[word][k])
            both[word] = _numbers(alone, sides, sigma, values[word], results[word].get(one.name), edges, draws, seed)
        were, are = (both_limits(own[k]) for own in judged.values())
        found[one.name] = made(
            MeasureWhatIf,
            unit=one.unit,
            lower_limit=are[0],
            upper_limit=are[1],
            **({} if were == are else {"limits_before": [*were]}),
            edges=edges.tolist(),
            before=both["before"],
            after=both["after"],
        )
    by_name = {contributor.name: contributor for contributor in asked.contributors}
    rows = []
    for change in changes:
        line = known(asked, change.name, change.name)
        first, *others = asked.lines[line]
        each = f", each of {1 + len(others)}" if others else ""
        laws = {word: told(by_name[first], own.drawn_by(first)) + each for word, own in states.items()}
        rows.append(made(ChangeMade, contributor=line, **laws))
    for one, other in zip(asked.measures, judged["after"], strict=True):
        if other is not one:
            words = [limits_text(*both_limits(each), one.unit) for each in (one, other)]
            rows.append(made(ChangeMade, contributor=f"limits of {one.name}", before=words[0], after=words[1]))
    return made(
        WhatIf,
        changes=rows,
        trials=count,
        draws=draws,
        rough=list(asked.rough),
        measures=found,
        evaluations=asked.evaluations - before,
    )


def _concerned(
    response: Response, changes: Sequence[Change], limits: Sequence[OtherLimits], measure: str | None
) -> list[str]:
    """Measures that depend on changed contributors, or on what reads these, and those with other limits."""
    names = {name for change in changes for name in response.lines[known(response, change.name, change.name)]}
    system = response.simulation.system
    names |= {contributor.name for contributor in system.contributors if names & set(reads_of(contributor))}
    asked = response.measures if measure is None else response.of(measure).measures
    with_others = [own.measure for own in limits]
    found = [
        own.name
        for own in asked
        if own.name in with_others or names & {each.name for each in (response.acting(own) if names else ())}
    ]
    if not found:
        which = "a measure" if measure is None else repr(measure)
        changed_ones = ", ".join([*(change.name for change in changes), *with_others])
        builds = [looked_at(response.simulation, response.source(own)).builds for own in asked]
        how = f"; not seen to act in {min(builds)} builds" if all(builds) else ""
        raise InputError(f"expected contributors on which {which} depends, got {changed_ones}{how}")
    return found


def _numbers(
    response: Response,
    limits: Mapping[Side, float],
    by_rates: float,
    values: Array,
    sample: Sample | None,
    edges: Array,
    draws: int,
    seed: int,
) -> StateNumbers:
    good = values[np.isfinite(values)]
    by_run = _of_a_run(sample, response.simulation.study.accept_ppk, limited=bool(limits)) if sample else {}
    return made(
        StateNumbers,
        sigma_by_rates=by_rates if np.isfinite(by_rates) else None,
        mean=sample.mean if sample else None,
        sigma=sample.sigma if sample else None,
        low=sample.p0_135 if sample else None,
        high=sample.p99_865 if sample else None,
        failed=sample.trials - sample.count if sample else 0,
        **by_run,
        counts=np.histogram(good, edges)[0].astype(float).tolist(),
        limits={
            side: _limit(response, side, limit, values, draws, seed, smooth=bool(np.isfinite(by_rates)))
            for side, limit in limits.items()
        },
    )


def _of_a_run(sample: Sample, accept_ppk: float | None, *, limited: bool) -> dict[str, Any]:
    """Ppk, fraction out of limits and verdict as a run with these trials has them, as far as it knows them."""
    judged = JudgedMeasure.by(sample, demand_of(accept_ppk), limited=limited)
    found: dict[str, Any] = {"ppk": sample.ppk}
    if judged.verdict != "no limits":
        found |= {"out_ppm": sample.out_ppm, "out_ppm_95": sample.out_ppm_95, "verdict": judged.verdict}
    return {key: value for key, value in found.items() if value is not None}


def _limit(
    response: Response, side: Side, limit: float, values: Array, draws: int, seed: int, *, smooth: bool
) -> LimitNumbers:
    if response.rough:
        with np.errstate(invalid="ignore"):
            within = values >= limit if side == "low" else values <= limit
        counted = Proportion(int((~within).sum()), len(values))
        interval = list(counted.interval_ppm()) if len(values) else None
        below = _below(len(values)) if len(values) and within.all() else None
        return made(LimitNumbers, first_order=None, ppm=counted.ppm, interval=interval, beta=None, below=below)
    if not draws:
        first, beta = first_order_ppm(response, side, limit, seed=seed) if smooth else (None, None)
        return made(LimitNumbers, first_order=first, ppm=None, interval=None, beta=beta)
    event = rare_event(response, side, limit, draws=draws, seed=seed)
    return made(
        LimitNumbers,
        first_order=1e6 * event.first_order if smooth and event.first_order is not None else None,
        ppm=min(1e6 * event.probability, 1e6),
        interval=[1e6 * own for own in event.interval],
        beta=event.points[0].beta if event.points else None,
        below=None if event.points or event.probability > 0.0 else _below(event.estimate.draws),
    )


def _below(count: int) -> float:
    """Upper bound of a fraction [ppm], one-sided with 95 % confidence, of which none of so many builds is: near 3/n.

    >>> round(_below(4800), 1)
    623.9
    """
    return 1e6 * -math.expm1(math.log(1.0 - CONFIDENCE) / count)


def _edges(values: dict[str, Array]) -> Array:
    every = np.concatenate([value[np.isfinite(value)] for value in values.values()])
    if not every.size or not every.max() > every.min():
        middle = float(every[0]) if every.size else 0.0
        return np.array([middle - 0.5, middle + 0.5])
    return np.linspace(float(every.min()), float(every.max()), BINS + 1)
