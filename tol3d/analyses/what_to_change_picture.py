"""The picture of what to change: each measure in its limits as it is, and after each change."""

from pathlib import Path
from typing import Final

from tol3d.analyses.what_to_change import Changes, MeasureChanges, Spread
from tol3d.analyses.what_to_change_table import proposal_text
from tol3d.report.canvas import BLACK, BLUE, GREEN, ORANGE, OUTSIDE, label_angles, new_figure, plain_axes, save_figure
from tol3d.report.label import legible
from tol3d.report.number import UNIT_SIGNS, share_text

WIDTH: Final = 10.0  # inch
BAR, AXES, HEAD = 0.26, 0.9, 0.5  # inch; a change, what axes take besides, the title
LONGEST: Final = 60  # characters of a change
MOST: Final = 6
"""Measures that are drawn."""


def draw_changes(name: str, found: Changes, path: Path) -> None:
    """Draw mean ± 3 sigma of each change: `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    shown = list(found.measures.items())[:MOST]
    rows = [changes_of_one(own) for _, own in shown]
    heights = [BAR * len(own) + AXES for own in rows] or [AXES]
    figure = new_figure(WIDTH, sum(heights) + HEAD)
    figure.suptitle(f"{legible(name, LONGEST)} · what to change", fontsize=11, color=BLACK, x=0.01, ha="left")
    every = figure.subplots(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
    for axes, (measure, own), changes in zip(every, shown, rows, strict=False):
        plain_axes(axes)
        for at, (_, after, colour) in enumerate(changes):
            if after.mean is not None and after.sigma is not None:
                axes.errorbar(
                    after.mean, at, xerr=3 * after.sigma, fmt="o", color=colour, capsize=3, markersize=4, linewidth=1.6
                )
            place = (1.01, at)
            axes.annotate(share_text(after.out_ppm), place, xycoords=("axes fraction", "data"), va="center", fontsize=8)
        for limit in (own.lower_limit, own.upper_limit):
            if limit is not None:
                axes.axvline(limit, color=OUTSIDE, linewidth=1.2, linestyle="--")
        axes.set_yticks(range(len(changes)), [legible(words, LONGEST) for words, _, _ in changes], fontsize=8)
        axes.invert_yaxis()
        axes.set_xlabel(f"{measure} [{UNIT_SIGNS.get(own.unit, own.unit)}], mean ± 3 sigma; out of limits", fontsize=9)
        label_angles(axes.xaxis, own.unit)
    if not shown:
        every[0].set_axis_off()
        every[0].text(0.0, 0.5, "no limit is left more often than is accepted", fontsize=10, color=BLACK)
    save_figure(figure, path)


def changes_of_one(own: MeasureChanges) -> list[tuple[str, Spread, str]]:
    """Every change of a measure in words, what it makes of it, and its colour."""
    found = [("as it is", own.now, BLACK)]
    for each in own.proposals:
        moves = any(step.change is not None for step in each.steps)
        found.append((proposal_text(each), each.after, BLUE if len(each.steps) > 1 else GREEN if moves else ORANGE))
    return found
