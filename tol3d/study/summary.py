"""A run's summary: what summary.json holds, in the measures' units."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines import Engine
from tol3d.gearing.model import Backlash, Kind, Measure, Model
from tol3d.gearing.stack_up import closed_form, per_normal_backlash
from tol3d.runs.outcome import SEATED, told
from tol3d.study.agreement.explaining import explanations
from tol3d.study.agreement.explanation import Explanation, faults
from tol3d.study.block import Block, mean_block, nominal_block, simulate_block, stated_block
from tol3d.study.high_low_mean import high_low_mean_percents
from tol3d.study.regressors import MOST_REGRESSED, acting
from tol3d.study.sample import curve_limits, in_unit, sample_summary
from tol3d.study.stages import train_summaries
from tol3d.study.stopping import shortfalls
from tol3d.study.tally import Tally, histograms, share_percents

FAILURES_TOLD = 1e-3  # of the trials; a third of the 0.27 % that ±3 sigma leave out, told in the table all the same
FAILURE_WORDS = {"interferes": "jam", "no contact": "find no contact", "out of range": "are out of range"}


def study_summary(model: Model, engine: Engine | None, tally: Tally) -> dict[str, Any]:
    """What a study found: everything of summary.json but files, timing and versions."""
    explained = explanations(model, engine, tally)
    return {
        "scene": model.name,
        "seed": model.study.seed,
        "trials": tally.trials,
        "engine": model.study.engine,
        "study": vars(model.study),
        "status": dict(tally.status),
        "chord_error_um": engine.chord_error * 1000 if engine else None,
        "measures": measure_summaries(model, engine, tally, explained),
        "trains": train_summaries(model, tally.stages),
        "warnings": [
            *failures(model, tally),
            *_too_many(model),
            *faults(explained),
            *model.warnings,
            *_unphysical_draws(tally),
            *shortfalls(model, tally),
        ],
    }


def failures(model: Model, tally: Tally) -> Iterator[str]:
    """A sentence for measures of which more trials failed than may be passed over; one for those that failed alike."""
    alike: dict[tuple[tuple[str, int], ...], list[str]] = {}
    for measure in model.measures:
        status = _status(measure, tally)
        if tally.trials - status[SEATED] > FAILURES_TOLD * tally.trials:
            alike.setdefault(tuple(status.items()), []).append(measure.name)
    for ends, names in alike.items():
        counts = dict(ends)
        seated = counts.pop(SEATED)
        how = ", ".join(f"{count} {FAILURE_WORDS[text]}" for text, count in counts.items() if count)
        yield (
            f"{', '.join(names)}: of {tally.trials} builds {how}: {100 * sum(counts.values()) / tally.trials:.3g} % "
            f"failed; mean, sigma and shares are of the {seated} that seated, what is out of limits is counted of all"
        )


def _status(measure: Measure, tally: Tally) -> Mapping[str, int]:
    """How many trials of a measure ended how."""
    return (tally.curves if measure.take == "curve" else tally.measures)[measure.name].status


def _too_many(model: Model) -> Iterator[str]:
    """A sentence for measures of more contributors than shares are told of."""
    alike: dict[int, list[str]] = {}
    for measure in model.measures:
        if (count := len(acting(model, measure))) > MOST_REGRESSED:
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
    model: Model, engine: Engine | None, tally: Tally, explained: Mapping[str, Explanation]
) -> dict[str, Any]:
    """The measures as summary.json shows them: statistics of both roads, contributors, published columns."""
    return {
        measure.name: {
            **_what(measure.kind),
            "over": measure.positions.over,
            "take": measure.take,
            "unit": measure.unit,
            "worse": "low" if isinstance(measure.kind, Backlash) else "high",
            **_lost_motion(model, measure),
            "lower_limit": in_unit(measure, measure.lower_limit),
            "upper_limit": in_unit(measure, measure.upper_limit),
            "status": dict(_status(measure, tally)),
            "nominal": _single(model, engine, measure, nominal_block(model)),
            "mean_build": _single(model, engine, measure, mean_block(model, measure)),
            **_statistics(model, engine, measure, tally, explained.get(measure.name)),
            "published": _published(model, measure),
        }
        for measure in model.measures
    }


def _what(kind: Kind) -> dict[str, Any]:
    """What is measured."""
    if isinstance(kind, Backlash):
        return {"kind": kind.quantity, "of": kind.mesh, "gear": kind.gear, "reading": vars(kind.reading)}
    return {
        "kind": kind.quantity,
        "of": kind.train,
        "gear": None,
        "reading": None,
        "readings": {backlash.mesh: vars(backlash.reading) for _, backlash in kind.backlashes},
        "shaft": kind.shaft,
        "held": kind.held,
        "arm": kind.tip.arm if kind.tip else None,
        "point": kind.tip.point if kind.tip else None,
        "lever_mm": kind.tip.lever if kind.tip else None,
        "load_changes_deg": np.degrees(kind.changes).tolist(),
    }


def _lost_motion(model: Model, measure: Measure) -> Mapping[str, Any]:
    """For a normal backlash: the turn of the driven gear that it leaves free, per um."""
    if not isinstance(measure.kind, Backlash) or measure.kind.quantity != "normal_backlash":
        return {}
    driven = model.mesh(measure.kind.mesh).driven
    turn = per_normal_backlash(model, Backlash("angular_backlash", measure.kind.mesh, driven))
    return {"lost_motion": {"of": driven, "arcmin_per_um": turn * np.degrees(60) / 1000}}


def _single(model: Model, engine: Engine | None, measure: Measure, block: Block) -> dict[str, Any]:
    """Both roads' values of one build, None where it does not seat."""
    columns = simulate_block(replace(model, measures=(measure,)), engine, block)

    def value(road: str) -> Any:
        column = columns.get(f"{road}:{measure.name}")
        if column is None or np.isnan(np.asarray(column, dtype=np.float64)).any():
            return None
        return column[0].tolist()

    return {road: value(road) for road in ("analytic", "geometric")}


def _statistics(
    model: Model, engine: Engine | None, measure: Measure, tally: Tally, explanation: Explanation | None
) -> dict[str, Any]:
    if measure.take == "curve":
        return _curve(model, measure, tally)
    own = tally.measures[measure.name]
    summary: dict[str, Any] = {"analytic": sample_summary(measure, own.analytic)}
    form = closed_form(model, measure)
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
    by_sample = share_percents(model, measure, own.analytic_features)
    geometric = share_percents(model, measure, own.geometric_features)
    alone = _high_low_mean(model, engine, measure)
    summary["contributors"] = [
        {
            "name": contributor.name,
            "analytic_percent": form.percent(contributor.name) if form else by_sample[contributor.name][0],
            "geometric_percent": geometric[contributor.name][0],
            "geometric_percent_se": geometric[contributor.name][1] if independent else None,
            "high_low_mean_percent": alone[contributor.name],
        }
        for contributor in acting(model, measure)
    ]
    return summary


def _high_low_mean(model: Model, engine: Engine | None, measure: Measure) -> Mapping[str, float | None]:
    """High-low-mean shares on the geometric road, or on the analytic one where there is no engine.

    None of any where there are too many: each takes builds of its own, and each build all contributors.
    """
    if len(acting(model, measure)) > MOST_REGRESSED:
        return dict.fromkeys((contributor.name for contributor in model.contributors), None)
    alone = replace(model, measures=(measure,))
    road = "geometric" if engine else "analytic"

    def values(deviations: NDArray[np.float64]) -> NDArray[np.float64]:
        return told(simulate_block(alone, engine, stated_block(alone, deviations)), road, measure.name).values

    return high_low_mean_percents(model, measure, values)


def _curve(model: Model, measure: Measure, tally: Tally) -> dict[str, Any]:
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
                **curve_limits(own.limits[road], independent=model.study.sampler == "monte_carlo"),
            }
            for road, moments in roads.items()
        },
        "contributors": [],
    }


def _published(model: Model, measure: Measure) -> dict[str, Any]:
    """Other people's columns for this measure, in its unit."""
    return {
        column: {
            key: value * measure.per_internal if isinstance(value, float) else value
            for key, value in measures[measure.name].items()
        }
        for column, measures in model.published.items()
        if measure.name in measures
    }
