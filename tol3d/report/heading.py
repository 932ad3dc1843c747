"""Headings of reports, and the measures and contributors shown."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final, TypeVar

from tol3d.report.number import limit_text
from tol3d.study.runs.summary.measure import MeasureSummary, Worse
from tol3d.study.runs.summary.run import RunSummary

ENDS: Mapping[Worse, str] = {"low": "smallest", "high": "largest"}


def worst_words(run: RunSummary) -> str:
    """Criterion of the worst trial, see `worst_trial`: `the nearest to a limit of play, or the furthest beyond it`."""
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
    """Description of a measure, in a line."""
    return measure.words


def position_of(measure: MeasureSummary) -> str:
    """Whose positions a curve is over."""
    return measure.position_word


T = TypeVar("T")

MOST_MEASURES: Final = 20  # rows and tables of measures that are shown
MOST_CONTRIBUTORS: Final = 15  # rows of contributors in the table of a measure
WORST_FIRST: Final = "by the share out of limits, then by Ppk"


def badness(out_ppm: float | None, ppk: float | None) -> tuple[float, float]:
    """A key that sorts the worst measure first: the largest share out of limits [ppm], of equal ones the least Ppk.

    >>> sorted([(0.0, 1.2), (None, None), (0.0, 1.1), (12.0, 1.4)], key=lambda own: badness(*own))
    [(12.0, 1.4), (0.0, 1.1), (0.0, 1.2), (None, None)]
    """
    return -(out_ppm or 0.0), float("inf") if ppk is None else ppk


def worst_first(measures: Mapping[str, MeasureSummary]) -> list[str]:
    """Names of measures, the worst first; those without limits come last, in the scene's order."""
    shares = {name: own.shares for name, own in measures.items()}
    return sorted(measures, key=lambda name: badness(shares[name].out_ppm, shares[name].ppk))


def shown_measures(measures: Mapping[str, MeasureSummary], most: int = MOST_MEASURES) -> Sequence[str]:
    """Names of the measures that are shown: all in their order, or of more than `most` the worst, the worst first."""
    return list(measures) if len(measures) <= most else worst_first(measures)[:most]


def largest(items: Iterable[T], sizes: Mapping[T, float], most: int = MOST_CONTRIBUTORS) -> list[T]:
    """Items that are shown: all in their order, or of more than `most` the largest, the largest first."""
    every = list(items)
    return every if len(every) <= most else sorted(every, key=lambda item: -sizes.get(item, 0.0))[:most]


def cut(text: str, longest: int) -> str:
    """A text not longer than fits; a longer one ends in an ellipsis."""
    return text if len(text) <= longest else text[: max(longest - 1, 0)] + "…"


LONGEST: Final = 34  # letters of a name in a picture


def legible(text: str, longest: int = LONGEST) -> str:
    """A user's name as a label of matplotlib or VTK: no mathematics in its dollar signs, not longer than fits."""
    return cut(text, longest).replace("$", r"\$")
