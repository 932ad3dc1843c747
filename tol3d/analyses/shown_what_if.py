"""Tables of other tolerances' effect: a measure before, after, and the change.

Charts of what other tolerances do: each measure before and after, with its limits.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np

from tol3d.analyses.before_after import LimitNumbers, MeasureWhatIf, StateNumbers, WhatIf
from tol3d.report.chart import Axis, Chart, Charts, Mark, Outline, Panel, Role
from tol3d.report.declared import declared_table, formed
from tol3d.report.measure_charts import spanned
from tol3d.report.number import NOTHING, UNIT_SIGNS, limit_text, ppm_text, share_text, value_cell, with_unit
from tol3d.report.page import BLANK, Line, Page, PageItem, Shown, Table, note, page, titled
from tol3d.study.runs.summary.shows import Shows, shown_by

WORDS: Final = (
    "sigma by rates: from the slopes at the mean build; first order: Φ(−β), with β the distance to the most likely "
    "build beyond the limit; by sampling: importance sampling around that build, with its 95 % interval, or where none "
    "is found the 95 % upper bound by draws alone; builds that "
    "cannot be assembled count as out of limits; before and after use the same random numbers"
)
JUMPS: Final = (
    "no sigma by rates and no first order where a part floats anywhere in its room: the measure has no slope at the "
    "mean build"
)


def what_if_report(name: str, found: WhatIf) -> Page:
    """Changes, then a table a measure.

    Args:
        name: of the scene.
        found: what they do.
    """
    head = Line(((name, "bold"), (" · what if", "")))
    changes = declared_table("", ((change.contributor, change) for change in found.changes))
    answers = [_answer(measure, own) for measure, own in found.measures.items()]
    blocks: list[PageItem] = [head, BLANK, *answers, BLANK, *titled("tolerances", changes)]
    for measure, own in found.measures.items():
        blocks += [BLANK, *titled(f"{measure} [{UNIT_SIGNS.get(own.unit, own.unit)}]", what_if_table(own))]
    if not found.rough:
        blocks += [note(text) for measure, own in found.measures.items() for text in _unseen(measure, own)]
    counted = f"{found.trials} trials, {found.draws} draws a limit, {found.evaluations} builds evaluated"
    blocks += [BLANK, note(WORDS)]
    if any(own.before.sigma_by_rates is None for own in found.measures.values()):
        blocks += [note(JUMPS)]
    if found.rough:
        words = f"{', '.join(found.rough)}: no smooth map from normals, so limits are counted in the trials"
        blocks += [note(words)]
    return page(*blocks, note(counted))


def _answer(name: str, measure_what_if: MeasureWhatIf) -> Line:
    """Sigma and the fraction out of limits, before and after: by simulation, without one by rates."""
    before, after = (
        _first(each.sigma, each.sigma_by_rates) for each in (measure_what_if.before, measure_what_if.after)
    )
    if before is None or after is None:
        return Line(((name, "bold"), (": known only by simulation", "")))
    told = [
        f"sigma {_named(before, measure_what_if.unit)} → {_named(after, measure_what_if.unit)}{_percent(before, after)}"
    ]
    if measure_what_if.before.limits or measure_what_if.after.limits:
        told.append(f"out of limits {_out(measure_what_if.before)} → {_out(measure_what_if.after)}")
    if measure_what_if.before.ppk is not None and measure_what_if.after.ppk is not None:
        told.append(f"Ppk {measure_what_if.before.ppk:.2f} → {measure_what_if.after.ppk:.2f}")
    if measure_what_if.before.verdict and measure_what_if.after.verdict:
        told.append(f"{measure_what_if.before.verdict} → {measure_what_if.after.verdict}")
    return Line(((name, "bold"), (f": {'; '.join(told)}", "")))


def _first(*values: float | None) -> float | None:
    return next((value for value in values if value is not None), None)


def _named(value: float, unit: str) -> str:
    return with_unit(value_cell(value, unit), unit)


def _percent(before: float, after: float) -> str:
    return f" ({100 * (after / before - 1):+.0f} %)" if before else ""


def _out(state_numbers: StateNumbers) -> str:
    """Fraction beyond all limits; with those beyond which none was found at the bound that this leaves."""
    if not state_numbers.limits:
        return NOTHING
    ppm = [_first(limit.ppm, limit.first_order) for limit in state_numbers.limits.values()]
    known = [each for each in ppm if each is not None]
    if len(known) < len(ppm):
        return NOTHING
    below = sum(limit.below for limit in state_numbers.limits.values() if limit.below is not None)
    total = share_text(sum(known))
    if not below:
        return total
    return f"{total} (+ < {share_text(below)})" if sum(known) else f"none found, < {share_text(below)}"


def _unseen(name: str, measure_what_if: MeasureWhatIf) -> Iterator[str]:
    """Sentences on limits beyond which no build was found, with their distances by slopes."""
    for side, *both in _sides(measure_what_if):
        known = zip(("before", "after"), (measure_what_if.before, measure_what_if.after), both, strict=True)
        unseen = {
            word: (state, limit)
            for word, state, limit in known
            if limit is not None and state.limits[side].below is not None
        }
        if not unseen:
            continue
        away = [
            f"{word} {abs(limit - state.mean) / state.sigma_by_rates:.3g}"
            for word, (state, limit) in unseen.items()
            if state.mean is not None and state.sigma_by_rates
        ]
        slopes = f"; by slopes it lies sigmas away: {', '.join(away)}" if away else ""
        yield (
            f"{name}, {side} limit {' and '.join(unseen)}: no build beyond it was found within 9 sigma{slopes}; the "
            "bound is that of draws, none of which is beyond it; tol3d rare --method subset looks farther"
        )


@dataclass(frozen=True)
class BeforeAfter:
    """A number of a measure before and after."""

    before: Annotated[str, Shows("before")]
    after: Annotated[str, Shows("after")]
    change: Annotated[str, Shows("change")]


def what_if_table(measure_what_if: MeasureWhatIf) -> Table:
    """Table of one measure."""
    unit = measure_what_if.unit
    rows: list[tuple[str, BeforeAfter]] = []
    for name, shows in shown_by(StateNumbers).items():
        before, after = getattr(measure_what_if.before, name), getattr(measure_what_if.after, name)
        if (before, after) != (None, None):
            cells = [formed(value, shows.form, unit) for value in (before, after)]
            if isinstance(before, float) and isinstance(after, float):
                cells.append(formed(after - before, shows.form, unit))
            else:
                cells.append(NOTHING if None in (before, after) else "")
            rows.append((shows.heading, BeforeAfter(*cells)))
    if measure_what_if.before.failed or measure_what_if.after.failed:
        rows.append(
            (
                "builds that fail",
                BeforeAfter(formed(measure_what_if.before.failed, "d"), formed(measure_what_if.after.failed, "d"), ""),
            )
        )
    for side, *both in _sides(measure_what_if):
        sign = "<" if side == "low" else ">"
        words = [NOTHING if limit is None else limit_text(limit, unit) for limit in both]
        if words != [NOTHING, NOTHING]:
            label = f"{sign} {_label(*words)}"
            states = (measure_what_if.before, measure_what_if.after)
            rows += _limit(label, *(state.limits.get(side, NO_LIMIT) for state in states))
    return declared_table("", rows)


def _label(before: str, after: str) -> str:
    if before == NOTHING or after == NOTHING:
        return f"{after}, none before" if before == NOTHING else f"{before}, none after"
    return after if before == after else f"{before} → {after}"


def _sides(measure_what_if: MeasureWhatIf) -> Iterator[tuple[str, float | None, float | None]]:
    """Each side with its limit before and after."""
    after = (measure_what_if.lower_limit, measure_what_if.upper_limit)
    yield from zip(("low", "high"), measure_what_if.limits_before or after, after, strict=True)


def _limit(label: str, before: LimitNumbers, after: LimitNumbers) -> Iterator[tuple[str, BeforeAfter]]:
    first = (before.first_order, after.first_order)
    yield f"{label}, first order [ppm]", BeforeAfter(_ppm(first[0]), _ppm(first[1]), _times(*first))
    if before.ppm is None and after.ppm is None:
        return
    sampled = BeforeAfter(_bounded(before), _bounded(after), _times(before.ppm, after.ppm))
    yield f"{label}, by sampling [ppm]", sampled
    if before.below is None or after.below is None:
        first_span, last_span = ("" if own.below is not None else _span(own.interval) for own in (before, after))
        yield "    95 %", BeforeAfter(first_span, last_span, "")


def _span(interval: Sequence[float] | None) -> str:
    return NOTHING if interval is None else f"{ppm_text(interval[0])} … {ppm_text(interval[1])}"


def _bounded(limit_numbers: LimitNumbers) -> Shown:
    """Fraction by sampling; the bound where nothing beyond the limit was found."""
    return _ppm(limit_numbers.ppm) if limit_numbers.below is None else Shown(f"< {ppm_text(limit_numbers.below)}", None)


def bounded_text(limit_numbers: LimitNumbers) -> str:
    """The same with its unit."""
    return share_text(limit_numbers.ppm) if limit_numbers.below is None else f"< {share_text(limit_numbers.below)}"


def _ppm(value: float | None) -> Shown:
    return Shown(ppm_text(value), value)


def _times(before: float | None, after: float | None) -> str:
    return f"× {after / before:.3g}" if before and after is not None else "–"


NO_LIMIT: Final = LimitNumbers(first_order=None, ppm=None, interval=None, beta=None, below=None)
MOST: Final = 8
"""Measures that are drawn."""


def what_if_charts(name: str, found: WhatIf) -> Charts:
    """The distributions before and after."""
    words = "; ".join(f"{change.contributor}: {change.before} → {change.after}" for change in found.changes)
    shown = list(found.measures.items())[:MOST]
    rows = [[what_if_chart(measure, own, found.trials)] for measure, own in shown]
    return Charts(rows, f"{name} · what if {words}")


def what_if_chart(name: str, measure_what_if: MeasureWhatIf, trials: int) -> Chart:
    """Outlines of a measure's histograms before and after."""
    edges, series, table = np.array(measure_what_if.edges, dtype=np.float64), [], []
    roles: dict[str, Role] = {"before": "series-0", "after": "series-1"}
    for (word, role), state in zip(roles.items(), (measure_what_if.before, measure_what_if.after), strict=True):
        ppm = ", ".join(f"{bounded_text(limit)} {side}" for side, limit in state.limits.items())
        percent = 100.0 * np.array(state.counts) / max(trials, 1)
        series.append(Outline(edges, percent, role, f"{word}{': ' if ppm else ''}{ppm}"))
        table.append((word, ppm))
    y = Axis("% of trials", 0.0, 1.05 * max(float(each.heights.max()) for each in series) or 1.0)
    marks = [*_limits(measure_what_if)]
    across = spanned(name, np.array([edges[0], edges[-1], *(mark.value for mark in marks)]), measure_what_if.unit)
    return Chart(f"{name} before and after", across, [Panel(y, series, marks, 0.7)], name, table=table)


def _limits(measure_what_if: MeasureWhatIf) -> Iterator[Mark]:
    for word, limit in (("LSL", measure_what_if.lower_limit), ("USL", measure_what_if.upper_limit)):
        if limit is not None:
            yield Mark(limit, "limit", (f"{word} {limit_text(limit, measure_what_if.unit)}",), upper=word == "USL")
