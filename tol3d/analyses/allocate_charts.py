"""Charts of allocated tolerances: their factors, and cost over ppm."""

from typing import Final

import numpy as np

from tol3d.analyses.allocation_section import Allocation
from tol3d.report.chart import Axis, Chart, Charts, Lengths, Line, Mark, Names, Panel, Points, Role, Series
from tol3d.report.measure_charts import spanned

WIDTH: Final = 12.0  # inch


def allocation_charts(name: str, found: Allocation) -> Charts:
    """Factors, and what they cost."""
    head = f"{name} · tolerances at least cost, {found.cost:.4g}"
    return Charts([[factors_chart(found), costs_chart(found)]], head, WIDTH, (1.3, 1.0))


def factors_chart(found: Allocation) -> Chart:
    """A bar for the factor of each tolerance; grey: held by more than a bound."""
    rows, factors = found.tolerances, [tolerance.factor for tolerance in found.tolerances.values()]
    texts = [f"{factor:.3g}" for factor in factors]
    roles: list[Role] = ["soft" if row.held and "bound" not in row.held else "series-0" for row in rows.values()]
    marks = [Mark(1.0, "guide", role="plain")]
    if found.equal_factor is not None:
        marks.append(
            Mark(found.equal_factor, "guide", label=f"equal factors, {found.equal_factor:.3g}", role="series-1")
        )
    across = Axis("factor of the scene's tolerance", 0.0, 1.02 * max([*factors, *(mark.value for mark in marks)]))
    panel = Panel(Names([*rows]), [Lengths(factors, texts, "series-0", roles=roles)], marks)
    words = "grey: held by more than a bound"
    return Chart("factors of tolerances", across, [panel], "factors", words, [*zip(rows, texts, strict=True)])


def costs_chart(found: Allocation) -> Chart:
    """Least cost over the fraction out of limits, the confirmed point and that of equal factors."""
    known = [(own.ppm, own.cost) for own in found.trade_off if own.cost is not None]
    ppm, cost = np.array(known, dtype=float).reshape(-1, 2).T
    series: list[Series] = [Line(ppm, cost, "series-0", "least cost", dots=True)]
    if found.equal_cost is not None and found.targets:
        wanted = np.array([found.targets[0].wanted])
        series.append(Points(wanted, np.array([found.equal_cost]), "series-1", "equal factors", "square"))
    for target in found.targets[:1]:
        series.append(Line(np.array(target.interval), np.array([found.cost] * 2), "series-5"))
        series.append(Points(np.array([target.ppm]), np.array([found.cost]), "series-5", "confirmed", "diamond"))
    drawn = [own for own in series if isinstance(own, Line | Points)]
    x = np.concatenate([own.x for own in drawn])
    least = float(x[x > 0.0].min(initial=1e6))
    across = Axis("ppm out of limits", least / 1.3, max(1.3 * float(x.max(initial=0.0)), 2 * least), log=True)
    y = spanned("cost", np.concatenate([own.y for own in drawn]))
    return Chart("cost over the fraction out of limits", across, [Panel(y, series)], "cost")
