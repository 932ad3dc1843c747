"""The matrix of contributors and measures: which tolerance matters where."""

from collections.abc import Mapping
from typing import Final

from tol3d.report.heading import largest, shown_measures
from tol3d.report.heat_map import LEAST_WRITTEN, of_scalars, percents_of
from tol3d.report.html.axis import Frame, chart
from tol3d.report.html.tags import Markup, tag
from tol3d.report.label import legible
from tol3d.runs.summary.run import RunSummary

Shares = Mapping[str, Mapping[str, float]]
"""Shares of contributors [%], by measure."""

MOST_COLUMNS, MOST_ROWS = 24, 40
CELL: Final = 18.0
LONGEST_HEAD: Final = 26
SIGN: Final = 6.2
"""Width of a sign of a name."""
DARK: Final = 0.75
"""Part of the largest share; digits of cells beyond it have the colour of the paper, others a rim of it."""
FEWEST: Final = 2
"""Measures of a matrix; of one the contributors' bars say all."""


def shares_in(run: RunSummary) -> Shares:
    """Shares of the variance in the worst measures of a run; none of fewer than two."""
    every = of_scalars(run)
    if len(every) < FEWEST:
        return {}
    return {name: percents_of(every[name]) for name in shown_measures(every, MOST_COLUMNS)}


def matrix_chart(shares: Shares, frame: Frame) -> Markup:
    """Shares [%] by measure and contributor, the largest contributors in the first measures."""
    room = frame.width - frame.names - 10
    names = [*shares][: min(MOST_COLUMNS, int(room / CELL))]
    sums: dict[str, float] = {}
    for name in names:
        for contributor, share in shares[name].items():
            sums[contributor] = sums.get(contributor, 0.0) + share
    rows = largest(sorted(sums, key=lambda each: -sums[each]), sums, MOST_ROWS)
    wide = min(CELL * 2, room / len(names))
    most = max([share for own in shares.values() for share in own.values()], default=0.0) or 1.0
    heads = SIGN * max(len(legible(name, LONGEST_HEAD)) for name in names) + 12
    inside = [
        tag(
            "text",
            tag("title", name),
            legible(name, LONGEST_HEAD),
            class_="name",
            transform=f"translate({frame.names + wide * (k + 0.65):.1f} {heads - 6:.0f}) rotate(-90)",
            text_anchor="start",
        )
        for k, name in enumerate(names)
    ]
    for row, contributor in enumerate(rows):
        y = heads + CELL * row
        inside.append(
            tag(
                "text",
                tag("title", contributor),
                legible(contributor, frame.letters),
                x=frame.names - 8,
                y=y + CELL / 2,
                text_anchor="end",
                class_="name",
            )
        )
        for k, name in enumerate(names):
            if contributor not in shares[name]:
                continue
            share = shares[name][contributor]
            words = f"{contributor}, {name}: {share:.1f} %"
            strength = max(0.0, min(1.0, share / most))
            place = {"x": frame.names + wide * k, "y": y}
            inside.append(
                tag(
                    "rect",
                    tag("title", words),
                    **place,
                    width=wide - 1,
                    height=CELL - 1,
                    class_="cell",
                    fill_opacity=0.06 + 0.94 * strength,
                )
            )
            if share >= LEAST_WRITTEN:
                dark = "tick strong" if strength > DARK else "tick"
                inside.append(
                    tag("text", f"{share:.0f}", x=place["x"] + wide / 2, y=y + 13, text_anchor="middle", class_=dark)
                )
    bottom = heads + CELL * len(rows) + 8
    if len(names) < len(shares):
        words = f"the first {len(names)} of {len(shares)} measures; a wider window shows more"
        bottom += 14
        inside.append(tag("text", words, x=4.0, y=bottom - 6, class_="label"))
    return chart(frame, "shares of the variance of contributors in measures", bottom, *inside)
