"""The thickness of shims as tables: those there are, by the formula, by the geometry, those to take."""

from collections.abc import Iterator, Mapping
from typing import Final

from tol3d.apps.adjustment.shim import ShimPlan, closing_of
from tol3d.apps.adjustment.shim_choice import MINIMUM_WORDS, UM, Shim, Shimmed
from tol3d.apps.adjustment.stock import thickness_text
from tol3d.report import CONVERTED_ROWS, NOTHING, STATISTICS, value_text
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Table, line, note, page, warning

ROWS: Final = ("low_3sigma", "mean", "high_3sigma", "p0.135", "sample_min")
SIDES: Final[Mapping[str, str]] = {
    "behind": "behind {}, moves it towards the apex: closes",
    "in_front": "in front of {}, moves it away from the apex: opens",
}


def shim_report(plan: ShimPlan) -> Page:
    """Report on the shims: their places, their thickness and their effect on the backlash."""
    blocks: list[PageItem] = [_title(plan), _words(plan), BLANK]
    blocks += [line(f"  {shim.name}: {_place(shim)}") for shim in plan.shims]
    blocks += [BLANK, _table(plan), *map(note, _notes(plan))]
    blocks += [*map(warning, _warnings(plan))]
    return page(*blocks)


def _title(plan: ShimPlan) -> Line:
    text = f" · shims for a minimum of {value_text(UM * plan.question.target, 'um')} µm"
    return Line(((plan.scene.scene, "bold"), (text, "")))


def _words(plan: ShimPlan) -> Line:
    called = MINIMUM_WORDS[plan.question.minimum]
    return line(f"{plan.measure}: {plan.before.measure.words}; minimum: {called}", "dim")


def _place(shim: Shim) -> str:
    state = "new" if shim.is_new else f"{thickness_text(shim.mean)} so far"
    return f"{SIDES[shim.spec.side].format(shim.spec.of)} ({state})"


def _table(plan: ShimPlan) -> Table:
    columns = {"as it stands": plan.before, "by the formula": plan.by_formula, "by the geometry": plan.by_geometry}
    columns["chosen"] = plan.chosen
    if plan.other is not None:
        columns[_other_words(plan.chosen, plan.other)] = plan.other
    shown = list(columns.values())
    rows = [Row("each shim [µm]", [_thickness(own, plan) for own in shown])]
    for key in ROWS:
        style = "bold" if key == plan.question.minimum else ""
        rows.append(Row(STATISTICS[key].heading, [value_text(own.found.value(key), "um") for own in shown], style))
    for key, label in CONVERTED_ROWS.items():
        rows.append(Row(f"lost motion, {label}", [_lost_motion(own, key) for own in shown]))
    headings = [Heading(text, "bold" if text == "chosen" else "") for text in columns]
    return Table("[µm], [′, ″ of arc]", headings, rows)


def _other_words(chosen: Shimmed, other: Shimmed) -> str:
    return "next thicker" if (other.thickness or 0.0) > (chosen.thickness or 0.0) else "next thinner"


def _thickness(own: Shimmed, plan: ShimPlan) -> str:
    """Thickness of each shim; nothing for shims that are not yet there or that differ in thickness."""
    before = {shim.mean for shim in plan.shims if not shim.is_new}
    thickness = before.pop() if own.thickness is None and len(before) == 1 else own.thickness
    return NOTHING if thickness is None else value_text(UM * thickness, "um")


def _lost_motion(own: Shimmed, key: str) -> str:
    value, free = own.found.value(key), own.measure.conversions[0]
    return value_text(None if value is None else value * free.per_unit, free.unit)


def _notes(plan: ShimPlan) -> Iterator[str]:
    chosen, stock = plan.chosen.thickness or 0.0, plan.question.stock
    yield f"chosen: {thickness_text(chosen)} each, {stock.words(chosen)}; rounding: {plan.question.rounding}"
    if plan.other is None:
        yield "of the stock there is no other near it with which the mean build turns"
    yield (
        f"formula: 2 sin α sin δ of each shim's gear, {closing_of(plan.shims):.5f} µm of backlash for 1 µm of every "
        "shim; geometry: the simulated minimum itself, the same draws at every thickness"
    )
    yield f"lost motion: the turn of {plan.before.measure.conversions[0].of} that the backlash leaves free"
    study = f"{plan.before.trials} trials, 3D simulation"
    error = plan.chosen.sampling_error
    if error is None:
        yield study
        return
    of_thickness = UM * error / abs(closing_of(plan.shims))
    yield (
        f"{study}; sampling error of the minimum ±{UM * error:.3f} µm, which is ±{of_thickness:.3f} µm of thickness "
        "(one standard error)"
    )


def _warnings(plan: ShimPlan) -> Iterator[str]:
    for words, own in (("as it stands", plan.before), ("with the chosen shims", plan.chosen)):
        if own.failed:
            yield (
                f"{own.failed} of {own.trials} builds {words} jam or find no contact; the numbers above are of the "
                f"{own.trials - own.failed} that were assembled"
            )
    if plan.chosen.minimum < plan.question.target - plan.chosen.resolution:
        short = UM * (plan.question.target - plan.chosen.minimum)
        yield f"the chosen thickness leaves {short:.3f} µm less than the target; --round down would not"
