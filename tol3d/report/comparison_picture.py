"""Runs laid over each other: histograms of both methods, the difference of every trial beside."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from tol3d.report.bars import bars_of
from tol3d.report.canvas import (
    BLACK,
    GREY,
    METHOD_COLOURS,
    OUTSIDE,
    RUN_COLOURS,
    label_angles,
    legend_below,
    new_figure,
    plain_axes,
    save_figure,
    say_instead,
    title_axes,
)
from tol3d.report.column import seated_text
from tol3d.report.compare import Compared, Difference, difference_of, labelled, measures_of, require_shared_measures
from tol3d.report.curve import Stepped, position_label
from tol3d.report.distribution import density_label, values_label
from tol3d.report.drawn_sample import FILL_OPACITY, DrawnSample, Line, draw_samples
from tol3d.report.heading import heading
from tol3d.report.label import wrapped
from tol3d.report.number import limit_text
from tol3d.runs.run import Run
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.values import Method

NO_SIMULATION: Final = "no 3D simulation in these runs"
NO_TRIALS: Final = "these runs kept no trials (--no-trials)"
METHODS: Final = {"analytic": "analytic", "geometric": "3D simulation"}
WIDTH: Final = 15.0  # inch; of the picture, and of words and legends in its columns
WORDS: Final = (5.2, 3.2, 4.2)
ROW_HEIGHT: Final = 4.3  # inch, of a measure without its legend
LEGEND_LINE: Final = 0.2  # inch
LEGEND_MARK: Final = 0.6  # inch, in front of a legend's words
LEGEND_SIZE: Final = 8.5  # points
HEAD_SIZE: Final = 12.0
DIFFERENCE_UNITS: Final = {"um": ("µm", 1.0), "mm": ("µm", 1000.0), "arcmin": ("″", 60.0), "pins": ("pins", 1.0)}
FULL_TURN: Final = 360.0  # deg
"""Unit of small differences, and the number of them in one of the measure's unit."""


@dataclass(frozen=True)
class Shown:
    """A run as it is shown in every row: its label, and the colours of both its methods."""

    label: str
    run: Run
    colours: Mapping[str, str]


def draw_comparison(runs: Sequence[Run], path: Path) -> None:
    """Draw a row a measure: histograms of both methods, histogram of their differences, differences by position.

    Raises:
        InputError: there are no runs, they share no measure, or the picture cannot be written.
    """
    save_figure(comparison_figure(runs), path)


def comparison_figure(runs: Sequence[Run]) -> Figure:
    """The picture of `draw_comparison`, not yet written.

    Raises:
        InputError: there are no runs, or they share no measure.
    """
    require_shared_measures(runs)
    measures = measures_of(runs)
    shown = _shown(runs)
    own = [[each for each in shown if measure in measures_of([each.run])] for measure in measures]
    heights = [ROW_HEIGHT + LEGEND_LINE * _legend_lines(each) for each in own]
    figure = new_figure(WIDTH, sum(heights) + 0.4)
    names = wrapped(",   ".join(each.label for each in shown), WIDTH - 0.5, HEAD_SIZE, 4)
    figure.suptitle(names, fontsize=HEAD_SIZE, color=BLACK, x=0.01, ha="left")
    grid = figure.add_gridspec(len(measures), 3, width_ratios=[1.6, 1, 1.3], height_ratios=heights)
    for row, (measure, found) in enumerate(zip(measures, own, strict=True)):
        axes = [plain_axes(figure.add_subplot(grid[row, column])) for column in range(3)]
        _draw_methods(axes[0], measure, found, single=len(runs) == 1)
        differences = [(each, difference_of(each.run, measure.name)) for each in found]
        known = [(each, difference) for each, difference in differences if difference is not None]
        instead = NO_SIMULATION if any(each.run.keeps_trials for each in found) else NO_TRIALS
        if not known:
            say_instead(axes[1], instead, GREY)
            say_instead(axes[2], instead, GREY)
        _draw_differences(axes[1], measure.unit, known, single=len(runs) == 1)
        _draw_by_position(axes[2], measure, known)
    return figure


def _shown(runs: Sequence[Run]) -> list[Shown]:
    """Every run in a colour of its own; a single one in those of its methods."""
    if len(runs) == 1:
        return [Shown(label, run, METHOD_COLOURS) for label, run in labelled(runs)]
    colours = [RUN_COLOURS[index % len(RUN_COLOURS)] for index in range(len(runs))]
    named = zip(labelled(runs), colours, strict=True)
    return [Shown(label, run, dict.fromkeys(METHODS, colour)) for (label, run), colour in named]


def _legend_lines(shown: Sequence[Shown]) -> int:
    """Lines of the longest legend of a row: runs, methods and limits, or runs with their differences."""
    breaks = sum(_broken(each.label, 1).count("\n") for each in shown)
    return breaks + 2 * len(shown) + 3


def _broken(text: str, column: int) -> str:
    """Words of a legend in lines of the width of their column."""
    return wrapped(text, WORDS[column] - LEGEND_MARK, LEGEND_SIZE, 6)


# both methods ---------------------------------------------------------------------------------------


def _draw_methods(axes: Axes, measure: Compared, shown: Sequence[Shown], *, single: bool) -> None:
    name, unit = measure.name, measure.unit
    first = shown[0].run.found.measures[name]
    curve = first.take == "curve"
    measures = [(each.run.found.measures[name], each.colours) for each in shown]
    if curve:
        for own, colours in measures:
            _draw_curves(axes, own, colours)
    else:
        draw_samples(axes, [each for own, colours in measures for each in _samples(own, colours, single=single)])
    _add_marks(axes, name, shown, curve=curve, single=single)
    if curve:
        label_angles(axes.yaxis, unit)
        axes.set_xlabel(position_label(first), fontsize=10)
        axes.set_ylabel(values_label(name, unit, 34), fontsize=10)
    else:
        _mark_limits(axes, name, shown)
        label_angles(axes.xaxis, unit)
        axes.set_xlabel(values_label(name, unit), fontsize=10)
        axes.set_ylabel(density_label(unit), fontsize=10)
    title_axes(axes, name, heading(first), WORDS[0])
    legend_below(axes)


def _samples(measure: MeasureSummary, colours: Mapping[str, str], *, single: bool) -> Iterator[DrawnSample]:
    """Both methods' samples of a run: the 3D simulation filled, the stack-up as outline."""
    for method, bars in bars_of(measure).items():
        beside: Line = "solid" if single else "dashed"
        yield DrawnSample(None, colours[method], bars, "filled" if method == "geometric" else beside)


def _draw_curves(axes: Axes, measure: MeasureSummary, colours: Mapping[str, str]) -> None:
    stepped = Stepped(measure)
    styles: Mapping[Method, str] = {"geometric": "-", "analytic": "--"}
    for method, style in styles.items():
        if own := measure.curve_sample(method):
            axes.plot(stepped.x, stepped(own.mean), style, linewidth=2, color=colours[method])


def _add_marks(axes: Axes, name: str, shown: Sequence[Shown], *, curve: bool, single: bool) -> None:
    """The legend: the colour of each run, of how many trials it is if some failed, and how methods are drawn."""
    seated = [f", {text}" if (text := seated_text(each.run.found.measures[name])) else "" for each in shown]
    word = ", mean" if curve else ""
    if not single:
        for each, text in zip(shown, seated, strict=True):
            axes.add_patch(_unseen(each.colours["geometric"], _broken(f"{each.label}{text}", 0)))
    own = shown[0].colours if single else dict.fromkeys(METHODS, GREY)
    own_seated = seated[0] if single else ""
    dashed = "-" if single and not curve else "--"
    if curve:
        axes.plot([], [], color=own["geometric"], linewidth=2, label=f"{METHODS['geometric']}{word}{own_seated}")
    else:
        axes.add_patch(_unseen(own["geometric"], f"{METHODS['geometric']}{own_seated}"))
    axes.plot([], [], dashed, color=own["analytic"], linewidth=1.8, label=f"{METHODS['analytic']}{word}")


def _unseen(colour: str, label: str) -> Rectangle:
    """A patch for the legend alone."""
    return Rectangle((0, 0), 0, 0, facecolor=colour, alpha=FILL_OPACITY, linewidth=0, label=label)


def _mark_limits(axes: Axes, name: str, shown: Sequence[Shown]) -> None:
    """Limits that lie in the picture; those that not all runs share in the colour of theirs."""
    low, high = axes.get_xlim()
    measures = [each.run.found.measures[name] for each in shown]
    for word, limits in zip(("LSL", "USL"), zip(*(measure.limits for measure in measures), strict=True), strict=True):
        shared = len(set(limits)) == 1
        for each, limit in list(zip(shown, limits, strict=True))[: 1 if shared else None]:
            if limit is None or not low <= limit <= high:
                continue
            unit = measures[0].unit
            text = f"{word} {limit_text(limit, unit)}" + ("" if shared else f" of {each.label}")
            colour = OUTSIDE if shared else each.colours["geometric"]
            axes.axvline(limit, color=colour, linewidth=2, label=_broken(text, 0))


# their difference ---------------------------------------------------------------------------------


Known = Sequence[tuple[Shown, Difference]]


def _draw_differences(axes: Axes, unit: str, known: Known, *, single: bool) -> None:
    word, factor = DIFFERENCE_UNITS[unit]
    title_axes(axes, "3D simulation − analytic", "of every trial", WORDS[1])
    if not known:
        return
    samples = []
    for each, found in known:
        text = f"max {factor * found.largest:.3f} {word}, rms {factor * found.rms:.3f} {word}"
        label = text if single else f"{_broken(each.label, 1)}:\n{text}"
        samples.append(DrawnSample(label, each.colours["geometric"], found.bars.times(factor)))
    draw_samples(axes, samples)
    axes.axvline(0, color=BLACK, linewidth=0.8)
    axes.set_xlabel(f"difference of a trial [{word}]", fontsize=10)
    axes.set_ylabel("share of trials", fontsize=10)
    axes.set_yticks([])
    axes.locator_params(axis="x", nbins=6)
    axes.set_ylim(bottom=0)
    legend_below(axes)


def _draw_by_position(axes: Axes, measure: Compared, known: Known) -> None:
    word, factor = DIFFERENCE_UNITS[measure.unit]
    turning = measure.position_word
    by_position = all(found.by_position for _, found in known)
    title_axes(axes, "difference", f"by position of the {turning}" if by_position else "by value", WORDS[2])
    if not known:
        return
    for each, found in known:
        axes.plot(
            found.at,
            factor * found.values,
            linestyle="",
            marker=".",
            markersize=3.5,
            markeredgewidth=0,
            alpha=0.5,
            color=each.colours["geometric"],
        )
    axes.axhline(0, color=BLACK, linewidth=0.8)
    if by_position:
        within = all(found.at.max(initial=0.0) <= FULL_TURN for _, found in known)
        turn = " within its turn" if turning == "driver" and within else ""
        axes.set_xlabel(f"{turning} position{turn} [deg]", fontsize=10)
    else:
        label_angles(axes.xaxis, measure.unit)
        axes.set_xlabel(f"analytic: {values_label(measure.name, measure.unit, 40)}", fontsize=10)
    axes.set_ylabel(f"difference [{word}]", fontsize=10)
