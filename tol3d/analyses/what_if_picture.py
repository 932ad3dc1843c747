"""The picture of what other tolerances do: each measure before and after, with its limits."""

from pathlib import Path
from typing import Final

import numpy as np

from tol3d.analyses.before_after import WhatIf
from tol3d.analyses.what_if_table import bounded_text
from tol3d.report.canvas import BLACK, BLUE, ORANGE, OUTSIDE, label_angles, new_figure, plain_axes, save_figure
from tol3d.report.label import legible
from tol3d.report.number import UNIT_SIGNS, limit_text

WIDTH: Final = 9.0  # inch
ROW: Final = 3.0
HEAD: Final = 0.6
LONGEST: Final = 120
"""Characters of the head."""
MOST: Final = 8
"""Measures that are drawn."""


def draw_what_if(name: str, found: WhatIf, path: Path) -> None:
    """Draw the distributions before and after: `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    shown = list(found.measures.items())[:MOST]
    figure = new_figure(WIDTH, ROW * len(shown) + HEAD)
    words = "; ".join(f"{own.contributor}: {own.before} → {own.after}" for own in found.changes)
    figure.suptitle(
        legible(f"{name} · what if {words}", LONGEST), fontsize=10, color=BLACK, x=0.01, ha="left", wrap=True
    )
    rows = figure.subplots(len(shown), 1, squeeze=False)[:, 0]
    for axes, (measure, own) in zip(rows, shown, strict=True):
        plain_axes(axes)
        edges = np.array(own.edges, dtype=np.float64)
        for word, state, colour in (("before", own.before, BLUE), ("after", own.after, ORANGE)):
            ppm = ", ".join(f"{bounded_text(limit)} {side}" for side, limit in state.limits.items())
            percent = 100.0 * np.array(state.counts) / max(found.trials, 1)
            axes.stairs(percent, edges, color=colour, linewidth=1.8, label=f"{word}{': ' if ppm else ''}{ppm}")
        for limit in (own.lower_limit, own.upper_limit):
            if limit is not None:
                axes.axvline(limit, color=OUTSIDE, linestyle="--", linewidth=1.2, label=limit_text(limit, own.unit))
        axes.set_title(legible(measure), loc="left", fontsize=10, fontweight="bold")
        if own.unit != "arcmin":  # whose numbers have their signs
            axes.set_xlabel(UNIT_SIGNS.get(own.unit, own.unit), fontsize=9)
        axes.set_ylabel("% of trials", fontsize=9)
        label_angles(axes.xaxis, own.unit)
        axes.legend(fontsize=8, frameon=False)
    save_figure(figure, path)
