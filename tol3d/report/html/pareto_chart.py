"""Contributors of a measure as bars, the largest first, with their cumulative share."""

from typing import Final

from tol3d.report.bars import shown_names
from tol3d.report.column import Column, shares_of
from tol3d.report.html.axis import Axis, Frame, below, chart
from tol3d.report.html.tags import Markup, tag
from tol3d.report.label import legible
from tol3d.report.number import percent_text
from tol3d.runs.summary.measure import MeasureSummary

BAR, GAP, FOOT = 13.0, 8.0, 44.0
NUMBERS: Final = 40.0
"""Width of the numbers beside the bars."""


def pareto_chart(measure: MeasureSummary, frame: Frame) -> Markup:
    """Shares of the variance by each method; the names that find no room are whole in tooltips."""
    columns = [own for own in shares_of(measure) if own.method != "published"]
    shown, rest = shown_names(measure)
    rows = [(name, [name]) for name in shown] + ([(f"{len(rest)} others", rest)] if rest else [])
    most = max([_share(own, names) for own in columns for _, names in rows], default=0.0)
    x = Axis(0.0, most or 1.0, start=frame.names, end=frame.width - NUMBERS, most=6 if frame.names > 200 else 3)
    high = len(columns) * BAR + GAP
    bottom = 8 + high * len(rows)
    inside = [*below(x, 4.0, bottom, "share of the variance [%]")]
    for row, (name, names) in enumerate(rows):
        top = 8 + high * row
        label = tag(
            "text",
            tag("title", name),
            legible(name, frame.letters),
            x=frame.names - 8,
            y=top + high / 2,
            text_anchor="end",
            class_="name",
        )
        inside.append(label)
        longest = max(_share(column, names) for column in columns)  # no number lies over a neighbour's bar
        for k, column in enumerate(columns):
            share = _share(column, names)
            y = top + k * BAR
            words = f"{name}, {column.heading}: {percent_text(share)} %"
            inside.append(
                tag(
                    "rect",
                    tag("title", words),
                    x=frame.names,
                    y=y,
                    width=x(share) - frame.names,
                    height=BAR - 1.5,
                    class_=column.method,
                )
            )
            inside.append(tag("text", percent_text(share), x=x(longest) + 4, y=y + BAR - 2.5, class_="tick"))
    return chart(frame, "contributors, the largest first", bottom + FOOT, *inside)


def _share(column: Column, names: list[str]) -> float:
    return sum(max(column.percents.get(name) or 0.0, 0.0) for name in names)
