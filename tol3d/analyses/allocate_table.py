"""Allocated tolerances as tables: factors and costs, what simulation confirms, and cost over ppm."""

from dataclasses import replace
from typing import Final

from tol3d.analyses.allocation_section import Allocation
from tol3d.report.declared import declared_table, formed
from tol3d.report.number import ppm_text
from tol3d.report.page import BLANK, Line, Page, PageItem, Row, Table, note, page, titled, warning

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
            f"{target.measure}: {ppm_text(target.wanted)} ppm were wanted, sampling says {ppm_text(target.ppm)}: near "
            f"there the share jumps with the tolerances; ask for less (--ppm {ppm_text(target.wanted / 2)}), or freeze "
            "some"
        )
        for target in found.targets
        if target.interval[0] > target.wanted
    ]
    blocks += [BLANK, *titled("cost over ppm", _trade_off(found)), BLANK, note(WORDS)]
    counted = f"{found.rounds} rounds, {found.draws} draws a limit each, {found.evaluations} builds evaluated"
    return page(*blocks, note(counted))


def _tolerances(found: Allocation) -> Table:
    table = declared_table("", found.tolerances.items())
    totals: dict[str, tuple[float | str | None, float | None]] = {"least cost": ("", found.cost)}
    if found.equal_cost is not None:
        totals["equal factors"] = (found.equal_factor, found.equal_cost)
    totals["as in the scene"] = (1.0, found.scene_cost)
    blank = [""] * (len(table.headings) - 2)
    rows = [Row(name, [*(formed(own, ".4g") for own in both), *blank]) for name, both in totals.items()]
    return replace(table, rows=[*table.rows, replace(rows[0], style="bold"), *rows[1:]])


def _targets(found: Allocation) -> Table:
    return declared_table("", ((f"{target.measure}, {' and '.join(target.sides)}", target) for target in found.targets))


def _trade_off(found: Allocation) -> Table:
    return declared_table("", ((f"{ppm_text(own.ppm)} ppm", own) for own in found.trade_off))
