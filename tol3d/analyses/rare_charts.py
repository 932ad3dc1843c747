"""Charts of rare events: probability beyond each limit by each method, and contributors to the design points."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from tol3d.analyses.rare_section import LimitLeft, RareEvents
from tol3d.report.chart import Axis, Chart, Charts, Lengths, Names, Panel, Points, Range, Role, Series, Sign
from tol3d.report.number import ppm_text

WIDTH: Final = 12.0  # inch

MOST_BARS: Final = 8

MOST_LIMITS: Final = 30

MOST_POINTS: Final = 6

LEAST_PPM: Final = 1e-12

SAMPLED: Final = "by sampling, with its interval of 95 %"

MARKS: Final[Sequence[tuple[str, str, Sign, Role]]] = (
    ("first_order_ppm", "first order", "diamond", "series-1"),
    ("second_order_ppm", "second order", "square", "series-3"),
)


def rare_charts(found: RareEvents) -> Charts:
    """The limits that are left most, and the design points of the first of them."""
    ranked = sorted(found.limits, key=lambda own: -(own.ppm or 0.0))[:MOST_LIMITS]
    points = [design_point_chart(own) for own in ranked if own.design_point is not None][:MOST_POINTS]
    rows = [[limits_chart(ranked)], *([*points[k : k + 2]] for k in range(0, len(points), 2))]
    return Charts(rows, f"{found.scene} · fraction out of limits", WIDTH)


def limits_chart(limits: Sequence[LimitLeft]) -> Chart:
    """A row for each limit with its fraction by each method."""
    series: list[Series] = []
    for row, own in enumerate(limits):
        if own.method in ("importance", "subset") and (own.ppm or (own.ppm_interval and own.ppm_interval[1] > 0.0)):
            low, high = (max(end, LEAST_PPM) for end in own.ppm_interval) if own.ppm_interval else (None, None)
            series.append(Range(row, low, high, own.ppm or None, "series-0", label=SAMPLED))
    for key, label, sign, role in MARKS:
        known = [(value, row) for row, own in enumerate(limits) if (value := own.value(key))]
        if known:
            x, y = np.array(known, dtype=float).T
            series.append(Points(x, y, role, label, sign))
    values = [each for own in series if isinstance(own, Range) for each in (own.low, own.middle, own.high) if each]
    values += [each for own in series if isinstance(own, Points) for each in own.x.tolist()]
    low, high = (
        (10.0 ** np.floor(np.log10(min(values))), 10.0 ** np.ceil(np.log10(max(values)))) if values else (1e-3, 1e6)
    )
    across = Axis("builds beyond the limit", low, max(high, 10 * low), "ppm", log=True)
    names = Names([f"{limit.measure} {limit.words}" for limit in limits])
    table = [(name, f"{ppm_text(own.ppm)} ppm") for name, own in zip(names.names, limits, strict=True)]
    instead = "" if series else "nothing is known of these limits"
    return Chart("fractions beyond limits", across, [Panel(names, series)], "", "", table, instead)


def design_point_chart(limit_left: LimitLeft) -> Chart:
    """Contributors to the most likely build beyond a limit, the largest first."""
    assert limit_left.design_point is not None
    every = limit_left.design_point.contributors
    shown, rest = every[:MOST_BARS], every[MOST_BARS:]
    percents = [each.percent for each in shown] + ([sum(each.percent for each in rest)] if rest else [])
    names = [each.name for each in shown] + ([f"{len(rest)} other{'s' if len(rest) > 1 else ''}"] if rest else [])
    texts = [f"{percent:.1f}" for percent in percents]
    across = Axis("share of the distance to the design point", 0.0, max(percents, default=1.0) or 1.0, "%")
    title = f"{limit_left.measure} {limit_left.words}, β {limit_left.design_point.beta:.2f}"
    panel = Panel(Names(names), [Lengths(percents, texts, "series-0")])
    return Chart(f"design point of {title}", across, [panel], title, "", [*zip(names, texts, strict=True)])
