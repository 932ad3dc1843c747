"""Recommended changes, as tables, and as a few lines below a verdict.

Charts of what to change: each measure in its limits as it is, and after each change.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Annotated, Final

import numpy as np

from tol3d.analyses.compared_builds import SURE
from tol3d.analyses.slopes import Rates
from tol3d.analyses.what_to_change import Beside, Changes, MeasureChanges, Proposal, Spread, Step
from tol3d.report.chart import Axis, Chart, Charts, Mark, Names, Panel, Range, Role
from tol3d.report.declared import cells_of, declared_table, headings
from tol3d.report.measure_charts import spanned
from tol3d.report.number import (
    NOTHING,
    UNIT_SIGNS,
    bounded_share_text,
    counted,
    limit_text,
    share_text,
    unsigned_zero,
    value_cell,
    with_unit,
)
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, line, note, page, title
from tol3d.study.runs.summary.shows import Shows

MOST_TAKEN: Final = 5
"""Contributors of a mean's shift that are shown."""
LEAST_TAKEN: Final = 0.005
"""Fraction of sigma; a smaller shift of the mean is not shown."""
BRIEF_TOLD: Final = 3
ERRORS: Final = 1.96
"""Standard errors of an interval of 95 %."""
NOTE: Final = (
    "each change is simulated with the same uniforms: a nominal moved, or a tolerance half as wide; told is what makes "
    "the measure better beyond chance, and no other one with limits worse"
)
AFTER: Final = headings(Spread)


def changes_report(name: str, found: Changes) -> Page:
    """Recommended changes, measure by measure.

    Args:
        name: of the scene.
        found: in it.
    """
    aims = f" · accepted: {share_text(found.accepted_ppm)} out of limits · aim: Ppk {found.ppk:g}"
    head = Line(((name, "bold"), (f" · what to change{aims}", "")))
    blocks: list[PageItem] = [head, BLANK, *_answers(found)]
    if not found.measures:
        blocks.append(line(" nothing: no measure is out of its limits more often than accepted"))
    for measure, own in found.measures.items():
        blocks += _of_measure(measure, own)
    blocks += [BLANK, note(NOTE) if found.measures else BLANK]
    if found.further:
        blocks.append(note(f"not looked at: {', '.join(found.further)}"))
    return page(*blocks, note(f"{found.evaluations} builds"))


@dataclass(frozen=True)
class ProposalRow:
    """A change, and the columns of the measure's spread after it."""

    how_much: Annotated[str, Shows("by how much")]
    after: Annotated[Mapping[Heading, str], Shows("{key}")]


def _of_measure(name: str, measure_changes: MeasureChanges) -> Iterator[PageItem]:
    unit = measure_changes.unit
    yield title(name, f" · limits {_limits(measure_changes)} · {measure_changes.builds} builds each")
    yield BLANK
    rows = [("as it is", ProposalRow("", dict(zip(AFTER, cells_of(measure_changes.now, unit), strict=True))))]
    for proposal in measure_changes.proposals:
        after = dict(zip(AFTER, cells_of(proposal.after, unit), strict=True))
        rows.append((proposal_text(proposal), ProposalRow(_how_much(proposal), after)))
        rows += [(f"  {_beside(other)}", ProposalRow("", dict.fromkeys(AFTER, ""))) for other in proposal.beside]
    yield declared_table("change", rows)
    if table := _taken_table(measure_changes):
        yield BLANK
        yield table


def proposal_text(proposal: Proposal) -> str:
    """Its steps: `half centre distance`, `pinion tooth thickness (E_sns and E_sni)`."""
    return " and ".join(f"half {step.contributor}" if step.change is None else _moved(step) for step in proposal.steps)


def _moves(proposal: Proposal) -> bool:
    return all(step.change is not None for step in proposal.steps)


def _moved(step: Step) -> str:
    plain = step.nominal in step.contributor.lower().split() or step.nominal == "nominal"
    return step.contributor if plain else f"{step.contributor} ({step.nominal})"


def _how_much(proposal: Proposal) -> Shown | str:
    """By how much a nominal moves, or what a tolerance becomes; of several changes nothing."""
    if len(proposal.steps) > 1:
        return ""
    (step,) = proposal.steps
    return step.becomes if step.change is None else _change(step)


def _beside(beside: Beside) -> str:
    """Another measure before and after a change: `lost motion 1′25″ → 1′50″`."""
    text = f"{beside.measure} {_valued(beside.now.mean, beside.unit)} → {_valued(beside.after.mean, beside.unit)}"
    return f"{text}, Ppk {_ppk(beside.now)} → {_ppk(beside.after)}" if beside.has_limits else text


@dataclass(frozen=True)
class TakenRow:
    """Distance by which something takes a mean off nominal."""

    by_mean: Annotated[str, Shows("by its mean")]
    by_spread: Annotated[str, Shows("by its spread")]


def _taken_table(measure_changes: MeasureChanges) -> Table | None:
    """Table of causes of a mean off nominal; None if there are none."""
    unit, sigma = measure_changes.unit, measure_changes.now.sigma or 0.0
    large = [each for each in measure_changes.taken if abs(each.first_order + each.second_order) > LEAST_TAKEN * sigma]
    if not large and abs(measure_changes.taken_together or 0.0) <= max(
        LEAST_TAKEN * sigma, SURE * (measure_changes.taken_error or 0.0)
    ):
        return None
    shown = large[:MOST_TAKEN]
    rest = [each for each in measure_changes.taken if each not in shown]
    rows = [(each.contributor, TakenRow(_off(each.first_order, unit), _off(each.second_order, unit))) for each in shown]
    if rest:
        sums = (sum(each.first_order for each in rest), sum(each.second_order for each in rest))
        rows.append((counted(len(rest), "other"), TakenRow(*(_off(value, unit) for value in sums))))
    rows.append(
        (
            "interactions and sampling",
            TakenRow("", _with_error(measure_changes.taken_together, measure_changes.taken_error, unit)),
        )
    )
    return declared_table(f"mean off nominal ({_valued(measure_changes.nominal, unit)})", rows)


def _with_error(value: float | None, error: float | None, unit: str) -> Shown | str:
    """With its interval of 95 %."""
    if value is None or error is None:
        return _off(value, unit)
    return Shown(f"{_signed(value, unit)} ±{value_cell(ERRORS * error, unit)}", value)


def _off(value: float | None, unit: str) -> Shown | str:
    return NOTHING if value is None else Shown(_signed(value, unit), value)


def _ppk(spread: Spread) -> str:
    return NOTHING if spread.ppk is None else unsigned_zero(f"{spread.ppk:.2f}")


def _limits(measure_changes: MeasureChanges) -> str:
    lower, upper = measure_changes.lower_limit, measure_changes.upper_limit
    if lower is None or upper is None:
        return "".join(
            f"{sign} {_limit(limit, measure_changes.unit)}"
            for sign, limit in (("≥", lower), ("≤", upper))
            if limit is not None
        )
    return f"{_limit(lower, measure_changes.unit)} to {_limit(upper, measure_changes.unit)}"


def _limit(value: float, unit: str) -> str:
    return limit_text(value, unit) if unit in UNIT_SIGNS or unit == "arcmin" else f"{value:g}"


def _valued(value: float | None, unit: str) -> str:
    return NOTHING if value is None else with_unit(str(value_cell(value, unit)), unit)


def _signed(value: float, unit: str) -> str:
    """A change with its sign and unit: `+3.2 µm`."""
    text = with_unit(str(value_cell(abs(value), unit)), unit)
    return f"{'−' if value < 0.0 else '+'}{text}"


def _change(step: Step) -> Shown:
    change = step.change or 0.0
    digits, sign = f"{abs(change):.4g}", "−" if change < 0.0 else "+"
    return Shown(f"{sign}{digits} {UNIT_SIGNS.get(step.unit, step.unit)}", change)


# below a verdict ----------------------------------------------------------------------------------


def changes_lines(found: Changes, where: str) -> list[PageItem]:
    """A few lines for each measure.

    Args:
        found: in a run.
        where: what `tol3d changes` is to be asked for the whole.
    """
    if not found.measures:
        return [note(f"tol3d changes {where} asks what to change")]
    builds = min(measure.builds for measure in found.measures.values())
    words = f" · simulated, {builds} builds each; tol3d changes {where} has more"
    blocks: list[PageItem] = [title("what to change", words), *_answers(found)]
    if found.further:
        dots = " …" if len(found.further) > BRIEF_TOLD else ""
        blocks.append(note(f"{len(found.further)} more NOT OK: {', '.join(found.further[:BRIEF_TOLD])}{dots}"))
    return blocks


def best_change(found: Changes) -> str:
    """The first measure and the best change that was found for it, in a line; "" where none is."""
    measure, *changes = [str(own).strip() for own in islice(_answers(found), 2)] or [""]
    return "; ".join([measure, *changes]) if changes else ""


def _answers(found: Changes) -> Iterator[PageItem]:
    for name, own in found.measures.items():
        yield line(f" {name}: {_told(own.now)}")
        yield from map(note, _brief(own, found.ppk))


def _brief(measure_changes: MeasureChanges, ppk: float) -> Iterator[str]:
    """The best changes, the best first, and whether one suffices."""
    first, rest = measure_changes.proposals[: BRIEF_TOLD - 1], measure_changes.proposals[BRIEF_TOLD - 1 :]
    if all(_moves(each) for each in first):  # a tolerance is among them, too
        rest = [each for each in rest if not _moves(each)] or rest
    for k, each in enumerate([*first, *rest[:1]]):
        steps = [
            f"halve {step.contributor}" if step.change is None else f"move {_moved(step)} by {_change(step)}"
            for step in each.steps
        ]
        beside = "".join(f"; {_beside(other)}" for other in each.beside[:BRIEF_TOLD])
        yield f" {'or ' if k else ''}{' and '.join(steps)}: {_told(each.after)}{beside}"
    if not measure_changes.tried:
        yield " no tolerance that acts on it can be changed: change the nominal geometry or the limit"
        return
    if not measure_changes.proposals:
        tried = counted(measure_changes.tried, "change")
        yield f" none of {tried} that were simulated helps without harm to another measure"
    if not any(proposal.reaches(ppk) for proposal in measure_changes.proposals):
        yield f" Ppk {ppk:g} is reached by none; tol3d allocate looks for tolerances that reach it"


def _told(after: Spread) -> str:
    return f"{bounded_share_text(after.out_ppm, after.out_ppm_95)} out, Ppk {_ppk(after)}"


# all measures -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ContributionRow:
    """Contribution to a measure, in its unit."""

    contributor: Annotated[str, Shows("contributor", "words")]
    slope_unit: Annotated[str, Shows("of the slope", "words")]
    slope: Annotated[float, Shows("slope", ".6g")]
    share: Annotated[float, Shows("share of variance, estimated by slopes", ".6g", "%")]
    share_95: Annotated[float, Shows("95 % ± of that", ".6g", "%")]
    sigma: Annotated[float, Shows("sigma it gives", ".6g")]
    mean: Annotated[float, Shows("mean it gives", ".6g")]
    by_spread: Annotated[float, Shows("mean by its spread", ".6g")]


def contributions_table(rates: Rates) -> Table:
    """A row for each measure and contributor: slopes, share of the variance, and what it takes the mean off."""
    rows = []
    for measure, of in enumerate(rates.response.measures):
        for k, own in enumerate(rates.response.contributors):
            slopes = rates.slopes[measure, rates.response.slices[own.name]] * own.per_unit
            row = ContributionRow(
                own.name,
                f"{of.unit} per {own.unit}",
                float(slopes[0] if len(slopes) == 1 else (slopes * slopes).sum() ** 0.5),
                float(rates.shares[measure, k]),
                ERRORS * float(rates.share_errors[measure, k]),
                float(rates.mean_variances[measure, k]) ** 0.5,
                float(rates.first[measure, k]),
                float(rates.second[measure, k]),
            )
            rows.append((Row(of.name, (), unit=of.unit), row))
    return declared_table("measure", rows)


WIDTH: Final = 10.0  # inch
MOST: Final = 6
"""Measures that are drawn."""
NO_CHANGES: Final = "no limit is left more often than is accepted"


def changes_charts(name: str, found: Changes) -> Charts:
    """Mean ± 3 sigma of each change."""
    charts = [changes_chart(measure, own) for measure, own in list(found.measures.items())[:MOST]]
    rows = [[chart] for chart in charts] or [[Chart(NO_CHANGES, Axis("", 0.0, 1.0), (), instead=NO_CHANGES)]]
    return Charts(rows, f"{name} · what to change", WIDTH)


def changes_chart(name: str, measure_changes: MeasureChanges) -> Chart:
    """A row for each change of a measure with mean ± 3 sigma and the fraction out of limits."""
    changes = changes_of_one(measure_changes)
    rows = [
        Range(row, mean - 3 * sigma, mean + 3 * sigma, mean, role, words, share_text(after.out_ppm))
        for row, (words, after, role) in enumerate(changes)
        if (mean := after.mean) is not None and (sigma := after.sigma) is not None
    ]
    limits = [
        (word, end)
        for word, end in (("LSL", measure_changes.lower_limit), ("USL", measure_changes.upper_limit))
        if end is not None
    ]
    marks = [Mark(limit, "limit", label=f"{word} {limit_text(limit, measure_changes.unit)}") for word, limit in limits]
    ends = [end for row in rows for end in (row.low, row.high) if end is not None]
    across = spanned(name, np.array([*ends, *(limit for _, limit in limits)]), measure_changes.unit)
    panel = Panel(Names([words for words, _, _ in changes]), rows, marks)
    table = [(words, f"{share_text(after.out_ppm)} out of limits") for words, after, _ in changes]
    return Chart(f"{name} after each change", across, [panel], name, "mean ± 3 sigma; out of limits", table)


def changes_of_one(measure_changes: MeasureChanges) -> list[tuple[str, Spread, Role]]:
    """Every change of a measure in words, what it makes of it, and its role."""
    found: list[tuple[str, Spread, Role]] = [("as it is", measure_changes.now, "plain")]
    for proposal in measure_changes.proposals:
        moves = any(step.change is not None for step in proposal.steps)
        role: Role = "series-0" if len(proposal.steps) > 1 else "series-2" if moves else "series-1"
        found.append((proposal_text(proposal), proposal.after, role))
    return found
