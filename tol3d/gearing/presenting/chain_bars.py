"""Bars below the chain of a train: what each link brings at the shaft that is read, and its share of the variance."""

from collections.abc import Sequence
from typing import Any, Final

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from tol3d.gearing.presenting.chain_grid import (
    BARS,
    CAPTIONS,
    EDGE,
    LIGHT,
    SMALL,
    TEXT,
    ChainRow,
    draw_caption,
    published_colours,
)
from tol3d.gearing.presenting.link_symbol import LINK_COLOURS
from tol3d.gearing.presenting.stage import Stage, share_text
from tol3d.report.canvas import BLACK
from tol3d.report.label import wrapped
from tol3d.report.number import NOTHING, tip_mm

Summary = Any  # typed, read by text

BAR_LABEL: Final = 0.46  # inch, of two lines of text
LONG_MM: Final = 10.0  # mm; from there on two decimals, or two labels do not stand side by side
MOST_APART: Final = 0.85  # inch, from a mean's bar to its high's
TRACK_LENGTH, TRACK_THICKNESS = 1.0, 0.1  # inch, of a share's gauge


def bar_scale(stages: Sequence[Stage]) -> float:
    """Height of a bar of one arc minute [inch]: the highest leaves room for its label."""
    largest = max((_reach(stage) for stage in stages), default=0.0)
    return (BARS - BAR_LABEL) / largest if largest > 0 else 0.0


def _reach(stage: Stage) -> float:
    """The largest of a stage's bars and marks [arcmin]."""
    ends = [stage.at_shaft.mean, stage.at_shaft.high, *_published_highs(stage).values()]
    return max(0.0, *(end for end in ends if end is not None))


def _published_highs(stage: Stage) -> dict[str, float]:
    """Others' highs at the shaft that is read [arcmin]."""
    highs = {name: told.times(stage.factor).high for name, told in stage.published.items()}
    return {name: high for name, high in highs.items() if high is not None}


def draw_bars(axes: Axes, train: Summary, row: ChainRow, scale: float) -> None:
    """Mean and high of each link of a row, others' highs as marks, and the share of the variance below."""
    apart = min(0.42 * row.pitch, MOST_APART)
    for column, stage in enumerate(row.stages):
        x, half = row.link_at(column), 0.45 * row.pitch
        axes.plot([x - half, x + half], [row.floor, row.floor], color="#999999", linewidth=0.8)
        marked = _draw_published(axes, train, stage, (x + apart / 2, row.floor), 0.75 * apart, scale)
        for value, side, opacity, reach in (
            (stage.at_shaft.mean, -0.5, 1.0, 0.0),
            (stage.at_shaft.high, 0.5, LIGHT, marked),
        ):
            foot = (x + side * apart, row.floor)
            top = max(value or 0.0, 0.0) * scale
            bar = Rectangle((foot[0] - 0.31 * apart, foot[1]), 0.62 * apart, top)
            bar.set(facecolor=LINK_COLOURS[stage.kind], alpha=opacity, linewidth=0)
            axes.add_patch(bar)
            at, text = foot[1] + max(top, reach) + 0.05, _bar_text(value, train["lever_mm"])
            axes.text(foot[0], at, text, ha="center", va="bottom", fontsize=SMALL, color=BLACK, linespacing=1.1)
        _draw_share(axes, stage, x, row.floor)
    shaft = wrapped(f"at {train['shaft']}", CAPTIONS - EDGE, SMALL, 3)
    draw_caption(axes, row.floor + (BARS - BAR_LABEL) / 2, shaft)
    draw_caption(axes, row.floor - 0.34, "share of variance")


def _draw_published(
    axes: Axes, train: Summary, stage: Stage, foot: tuple[float, float], width: float, scale: float
) -> float:
    """Marks of others' highs side by side over the bar of ours; returns the height of the highest [inch]."""
    colours, highs = published_colours(train), _published_highs(stage)
    for k, (name, high) in enumerate(highs.items()):
        ends = [foot[0] + width * (part / len(highs) - 0.5) for part in (k, k + 1)]
        axes.plot(
            ends, [foot[1] + high * scale] * 2, color=colours[name], linewidth=2.5, solid_capstyle="butt", zorder=3
        )
    return max(highs.values(), default=0.0) * scale


def _bar_text(arcmin: float | None, lever_mm: float | None) -> str:
    moved = tip_mm(arcmin, lever_mm)
    if arcmin is None:
        return NOTHING
    if moved is None:
        return f"{60 * arcmin:.1f}″"
    return f"{60 * arcmin:.1f}″\n{moved:.{3 if abs(moved) < LONG_MM else 2}f} mm"


def _draw_share(axes: Axes, stage: Stage, x: float, floor: float) -> None:
    """A share of the variance as the filled part of a track."""
    for share, colour in ((100.0, "#E6E6E6"), (stage.share or 0.0, LINK_COLOURS[stage.kind])):
        length = TRACK_LENGTH * min(max(share, 0.0), 100.0) / 100
        track = Rectangle((x - TRACK_LENGTH / 2, floor - 0.2), length, TRACK_THICKNESS)
        track.set(facecolor=colour, linewidth=0)
        axes.add_patch(track)
    axes.text(x, floor - 0.34, share_text(stage.share), ha="center", va="center", fontsize=TEXT, color=BLACK)
