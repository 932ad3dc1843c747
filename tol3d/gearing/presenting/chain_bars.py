"""Bars below the chain of a train: what each link brings at the shaft that is read, and its share of the variance."""

from collections.abc import Sequence
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from tol3d.gearing.presenting.chain_grid import (
    BARS,
    CAPTIONS,
    EDGE,
    LIGHT,
    SHARES,
    SMALL,
    TEXT,
    ChainRow,
    draw_caption,
    plain_part,
    published_colours,
)
from tol3d.gearing.presenting.link_symbol import link_colour
from tol3d.gearing.presenting.shown_stage import ShownStage, share_text
from tol3d.gearing.summary_types import TrainSummary
from tol3d.report.canvas import BLACK
from tol3d.report.label import wrapped
from tol3d.report.number import NOTHING, tip_mm

BAR_LABEL: Final = 0.46  # inch, of two lines of text
LABEL_LIFT: Final = 3.6  # points, from a bar to its label
LONG_MM: Final = 10.0  # mm; from there on two decimals, or two labels do not stand side by side
MOST_APART: Final = 0.85  # inch, from a mean's bar to its high's
TRACK_LENGTH, TRACK_THICKNESS = 1.0, 0.1  # inch, of a share's gauge
TRACK_BELOW, TEXT_BELOW = 0.15, 0.34  # inch, from the foot of the bars to a gauge and to its text


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
    axes = plain_part(figure, place, max(highest, 1e-9) * BARS / (BARS - BAR_LABEL))
    apart = min(0.42 * row.pitch, MOST_APART)
    for column, stage in enumerate(row.stages):
        x, half = row.link_at(column), 0.45 * row.pitch
        axes.hlines(0.0, x - half, x + half, color="#999999", linewidth=0.8, clip_on=False)
        marked = _draw_published(axes, train, stage, x + apart / 2, 0.75 * apart)
        for value, at, opacity, least in (
            (stage.at_shaft.mean, x - apart / 2, 1.0, 0.0),
            (stage.at_shaft.high, x + apart / 2, LIGHT, marked),
        ):
            top = max(value or 0.0, 0.0)
            axes.bar(at, top, 0.62 * apart, color=link_colour(stage.kind), alpha=opacity, linewidth=0)
            axes.annotate(
                _bar_text(value, train.lever_mm),
                (at, max(top, least)),
                (0, LABEL_LIFT),
                textcoords="offset points",
                ha="center",
                va="bottom",
                fontsize=SMALL,
                color=BLACK,
                linespacing=1.1,
            )
    draw_caption(axes, (BARS - BAR_LABEL) / 2 / BARS, wrapped(f"at {train.shaft}", CAPTIONS - EDGE, SMALL, 3))


def _draw_published(axes: Axes, train: TrainSummary, stage: ShownStage, x: float, width: float) -> float:
    """Marks of others' highs side by side over the bar of ours; returns the highest [arcmin]."""
    colours, highs = published_colours(train), _published_highs(stage)
    for k, (name, high) in enumerate(highs.items()):
        begin, end = (x + width * (part / len(highs) - 0.5) for part in (k, k + 1))
        axes.hlines(high, begin, end, color=colours[name], linewidth=2.5, zorder=3)
    return max(highs.values(), default=0.0)


def draw_shares(figure: Figure, place: SubplotSpec, row: ChainRow) -> None:
    """Shares of the variance of the links of a row, each as the filled part of a gauge."""
    axes = plain_part(figure, place, SHARES)
    for column, stage in enumerate(row.stages):
        x, y = row.link_at(column), SHARES - TRACK_BELOW
        for share, colour in ((100.0, "#E6E6E6"), (stage.share or 0.0, link_colour(stage.kind))):
            length = TRACK_LENGTH * min(max(share, 0.0), 100.0) / 100
            axes.barh(y, length, TRACK_THICKNESS, left=x - TRACK_LENGTH / 2, color=colour, linewidth=0)
        text = share_text(stage.share)
        axes.text(x, SHARES - TEXT_BELOW, text, ha="center", va="center", fontsize=TEXT, color=BLACK)
    draw_caption(axes, 1 - TEXT_BELOW / SHARES, "share of variance")


def _bar_text(arcmin: float | None, lever_mm: float | None) -> str:
    moved = tip_mm(arcmin, lever_mm)
    if arcmin is None:
        return NOTHING
    if moved is None:
        return f"{60 * arcmin:.1f}″"
    return f"{60 * arcmin:.1f}″\n{moved:.{3 if abs(moved) < LONG_MM else 2}f} mm"
