"""Contributors of a measure as bars, the largest first, with their cumulative share."""

from typing import Final

from tol3d.report.bars import shown_names
from tol3d.report.column import Column, shares_of
from tol3d.report.html.axis import WIDTH, Axis, below, chart
from tol3d.report.html.tags import Markup, tag
from tol3d.report.label import legible
from tol3d.report.number import percent_text
from tol3d.runs.summary.measure import MeasureSummary

BAR, GAP, FOOT = 11.0, 8.0, 44.0
NAMES: Final = 230.0
LONGEST: Final = 38
"""Characters of a name; longer ones are shown in a tooltip."""


def pareto_chart(measure: MeasureSummary) -> Markup | None:
    """Shares of the variance by each method; None where none is known."""
    columns = [own for own in shares_of(measure) if own.method != "published"]
    if not columns:
        return None
    shown, rest = shown_names(measure)
    rows = [(name, [name]) for name in shown] + ([(f"{len(rest)} others", rest)] if rest else [])
    most = max([_share(own, names) for own in columns for _, names in rows], default=0.0)
    x = Axis(0.0, 1.08 * most or 1.0, start=NAMES, end=WIDTH - 40)
    high = len(columns) * BAR + GAP
    bottom = 8 + high * len(rows)
    inside = [*below(x, 4.0, bottom, "share of the variance [%]")]
    for row, (name, names) in enumerate(rows):
        top = 8 + high * row
        label = tag(
            "text",
            tag("title", name),
            legible(name, LONGEST),
            x=NAMES - 8,
            y=top + high / 2,
            text_anchor="end",
            class_="name",
        )
        inside.append(label)
        for k, column in enumerate(columns):
            share = _share(column, names)
            y = top + k * BAR
            words = f"{name}, {column.heading}: {percent_text(share)} %"
            inside.append(
                tag(
                    "rect",
                    tag("title", words),
                    x=NAMES,
                    y=y,
                    width=x(share) - NAMES,
                    height=BAR - 1.5,
                    class_=column.method,
                )
            )
            inside.append(tag("text", percent_text(share), x=x(share) + 4, y=y + BAR - 2.5, class_="tick"))
    return chart("contributors, the largest first", bottom + FOOT, *inside)


def _share(column: Column, names: list[str]) -> float:
    return sum(max(column.percents.get(name) or 0.0, 0.0) for name in names)
