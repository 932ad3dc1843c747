"""The matrix of contributors and measures as a picture: which tolerance matters where."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from tol3d.numerics.arrays import Array
from tol3d.report.canvas import BLACK, new_figure, save_figure
from tol3d.report.column import shares_of
from tol3d.report.heading import WORST_FIRST, largest, shown_measures
from tol3d.report.label import text_width, wrapped
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.run import RunSummary

MOST_COLUMNS: Final = 40  # measures
MOST_ROWS: Final = 50  # contributors; the others share a row
ROW, COLUMN = 0.22, 0.32  # inch
NAME_SIZE, CELL_SIZE, HEAD_SIZE = 8.0, 6.5, 11.0  # points
NAME_WIDTH: Final = 2.6  # inch; longer names are cut
LINE, GAP = 0.2, 0.1  # inch; a line of the head, and between a name and its row
BAR: Final = 0.9  # inch; of the scale of colours, with its numbers
LEAST_WIDTH: Final = 7.0  # inch; of a picture, for its head
LEAST_WRITTEN: Final = 0.95  # %; smaller shares have no number
DARK: Final = 0.62  # of the largest share; numbers are white above it
COLOURS: Final = "Blues"


def draw_heat_map(summary: RunSummary, path: Path) -> None:
    """Draw the shares of the largest contributors in the worst measures.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(heat_map_figure(summary), path)


def of_scalars(summary: RunSummary) -> dict[str, MeasureSummary]:
    """The measures whose shares of the variance are known."""
    return {name: own for name, own in summary.measures.items() if own.take != "curve" and shares_of(own)}


def heat_map_figure(summary: RunSummary) -> Figure:
    """A row a contributor, a column a measure, each share [%] as a colour and a number; not yet written."""
    every = of_scalars(summary)
    names = shown_measures(every, MOST_COLUMNS)
    percents = {name: percents_of(every[name]) for name in names}
    acting = list(dict.fromkeys(contributor for own in percents.values() for contributor in own))
    sums = {contributor: sum(own.get(contributor, 0.0) for own in percents.values()) for contributor in acting}
    ranked = sorted(acting, key=lambda contributor: -sums[contributor])
    shown = largest(ranked, sums, MOST_ROWS)
    shares = np.array([[percents[name].get(contributor, np.nan) for name in names] for contributor in shown])
    rest = ranked[len(shown) :]
    others = [sum(percents[name].get(contributor, 0.0) for contributor in rest) for name in names]
    head = [f"{summary.scene}   ·   share of the variance [%], {_methods(every)}"]
    if len(names) < len(every):
        head.append(f"the {len(names)} worst of {len(every)} measures {WORST_FIRST}")
    if rest:
        head.append(f"the {len(shown)} largest of {len(acting)} contributors; all in contributors.csv")
    if not rest:
        return matrix_figure(shares, shown, names, head)
    return matrix_figure(np.vstack([shares, others]), [*shown, f"{len(rest)} others"], names, head, coloured=len(shown))


def percents_of(measure: MeasureSummary) -> Mapping[str, float]:
    """Share of each contributor by the best method that knows it [%]."""
    columns = [column for column in shares_of(measure) if column.method != "published"]
    own = next((column for column in columns if column.method == measure.best_method), columns[0])
    return {name: share for name, share in own.percents.items() if share is not None}


def _methods(measures: Mapping[str, MeasureSummary]) -> str:
    methods = {measure.best_method for measure in measures.values()}
    return "3D simulation" if methods == {"geometric"} else "analytic"


def matrix_figure(
    shares: Array, rows: Sequence[str], columns: Sequence[str], head: Sequence[str], coloured: int | None = None
) -> Figure:
    """Shares (rows, columns) as they are named, the first `coloured` rows with colours, all by default."""
    labels = [wrapped(name, NAME_WIDTH, NAME_SIZE, 1) for name in rows]
    across = [wrapped(name, NAME_WIDTH, NAME_SIZE, 1) for name in columns]
    left = GAP + max(text_width(label, NAME_SIZE, "normal") for label in labels) + GAP
    above = GAP + LINE * len(head) + GAP + max(text_width(label, NAME_SIZE, "normal") for label in across) + GAP
    wide, high = COLUMN * len(columns), ROW * len(rows)
    width, height = max(left + wide + BAR, LEAST_WIDTH), above + high + 2 * GAP
    figure = new_figure(width, height)
    figure.set_layout_engine("none")
    axes = figure.add_axes((left / width, 2 * GAP / height, wide / width, high / height))
    colours = np.where(np.arange(len(rows))[:, None] < (coloured or len(rows)), shares, 0.0)
    most = max(float(np.nanmax(colours, initial=0.0)), LEAST_WRITTEN)
    image = axes.imshow(colours, aspect="auto", cmap=COLOURS, vmin=0.0, vmax=most)
    axes.set_yticks(range(len(rows)), labels, fontsize=NAME_SIZE)
    axes.set_xticks(range(len(columns)), across, fontsize=NAME_SIZE, rotation=90)
    axes.tick_params(length=0, labeltop=True, labelbottom=False)
    for (row, column), share in np.ndenumerate(shares):
        if share >= LEAST_WRITTEN:
            colour = "white" if colours[row, column] > DARK * most else BLACK
            axes.text(column, row, f"{share:.0f}", ha="center", va="center", fontsize=CELL_SIZE, color=colour)
    bar = figure.add_axes(((left + wide + 2 * GAP) / width, 2 * GAP / height, GAP / width, min(high, 3.0) / height))
    figure.colorbar(image, cax=bar).ax.tick_params(labelsize=NAME_SIZE)
    for number, words in enumerate(head):
        size, weight = (HEAD_SIZE, "bold") if number == 0 else (NAME_SIZE, "normal")
        text = wrapped(words, width - 2 * GAP, size, 1, weight)
        place = (GAP / width, 1 - (GAP + LINE * number) / height)
        figure.text(*place, text, fontsize=size, fontweight=weight, color=BLACK, va="top")
    return figure
