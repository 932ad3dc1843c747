"""The picture of a train: its chain from the motor to the tip, the contribution of each link, and their sum."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyBboxPatch, Patch, Polygon

from tol3d.gearing.presenting.chain_bars import (
    draw_bars,
    draw_shares,
    draw_sums,
    height_of_sums,
    highest_bar,
    sum_lines,
)
from tol3d.gearing.presenting.chain_grid import (
    ARM,
    CAPTIONS,
    CHAIN,
    EDGE,
    HEAD,
    LIGHT,
    ROW,
    STRONG,
    TEXT,
    WIDTH,
    ChainRow,
    plain_part,
    published_colours,
    rows_of,
)
from tol3d.gearing.presenting.link_symbol import draw_link, draw_text
from tol3d.gearing.presenting.shown_stage import ShownStage, stages_of, trains_of, whole_ratio_text
from tol3d.gearing.summary.types import TrainSummary
from tol3d.report.canvas import BLACK, GREY, OUTSIDE, new_figure, save_figure, say_instead, wrapped
from tol3d.report.column import seated_text
from tol3d.report.heading import legible
from tol3d.report.number import NOTHING, given_text, value_text
from tol3d.study.runs.summary.run import RunSummary

SHAFT_HEIGHT: Final = 0.68  # inch
SENSE_HEIGHT: Final = SHAFT_HEIGHT / 2 + 0.14  # inch, from the middle of the shafts
TIP_REACH: Final = 0.42  # inch, of the arrow at the tip
LINE_CAPTIONS: Final = ("ratio", "working flank", "own lost motion", "low … high (±3σ)")
TITLE, SENSE = 16.0, 15.0  # points
PUBLISHED_LETTERS, MOST_LETTERS = 60, 28  # of all published names together, which leaves room for the title; of one
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
    heights = [HEAD, *ROW * len(rows), height_of_sums(lines)]
    figure = new_figure(WIDTH, sum(heights))
    figure.set_layout_engine("none")
    grid = figure.add_gridspec(
        len(heights), 1, height_ratios=heights, left=CAPTIONS / WIDTH, right=1.0, bottom=0.0, top=1.0, hspace=0.0
    )
    _draw_head(plain_part(figure, grid[0, 0], (0, HEAD)), train_name, train, summary)
    if not rows:
        say_instead(plain_part(figure, grid[1, 0], (0, 1)), NO_LINKS, GREY)
        return figure
    highest = highest_bar(stages)
    for index, row in enumerate(rows):
        chain, words, bars, shares = (grid[2 + index * len(ROW) + part, 0] for part in range(4))
        _draw_row(plain_part(figure, chain, (-CHAIN / 2, CHAIN / 2), {SENSE_HEIGHT: "sense of rotation"}), train, row)
        _draw_words(plain_part(figure, words, (3.5, -0.5), dict(enumerate(LINE_CAPTIONS))), row)
        draw_bars(figure, bars, train, row, highest)
        draw_shares(figure, shares, row)
    draw_sums(figure, grid[len(heights) - 1, 0], train, stages, lines)
    return figure


def _draw_head(axes: Axes, name: str, train: TrainSummary, summary: RunSummary) -> None:
    """The legend at the right, the name beside it, and below it a description of the train."""
    left, right = EDGE - CAPTIONS, WIDTH - CAPTIONS - EDGE
    published = published_colours(train)
    letters = min(PUBLISHED_LETTERS // max(len(published), 1), MOST_LETTERS)
    marks: list[Patch | Line2D] = [
        Patch(facecolor=GREY, label="mean"),
        Patch(facecolor=GREY, alpha=LIGHT, label="high (+3 sigma)"),
        *(
            Line2D([], [], color=colour, linewidth=2.5, label=f"{legible(who, letters)}: high")
            for who, colour in published.items()
        ),
    ]
    legend = axes.legend(
        handles=marks,
        loc="upper right",
        bbox_to_anchor=(right, HEAD - 0.15),
        bbox_transform=axes.transData,
        ncols=len(marks),
        fontsize=TEXT,
        frameon=False,
        borderpad=0,
    )
    room = legend.get_window_extent().transformed(axes.transData.inverted()).x0 - left
    title = wrapped(name, room, TITLE, 1, "bold")
    axes.text(left, HEAD - 0.3, title, fontsize=TITLE, fontweight="bold", color=BLACK, va="center")
    words = f"{train.driven} → {train.output},  i = {whole_ratio_text(train.ratio)}"
    words += f"   ·   {train.held} held   ·   {summary.trials} trials, seed {summary.seed}"
    seated = seated_text(summary.measures[train.measure]) if train.measure in summary.measures else ""
    words += f"   ·   {seated}" if seated else ""
    words = wrapped(words, right - left, STRONG, 2)
    axes.text(left, HEAD - 0.54, words, fontsize=STRONG, color=GREY, va="top")


def _draw_row(axes: Axes, train: TrainSummary, row: ChainRow) -> None:
    """The shafts of a row, the signs of its links between them and their names above; y from the shafts' middle."""
    names = [wrapped(f"{stage.number}  {stage.link}", row.pitch - 0.12, STRONG, 2, "bold") for stage in row.stages]
    axes.xaxis.tick_top()
    axes.set_xticks(row.links, names, fontsize=STRONG, fontweight="bold", color=BLACK)
    half = (row.pitch - row.shaft) / 2
    for x, stage in zip(row.links, row.stages, strict=True):
        draw_link(axes, stage, (x - half, x + half))
    for x, name, sense in zip(row.middles, row.shafts, row.senses, strict=True):
        _draw_shaft(axes, row, x, name)
        draw_text(axes, x, SENSE_HEIGHT, "↺" if sense > 0 else "↻", SENSE)
    if row.last and train.lever_mm is not None:
        _draw_arm(axes, train, row.middles[-1] + row.shaft / 2)


def _draw_words(axes: Axes, row: ChainRow) -> None:
    """Draw the words for each link of a row, line by line."""
    for x, stage in zip(row.links, row.stages, strict=True):
        for line, (text, weight) in enumerate(_link_lines(stage)):
            draw_text(axes, x, line, text, TEXT, weight)


def _link_lines(stage: ShownStage) -> Iterator[tuple[str, str]]:
    """Lines below a link, with their weight: ratio, flank, and its own lost motion at its driven shaft."""
    yield stage.ratio_text, "bold"
    yield stage.working_flank or NOTHING, "normal"
    yield value_text(stage.own.mean, "arcmin"), "normal"
    ends = f"{value_text(stage.own.low, 'arcmin')} … {value_text(stage.own.high, 'arcmin')}"
    yield ends + (OF_ITS_LAW if stage.within_its_law else ""), "normal"


def _draw_shaft(axes: Axes, row: ChainRow, x: float, name: str) -> None:
    """A box with round ends; dashed where the same shaft has stood at the end of the row before."""
    corner = (x - row.shaft / 2, -SHAFT_HEIGHT / 2)
    ends = f"round,pad=0,rounding_size={0.45 * SHAFT_HEIGHT}"
    box = FancyBboxPatch(corner, row.shaft, SHAFT_HEIGHT, boxstyle=ends)
    seen = row.goes_on and x == row.middles[0]
    box.set(facecolor="#F3F3F3", edgecolor=GREY, linewidth=1.3, linestyle="--" if seen else "-", zorder=3)
    axes.add_patch(box)
    draw_text(axes, x, 0.0, wrapped(name, row.shaft - 0.14, TEXT, 3), TEXT)


def _draw_arm(axes: Axes, train: TrainSummary, start: float) -> None:
    """An arm that grows thinner to its tip, from the right end of the last shaft."""
    end = start + ARM - 0.25
    beam = Polygon([(start - 0.1, -0.13), (start - 0.1, 0.13), (end, 0.05), (end, -0.05)])
    beam.set(facecolor="#D9D9D9", edgecolor=GREY, linewidth=1.3, zorder=1)
    axes.add_patch(beam)
    axes.add_patch(Circle((end, 0.0), 0.09, facecolor=OUTSIDE, edgecolor="white", linewidth=1.2, zorder=4))
    arrow = {"arrowstyle": "<->", "color": OUTSIDE, "linewidth": 1.4, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (end, TIP_REACH), (end, -TIP_REACH), arrowprops=arrow)
    name = wrapped(train.point or "tip", ARM, TEXT, 2)
    text = f"{name}\nlever {given_text(train.lever_mm, 'mm')} mm"
    axes.text(start + ARM / 2, -CHAIN / 2, text, ha="center", va="top", fontsize=TEXT, color=BLACK, linespacing=1.25)
