"""Figures without a window: colours that colour-blind readers can distinguish, and how a picture is saved.

Labels that fit: users' names broken into lines of a width.
"""

import warnings
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.textpath import text_to_path
from matplotlib.ticker import FuncFormatter, MultipleLocator
from matplotlib.transforms import ScaledTranslation

from tol3d.errors import InputError, unwritable
from tol3d.report.heading import legible
from tol3d.report.ticks import angle_step, minutes_seconds

# Okabe and Ito 2008, "Color Universal Design": eight colours for all kinds of colour vision
ORANGE: Final = "#E69F00"
SKY: Final = "#56B4E9"
GREEN: Final = "#009E73"
BLUE: Final = "#0072B2"
VERMILLION: Final = "#D55E00"
PURPLE: Final = "#CC79A7"
BLACK: Final = "#222222"
GREY: Final = "#7A7A7A"


METHOD_COLOURS: Final = {"closed form": BLACK, "analytic": ORANGE, "geometric": BLUE}
PUBLISHED_COLOURS: Final = (GREEN, PURPLE, SKY, GREY)
RUN_COLOURS: Final = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILLION, GREY, BLACK)
OUTSIDE: Final = VERMILLION

NAME_SIZE: Final = 12.0  # points
WORDS_SIZE: Final = 9.0
LINE_SPACING: Final = 1.2
TITLE_LIFT: Final = 4.0  # points, from the axes to the words above them
MOST_LINES: Final = 5  # of names and words; enough for the longest possible names
LEGEND_BELOW: Final = 0.5  # inch, from the axis to the first line of the legend below it
DOTS_PER_INCH: Final = 150
PNG: Final = ".png"
FORMATS: Final = (PNG, ".svg", ".pdf")
QUICK: Final = {"compress_level": 1}  # of a PNG: an eighth larger, written in a third of the time


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [inch], laid out by constraints."""
    layout = ConstrainedLayoutEngine(w_pad=0.08, h_pad=0.08, wspace=0.02, hspace=0.0)
    figure = Figure(figsize=(width, height), dpi=DOTS_PER_INCH, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def plain_axes(axes: Axes) -> Axes:
    """Axes with little ink: no upper and right frame, a faint grid behind."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color("#999999")
    axes.tick_params(labelsize=9, color="#999999")
    axes.grid(color="#E6E6E6", linewidth=0.7)
    axes.set_axisbelow(True)
    return axes


def title_axes(axes: Axes, name: str, words: str, width: float) -> None:
    """A name above axes and below it what they show, both whole, in lines of at most `width` [inch]."""
    below = wrapped(words, width, WORDS_SIZE, MOST_LINES)
    above = wrapped(name, width, NAME_SIZE, MOST_LINES, "bold")
    lines = below.count("\n") + bool(below)
    lift = (2.5 if below else 1.0) * TITLE_LIFT + lines * LINE_SPACING * WORDS_SIZE
    axes.set_title(above, loc="left", fontsize=NAME_SIZE, fontweight="bold", pad=lift)
    if not below:
        return
    words_below = axes.annotate(
        below,
        (0, 1),
        xycoords="axes fraction",
        xytext=(0, TITLE_LIFT),
        textcoords="offset points",
        va="bottom",
        linespacing=LINE_SPACING,
        fontsize=WORDS_SIZE,
        color=GREY,
    )
    words_below.set_in_layout(False)  # lines are broken already, and the name above them keeps their room


def legend_below(axes: Axes, named: Mapping[str, Artist] | None = None) -> None:
    """A legend below the axis and its label, where it hides nothing; default: of what on the axes has a label."""
    figure = axes.get_figure(root=True)
    handles, labels = axes.get_legend_handles_labels() if named is None else ([*named.values()], [*named])
    if figure is None or not labels:
        return
    axes.legend(
        handles,
        labels,
        loc="upper left",
        bbox_to_anchor=(0.0, 0.0),
        bbox_transform=axes.transAxes + ScaledTranslation(0.0, -LEGEND_BELOW, figure.dpi_scale_trans),
        borderaxespad=0.0,
        fontsize=8.5,
        frameon=False,
    )


def say_instead(axes: Axes, text: str, colour: str) -> None:
    """A sentence in the middle of axes that have nothing to show."""
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", color=colour)


def label_angles(axis: Axis, unit: str) -> None:
    """Ticks of an axis in arc minutes as minutes and seconds; other units are left as they are."""
    if unit != "arcmin":
        return
    step = angle_step(*axis.get_view_interval())
    if step is not None:
        axis.set_major_locator(MultipleLocator(step / 60))
    axis.set_major_formatter(FuncFormatter(lambda value, position: minutes_seconds(value)))


def save_figure(figure: Figure, path: Path) -> None:
    """Write a picture in the format of the path's ending.

    Raises:
        InputError: another ending, or the file cannot be written.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"{path}: expected a picture ending in {', '.join(FORMATS)}")
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", r"Glyph \d+ .* missing")  # of a user's name: shown as a box
            is_png = path.suffix.lower() == PNG
            if is_png:  # laid out here: matplotlib would traverse everything once more for that alone
                if engine := figure.get_layout_engine():
                    engine.execute(figure)
                figure.set_layout_engine(None)
            more: dict[str, Any] = {"pil_kwargs": QUICK} if is_png else {}
            figure.savefig(path, facecolor="white", **more)
    except OSError as error:
        raise unwritable(path, error, "choose another file") from None


POINTS_PER_INCH: Final = 72.0


def wrapped(text: str, width: float, size: float, lines: int, weight: str = "normal") -> str:
    """A user's name in lines of at most `width` [inch]; what does not fit in so many lines ends in an ellipsis."""
    found: list[str] = []
    rest = text
    while rest and len(found) < lines:
        line = _longest_start(rest, width, size, weight)
        found.append(line.strip())
        rest = rest[len(line) :].lstrip()
    if rest:
        last = found[-1] + "…"
        while len(last) > 1 and text_width(last, size, weight) > width:
            last = last[:-2] + "…"
        found[-1] = last
    return "\n".join(legible(line, len(line)) for line in found)


def _longest_start(text: str, width: float, size: float, weight: str) -> str:
    """As many words as fit in a line, or as much of the first word."""
    if text_width(text, size, weight) <= width:
        return text
    ends = [k for k, sign in enumerate(text) if sign == " "]
    if fitting := bisect_right(ends, width, key=lambda k: text_width(text[:k], size, weight)):
        return text[: ends[fitting - 1]]
    cut = bisect_right(range(1, len(text) + 1), width, key=lambda k: text_width(text[:k], size, weight))
    return text[: max(cut, 1)]


@lru_cache(maxsize=4096)
def text_width(text: str, size: float, weight: str) -> float:
    """Width of a line of text [inch], in points of `size`."""
    font = FontProperties(size=size, weight=weight)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph \d+ .* missing")  # of a user's name: shown as a box
        width, _, _ = text_to_path.get_text_width_height_descent(text, font, ismath=False)
    return float(width) / POINTS_PER_INCH


def widest(labels: Sequence[str], size: float) -> float:
    """Width of the widest line of any of the labels [inch]; 0 without any."""
    return max((text_width(line, size, "normal") for label in labels for line in label.split("\n")), default=0.0)
