"""The picture of rare events: probability beyond each limit by each method, and contributors to the design points."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tol3d.analyses.rare_section import LimitLeft, RareEvents
from tol3d.report.canvas import (
    BLUE,
    GREY,
    ORANGE,
    PURPLE,
    legend_below,
    new_figure,
    plain_axes,
    save_figure,
    say_instead,
)
from tol3d.report.label import legible, wrapped

WIDTH: Final = 11.0  # inch
ROW, BAR, HEAD = 0.45, 0.28, 1.7  # inch; of a limit, of a contributor, of what stands above and below
MOST_BARS: Final = 8
MOST_LIMITS: Final = 30
MOST_POINTS: Final = 6
NAME_WIDTH, NAME_SIZE = 2.4, 8.5  # inch, points
LEAST_PPM: Final = 1e-12
MARKS: Final = (("first_order_ppm", "first order", "D", ORANGE), ("second_order_ppm", "second order", "s", PURPLE))


def draw_rare(found: RareEvents, path: Path) -> None:
    """Draw it: `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(rare_figure(found), path)


def rare_figure(found: RareEvents) -> Figure:
    """The picture, not yet written: the limits that are left most, and the design points of the first of them."""
    ranked = sorted(found.limits, key=lambda own: -(own.ppm or 0.0))[:MOST_LIMITS]
    points = [own for own in ranked if own.design_point is not None][:MOST_POINTS]
    rows = -(-len(points) // 2)
    heights = [ROW * len(ranked) + HEAD, *[BAR * MOST_BARS + HEAD] * rows]
    figure = new_figure(WIDTH, sum(heights))
    figure.suptitle(f"{legible(found.scene, 90)} · fraction out of limits", fontsize=12, x=0.01, ha="left")
    grid = figure.add_gridspec(1 + rows, 2, height_ratios=heights)
    _draw_limits(plain_axes(figure.add_subplot(grid[0, :])), ranked)
    for k, own in enumerate(points):
        last_alone = k == len(points) - 1 and k % 2 == 0
        _draw_point(plain_axes(figure.add_subplot(grid[1 + k // 2, slice(None) if last_alone else k % 2])), own)
    return figure


def _draw_limits(axes: Axes, limits: Sequence[LimitLeft]) -> None:
    axes.grid(axis="y", visible=False)
    axes.set_xscale("log")
    shown = False
    for row, own in enumerate(limits):
        sampled = own.method in ("importance", "subset")
        if sampled and own.ppm_interval is not None and own.ppm_interval[1] > 0.0:
            low, high = (max(end, LEAST_PPM) for end in own.ppm_interval)
            axes.plot([low, high], [row, row], color=BLUE, linewidth=3, alpha=0.5, solid_capstyle="butt")
            shown = True
        if sampled and own.ppm:
            label = "by sampling, with its interval of 95 %"
            axes.plot(own.ppm, row, "o", color=BLUE, markersize=6, label=None if _has(axes, label) else label)
            shown = True
        for key, label, mark, colour in MARKS:
            value = own.value(key)
            if value:
                name = None if _has(axes, label) else label
                axes.plot(value, row, mark, color=colour, markersize=6, markerfacecolor="none", label=name)
                shown = True
    names = [wrapped(f"{own.measure} {own.words}", NAME_WIDTH, NAME_SIZE, 2) for own in limits]
    axes.set_yticks(range(len(limits)), names, fontsize=NAME_SIZE)
    axes.set_ylim(len(limits) - 0.5, -0.5)
    axes.set_xlabel("builds beyond the limit [ppm]", fontsize=10)
    low, high = axes.get_xlim() if shown else (1e-3, 1e6)
    axes.set_xlim(10.0 ** np.floor(np.log10(low)), 10.0 ** np.ceil(np.log10(high)))
    if not shown:
        say_instead(axes, "nothing is known of these limits", GREY)
    legend_below(axes)


def _has(axes: Axes, label: str) -> bool:
    return label in axes.get_legend_handles_labels()[1]


def _draw_point(axes: Axes, own: LimitLeft) -> None:
    assert own.design_point is not None
    axes.grid(axis="y", visible=False)
    ways = own.design_point.contributors
    shown, rest = ways[:MOST_BARS], ways[MOST_BARS:]
    percents = np.array([each.percent for each in shown] + ([sum(each.percent for each in rest)] if rest else []))
    names = [wrapped(each.name, NAME_WIDTH, NAME_SIZE, 1) for each in shown]
    names += [f"{len(rest)} other{'s' if len(rest) > 1 else ''}"] if rest else []
    drawn = axes.barh(np.arange(len(percents)), percents, color=BLUE, alpha=0.8, height=0.7)
    axes.bar_label(drawn, labels=[f"{own:.1f}" for own in percents], fontsize=7, padding=2)
    axes.set_yticks(range(len(names)), names, fontsize=NAME_SIZE)
    axes.set_ylim(max(len(names), 4) - 0.5, -0.5)
    axes.margins(x=0.12)
    axes.set_xlabel("share of the distance to the design point [%]", fontsize=9)
    title = wrapped(f"{own.measure} {own.words}, β {own.design_point.beta:.2f}", 4.5, 10.0, 2, "bold")
    axes.set_title(title, loc="left", fontsize=10, fontweight="bold")
