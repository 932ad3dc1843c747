"""Bars below the chain of a train: what each link brings at the shaft that is read, and its share of the variance."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from tol3d.gearing.presenting.chain_grid import (
    BARS,
    CAPTIONS,
    EDGE,
    LIGHT,
    SMALL,
    TEXT,
    Array,
    ChainRow,
    plain_part,
    published_colours,
)
from tol3d.gearing.presenting.shown_stage import ShownStage, share_text
from tol3d.gearing.summary_types import TrainSummary
from tol3d.report.canvas import BLACK
from tol3d.report.label import wrapped
from tol3d.report.number import NOTHING, tip_mm

BAR_LABEL: Final = 0.46  # inch, of two lines of text
LEAST_HEIGHT: Final = 1e-9  # arcmin; of a bar that has a label above it
LABEL_LIFT: Final = 3.6  # points, from a bar to its label
LONG_MM: Final = 10.0  # mm; from there on two decimals, or two labels do not stand side by side
MOST_APART: Final = 0.85  # inch, from a mean's bar to its high's
GAUGE_LENGTH: Final = 1.0  # inch
GAUGE_SHARE: Final = 0.8  # of the height of its part


def highest_bar(stages: Sequence[ShownStage]) -> float:
    """The largest of all bars and marks [arcmin]."""
    ends = [(stage.at_shaft.mean, stage.at_shaft.high, *_published_highs(stage).values()) for stage in stages]
    return max((end for own in ends for end in own if end is not None), default=0.0)


def _published_highs(stage: ShownStage) -> dict[str, float]:
    """Others' highs at the shaft that is read [arcmin]."""
    highs = {name: ends.times(stage.factor).high for name, ends in stage.published.items()}
    return {name: high for name, high in highs.items() if high is not None}


def draw_bars(figure: Figure, place: SubplotSpec, train: TrainSummary, row: ChainRow, highest: float) -> None:
    """Mean and high of each link of a row, and others' highs as marks.

    Args:
        figure, place: where.
        train: its summary.
        row: whose links.
        highest: of the bars in all rows [arcmin], which leaves room for its label.
    """
    highest = max(highest, LEAST_HEIGHT)
    caption = wrapped(f"at {train.shaft}", CAPTIONS - EDGE, SMALL, 3)
    axes = plain_part(figure, place, (0, highest * BARS / (BARS - BAR_LABEL)), {highest / 2: caption})
    axes.bar(row.links, 0.0, 0.9 * row.pitch, edgecolor="#999999", linewidth=0.8, clip_on=False)
    apart = min(0.42 * row.pitch, MOST_APART)
    marked = _draw_published(axes, train, row, row.links + apart / 2, 0.75 * apart)
    for values, at, opacity, least in (
        ([stage.at_shaft.mean for stage in row.stages], row.links - apart / 2, 1.0, 0.0),
        ([stage.at_shaft.high for stage in row.stages], row.links + apart / 2, LIGHT, marked),
    ):
        heights = np.array([max(value or 0.0, LEAST_HEIGHT) for value in values])
        axes.bar(at, heights, 0.62 * apart, color=row.colours, alpha=opacity, linewidth=0)
        texts = [_bar_text(value, train.lever_mm) for value in values]
        labelled = axes.bar(at, np.maximum(heights, least), alpha=0.0)  # to what is higher: the bar or a mark
        axes.bar_label(labelled, texts, padding=LABEL_LIFT, fontsize=SMALL, color=BLACK, linespacing=1.1)


def _draw_published(axes: Axes, train: TrainSummary, row: ChainRow, at: Array, width: float) -> Array:
    """Marks of others' highs side by side over the bars of ours; returns the highest of each link [arcmin]."""
    colours = published_colours(train)
    highs = [_published_highs(stage) for stage in row.stages]
    for own, x in zip(highs, at, strict=True):
        ends = x + width * np.linspace(-0.5, 0.5, len(own) + 1)
        axes.hlines([*own.values()], ends[:-1], ends[1:], [colours[name] for name in own], linewidth=2.5, zorder=3)
    return np.array([max(own.values(), default=0.0) for own in highs])


def draw_shares(figure: Figure, place: SubplotSpec, row: ChainRow) -> None:
    """Shares of the variance of the links of a row, each as the filled part of a gauge."""
    axes = plain_part(figure, place, (-1, 1), {0.0: "share of variance"})
    shares = np.clip([stage.share or 0.0 for stage in row.stages], 0.0, 100.0)
    for filled, colour in ((100.0, "#E6E6E6"), (shares, row.colours)):
        left = row.links - GAUGE_LENGTH / 2
        axes.barh(0.0 * left, GAUGE_LENGTH * filled / 100, GAUGE_SHARE, left=left, color=colour, linewidth=0)
    axes.set_xticks(row.links, [share_text(stage.share) for stage in row.stages], fontsize=TEXT, color=BLACK)


def _bar_text(arcmin: float | None, lever_mm: float | None) -> str:
    moved = tip_mm(arcmin, lever_mm)
    if arcmin is None:
        return NOTHING
    if moved is None:
        return f"{60 * arcmin:.1f}″"
    return f"{60 * arcmin:.1f}″\n{moved:.{3 if abs(moved) < LONG_MM else 2}f} mm"
