"""Allocated tolerances as tables: factors and costs, what simulation confirms, and cost over ppm."""

from typing import Final

from tol3d.analyses.allocation_section import Allocation
from tol3d.report.number import ppm_text
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, note, page, titled, warning

WORDS: Final = (
    "factors multiply the tolerances of the scene, cost is the sum of their costs; first order: from design points; by "
    "sampling: importance sampling with another seed than the search, with its 95 % interval; the curve is of first "
    "order, corrected as at the target"
)


def allocation_report(name: str, found: Allocation) -> Page:
    """Factors, targets and the trade-off.

    Args:
        name: of the scene.
        found: what was allocated.
    """
    blocks: list[PageItem] = [Line(((name, "bold"), (" · tolerances at least cost", ""))), BLANK]
    blocks += titled("tolerances", _tolerances(found))
    blocks += [BLANK, *titled("out of limits [ppm]", _targets(found))]
    blocks += [
        warning(
            f"{own.measure}: {ppm_text(own.wanted)} ppm were wanted, sampling says {ppm_text(own.ppm)}: near there the "
            f"share jumps with the tolerances; ask for less (--ppm {ppm_text(own.wanted / 2)}), or freeze some"
        )
        for own in found.targets
        if own.interval[0] > own.wanted
    ]
    blocks += [BLANK, *titled("cost over ppm", _trade_off(found)), BLANK, note(WORDS)]
    counted = f"{found.rounds} rounds, {found.draws} draws a limit each, {found.evaluations} builds evaluated"
    return page(*blocks, note(counted))


def _tolerances(found: Allocation) -> Table:
    heads = [Heading("factor"), Heading("cost"), *(Heading(own, words=True) for own in ("before", "after", ""))]
    rows = [
        Row(name, (_text(own.factor), _text(own.cost), own.before, own.after, own.held))
        for name, own in found.tolerances.items()
    ]
    rows.append(Row("least cost", ("", _text(found.cost), "", "", ""), "bold"))
    if found.equal_cost is not None:
        rows.append(Row("equal factors", (_text(found.equal_factor), _text(found.equal_cost), "", "", "")))
    rows.append(Row("as in the scene", (_text(1.0), _text(found.scene_cost), "", "", "")))
    return Table("", heads, rows)


def _targets(found: Allocation) -> Table:
    heads = [Heading(own) for own in ("wanted", "scene", "first order", "by sampling", "95 %")]
    rows = [
        Row(
            f"{own.measure}, {' and '.join(own.sides)}",
            (
                *(Shown(ppm_text(value), value) for value in (own.wanted, own.scene, own.first_order, own.ppm)),
                f"{ppm_text(own.interval[0])} … {ppm_text(own.interval[1])}",
            ),
        )
        for own in found.targets
    ]
    return Table("", heads, rows)


def _trade_off(found: Allocation) -> Table:
    rows = [Row(f"{ppm_text(own.ppm)} ppm", (_text(own.cost),)) for own in found.trade_off]
    return Table("", [Heading("cost")], rows)


def _text(value: float | None) -> Shown:
    return Shown("–" if value is None else f"{value:.4g}", value)
