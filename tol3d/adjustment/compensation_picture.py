"""The picture of a motor's compensation: the remaining error at a random position, and the tip over the swing."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tol3d.adjustment.compensated_swing import Swing
from tol3d.adjustment.compensation import Compensation, Unit
from tol3d.adjustment.compensation_table import COLUMN_WORDS, STATE_WORDS, TOLD_OF_TIPS, Spread
from tol3d.adjustment.robots import STATES, State
from tol3d.numerics.arrays import Array
from tol3d.report.bars import Bars
from tol3d.report.canvas import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    PURPLE,
    VERMILLION,
    label_angles,
    new_figure,
    plain_axes,
    save_figure,
    say_instead,
)
from tol3d.report.drawn_sample import DrawnSample, draw_samples
from tol3d.report.ends import Ends
from tol3d.report.label import legible
from tol3d.report.number import given_text, short_text, tip_mm

LINE_WIDTHS: Final[Mapping[State, float]] = {"before": 2.0, "batch": 4.5, "robot": 1.6}  # the last lies on the second
MARKERS: Final[Mapping[str, str]] = {"mean": "D", "low_3sigma": "<", "high_3sigma": ">"}
MARKS_HEIGHT: Final = 0.58  # of the axes; above them stands the legend
STATE_COLOURS: Final[Mapping[State, str]] = {"before": VERMILLION, "batch": BLUE, "robot": GREEN}
BINS: Final = 90  # over what all scenes and states span together
WIDTH: Final = 14.0  # inch
ROW: Final = 4.2
HEAD: Final = 0.7
BAND: Final = 0.22
MARGIN: Final = 0.04  # of the span, beside it


def draw_compensation(found: Sequence[Compensation], path: Path) -> None:
    """Draw it, a row a scene: `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(compensation_figure(found), path)


def compensation_figure(found: Sequence[Compensation]) -> Figure:
    """The picture, not yet written; equal scales in all rows of one unit."""
    swings = any(own.swing for own in found)
    figure = new_figure(WIDTH, ROW * len(found) + HEAD)
    figure.suptitle("motor compensation when the load changes side", fontsize=12, color=BLACK, x=0.01, ha="left")
    axes = figure.subplots(len(found), 2 if swings else 1, squeeze=False, width_ratios=[1.15, 1] if swings else [1])
    for row, own in zip(axes, found, strict=True):
        unit = own.units[0]
        _draw_left(plain_axes(row[0]), own, unit, _edges([each for each in found if each.units[0] == unit], unit))
        if swings:
            _draw_swing(plain_axes(row[1]), own, _swing_span(found))
    return figure


def _edges(found: Sequence[Compensation], unit: Unit) -> Array:
    """Edges of bins that hold every value, zero and the sums of highs of the scenes."""
    values = [own.remaining[own.method].in_unit(unit)[state] for own in found for state in STATES]
    marks = [value for own in found for _, value, _ in _highs(own, unit)]
    every = np.concatenate([*values, np.array([0.0, *marks])])
    low, high = float(every.min()), float(every.max())
    margin = MARGIN * (high - low) or 1e-3
    return np.linspace(low - margin, high + margin, BINS + 1)


# at a random position -----------------------------------------------------------------------------


def _draw_left(axes: Axes, own: Compensation, unit: Unit, edges: Array) -> None:
    _title(axes, own, f"{own.robots - own.failed} robots at a random position, {COLUMN_WORDS[own.method]}")
    samples = [*_samples(own, unit, edges)]
    if not samples:
        say_instead(axes, "no robot could be assembled", VERMILLION)
        return
    width = float(edges[1] - edges[0])
    draw_samples(axes, samples, per=width)
    for label, value, colour in _highs(own, unit):
        text = f"{label}: {short_text(value, unit)}"
        axes.axvline(value, ymax=MARKS_HEIGHT, color=colour, linewidth=1.6, linestyle="--", label=text)
    for label, value, marker in _published(own, unit):
        text = f"{label}: {given_text(value, unit)} mm"
        mark = axes.plot(value, 0, marker=marker, markersize=9, color=PURPLE, linestyle="none", label=text)
        mark[0].set(clip_on=False, zorder=5, markeredgecolor="white")
    axes.axvline(0.0, color=GREY, linewidth=0.8)
    axes.set_xlim(edges[0], edges[-1])
    axes.set_xlabel(_label(own, unit), fontsize=10)
    axes.set_ylabel(f"% of robots per {short_text(width, unit)}", fontsize=10)
    label_angles(axes.xaxis, unit)
    axes.legend(fontsize=8.5, frameon=True, framealpha=0.85, edgecolor="none", loc="upper right")
    axes.set_ylim(0, 1.02 * axes.get_ylim()[1])


def _samples(own: Compensation, unit: Unit, edges: Array) -> Iterator[DrawnSample]:
    """Remaining error in each state; nothing if no robot could be assembled."""
    values = own.remaining[own.method].in_unit(unit)
    for state in STATES:
        if len(values[state]):
            spread = Spread(values[state])
            yield DrawnSample(
                label=f"{STATE_WORDS[state]}: {_ends_text(spread, unit)}",
                colour=STATE_COLOURS[state],
                bars=Bars.of(values[state], edges),
                mean=spread.moments.mean,
                ends=Ends(spread.low, spread.high),
            )


def _ends_text(spread: Spread, unit: Unit) -> str:
    return (
        f"{short_text(spread.moments.mean, unit)}, ±3σ {short_text(spread.low, unit)} … {short_text(spread.high, unit)}"
    )


def _highs(own: Compensation, unit: Unit) -> list[tuple[str, float, str]]:
    """The sums of the stages' highs by the leading method, with their colours."""
    correction = own.corrections[own.method]
    cases = (
        ("sum of highs", correction.before, STATE_COLOURS["before"]),
        ("sum of highs, compensated", correction.left, STATE_COLOURS["batch"]),
    )
    values = [(label, tip_mm(arcmin, own.lever) if unit == "mm" else arcmin, colour) for label, arcmin, colour in cases]
    return [(label, value, colour) for label, value, colour in values if value is not None]


def _published(own: Compensation, unit: Unit) -> list[tuple[str, float, str]]:
    """Published displacements of the tip without compensation, with their marks."""
    return [
        (f"{legible(column, 24)}, {word}", values[key], MARKERS[key])
        for column, values in own.published_tips.items()
        for key, word in TOLD_OF_TIPS.items()
        if unit == "mm" and values.get(key) is not None
    ]


def _label(own: Compensation, unit: Unit) -> str:
    if own.tip and own.tip.tip and unit == "mm":
        return f"error of {legible(f'{own.tip.tip.point} of {own.tip.tip.arm}', 50)} [mm]"
    return f"error of {legible(own.shaft, 50)} [′, ″ of arc]"


def _title(axes: Axes, own: Compensation, text: str) -> None:
    axes.set_title(f"{legible(own.name, 60)}\n", loc="left", fontsize=12, fontweight="bold")
    axes.text(0, 1.03, legible(text, 90), transform=axes.transAxes, fontsize=9, color=GREY)


# over the swing -----------------------------------------------------------------------------------


def _swing_span(found: Sequence[Compensation]) -> tuple[float, float]:
    bands = [_band(own.swing.curves[own.method][state]) for own in found if own.swing for state in STATES]
    low = min(float(np.nanmin(ends, initial=0.0)) for _, ends, _ in bands)
    high = max(float(np.nanmax(ends, initial=0.0)) for _, _, ends in bands)
    margin = MARGIN * (high - low) or 1e-3
    return low - margin, high + margin


def _band(curve: Array) -> tuple[Array, Array, Array]:
    """Mean and mean -+ 3 sigma at every position."""
    spreads = [Spread(values) for values in curve.T]
    ends = [[spread.moments.mean, spread.low, spread.high] for spread in spreads]
    mean, low, high = np.array(ends).T
    return mean, low, high


def _draw_swing(axes: Axes, own: Compensation, span: tuple[float, float]) -> None:
    if own.swing is None:
        axes.set_axis_off()
        say_instead(axes, "no tip error over a swing in which the load changes side", GREY)
        return
    _title(axes, own, f"{legible(own.swing.measure, 50)}: mean and ±3 sigma of the robots, {COLUMN_WORDS[own.method]}")
    for state in STATES:
        mean, low, high = _band(own.swing.curves[own.method][state])
        for first, last in _stretches(own.swing):
            x = np.degrees(_reaching_the_jumps(own.swing, first, last))
            label = STATE_WORDS[state] if first == 0 else None
            colour = STATE_COLOURS[state]
            lower, middle, upper = (_held(own.swing, ends, first, last) for ends in (low, mean, high))
            axes.fill_between(x, lower, upper, color=colour, alpha=BAND, linewidth=0)
            axes.plot(x, middle, color=colour, linewidth=LINE_WIDTHS[state], solid_capstyle="butt", label=label)
    for angle in np.degrees(own.swing.jumps):
        axes.axvline(angle, color=BLACK, linewidth=1.0, linestyle=":", zorder=1)
        axes.annotate(
            f"the load changes side, {angle:.1f}°",
            (angle, 0.97),
            xycoords=("data", "axes fraction"),
            xytext=(-5, 0),
            textcoords="offset points",
            ha="right",
            va="top",
            fontsize=9,
            color=BLACK,
        )
    axes.set_xlim(np.degrees(own.swing.output[0]), np.degrees(own.swing.output[-1]))
    axes.set_ylim(*span)
    axes.set_xlabel("output position [deg]", fontsize=10)
    axes.set_ylabel(_label(own, "mm"), fontsize=10)
    axes.legend(fontsize=8.5, frameon=True, framealpha=0.85, edgecolor="none", loc="center left")


def _stretches(swing: Swing) -> list[tuple[int, int]]:
    """First and last position of every stretch on which the same flanks work."""
    starts = [0, *(np.flatnonzero(np.diff(swing.turned)) + 1).tolist()]
    return list(zip(starts, [*(start - 1 for start in starts[1:]), len(swing.turned) - 1], strict=True))


def _reaching_the_jumps(swing: Swing, first: int, last: int) -> Array:
    """The output's angles of a stretch [rad], with the jumps at its ends."""
    before = [angle for angle in swing.jumps if first and swing.output[first - 1] <= angle <= swing.output[first]]
    inside = len(swing.output) > last + 1
    after = [angle for angle in swing.jumps if inside and swing.output[last] <= angle <= swing.output[last + 1]]
    return np.array([*before[:1], *swing.output[first : last + 1], *after[:1]])


def _held(swing: Swing, values: Array, first: int, last: int) -> Array:
    """Values of a stretch, held from its ends to the jumps."""
    x = _reaching_the_jumps(swing, first, last)
    return np.asarray(np.interp(x, swing.output[first : last + 1], values[first : last + 1]))
