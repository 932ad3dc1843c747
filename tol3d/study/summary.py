"""A run's summary: what summary.json holds, in the measures' units."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.study.agreement.explaining import explanations
from tol3d.study.agreement.explanation import Explanation, faults
from tol3d.study.columns import columns_of
from tol3d.study.high_low_mean import high_low_mean_percents
from tol3d.study.histograms import histograms
from tol3d.study.regressors import MOST_REGRESSED
from tol3d.study.sample import curve_limits, in_unit, sample_summary
from tol3d.study.shares import share_percents
from tol3d.study.simulation import Simulation
from tol3d.study.stopping import shortfalls
from tol3d.study.tally import Tally
from tol3d.system.measure import Measure
from tol3d.system.outcome import ANALYTIC, GEOMETRIC, ROADS, outcome_of, value_column
from tol3d.system.road import Road
from tol3d.system.stated import mean_build, nominal_build, stated
from tol3d.system.trials import Trials

FAILURES_NAMED = 1e-3  # of the trials; a third of the 0.27 % that ±3 sigma leave out, in the table all the same


def study_summary(simulation: Simulation, road: Road | None, tally: Tally) -> dict[str, Any]:
    """What a study found: everything of summary.json but files, timing and versions."""
    explained = explanations(simulation, road, tally)
    return {
        "scene": simulation.system.name,
        **({"mechanism": dict(simulation.mechanism)} if simulation.mechanism else {}),
        "seed": simulation.study.seed,
        "trials": tally.trials,
        "engine": simulation.study.engine,
        "study": vars(simulation.study),
        "status": dict(tally.status),
        "statuses": simulation.system.statuses.meanings,
        "chord_error_um": road.chord_error * 1000 if road else None,
        "measures": measure_summaries(simulation, road, tally, explained),
        **simulation.system.sections(tally.terms, simulation.published),
        "warnings": [
            *failures(simulation, tally),
            *_too_many(simulation),
            *faults(explained),
            *simulation.warnings,
            *_unphysical_draws(tally),
            *shortfalls(simulation, tally),
        ],
    }


def failures(simulation: Simulation, tally: Tally) -> Iterator[str]:
    """A sentence for measures of which more trials failed than may be passed over; one for those that failed alike."""
    alike: dict[tuple[tuple[str, int], ...], list[str]] = {}
    for measure in simulation.system.measures:
        status = _status(measure, tally)
        if tally.trials - status[simulation.system.statuses.seated] > FAILURES_NAMED * tally.trials:
            alike.setdefault(tuple(status.items()), []).append(measure.name)
    words = simulation.system.statuses.words
    for ends, names in alike.items():
        counts = dict(ends)
        seated = counts.pop(simulation.system.statuses.seated)
        how = ", ".join(f"{count} {words.get(text, text)}" for text, count in counts.items() if count)
        yield (
            f"{', '.join(names)}: of {tally.trials} builds {how}: {100 * sum(counts.values()) / tally.trials:.3g} % "
            f"failed; mean, sigma and shares are of the {seated} that seated, what is out of limits is counted of all"
        )


def _status(measure: Measure, tally: Tally) -> Mapping[str, int]:
    """How many trials of a measure ended how."""
    return (tally.curves if measure.take == "curve" else tally.measures)[measure.name].status


def _too_many(simulation: Simulation) -> Iterator[str]:
    """A sentence for measures of more contributors than have shares."""
    alike: dict[int, list[str]] = {}
    for measure in simulation.system.measures:
        if (count := len(simulation.system.acting(measure))) > MOST_REGRESSED:
            alike.setdefault(count, []).append(measure.name)
    for count, names in alike.items():
        yield (
            f"{', '.join(names)}: {count} tolerances act; shares of the 3D simulation are told of the {MOST_REGRESSED} "
            "that matter most by the stack-up (or come first, where it has no closed form), the others are in none; "
            "no high-low-mean shares"
        )


def _unphysical_draws(tally: Tally) -> Iterator[str]:
    for name, count in tally.unphysical.items():
        if count:
            yield f"{name}: {count} of {tally.trials} draws are below zero, which no clearance is; kept as drawn"


def measure_summaries(
    simulation: Simulation, road: Road | None, tally: Tally, explained: Mapping[str, Explanation]
) -> dict[str, Any]:
    """The measures as summary.json shows them: statistics of both roads, contributors, published columns."""
    return {
        measure.name: {
            **simulation.system.describe(measure),
            "over": measure.positions.over,
            "take": measure.take,
            "unit": measure.unit,
            "worse": measure.worse,
            "lower_limit": in_unit(measure, measure.lower_limit),
            "upper_limit": in_unit(measure, measure.upper_limit),
            "status": dict(_status(measure, tally)),
            "nominal": _single(simulation, road, measure, nominal_build(simulation.system)),
            "mean_build": _single(simulation, road, measure, mean_build(simulation.system, measure)),
            **_statistics(simulation, road, measure, tally, explained.get(measure.name)),
            "published": _published(simulation, measure),
        }
        for measure in simulation.system.measures
    }


def _single(simulation: Simulation, road: Road | None, measure: Measure, build: Trials) -> dict[str, Any]:
    """Both roads' values of one build, None where it does not seat."""
    columns = columns_of(simulation.system, road, build, (measure,))

    def value(name: str) -> Any:
        column = columns.get(value_column(name, measure.name))
        if column is None or np.isnan(np.asarray(column, dtype=np.float64)).any():
            return None
        return column[0].tolist()

    return {name: value(name) for name in ROADS}


def _statistics(
    simulation: Simulation, road: Road | None, measure: Measure, tally: Tally, explanation: Explanation | None
) -> dict[str, Any]:
    if measure.take == "curve":
        return _curve(simulation, measure, tally)
    own = tally.measures[measure.name]
    summary: dict[str, Any] = {"analytic": sample_summary(measure, own.analytic)}
    form = simulation.system.closed_form(measure)
    if form is not None:
        mean, sigma = form.mean * measure.per_internal, form.sigma * measure.per_internal
        summary["analytic_closed_form"] = {
            "mean": mean,
            "sigma": sigma,
            "low_3sigma": mean - 3 * sigma,
            "high_3sigma": mean + 3 * sigma,
        }
    summary["histogram"] = histograms(own)
    if own.geometric is not None and own.agreement is not None:
        summary["geometric"] = sample_summary(measure, own.geometric)
        seen = own.agreement.count > 0
        summary["agreement"] = {
            "max_abs_difference": own.agreement.max_abs if seen else None,
            "rms_difference": own.agreement.rms if seen else None,
            "mean_difference": own.agreement.mean if seen else None,
            "compared": own.agreement.count,
            "explanation": explanation.summary() if explanation else None,
        }
    independent = own.analytic.replicated is None  # what the error of a share by regression is worked out for
    by_sample = share_percents(simulation.system, measure, own.analytic_regressors)
    geometric = share_percents(simulation.system, measure, own.geometric_regressors)
    alone = _high_low_mean(simulation, road, measure)
    summary["contributors"] = [
        {
            "name": contributor.name,
            "analytic_percent": form.percent(contributor.name) if form else by_sample[contributor.name][0],
            "geometric_percent": geometric[contributor.name][0],
            "geometric_percent_se": geometric[contributor.name][1] if independent else None,
            "high_low_mean_percent": alone[contributor.name],
        }
        for contributor in simulation.system.acting(measure)
    ]
    return summary


def _high_low_mean(simulation: Simulation, road: Road | None, measure: Measure) -> Mapping[str, float | None]:
    """High-low-mean shares on the geometric road, or on the analytic one where there is no engine.

    None of any where there are too many: each takes builds of its own, and each build all contributors.
    """
    system = simulation.system
    if len(system.acting(measure)) > MOST_REGRESSED:
        return dict.fromkeys((contributor.name for contributor in system.contributors), None)
    shown = GEOMETRIC if road else ANALYTIC

    def values(deviations: NDArray[np.float64]) -> NDArray[np.float64]:
        columns = columns_of(system, road, stated(system, deviations), (measure,))
        return outcome_of(columns, shown, measure.name, system.statuses.lacking).values

    return high_low_mean_percents(system, measure, values)


def _curve(simulation: Simulation, measure: Measure, tally: Tally) -> dict[str, Any]:
    own = tally.curves[measure.name]
    roads = {"analytic": own.analytic, **({"geometric": own.geometric} if own.geometric else {})}
    return {
        "position_deg": np.degrees(measure.positions.shown or measure.positions.fixed or ()).tolist(),
        "curve": {
            road: {
                "mean": [m.mean if m.count else None for m in moments],
                "sigma": [m.sigma if m.count > 1 else None for m in moments],
                "min": [m.minimum if m.count else None for m in moments],
                "max": [m.maximum if m.count else None for m in moments],
                **curve_limits(own.limits[road], independent=simulation.study.sampler == "monte_carlo"),
            }
            for road, moments in roads.items()
        },
        "contributors": [],
    }


def _published(simulation: Simulation, measure: Measure) -> dict[str, Any]:
    """Other people's columns for this measure, in its unit."""
    return {
        column: {
            **{
                key: value * measure.per_internal if isinstance(value, float) else value
                for key, value in measures[measure.name].items()
                if key != "numbers"
            },
            **measures[measure.name].get("numbers", {}),
        }
        for column, measures in simulation.published.items()
        if measure.name in measures
    }
