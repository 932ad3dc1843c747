"""Bars below the chain of a train: each link's contribution at the shaft read, and its share of the variance."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
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
    WIDTH,
    ChainRow,
    plain_part,
    published_colours,
)
from tol3d.gearing.presenting.link_symbol import link_colour
from tol3d.gearing.presenting.shown_stage import Range, ShownStage, distributions_of, leading_sums, share_text
from tol3d.gearing.summary.types import TrainSummary
from tol3d.numerics.arrays import Array
from tol3d.report.canvas import BLACK, METHOD_COLOURS, OUTSIDE, label_angles, plain_axes, wrapped
from tol3d.report.heading import legible
from tol3d.report.number import NOTHING, short_text, tip_mm, value_text
from tol3d.study.runs.summary.run import RunSummary

BAR_LABEL: Final = 0.46  # inch, of two lines of text
LEAST_HEIGHT: Final = 1e-9  # arcmin; of a bar that has a label above it
LABEL_LIFT: Final = 3.6  # points, from a bar to its label
LONG_MM: Final = 10.0  # mm; from there on two decimals, else two labels do not fit side by side
MOST_APART: Final = 0.85  # inch, from a mean's bar to its high's
GAUGE_LENGTH: Final = 1.0  # inch
GAUGE_SHARE: Final = 0.8  # of the height of its part


def highest_bar(stages: Sequence[ShownStage]) -> float:
    """The largest of all bars and marks [arcmin]."""
    ends = [(stage.at_shaft.mean, stage.at_shaft.high, *_published_highs(stage).values()) for stage in stages]
    return max((end for own in ends for end in own if end is not None), default=0.0)


def _published_highs(stage: ShownStage) -> dict[str, float]:
    """Published highs at the shaft that is read [arcmin]."""
    highs = {name: ends.times(stage.factor).high for name, ends in stage.published.items()}
    return {name: high for name, high in highs.items() if high is not None}


def draw_bars(figure: Figure, place: SubplotSpec, train: TrainSummary, row: ChainRow, highest: float) -> None:
    """Mean and high of each link of a row, and published highs as marks.

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
        labelled = axes.bar(at, np.maximum(heights, least), alpha=0.0)  # to the higher of bar and mark
        axes.bar_label(labelled, texts, padding=LABEL_LIFT, fontsize=SMALL, color=BLACK, linespacing=1.1)


def _draw_published(axes: Axes, train: TrainSummary, row: ChainRow, at: Array, width: float) -> Array:
    """Marks of published highs side by side over our bars; returns the highest of each link [arcmin]."""
    colours = published_colours(train)
    highs = [_published_highs(stage) for stage in row.stages]
    for own, x in zip(highs, at, strict=True):
        ends = x + width * np.linspace(-0.5, 0.5, len(own) + 1)
        axes.hlines([*own.values()], ends[:-1], ends[1:], [colours[name] for name in own], linewidth=2.5, zorder=3)
    return np.array([max(high.values(), default=0.0) for high in highs])


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


LINE: Final = 0.34  # inch; heights and widths of the foot's parts
ABOVE: Final = 0.15
FOOT: Final = 0.75
LABELS: Final = 3.1
VALUES: Final = 3.7
LEAST_SEGMENT: Final = 0.2  # a narrower part of the stack shows no number


@dataclass(frozen=True)
class SumLine:
    """A line of the foot [arcmin].

    Args:
        label, text: what stands left and right of it.
        values: ends and mean.
        colour: of its bar.
        stacked: the stages' highs end to end, instead of one bar from low to high.
    """

    label: str
    text: str
    values: Range
    colour: str
    stacked: bool = False


def sum_lines(train: TrainSummary, summary: RunSummary) -> list[SumLine]:
    """The distribution of the sum by each method, the stages' highs by the leading one, and published sums."""
    return list(_lines(train, summary))


def _lines(train: TrainSummary, summary: RunSummary) -> Iterator[SumLine]:
    lever, distributions = train.lever_mm, distributions_of(train, summary)
    for method, words in (("geometric", "3D simulation"), ("analytic", "analytic")):
        values = distributions.get(method, Range(None, None, None))
        if values.known:
            text = f"mean {value_text(values.mean, 'arcmin')}, high {_with_tip(values.high, lever)}"
            yield SumLine(f"{words}: mean ± 3 sigma", text, values, METHOD_COLOURS[method])
    highs = leading_sums(train)
    yield SumLine("sum of the stages' highs", f"{_with_tip(highs.high, lever)}, all at +3 sigma", highs, OUTSIDE, True)
    colours = published_colours(train)
    for name, ends in train.sums.published.items():
        values = Range.of(ends)
        label = f"{legible(name, 18)}: sum of lows … highs"
        yield SumLine(label, f"high {_with_tip(values.high, lever)}", values, colours[name])


def _with_tip(arcmin: float | None, lever_mm: float | None) -> str:
    moved = tip_mm(arcmin, lever_mm)
    return value_text(arcmin, "arcmin") + ("" if moved is None else f" = {short_text(moved, 'mm')}")


def height_of_sums(lines: Sequence[SumLine]) -> float:
    """Height of the foot [inch]."""
    return ABOVE + LINE * len(lines) + FOOT


def draw_sums(
    figure: Figure, place: SubplotSpec, train: TrainSummary, stages: Sequence[ShownStage], lines: Sequence[SumLine]
) -> None:
    """All lines on one axis, and the sum of the stages' highs as a mark across them."""
    width = WIDTH - LABELS - VALUES
    heights, widths = [ABOVE, LINE * len(lines), FOOT], [LABELS - CAPTIONS, width, VALUES]
    parts = place.subgridspec(3, 3, height_ratios=heights, width_ratios=widths, wspace=0.0, hspace=0.0)
    axes = plain_axes(figure.add_subplot(parts[1, 1]))
    axes.grid(axis="y", visible=False)
    most = max((end for line in lines for end in (line.values.mean, line.values.high) if end is not None), default=0.0)
    axes.set_xlim(0, 1.02 * most if most > 0 else 1.0)
    axes.set_ylim(len(lines) - 0.5, -0.5)
    for y, line in enumerate(lines):
        if line.stacked:
            _stack_highs(axes, stages, y, axes.get_xlim()[1] / width)
            _mark_highs(axes, line)
        else:
            _draw_range(axes, line, y)
        colour, weight = (OUTSIDE, "bold") if line.stacked else (BLACK, "normal")
        words = axes.text(1.015, y, line.text, va="center", fontsize=TEXT, color=colour, fontweight=weight)
        words.set_transform(axes.get_yaxis_transform())
    axes.set_yticks(range(len(lines)), [line.label for line in lines], fontsize=TEXT)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    label_angles(axes.xaxis, train.unit)
    axes.set_xlabel(f"lost motion of {legible(train.shaft, 50)} [′, ″ of arc]", fontsize=10)


def _stack_highs(axes: Axes, stages: Sequence[ShownStage], y: float, per_inch: float) -> None:
    start = 0.0
    for stage in stages:
        high = max(stage.at_shaft.high or 0.0, 0.0)
        axes.barh(y, high, left=start, height=0.62, color=link_colour(stage.kind), alpha=LIGHT, edgecolor="white")
        if high / per_inch >= LEAST_SEGMENT:
            axes.text(start + high / 2, y, str(stage.number), ha="center", va="center", fontsize=SMALL, color=BLACK)
        start += high


def _mark_highs(axes: Axes, line: SumLine) -> None:
    if line.values.high is not None:
        axes.axvline(line.values.high, color=line.colour, linewidth=1.5, linestyle="--", zorder=1)


def _draw_range(axes: Axes, line: SumLine, y: float) -> None:
    low, mean, high = line.values.low, line.values.mean, line.values.high
    if low is not None and high is not None:
        axes.plot([low, high], [y, y], color=line.colour, linewidth=8, solid_capstyle="butt", alpha=0.75, zorder=2)
    if mean is not None:
        axes.plot(mean, y, marker="o", markersize=8, color=line.colour, markeredgecolor="white", zorder=3)
