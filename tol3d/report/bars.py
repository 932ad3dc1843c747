"""Histograms ready to be drawn: fewer bars for few trials, densities in % per unit."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from matplotlib.axes import Axes

from tol3d.numerics.arrays import Array
from tol3d.report.canvas import BLACK, legend_below, plain_axes
from tol3d.report.column import Column, ranked_contributors, shares_of, unexplained_words
from tol3d.report.label import wrapped
from tol3d.report.number import percent_text
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.values import Method

FEWEST_BARS = 8


@dataclass(frozen=True, eq=False)
class Bars:
    """Bars of a histogram.

    Args:
        edges: (bars + 1,) in the unit of the values.
        counts: (bars,) values in each bar.
        trials: how many trials there were in all; those that failed are in no bar.
    """

    edges: Array
    counts: Array
    trials: float

    @classmethod
    def of(cls, values: Array, edges: Array) -> "Bars":
        """Bars of values, all of which are counted."""
        return cls(edges, np.histogram(values, edges)[0].astype(np.float64), len(values))

    @property
    def density(self) -> Array:
        """(bars,) % of the trials a unit, so that samples with other bars and the normal curve compare."""
        return 100 * self.counts / (max(self.trials, 1.0) * np.diff(self.edges))

    @property
    def middles(self) -> Array:
        """Middle of each bar."""
        return (self.edges[:-1] + self.edges[1:]) / 2

    def times(self, factor: float) -> "Bars":
        """The same values in another unit, so many to one of this one."""
        return Bars(factor * self.edges, self.counts, self.trials)


def bars_of(measure: MeasureSummary) -> dict[Method, Bars]:
    """Bars of each method of a measure; none where nothing was counted.

    Densities refer to all trials: failed ones are missing in the bars and do not raise the others.
    """
    histogram = measure.histogram
    if histogram is None or histogram.counts is None or histogram.lower_edge is None or histogram.bin_width is None:
        return {}
    total = max(sum(counts) for counts in histogram.counts.values())
    merged = _neighbours_in_one(len(next(iter(histogram.counts.values()))), total)
    width = merged * histogram.bin_width
    found: dict[Method, Bars] = {}
    for method, counts in histogram.counts.items():
        joined = _joined(np.asarray(counts, dtype=np.float64), merged)
        edges = histogram.lower_edge + width * np.arange(len(joined) + 1, dtype=np.float64)
        found[method] = Bars(edges, joined, sum(counts) / _seated(measure, method))
    return found


def _seated(measure: MeasureSummary, method: Method) -> float:
    """The share of a method's trials that were assembled."""
    sample = measure.sample(method)
    return sample.count / sample.trials if sample and sample.count and sample.trials else 1.0


def _neighbours_in_one(bars: int, total: int) -> int:
    """Number of bars to merge into one, for about 2 n^(1/3) bars (the Rice rule)."""
    wanted: float = max(FEWEST_BARS, 2 * total ** (1 / 3))
    return max(1, round(bars / wanted))


def _joined(counts: Array, merged: int) -> Array:
    """Counts of bars that are so many neighbours each."""
    padded = np.pad(counts, (0, -len(counts) % merged))
    return np.asarray(padded.reshape(-1, merged).sum(axis=1))


MOST_CONTRIBUTORS: Final = 9  # bars; the rest is shown as one
NAME_WIDTH, NAME_SIZE, NAME_LINES = 2.05, 9.0, 4  # inch, points; the longest possible names fit
LINE: Final = 0.155  # inch, of a name
BAR: Final = 0.115  # inch; least thickness of a bar that bears its number
BETWEEN: Final = 0.06  # inch, between two contributors
HEAD_AND_FOOT: Final = 1.0  # inch; title, axis and its label
LEGEND_LINE, LEGEND_WIDTH = 0.2, 3.0  # inch
FEWEST_ROWS: Final = 4  # fewer bars are no thicker than these
METHOD_WORDS: Final = {"analytic": "analytic", "geometric": "3D simulation"}


def shown_names(measure: MeasureSummary) -> tuple[list[str], list[str]]:
    """The contributors with a bar of their own, and those that share one."""
    names = ranked_contributors(measure)
    return names[:MOST_CONTRIBUTORS], names[MOST_CONTRIBUTORS:]


def labels_of(measure: MeasureSummary) -> list[str]:
    """Labels beside the bars, unshortened."""
    shown, rest = shown_names(measure)
    others = [f"{len(rest)} other{'s' if len(rest) > 1 else ''}"] if rest else []
    return [wrapped(name, NAME_WIDTH, NAME_SIZE, NAME_LINES) for name in shown] + others


def height_of_contributors(measure: MeasureSummary) -> float:
    """Height that the bars of a measure need with their names and legend [inch]; 0 without shares."""
    columns = shares_of(measure)
    if not columns:
        return 0.0
    labels = labels_of(measure)
    most_lines = max((label.count("\n") + 1 for label in labels), default=1)
    each = max(LINE * most_lines, BAR * len(columns)) + BETWEEN
    legend = sum(legend_text(column).count("\n") + 1 for column in columns)
    return HEAD_AND_FOOT + LEGEND_LINE * legend + each * len(labels)


def legend_text(column: Column) -> str:
    """Name of a column in the legend."""
    return METHOD_WORDS.get(column.method) or wrapped(column.heading, LEGEND_WIDTH, 8.5, NAME_LINES)


def draw_contributors(axes: Axes, measure: MeasureSummary, colours: Mapping[str, str]) -> None:
    """Shares of the variance, the largest first."""
    plain_axes(axes).grid(axis="y", visible=False)
    columns, labels = shares_of(measure), labels_of(measure)
    shown, rest = shown_names(measure)
    height = 0.8 / len(columns)
    for k, column in enumerate(columns):
        percents = _percents(column, shown, rest)
        values = [max(percent or 0.0, 0.0) for percent in percents]
        places = np.arange(len(values)) - 0.4 + (k + 0.5) * height
        drawn = axes.barh(
            places,
            values,
            height=0.9 * height,
            color=colours[column.heading],
            alpha=0.8,
            label=legend_text(column),
        )
        texts = ["" if percent is None else percent_text(percent) for percent in percents]
        axes.bar_label(drawn, labels=texts, fontsize=7, padding=2, color=BLACK)
    axes.set_yticks(range(len(labels)), labels, fontsize=NAME_SIZE)
    axes.tick_params(axis="y", length=0)
    axes.set_ylim(max(len(labels), FEWEST_ROWS) - 0.5, -0.5)
    axes.margins(x=0.12)
    axes.set_xlim(left=0)
    axes.set_xlabel("share of the variance [%]", fontsize=10)
    axes.set_title("contributors", loc="left", fontsize=11, fontweight="bold")
    axes.set_title(unexplained_words(measure), loc="right", fontsize=NAME_SIZE)
    legend_below(axes)


def _percents(column: Column, shown: list[str], rest: list[str]) -> list[float | None]:
    """A column's share of each bar [%]; None where it has none."""
    others = [share for name in rest if (share := column.percents.get(name)) is not None]
    return [column.percents.get(name) for name in shown] + ([sum(others) if others else None] if rest else [])
