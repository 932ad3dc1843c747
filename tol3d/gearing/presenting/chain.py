"""The picture of a train: its chain from the motor to the tip, what each link brings, and the sum of it all."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyBboxPatch, Patch, Polygon

from tol3d.gearing.presenting.chain_bars import draw_bars, draw_shares, highest_bar
from tol3d.gearing.presenting.chain_grid import (
    ARM,
    BARS,
    CHAIN,
    EDGE,
    HEAD,
    LIGHT,
    LINES,
    NAMES,
    SHARES,
    SKETCH,
    STRONG,
    TEXT,
    WIDTH,
    ChainRow,
    draw_caption,
    plain_part,
    published_colours,
    rows_of,
)
from tol3d.gearing.presenting.chain_sum import draw_sums, height_of_sums, sum_lines
from tol3d.gearing.presenting.link_symbol import draw_link
from tol3d.gearing.presenting.shown_stage import ShownStage, stages_of, trains_of, whole_ratio_text
from tol3d.gearing.summary_types import TrainSummary
from tol3d.report.canvas import BLACK, GREY, OUTSIDE, new_figure, save_figure, say_instead
from tol3d.report.column import seated_text
from tol3d.report.label import legible, wrapped
from tol3d.report.number import NOTHING, given_text, value_text
from tol3d.runs.summary.run import RunSummary

SHAFT_HEIGHT: Final = 0.68  # inch
MIDDLE: Final = LINES + CHAIN / 2  # inch, of the shafts, from the foot of their part of the picture
LINE: Final = 0.19  # inch, from line to line of text
SENSE_ABOVE: Final = 0.14  # inch, of the shaft's box
TIP_REACH: Final = 0.42  # inch, of the arrow at the tip
LINE_CAPTIONS: Final = ("ratio", "working flank", "own lost motion", "low … high (±3σ)")
OF_ITS_LAW: Final = ", its law's"  # after ends that are nearer than 3 sigma
NO_LINKS: Final = "there is no link between the shaft that is held and the one that is read"


def draw_chain(summary: RunSummary, train_name: str, path: Path) -> None:
    """Draw a train of a run: `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(chain_figure(summary, train_name), path)


def chain_figure(summary: RunSummary, train_name: str) -> Figure:
    """The picture of a train, not yet written: up to six links in a row, bars below each, the sum at the foot."""
    train = trains_of(summary)[train_name]
    stages = stages_of(train)
    lines = sum_lines(train, summary)
    rows = rows_of(stages, train.held, ARM if train.lever_mm is not None else 0.0) if stages else []
    heights = [HEAD, *(part for _ in rows for part in (SKETCH, BARS, SHARES)), height_of_sums(lines)]
    figure = new_figure(WIDTH, sum(heights))
    figure.set_layout_engine("none")
    grid = figure.add_gridspec(
        len(heights), 1, height_ratios=heights, left=0.0, right=1.0, bottom=0.0, top=1.0, hspace=0.0
    )
    _draw_head(plain_part(figure, grid[0, 0], HEAD), train_name, train, summary)
    if not rows:
        say_instead(plain_part(figure, grid[1, 0], heights[1]), NO_LINKS, GREY)
        return figure
    highest = highest_bar(stages)
    for index, row in enumerate(rows):
        sketch, bars, shares = (grid[1 + 3 * index + part, 0] for part in range(3))
        _draw_row(plain_part(figure, sketch, SKETCH), train, row)
        draw_bars(figure, bars, train, row, highest)
        draw_shares(figure, shares, row)
    draw_sums(figure, grid[len(heights) - 1, 0], train, stages, lines)
    return figure


def _draw_head(axes: Axes, name: str, train: TrainSummary, summary: RunSummary) -> None:
    axes.text(EDGE, HEAD - 0.3, legible(name, 60), fontsize=16, fontweight="bold", color=BLACK, va="center")
    ends = f"{legible(train.driven, 40)} → {legible(train.output, 40)},  i = {whole_ratio_text(train.ratio)}"
    words = f"{ends}   ·   {legible(train.held, 40)} held   ·   {summary.trials} trials, seed {summary.seed}"
    seated = seated_text(summary.measures[train.measure]) if train.measure in summary.measures else ""
    words += f"   ·   {seated}" if seated else ""
    axes.text(EDGE, HEAD - 0.63, words, fontsize=STRONG, color=GREY, va="center")
    marks: list[Patch | Line2D] = [
        Patch(facecolor=GREY, label="mean"),
        Patch(facecolor=GREY, alpha=LIGHT, label="high (+3 sigma)"),
        *(
            Line2D([], [], color=colour, linewidth=2.5, label=f"{legible(who, 28)}: high")
            for who, colour in published_colours(train).items()
        ),
    ]
    axes.legend(
        handles=marks,
        loc="upper right",
        bbox_to_anchor=(WIDTH - EDGE, HEAD - 0.15),
        bbox_transform=axes.transData,
        ncols=min(len(marks), 4),
        fontsize=TEXT,
        frameon=False,
        borderpad=0,
    )


def _draw_row(axes: Axes, train: TrainSummary, row: ChainRow) -> None:
    for column, stage in enumerate(row.stages):
        x = row.link_at(column)
        name = wrapped(f"{stage.number}  {stage.link}", row.pitch - 0.12, STRONG, 2, "bold")
        axes.text(
            x, SKETCH - NAMES / 2, name, ha="center", va="center", fontsize=STRONG, fontweight="bold", color=BLACK
        )
        draw_link(axes, stage, row.link_ends(column), MIDDLE)
        for line, (text, weight) in enumerate(_link_lines(stage)):
            axes.text(x, _line_at(line), text, ha="center", va="center", fontsize=TEXT, fontweight=weight, color=BLACK)
    for column in range(len(row.shafts)):
        _draw_shaft(axes, row, column)
    for line, caption in enumerate(LINE_CAPTIONS):
        draw_caption(axes, _line_at(line) / SKETCH, caption)
    draw_caption(axes, (MIDDLE + SHAFT_HEIGHT / 2 + SENSE_ABOVE) / SKETCH, "sense of rotation")
    if row.last and train.lever_mm is not None:
        _draw_arm(axes, train, row)


def _line_at(line: int) -> float:
    """Height of a line of text below the shafts."""
    return LINES - (line + 0.5) * LINE


def _link_lines(stage: ShownStage) -> Iterator[tuple[str, str]]:
    """What stands below a link, with its weight: ratio, flank, and its own lost motion at its driven shaft."""
    yield stage.ratio_text, "bold"
    yield stage.working_flank or NOTHING, "normal"
    yield value_text(stage.own.mean, "arcmin"), "normal"
    ends = f"{value_text(stage.own.low, 'arcmin')} … {value_text(stage.own.high, 'arcmin')}"
    yield ends + (OF_ITS_LAW if stage.within_its_law else ""), "normal"


def _draw_shaft(axes: Axes, row: ChainRow, column: int) -> None:
    """A box with round ends; dashed where the same shaft has stood at the end of the row before."""
    x, y = row.shaft_at(column), MIDDLE
    corner = (x - row.shaft / 2, y - SHAFT_HEIGHT / 2)
    ends = f"round,pad=0,rounding_size={0.45 * SHAFT_HEIGHT}"
    box = FancyBboxPatch(corner, row.shaft, SHAFT_HEIGHT, boxstyle=ends)
    seen = row.goes_on and column == 0
    box.set(facecolor="#F3F3F3", edgecolor=GREY, linewidth=1.3, linestyle="--" if seen else "-", zorder=3)
    axes.add_patch(box)
    name = wrapped(row.shafts[column], row.shaft - 0.14, TEXT, 3)
    axes.text(x, y, name, ha="center", va="center", fontsize=TEXT, color=BLACK, zorder=4, linespacing=1.1)
    sense = "↺" if row.senses[column] > 0 else "↻"
    above = y + SHAFT_HEIGHT / 2 + SENSE_ABOVE
    axes.text(x, above, sense, ha="center", va="center", fontsize=15, color=BLACK)


def _draw_arm(axes: Axes, train: TrainSummary, row: ChainRow) -> None:
    """An arm that grows thinner to its tip, at the right of the last shaft."""
    start, y = row.shaft_at(len(row.stages)) + row.shaft / 2, MIDDLE
    end = start + ARM - 0.25
    beam = Polygon([(start - 0.1, y - 0.13), (start - 0.1, y + 0.13), (end, y + 0.05), (end, y - 0.05)])
    beam.set(facecolor="#D9D9D9", edgecolor=GREY, linewidth=1.3, zorder=1)
    axes.add_patch(beam)
    axes.add_patch(Circle((end, y), 0.09, facecolor=OUTSIDE, edgecolor="white", linewidth=1.2, zorder=4))
    arrow = {"arrowstyle": "<->", "color": OUTSIDE, "linewidth": 1.4, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (end, y + TIP_REACH), (end, y - TIP_REACH), arrowprops=arrow)
    name = wrapped(train.point or "tip", ARM, TEXT, 2)
    text = f"{name}\nlever {given_text(train.lever_mm, 'mm')} mm"
    axes.text(start + ARM / 2, LINES, text, ha="center", va="top", fontsize=TEXT, color=BLACK, linespacing=1.25)
