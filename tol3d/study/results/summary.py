"""A run's summary: the content of summary.json, in the measures' units."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from tol3d.statistics.estimates import Agreement as Comparison
from tol3d.statistics.estimates import LimitCounts, Moments
from tol3d.study.effects.acting_contributors import acting, nothing_acts
from tol3d.study.effects.high_low_mean import Percents, Ranges, extents, high_low_mean_percents, high_low_mean_ranges
from tol3d.study.effects.regressors import MOST_REGRESSED
from tol3d.study.results.agreement.differences import Differences
from tol3d.study.results.agreement.explanation import Explanation, faults
from tol3d.study.results.attribution import Attributed, Attribution
from tol3d.study.results.stopping import shortfalls
from tol3d.study.runs.summary.agreement import Agreement
from tol3d.study.runs.summary.measure import ContributorShare, MeasureSummary, Published, PublishedColumn, Unexplained
from tol3d.study.runs.summary.published import PER_INTERNAL, converted
from tol3d.study.runs.summary.run import Findings, MechanismSummary, StudySummary
from tol3d.study.runs.summary.sample import CurveMethods, CurveSample, Methods, Normal
from tol3d.study.runs.summary.values import Method as MethodName
from tol3d.study.runs.summary.values import Unit, made
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.dependent import DependentlyJudged
from tol3d.study.system.draw import JudgedDraw
from tol3d.study.system.faults import Origin
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Method
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC
from tol3d.study.system.stated import mean_deviations, stated
from tol3d.study.tallies.curve_tally import CurveTally, spectrum_sample
from tol3d.study.tallies.histograms import histograms
from tol3d.study.tallies.joint import joint_summary
from tol3d.study.tallies.sample import both, finite, in_unit, listed, sample_summary
from tol3d.study.tallies.tally import MeasureTally, Tally
from tol3d.study.trials.budget import Use, contacts_of_trials, of_other_method, shared
from tol3d.study.trials.correlated import closed_form_of, correlation_warnings
from tol3d.study.trials.evaluation import Evaluation, evaluations, measures_alike
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study
from tol3d.units import FACTORS

FAILURES_NAMED = 1e-3  # of the trials; a third of the 0.27 % that ±3 sigma leave out, in the table all the same
NAMED_AT_ONCE = 6  # measures in one warning


def study_summary(simulation: Simulation, method: Method | None, tally: Tally) -> Findings:
    """Findings of a study, without those that its system adds to the whole and to each measure."""
    study, mechanism, system = simulation.study, simulation.mechanism, simulation.system
    single = [measure for measure in system.measures if measure.take != "curve"]
    differences, of_trials = Differences.of(simulation, method, tally), contacts_of_trials(simulation, tally.trials)
    wanted: dict[Use, float] = {
        "high-low-mean": sum(extent.contacts for extent in extents(system, single)),
        **differences.wanted,
    }
    contacts = shared(of_trials, wanted)
    looks = differences.looks(contacts)
    explained = differences.explained(looks)
    builds = _single_builds(simulation, method)
    alone_by = Evaluation(system, method).values
    ranges = high_low_mean_ranges(system, single, alone_by, contacts["high-low-mean"])
    alone = {name: high_low_mean_percents(own) for name, own in ranges.items()}
    attributed = _attributed(simulation, method, tally, ranges)
    return made(
        Findings,
        scene=simulation.system.name,
        mechanism=_mechanism(mechanism) if mechanism else None,
        seed=study.seed,
        trials=tally.trials,
        engine=study.engine,
        study=_asked(study),
        status=tally.status,
        statuses=simulation.system.statuses.meanings,
        status_words=simulation.system.statuses.states or None,
        chord_error_um=method.chord_error * 1000 if method else None,
        measures={
            measure.name: _measure(
                simulation,
                measure,
                tally,
                explained.get(measure.name),
                alone.get(measure.name, {}),
                attributed.get(measure.name, {}),
                builds[measure.name],
            )
            for measure in simulation.system.measures
        },
        joint=joint_summary(simulation, tally.joint),
        published=_published_of_the_whole(simulation) or None,
        warnings=[
            *failures(simulation, tally),
            *_too_many(simulation),
            *_ends_not_built(simulation, contacts["high-low-mean"]),
            *differences.not_looked_at(looks),
            *_not_attributed(simulation, tally.trials, attributed),
            *_idle(simulation),
            *faults(explained),
            *simulation.warnings,
            *correlation_warnings(simulation),
            *_unphysical_draws(simulation, tally),
            *shortfalls(simulation, tally),
        ],
    )


def _mechanism(origin: Origin) -> MechanismSummary:
    return made(MechanismSummary, name=origin.name, module=origin.module, beside=list(origin.beside) or None)


def _asked(study: Study) -> StudySummary:
    return made(
        StudySummary,
        trials=study.trials,
        seed=study.seed,
        sampler=study.sampler,
        replicates=study.replicates,
        until=[list(until) for until in study.until],
        engine=study.engine,
        witness=study.witness,
        ppk_by=study.ppk_by,
        accept_ppk=study.accept_ppk,
    )


def failures(simulation: Simulation, tally: Tally) -> Iterator[str]:
    """A sentence for measures with too many failed trials; one for those that failed alike."""
    alike: dict[tuple[tuple[tuple[str, int], ...], str], list[str]] = {}
    for measure in simulation.system.measures:
        status = _status(measure, tally)
        failed = tally.trials - status[simulation.system.statuses.seated]
        if failed > FAILURES_NAMED * tally.trials:
            mostly = _mostly(_reasons(measure, tally), failed)
            alike.setdefault((tuple(status.items()), mostly), []).append(measure.name)
    words = simulation.system.statuses.words
    for (ends, mostly), names in alike.items():
        counts = dict(ends)
        seated = counts.pop(simulation.system.statuses.seated)
        how = ", ".join(f"{count} {words.get(text, text)}" for text, count in counts.items() if count)
        yield (
            f"{_named(names)}: {100 * sum(counts.values()) / tally.trials:.3g} % of {tally.trials} builds could not be "
            f"assembled ({how}{mostly}); mean, sigma and shares are of the {seated} assembled builds, the fraction out "
            "of limits is of all"
        )


def _named(names: Sequence[str]) -> str:
    """Names at the begin of a sentence; of many the first and the number of the others."""
    left = len(names) - NAMED_AT_ONCE
    return ", ".join(names) if left <= 0 else f"{', '.join(names[:NAMED_AT_ONCE])} and {left} more measures"


def _mostly(reasons: Mapping[str, int], failed: int) -> str:
    """Reason why most of the failed trials failed, for a sentence; "" where nothing is known of it."""
    if not reasons:
        return ""
    reason, count = max(reasons.items(), key=lambda own: own[1])
    return f"; {'all' if count == failed else f'{100 * count / failed:.3g} %'} of them by {reason}"


def _reasons(measure: Measure, tally: Tally) -> Mapping[str, int]:
    """Number of failed trials of a measure by reason, the most first."""
    if measure.take == "curve":
        return {}
    return dict(sorted(tally.measures[measure.name].reasons.items(), key=lambda own: -own[1]))


def _status(measure: Measure, tally: Tally) -> Mapping[str, int]:
    """Number of trials of a measure by status."""
    return (tally.curves if measure.take == "curve" else tally.measures)[measure.name].status


def _too_many(simulation: Simulation) -> Iterator[str]:
    """A sentence for measures of more contributors than are regressed on together."""
    counts = {measure.name: len(acting(simulation, measure)) for measure in simulation.system.measures}
    many = {name: count for name, count in counts.items() if count > MOST_REGRESSED}
    if many:
        least, most = min(many.values()), max(many.values())
        count = str(most) if least == most else f"{least} to {most}"
        yield (
            f"{_named([*many])}: {count} tolerances act, more than the {MOST_REGRESSED} that are regressed on "
            "together; each one's share of the 3D simulation is what it has in common with the measure by itself"
        )


def _idle(simulation: Simulation) -> Iterator[str]:
    """A sentence on measures that depend on no tolerance, where the scene has some."""
    alike: dict[str, list[str]] = {}
    for measure in simulation.system.measures if simulation.system.contributors else ():
        if words := nothing_acts(simulation, measure):
            alike.setdefault(words, []).append(measure.name)
    yield from (f"{_named(names)}: {words}" for words, names in alike.items())


def _ends_not_built(simulation: Simulation, contacts: float) -> Iterator[str]:
    """A sentence if high-low-mean shares are unknown, or of some contributors those of first-order effects."""
    single = [measure for measure in simulation.system.measures if measure.take != "curve"]
    found = extents(simulation.system, single, contacts)
    if any(own.exact is None for own in found):
        yield (
            "high–low–mean was not looked at: its builds would take longer than the trials did; more trials let more "
            "builds follow them"
        )
    short = [own for own in found if own.exact is not None and own.exact < own.asking]
    if short:
        count, built = max(own.asking for own in short), min(own.exact or 0 for own in short)
        which = f"those of the {built} that move a measure most are built, the others" if built else "they"
        yield (
            f"high–low–mean: {count} tolerances lie elsewhere at their ends for each of {len(single)} measures; "
            f"{which} count with what they do to first order"
        )


def _not_attributed(
    simulation: Simulation, trials: int, attributed: Mapping[str, Mapping[str, Attribution]]
) -> Iterator[str]:
    """A sentence if shares by the method that does not lead are those of a regression for want of builds."""
    if not simulation.has_geometry:
        return
    lacking = [
        measure
        for measure in simulation.system.measures
        if (found := attributed.get(measure.name, {}).get(ANALYTIC)) is not None and found.lacks
    ]
    if any(extent.exact is None for extent in extents(simulation.system, lacking, of_other_method(simulation, trials))):
        yield (
            f"{_named([own.name for own in lacking])}: shares of the analytic method are of what little a regression "
            "explains, for high–low–mean by it was not looked at; more trials let more builds follow them"
        )


def _unphysical_draws(simulation: Simulation, tally: Tally) -> Iterator[str]:
    judged = {
        contributor.name
        for contributor in simulation.system.contributors
        if isinstance(contributor.draw, JudgedDraw | DependentlyJudged)
    }
    for name, count in tally.unphysical.items():
        if count:
            why = "out of drawing" if name in judged else "below zero, which no clearance is"
            yield f"{name}: {count} of {tally.trials} draws are {why}; kept as drawn"


def _measure(
    simulation: Simulation,
    measure: Measure,
    tally: Tally,
    explanation: Explanation | None,
    alone: Percents,
    attributed: Mapping[str, Attribution],
    builds: tuple[Methods, Methods],
) -> MeasureSummary:
    """A measure: statistics of both methods, contributors, published columns; its kind and no more of its system's."""
    system, curve, asked = simulation.system, measure.take == "curve", simulation.study.ppk_by
    own = None if curve else tally.measures[measure.name]
    found = own if own is not None and own.geometric is not None and own.agreement is not None else None
    return made(
        MeasureSummary,
        kind=system.describe(measure)["kind"],
        over=measure.positions.over,
        take=measure.take,
        unit=cast(Unit, measure.unit),
        worse=measure.worse,
        lower_limit=in_unit(measure, measure.lower_limit),
        upper_limit=in_unit(measure, measure.upper_limit),
        status=_status(measure, tally),
        reasons=_reasons(measure, tally) or None,
        nominal=builds[0],
        mean_build=builds[1],
        analytic=sample_summary(measure, own.analytic, asked) if own else None,
        analytic_closed_form=None if curve else _closed_form(measure, closed_form_of(simulation, measure)),
        histogram=histograms(own) if own else None,
        geometric=sample_summary(measure, found.geometric, asked) if found and found.geometric else None,
        agreement=_agreement(found.agreement, explanation) if found and found.agreement else None,
        position_deg=np.degrees(measure.positions.shown or measure.positions.fixed or ()).tolist() if curve else None,
        curve=_curve(simulation, measure, tally.curves[measure.name]) if curve else None,
        contributors=_shares(simulation, measure, own, alone, attributed) if own else [],
        shares_by=_shares_by(attributed) or None,
        published=_published(simulation, measure),
    )


def _single_builds(simulation: Simulation, method: Method | None) -> dict[str, tuple[Methods, Methods]]:
    """Both methods' values of the nominal build and of the one at all means, by measure; None where one is none."""
    system = simulation.system
    found = {}
    for _, alike in measures_alike(system, system.measures):
        mean = mean_deviations(system, alike[0].positions)
        builds = np.concatenate([np.zeros_like(mean), mean])
        read = {
            shown: own.of(stated(system, builds), alike, lambda _: True)
            for shown, own in evaluations(system, method).items()
        }
        for measure in alike:
            found[measure.name] = (_both(read, measure, 0), _both(read, measure, 1))
    return found


def _both(read: Mapping[str, Mapping[str, NDArray[np.float64]]], measure: Measure, row: int) -> Methods:
    def value(method: str) -> Any:
        own = read[method][measure.name][row] if method in read else None
        return None if own is None or np.isnan(own).any() else own.tolist()

    return made(Methods, analytic=value(ANALYTIC), geometric=value(GEOMETRIC))


def _closed_form(measure: Measure, form: ClosedForm | None) -> Normal | None:
    if form is None:
        return None
    mean, sigma = form.mean * measure.per_internal, form.sigma * measure.per_internal
    return made(Normal, mean=mean, sigma=sigma, low_3sigma=mean - 3 * sigma, high_3sigma=mean + 3 * sigma)


def _agreement(compared: Comparison, explanation: Explanation | None) -> Agreement:
    seen = compared.count > 0
    return made(
        Agreement,
        max_abs_difference=compared.max_abs if seen else None,
        rms_difference=compared.rms if seen else None,
        mean_difference=compared.mean if seen else None,
        compared=compared.count,
        explanation=explanation.summary() if explanation else None,
    )


def _attributed(
    simulation: Simulation, method: Method | None, tally: Tally, ranges: Mapping[str, Ranges]
) -> Mapping[str, Mapping[str, Attribution]]:
    """Shares of the variance by measure and method, but of closed forms, which know their own."""
    scalars = [measure for measure in simulation.system.measures if measure.name in tally.measures]
    own = tally.measures
    regressed = {
        ANALYTIC: {m.name: own[m.name].analytic_regressors for m in scalars if closed_form_of(simulation, m) is None},
        GEOMETRIC: {m.name: sums for m in scalars if (sums := own[m.name].geometric_regressors) is not None},
    }
    leading = GEOMETRIC if method is not None else ANALYTIC
    by_method = {
        name: Attributed(simulation, each, tally.trials, ranges if name == leading else None).of(regressed[name])
        for name, each in evaluations(simulation.system, method).items()
    }
    return {m.name: {name: found[m.name] for name, found in by_method.items() if m.name in found} for m in scalars}


def _shares(
    simulation: Simulation,
    measure: Measure,
    measure_tally: MeasureTally,
    alone: Percents,
    found: Mapping[str, Attribution],
) -> list[ContributorShare]:
    form = closed_form_of(simulation, measure)
    percents = {method: each.percents for method, each in found.items()}
    known = percents.get(GEOMETRIC, {})
    # the error of a share by regression is worked out for independent trials
    with_errors = measure_tally.analytic.replicated is None or found[GEOMETRIC].by != "regression" if known else False
    return [
        made(
            ContributorShare,
            name=name,
            analytic_percent=form.percent(name) if form else percents[ANALYTIC][name][0],
            geometric_percent=known[name][0] if known else None,
            geometric_percent_se=known[name][1] if with_errors else None,
            high_low_mean_percent=alone[name],
        )
        for name in (contributor.name for contributor in acting(simulation, measure))
    ]


def _shares_by(found: Mapping[str, Attribution]) -> dict[MethodName, Unexplained]:
    """Means by which shares were found, of the methods whose regression explains too little."""
    methods: dict[MethodName, str] = {"analytic": ANALYTIC, "geometric": GEOMETRIC}
    return {
        method: made(
            Unexplained, by=own.by, explained_percent=None if own.explained is None else max(100 * own.explained, 0.0)
        )
        for method, name in methods.items()
        if (own := found.get(name)) is not None and own.lacks
    }


def _curve(simulation: Simulation, measure: Measure, own: CurveTally) -> CurveMethods:
    def sample(method: str, moments: Sequence[Moments], limits: LimitCounts) -> CurveSample:
        performance = own.performance(measure, method, simulation.study.ppk_by)
        return made(
            CurveSample,
            mean=[m.mean if m.count else None for m in moments],
            sigma=[m.sigma if m.count > 1 else None for m in moments],
            min=[m.minimum if m.count else None for m in moments],
            max=[m.maximum if m.count else None for m in moments],
            trials=limits.total,
            below_limit_ppm=limits.below_limit.ppm,
            above_limit_ppm=limits.above_limit.ppm,
            failed_ppm=limits.failures.ppm,
            out_ppm=limits.out_of_limits.ppm,
            out_ppm_95=listed(own.interval_ppm(method)),
            ppk=finite(performance.ppk),
            ppk_95=both(performance.bounds) if performance.ppk is not None else None,
            ppk_by=performance.by,
            ppk_reason=performance.reason or None,
            spectrum=spectrum_sample(measure, own.spectra[method]),
        )

    return made(
        CurveMethods,
        analytic=sample(ANALYTIC, own.analytic, own.limits[ANALYTIC]),
        geometric=sample(GEOMETRIC, own.geometric, own.limits[GEOMETRIC]) if own.geometric else None,
    )


def _published(simulation: Simulation, measure: Measure) -> dict[str, PublishedColumn]:
    """Other people's columns for this measure, in its unit."""
    per_internal = dict.fromkeys(FACTORS, measure.per_internal)
    return {
        name: converted(own[measure.name], per_internal, Published)
        for name, own in simulation.published.items()
        if measure.name in own
    }


def _published_of_the_whole(simulation: Simulation) -> dict[str, Any]:
    """Published figures beside measures, by column and key."""
    found = {name: own.figures for name, own in simulation.published.items()}
    return {name: converted(own, PER_INTERNAL) for name, own in found.items() if own}
