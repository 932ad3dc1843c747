"""Rare events as tables: how often each limit is left, and the build by which it most likely is."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from tol3d.analyses.rare import RareEvent
from tol3d.analyses.response import Response
from tol3d.report.number import limit_text, number_text, ppm_text
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Table, note, page, titled

MOST_SHOWN: Final = 8
"""Contributors of a design point."""
WORDS: Final = (
    "β: distance of the design point, the most likely build beyond the limit, in standard normals; first order: Φ(−β), "
    "averaged over positions; by sampling: importance sampling about the design points, with its interval of 95 %; "
    "builds that do not seat fail"
)


def rare_report(name: str, response: Response, events: Sequence[RareEvent]) -> Page:
    """How often limits are left, then the design point of each.

    Args:
        name: of the scene.
        response: of all of its measures.
        events: of its limits.
    """
    units = {own.name: own.unit for own in response.measures}
    rows = [
        Row(
            own.measure,
            (
                f"{'<' if own.side == 'low' else '>'} {limit_text(own.limit, units[own.measure])}",
                ppm_text(1e6 * own.probability),
                f"{ppm_text(1e6 * own.interval[0])} … {ppm_text(1e6 * own.interval[1])}",
                ppm_text(None if own.first_order is None else 1e6 * own.first_order),
                f"{own.points[0].beta:.3f}" if own.points else "–",
                str(own.evaluations),
            ),
        )
        for own in events
    ]
    heads = ("limit", "by sampling", "95 %", "first order", "β", "builds")
    table = Table("", [Heading(own, words=own == "limit") for own in heads], rows)
    blocks: list[PageItem] = [Line(((name, "bold"), (" · how often limits are left", ""))), BLANK, table, note(WORDS)]
    for own in events:
        if own.points:
            blocks += [BLANK, *_design_point(response, own)]
    return page(*blocks)


def _design_point(response: Response, event: RareEvent) -> Sequence[PageItem]:
    """Deviations of the contributors that lead there, the largest parts first."""
    nearest = event.points[0]
    deviations = response.deviations(nearest.normals[None])[0]
    shares = {name: float((nearest.sensitivities[own] ** 2).sum()) for name, own in response.normals.items()}
    rows = []
    for own in sorted(response.contributors, key=lambda each: -shares[each.name])[:MOST_SHOWN]:
        values = deviations[response.slices[own.name]] / own.per_unit
        told = ", ".join(number_text(float(value)) for value in np.round(values, 3) + 0.0)
        unit = "µm" if own.unit == "um" else own.unit
        rows.append(Row(own.name, (told, unit, f"{100 * shares[own.name]:.1f}")))
    side = "below" if event.side == "low" else "above"
    title = f"{event.measure}: the most likely build {side} its limit"
    heads = [Heading("deviation"), Heading("unit", words=True), Heading("share of the way [%]")]
    return titled(title, Table("", heads, rows))
