"""Recommended changes, as tables, and as a few lines below a verdict."""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Final

from tol3d.analyses.slopes import Rates
from tol3d.analyses.what_to_change import SURE, Changes, MeasureChanges, Moved, Spread, Target
from tol3d.report.number import (
    NOTHING,
    UNIT_SIGNS,
    counted,
    limit_text,
    percent_cell,
    share_text,
    unsigned_zero,
    value_cell,
    with_unit,
)
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, line, note, page, title

MOST_TAKEN: Final = 5
"""Contributors of a mean's shift that are shown."""
LEAST_TAKEN: Final = 0.005
"""Fraction of sigma; a smaller shift of the mean is not shown."""
BRIEF_TOLD: Final = 3
ERRORS: Final = 1.96
"""Standard errors of an interval of 95 %."""
BY: Final = {
    "simulation": (
        "each change is simulated with the same draws: one nominal shifted, or one tolerance halved about its middle"
    ),
    "rates": (
        "estimates: the trials of the run shifted, or narrowed by the contributor's share of the variance; "
        "tol3d changes simulates each change"
    ),
}
AFTER: Final = (
    Heading("mean"),
    Heading("sigma"),
    Heading("out of limits"),
    Heading("95 % interval", optional=True),
    Heading("Ppk"),
)


def changes_report(name: str, found: Changes) -> Page:
    """Recommended changes, measure by measure.

    Args:
        name: of the scene.
        found: in it.
    """
    head = Line(((name, "bold"), (f" · what to change · accepted: {share_text(found.accepted_ppm)} out of limits", "")))
    blocks: list[PageItem] = [head, BLANK, *_answers(found)]
    if not found.measures:
        blocks.append(line(" nothing: no measure is out of its limits more often than accepted"))
    for measure, own in found.measures.items():
        blocks += _of_measure(measure, own)
    blocks += [BLANK, note(BY[found.by]) if found.measures else BLANK]
    if found.further:
        blocks.append(note(f"not looked at: {', '.join(found.further)}"))
    return page(*blocks, note(f"{found.evaluations} builds"))


def _of_measure(name: str, own: MeasureChanges) -> Iterator[PageItem]:
    unit = own.unit
    yield title(name, f" · limits {_limits(own)} · {own.builds} builds each")
    yield BLANK
    rows = [Row("as it is", ["", *_after(own.now, unit)])]
    for shift in own.shifts:
        told = f"mean {_signed(shift.shift, unit)}: {shift.target}"
        rows.append(Row(told, ["", *_after(shift.after, unit)]))
        rows += [Row(f"  by {by.contributor}", [_change(by), *_after(by.after, unit)]) for by in shift.by]
    rows += [
        Row(f"half {each.contributor}", [_half(each.share_percent), *_after(each.after, unit)]) for each in own.halved
    ]
    yield Table("change", [Heading("by how much"), *AFTER], rows)
    if table := _taken_table(own):
        yield BLANK
        yield table


def _taken_table(own: MeasureChanges) -> Table | None:
    """Table of causes of a mean off nominal; None if there are none."""
    unit, sigma = own.unit, own.now.sigma or 0.0
    large = [each for each in own.taken if abs(each.first_order + each.second_order) > LEAST_TAKEN * sigma]
    if not large and abs(own.taken_together or 0.0) <= max(LEAST_TAKEN * sigma, SURE * (own.taken_error or 0.0)):
        return None
    shown = large[:MOST_TAKEN]
    rest = [each for each in own.taken if each not in shown]
    rows = [Row(each.contributor, [_off(each.first_order, unit), _off(each.second_order, unit)]) for each in shown]
    if rest:
        sums = (sum(each.first_order for each in rest), sum(each.second_order for each in rest))
        rows.append(Row(counted(len(rest), "other"), [_off(value, unit) for value in sums]))
    rows.append(Row("interactions and sampling", ["", _with_error(own.taken_together, own.taken_error, unit)]))
    corner = f"mean off nominal ({_valued(own.nominal, unit)})"
    return Table(corner, [Heading("by its mean"), Heading("by its spread")], rows)


def _with_error(value: float | None, error: float | None, unit: str) -> Shown | str:
    """With its interval of 95 %."""
    if value is None or error is None:
        return _off(value, unit)
    return Shown(f"{_signed(value, unit)} ±{value_cell(ERRORS * error, unit)}", value)


def _off(value: float | None, unit: str) -> Shown | str:
    return NOTHING if value is None else Shown(_signed(value, unit), value)


def _after(own: Spread, unit: str) -> Sequence[Shown | str]:
    ppk = NOTHING if own.ppk is None else unsigned_zero(f"{own.ppk:.2f}")
    sigma = value_cell(own.sigma, unit)
    return [
        value_cell(own.mean, unit),
        sigma,
        Shown(share_text(own.out_ppm), own.out_ppm),
        NOTHING if own.out_ppm_95 is None else " to ".join(map(share_text, own.out_ppm_95)),
        Shown(ppk, own.ppk),
    ]


def _half(percent: float | None) -> Shown:
    return Shown(f"{percent_cell(percent)} % of variance", percent)


def _limits(own: MeasureChanges) -> str:
    lower, upper = own.lower_limit, own.upper_limit
    if lower is None or upper is None:
        return "".join(
            f"{sign} {_limit(limit, own.unit)}" for sign, limit in (("≥", lower), ("≤", upper)) if limit is not None
        )
    return f"{_limit(lower, own.unit)} to {_limit(upper, own.unit)}"


def _limit(value: float, unit: str) -> str:
    return limit_text(value, unit) if unit in UNIT_SIGNS or unit == "arcmin" else f"{value:g}"


def _valued(value: float | None, unit: str) -> str:
    return NOTHING if value is None else with_unit(str(value_cell(value, unit)), unit)


def _signed(value: float, unit: str) -> str:
    """A change with its sign and unit: `+3.2 µm`."""
    text = with_unit(str(value_cell(abs(value), unit)), unit)
    return f"{'−' if value < 0.0 else '+'}{text}"


def _change(own: Moved) -> Shown:
    digits = f"{abs(own.change):.4g}"
    sign = "−" if own.change < 0.0 else "+"
    return Shown(f"{sign}{digits} {UNIT_SIGNS.get(own.unit, own.unit)}", own.change)


# below a verdict ----------------------------------------------------------------------------------


def changes_lines(found: Changes, where: str) -> list[PageItem]:
    """A few lines for each measure.

    Args:
        found: by rates.
        where: what `tol3d changes` is to be asked for the whole.
    """
    blocks: list[PageItem] = [title("what to change", f" · estimated; tol3d changes {where} simulates it")]
    blocks += _answers(found)
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
        yield line(f" {name}: {share_text(own.now.out_ppm)} out of limits")
        yield from map(note, _brief(own))


def _brief(own: MeasureChanges) -> Iterator[str]:
    unit = own.unit
    for shift in own.shifts:
        by = " or ".join(f"{each.contributor} {_change(each)}" for each in shift.by[:2])
        how = f": {by}" if by else ""
        yield f" shift the mean by {_signed(shift.shift, unit)} to {_aim(shift.target)}{how}; then {_told(shift.after)}"
    halves = [f"{each.contributor}: {_told(each.after)}" for each in own.halved[:BRIEF_TOLD]]
    if halves:
        yield f" halve {'; or '.join(halves)}"


def _aim(target: Target) -> str:
    return target if target == "Ppk 1.33" else f"the {target}"


def _told(after: Spread) -> str:
    ppk = NOTHING if after.ppk is None else unsigned_zero(f"{after.ppk:.2f}")
    return f"{share_text(after.out_ppm)} out, Ppk {ppk}"


# all measures -------------------------------------------------------------------------------------


def contributions_table(rates: Rates) -> Table:
    """A row for each measure and contributor: slopes, share of the variance, and what it takes the mean off."""
    rows = []
    for measure, of in enumerate(rates.response.measures):
        for k, own in enumerate(rates.response.contributors):
            slopes = rates.slopes[measure, rates.response.slices[own.name]] * own.per_unit
            numbers = (
                float(slopes[0] if len(slopes) == 1 else (slopes * slopes).sum() ** 0.5),
                100 * float(rates.shares[measure, k]),
                float(rates.variances[measure, k]) ** 0.5,
                float(rates.first[measure, k]),
                float(rates.second[measure, k]),
            )
            cells = [own.name, f"{of.unit} per {own.unit}", *(Shown(f"{number:.6g}", number) for number in numbers)]
            rows.append(Row(of.name, cells, unit=of.unit))
    heads = (
        "contributor",
        "of the slope",
        "slope",
        "share of variance [%]",
        "sigma it gives",
        "mean it gives",
        "mean by its spread",
    )
    return Table("measure", [Heading(own, words=own in heads[:2]) for own in heads], rows)
