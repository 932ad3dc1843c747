"""The foot of a train's picture: the distribution of its lost motion against the sum of its stages' highs."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from tol3d.gearing.presenting.chain_grid import CAPTIONS, LIGHT, SMALL, TEXT, WIDTH, published_colours
from tol3d.gearing.presenting.link_symbol import link_colour
from tol3d.gearing.presenting.shown_stage import Range, ShownStage, distributions_of, leading_sums
from tol3d.gearing.summary_types import TrainSummary
from tol3d.report.canvas import BLACK, OUTSIDE, ROAD_COLOURS, label_angles, plain_axes
from tol3d.report.label import legible
from tol3d.report.number import short_text, tip_mm, value_text
from tol3d.runs.summary.run import RunSummary

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
    """The distribution of the sum by each road, the stages' highs by the leading one, and others' sums."""
    return list(_lines(train, summary))


def _lines(train: TrainSummary, summary: RunSummary) -> Iterator[SumLine]:
    lever, distributions = train.lever_mm, distributions_of(train, summary)
    for road, words in (("geometric", "3D simulation"), ("analytic", "analytic")):
        values = distributions.get(road, Range(None, None, None))
        if values.known:
            text = f"mean {value_text(values.mean, 'arcmin')}, high {_with_tip(values.high, lever)}"
            yield SumLine(f"{words}: mean ± 3 sigma", text, values, ROAD_COLOURS[road])
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
