"""What makes a trial the worst, and the limits of a measure, in words."""

from collections.abc import Mapping

from tol3d.report.number import limit_text
from tol3d.runs.summary.measure import MeasureSummary, Worse
from tol3d.runs.summary.run import RunSummary

ENDS: Mapping[Worse, str] = {"low": "smallest", "high": "largest"}


def worst_words(run: RunSummary) -> str:
    """What makes a trial the worst, see `worst_trial`: `the nearest to a limit of play, or the furthest beyond it`."""
    measures = run.measures
    limited = [name for name, measure in measures.items() if measure.has_limits]
    judged = limited or [*measures][:1]
    if lacking := [name for name in judged if measures[name].ended_in(run.lacking)]:
        ended = [run.state(text) for text in run.statuses if text in run.lacking and run.status.get(text)]
        return f"{' or '.join(ended)}, the deepest by {' or '.join(lacking)}"
    if not limited:
        return f"the {ENDS[measures[judged[0]].worse]} {judged[0]}, for there are no limits"
    return f"the nearest to a limit of {' or '.join(limited)}, or the furthest beyond it"


def limits_text(measure: MeasureSummary) -> str:
    """The limits of a measure, with their unit."""
    unit = measure.unit
    given = [
        f"{word} limit {limit_text(limit, unit)}"
        for word, limit in zip(("lower", "upper"), measure.limits, strict=True)
        if limit is not None
    ]
    return ", ".join(given) or "no limits"


def heading(measure: MeasureSummary) -> str:
    """What a measure is, in a line."""
    return measure.words


def position_of(measure: MeasureSummary) -> str:
    """Whose positions a curve is over."""
    return measure.position_word
