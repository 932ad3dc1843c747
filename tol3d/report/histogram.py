"""The picture of a run: each measure's histogram with limits and published ranges, its contributors beside."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from numpy.typing import NDArray

from tol3d.report.bars import Bars, bars_of
from tol3d.report.canvas import (
    BLACK,
    GREY,
    ORANGE,
    OUTSIDE,
    PUBLISHED_COLOURS,
    ROAD_COLOURS,
    label_angles,
    legible,
    new_figure,
    plain_axes,
    save_figure,
    say_instead,
    title_measure,
)
from tol3d.report.column import Column, best_road, columns_of, ranked_contributors, shares_of
from tol3d.report.heading import position_of
from tol3d.report.number import UNIT_SIGNS, given_text, percent_text, ppm_text, short_text, unit_suffix

Summary = Mapping[str, Any]
Array = NDArray[np.float64]

SIGMAS_SHOWN = 3.6  # of the mean; a little more than the +-3 sigma that are marked
LIMIT_REACH = 0.6  # of the shown span; a limit further off is told at the edge, not drawn to scale
MOST_CONTRIBUTORS = 9  # bars; the rest is shown as one
NO_VALUES = "no trial gave a value"
TURN = 360.0  # deg; from two turns on the axis counts turns
LONGEST_HEADING = 96  # characters above a histogram; more would make it narrower
MARKERS = {"tip_error": "."}  # it jumps from one position to the next: the line between them is no value
AXIS_UNITS = {"arcmin": "′, ″ of arc"}  # where an axis has other words than a number


def values_label(name: str, unit: str, longest: int = 60) -> str:
    """Label of an axis of a measure's values."""
    return f"{legible(name, longest)} [{AXIS_UNITS.get(unit, UNIT_SIGNS[unit])}]"


def density_label(unit: str) -> str:
    """Label of an axis of a histogram's densities."""
    return f"% of trials per {UNIT_SIGNS[unit]}"


def draw_histogram(summary: Summary, path: Path) -> None:
    """Draw every measure of a run: `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    measures = summary["measures"]
    heights = [_height(measure) for measure in measures.values()]
    figure = new_figure(13.0, sum(heights) + 0.5)
    failed = sum(count for status, count in summary["status"].items() if status != "ok")
    figure.suptitle(
        f"{legible(summary['scene'], 70)}   ·   {summary['trials']} trials, seed {summary['seed']}"
        + (f", {failed} not seated" if failed else ""),
        fontsize=12,
        color=BLACK,
        x=0.01,
        ha="left",
    )
    scalars = [measure for measure in measures.values() if measure["take"] != "curve"]
    colours = column_colours([column for measure in scalars for column in columns_of(measure)])
    rows = figure.add_gridspec(len(measures), 1, height_ratios=heights, hspace=0.08)
    for row, (name, measure) in enumerate(measures.items()):
        if measure["take"] == "curve":
            draw_curve(plain_axes(figure.add_subplot(rows[row, 0])), name, measure)
        else:
            _draw_scalar(figure, rows[row, 0], name, measure, colours)
    save_figure(figure, path)


def _height(measure: Summary) -> float:
    """Height of a measure's row [inch]."""
    return 3.6 if measure["take"] == "curve" else 4.3 + 0.22 * len(columns_of(measure))


def _draw_scalar(figure: Figure, place: SubplotSpec, name: str, measure: Summary, colours: Mapping[str, str]) -> None:
    columns, shares = columns_of(measure), shares_of(measure)
    halves = place.subgridspec(1, 2, width_ratios=[2.2, 1])
    left = halves[0, 0] if shares else place
    parts = left.subgridspec(2, 1, height_ratios=[3.4, 0.28 * len(columns) + 0.15], hspace=0.02)
    axes = plain_axes(figure.add_subplot(parts[0, 0]))
    draw_distribution(axes, name, measure)
    ranges = figure.add_subplot(parts[1, 0], sharex=axes)
    draw_ranges(ranges, columns, colours)
    axes.tick_params(labelbottom=False)
    label_angles(ranges.xaxis, measure["unit"])
    ranges.set_xlabel(values_label(name, measure["unit"]), fontsize=10)
    if shares:
        draw_contributors(figure.add_subplot(halves[0, 1]), measure, shares, colours)


# histogram ----------------------------------------------------------------------------------------


def draw_distribution(axes: Axes, name: str, measure: Summary) -> None:
    """Both roads' histograms over each other, the closed form's normal curve, limits and +-3 sigma."""
    unit = measure["unit"]
    title_measure(axes, name, measure, LONGEST_HEADING)
    bars = bars_of(measure["histogram"])
    if not bars:
        say_instead(axes, NO_VALUES, OUTSIDE)
        return
    span = shown_span(measure, bars)
    leading = best_road(measure)
    _fill(axes, bars[leading], measure, leading)
    if leading != "analytic":
        axes.stairs(bars["analytic"].density, bars["analytic"].edges, color=ORANGE, linewidth=2.0)
    form = measure.get("analytic_closed_form")
    if form and form["sigma"]:
        x = np.linspace(*span, 400)
        mean, sigma = form["mean"], form["sigma"]
        normal = 100 * np.exp(-(((x - mean) / sigma) ** 2) / 2) / (sigma * math.sqrt(2 * math.pi))
        axes.plot(x, normal, color=BLACK, linewidth=1.2, linestyle=(0, (5, 3)))
    top = max(float(b.density.max()) for b in bars.values())
    axes.set_ylim(0, 1.25 * top)
    axes.set_xlim(*span)
    _mark_sigmas(axes, measure[leading], unit)
    _mark_limits(axes, measure, span, measure[leading])
    axes.set_ylabel(density_label(unit), fontsize=10)


def shown_span(measure: Summary, bars: Mapping[str, Bars]) -> tuple[float, float]:
    """What the axis shows: every bar, +-3 sigma of every column, and limits that are not far off."""
    lows = [float(b.edges[0]) for b in bars.values()]
    highs = [float(b.edges[-1]) for b in bars.values()]
    for column in columns_of(measure):
        mean, sigma = column.value("mean"), column.value("sigma")
        spread = (mean - SIGMAS_SHOWN * sigma, mean + SIGMAS_SHOWN * sigma) if mean is not None and sigma else ()
        ends = (*spread, *(column.value(key) for key in ("low_3sigma", "mean", "high_3sigma")))
        lows += [end for end in ends if end is not None]
        highs += [end for end in ends if end is not None]
    low, high = min(lows), max(highs)
    reach = LIMIT_REACH * (high - low)
    limits = [limit for limit in (measure.get("lower_limit"), measure.get("upper_limit")) if limit is not None]
    near = [limit for limit in limits if low - reach <= limit <= high + reach]
    low, high = min([low, *near]), max([high, *near])
    margin = 0.03 * (high - low) or max(1e-3 * abs(low), 1e-3)
    return low - margin, high + margin


def _fill(axes: Axes, bars: Bars, measure: Summary, road: str) -> None:
    below = measure["lower_limit"] if measure.get("lower_limit") is not None else -math.inf
    above = measure["upper_limit"] if measure.get("upper_limit") is not None else math.inf
    outside = (bars.middles < below) | (bars.middles > above)
    for chosen, colour in ((~outside, ROAD_COLOURS[road]), (outside, OUTSIDE)):
        if chosen.any():
            axes.bar(
                bars.edges[:-1][chosen],
                bars.density[chosen],
                width=np.diff(bars.edges)[chosen],
                align="edge",
                color=colour,
                alpha=0.55 if colour != OUTSIDE else 0.85,
                edgecolor="white",
                linewidth=0.5,
            )


def _mark_sigmas(axes: Axes, sample: Summary, unit: str) -> None:
    for key, word in (("low_3sigma", "−3σ"), ("mean", "mean"), ("high_3sigma", "+3σ")):
        value = sample.get(key)
        if value is None:
            continue
        axes.axvline(value, ymax=0.84, color=GREY, linewidth=1.0, linestyle=":")
        axes.annotate(
            f"{word}\n{short_text(value, unit)}",
            (value, 1.0),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="top",
            fontsize=8.5,
            color=BLACK,
        )


def _mark_limits(axes: Axes, measure: Summary, span: tuple[float, float], sample: Summary) -> None:
    unit = measure["unit"]
    for key, word, side in (("lower_limit", "LSL", "below"), ("upper_limit", "USL", "above")):
        limit = measure.get(key)
        if limit is None:
            continue
        lower = key == "lower_limit"
        text = f"{word} {given_text(limit, unit)}{unit_suffix(unit)}\n"
        text += f"{ppm_text(sample.get(f'{side}_limit_ppm'))} ppm {side}"
        inside = span[0] <= limit <= span[1]
        if inside:
            axes.axvline(limit, color=OUTSIDE, linewidth=2.0)
        else:
            text = f"◄ {text}" if lower else f"{text} ►"
        axes.annotate(
            text,
            (min(max(limit, span[0]), span[1]), 0.72),
            xycoords=("data", "axes fraction"),
            xytext=(5 if lower else -5, 0),
            textcoords="offset points",
            ha="left" if lower else "right",
            fontsize=9,
            color=OUTSIDE,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.5},
        )


def column_colours(columns: Sequence[Column]) -> dict[str, str]:
    """A colour for each column by its heading: the roads have their own, published ones get the others in turn."""
    published = dict.fromkeys(column.heading for column in columns if column.road == "published")
    colours = {name: PUBLISHED_COLOURS[k % len(PUBLISHED_COLOURS)] for k, name in enumerate(published)}
    return colours | {c.heading: ROAD_COLOURS[c.road] for c in columns if c.road != "published"}


def draw_ranges(axes: Axes, columns: Sequence[Column], colours: Mapping[str, str]) -> None:
    """One line a column below the histogram: low to high at +-3 sigma, one known end alone, the mean as a dot."""
    for row, column in enumerate(columns):
        colour = colours[column.heading]
        low, mean, high = (column.value(key) for key in ("low_3sigma", "mean", "high_3sigma"))
        if low is not None and high is not None:
            axes.plot([low, high], [row, row], color=colour, linewidth=5, solid_capstyle="butt", alpha=0.75)
        else:
            alone = [end for end in (low, high) if end is not None]
            axes.plot(alone, [row] * len(alone), marker="|", markersize=9, markeredgewidth=3, color=colour)
        if mean is not None:
            axes.plot(mean, row, marker="o", markersize=6, color=colour, markeredgecolor="white")
    axes.set_yticks(range(len(columns)), [legible(column.heading, 28) for column in columns], fontsize=8.5)
    axes.set_ylim(len(columns) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", labelsize=9, color="#999999")
    axes.grid(axis="x", color="#E6E6E6", linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)


# contributors -------------------------------------------------------------------------------------


def draw_contributors(axes: Axes, measure: Summary, columns: Sequence[Column], colours: Mapping[str, str]) -> None:
    """Shares of the variance as bars: the two roads and every published column."""
    plain_axes(axes).grid(axis="y", visible=False)
    names = ranked_contributors(measure)
    shown, rest = names[:MOST_CONTRIBUTORS], names[MOST_CONTRIBUTORS:]
    labels = [*(legible(name, 26) for name in shown), *([f"{len(rest)} others"] if rest else [])]
    height = 0.8 / len(columns)
    for k, column in enumerate(columns):
        values = [column.percents.get(name) or 0.0 for name in shown]
        values += [sum(column.percents.get(name) or 0.0 for name in rest)] if rest else []
        places = np.arange(len(values)) - 0.4 + (k + 0.5) * height
        label = {"analytic": "analytic", "geometric": "3D simulation"}.get(column.road, legible(column.heading, 28))
        drawn = axes.barh(places, values, height=0.9 * height, color=colours[column.heading], alpha=0.8, label=label)
        known = [column.percents.get(name) is not None for name in shown] + [any(values)] * bool(rest)
        texts = [percent_text(value) if told else "" for value, told in zip(values, known, strict=True)]
        axes.bar_label(drawn, labels=texts, fontsize=7, padding=2, color=BLACK)
    axes.set_yticks(range(len(labels)), labels, fontsize=9)
    axes.tick_params(axis="y", length=0)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    axes.margins(x=0.12)
    axes.set_xlim(left=0)
    axes.set_xlabel("share of the variance [%]", fontsize=10)
    axes.set_title("contributors", loc="left", fontsize=11, fontweight="bold")
    above_rest = 1 / len(labels) if rest else 0.0  # all others in one may be a long bar
    axes.legend(fontsize=8.5, frameon=False, loc="lower right", bbox_to_anchor=(1.0, above_rest))


# curve --------------------------------------------------------------------------------------------


def draw_curve(axes: Axes, name: str, measure: Summary) -> None:
    """A curve over positions of driver or output: mean, +-3 sigma and extremes of the 3D simulation, analytic mean."""
    unit, curve = measure["unit"], measure["curve"]
    degrees = np.asarray(measure["position_deg"])
    in_turns = len(degrees) > 0 and degrees[-1] > 2 * TURN
    x = degrees / TURN if in_turns else degrees
    leading = best_road(measure)
    stepped = _Stepped(x, measure.get("load_changes_deg") or [])
    own = {key: stepped(values) for key, values in curve[leading].items() if key in ("mean", "sigma", "min", "max")}
    mean, sigma, least, most = (own[key] for key in ("mean", "sigma", "min", "max"))
    analytic = stepped(curve["analytic"]["mean"])
    x = stepped(x)
    word = "3D simulation" if leading == "geometric" else "analytic"
    colour = ROAD_COLOURS[leading]
    axes.fill_between(x, least, most, color=colour, alpha=0.13, linewidth=0, label=f"{word}, all trials")
    axes.fill_between(
        x, mean - 3 * sigma, mean + 3 * sigma, color=colour, alpha=0.28, linewidth=0, label=f"{word}, ±3 sigma"
    )
    axes.plot(
        x, mean, color=colour, linewidth=2, marker=MARKERS.get(measure["kind"]), markersize=7, label=f"{word}, mean"
    )
    if leading != "analytic":
        axes.plot(x, analytic, color=ORANGE, linewidth=1.8, linestyle="--", label="analytic, mean")
    for change in stepped.changes:
        text = f"the load changes sides at {change:.1f}°"
        axes.axvline(change, color=GREY, linewidth=1.2, linestyle=":", label=text)
    for key, limit_word in (("lower_limit", "LSL"), ("upper_limit", "USL")):
        if measure.get(key) is not None:
            text = f"{limit_word} {given_text(measure[key], unit)}{unit_suffix(unit)}"
            axes.axhline(measure[key], color=OUTSIDE, linewidth=2, label=text)
    axes.set_xlim(x[0], x[-1])
    axes.set_xlabel(f"{position_of(measure)} position [{'turns' if in_turns else 'deg'}]", fontsize=10)
    axes.set_ylabel(values_label(name, unit, 34), fontsize=10)
    label_angles(axes.yaxis, unit)
    title_measure(axes, name, measure, 110)
    if np.isnan(mean).all():
        say_instead(axes, NO_VALUES, OUTSIDE)
    axes.legend(fontsize=8.5, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))


class _Stepped:
    """Curves over positions with both their values at the positions between at which they jump."""

    def __init__(self, x: Array, changes: Sequence[float]) -> None:
        self.changes = [change for change in changes if x[0] < change < x[-1]]
        self._x = x

    def __call__(self, values: Sequence[float] | Array) -> Array:
        """Values at the positions, in front of each jump the one before it and behind it the one after it."""
        known = np.asarray(values, dtype=float)
        after = np.searchsorted(self._x, self.changes)
        both = [self.changes * 2] if values is self._x else [known[after - 1], known[after]]
        added = np.concatenate(both) if self.changes else np.empty(0)
        return np.insert(known, np.concatenate([after, after]), added)
