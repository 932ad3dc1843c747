"""The picture of a sweep: of one variable curves with their bands, of two heat maps, of more a row of each."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from tol3d.analyses.sweep_table import short_names
from tol3d.analyses.variant_sweep import Sweep, measures_of
from tol3d.numerics.arrays import Array
from tol3d.report.canvas import BLACK, new_figure, plain_axes, save_figure
from tol3d.report.chart import Axis, Band, Chart, Line, Mark, Panel, Points, Series
from tol3d.report.chart_figure import charts_figure
from tol3d.report.measure_charts import spanned
from tol3d.report.number import UNIT_SIGNS

MOST_MEASURES: Final = 4
MOST_FIELDS: Final = 6
WIDTH, HEIGHT, HEAD = 4.6, 3.4, 0.5  # inch; of each of the axes, and of the title
COLOURS: Final = "viridis"
MARGIN: Final = 0.35


def draw_sweep(found: Sweep, path: Path) -> None:
    """Draw it: `path` ends in .png, .svg or .pdf.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(sweep_figure(found), path)


def sweep_figure(found: Sweep) -> Figure:
    """The picture, not yet written."""
    names, fields = list(measures_of(found))[:MOST_MEASURES], len(found.fields)
    words = f"{found.scene}   ·   {len(found.variants)} variants of {found.trials} trials"
    if names and fields == 2:
        return _maps(found, names, words)
    rows = [[over_field(found, name, field) for field in range(min(fields, MOST_FIELDS))] for name in names]
    if fields == 1:
        rows = [[chart for row in rows for chart in row]]
    if not names:
        nothing = "no variant could be built"
        rows = [[Chart(nothing, Axis("", 0.0, 1.0), (), instead=nothing)]]
    return charts_figure(rows, words, WIDTH * max(len(rows[0]), 1))


def over_field(found: Sweep, name: str, field: int) -> Chart:
    """A measure over the numbers of a field: mean and ends of each variant, of one field alone as a curve."""
    numbers, mean, low, high, _ = _numbers(found, name)
    order = np.argsort(numbers[:, field])
    at, mean, low, high = numbers[order, field], mean[order], low[order], high[order]
    if len(found.fields) == 1:
        series: list[Series] = [Band(at, low, high, "series-0"), Line(at, mean, "series-0", dots=True)]
    else:
        gaps = np.full(len(at), np.nan)
        upright = Line(np.repeat(at, 3), np.stack([low, high, gaps], axis=-1).ravel(), "soft", stroke="thin")
        series = [upright, Points(at, mean, "series-0")]
    first = next(own.measures[name] for own in found.variants if name in own.measures)
    limits = [limit for limit in (first.lower_limit, first.upper_limit) if limit is not None]
    marks = [Mark(limit, "limit", upright=False) for limit in limits]
    lost = [own.numbers[field] for own in found.variants if name not in own.measures]
    marks += [Mark(place, "guide", label="could not be built") for place in lost if len(found.fields) == 1]
    across = spanned(short_names(found.fields)[field], np.array([*at, *lost]), found.units[field])
    y = spanned(name, np.concatenate([mean, low, high, limits]), first.unit)
    alternative = f"{name} over {across.label}"
    return Chart(alternative, across, [Panel(y, series, marks, 0.8)])


def _maps(found: Sweep, names: Sequence[str], words: str) -> Figure:
    figure = new_figure(WIDTH * len(names), HEIGHT + HEAD)
    figure.suptitle(words, fontsize=11, color=BLACK, x=0.01, ha="left")
    for axes, name in zip(figure.subplots(1, len(names), squeeze=False)[0], names, strict=True):
        _map(figure, plain_axes(axes), found, name)
    return figure


def _numbers(found: Sweep, name: str) -> tuple[Array, Array, Array, Array, Array]:
    """Numbers of the fields (variants, fields), then mean, low, high and share out of limits of each."""
    built = [own for own in found.variants if name in own.measures]
    numbers = np.array([own.numbers for own in built]).reshape(len(built), len(found.fields))
    keys = ("mean", "low", "high", "out_ppm")
    columns = [np.array([own.measures[name].value(key) for own in built], dtype=np.float64) for key in keys]
    return numbers, columns[0], columns[1], columns[2], columns[3]


def _label(found: Sweep, name: str) -> str:
    unit = next(own.measures[name].unit for own in found.variants if name in own.measures)
    return f"{name} [{UNIT_SIGNS.get(unit, unit)}]"


def _field_label(found: Sweep, field: int) -> str:
    unit = found.units[field]
    return short_names(found.fields)[field] + (f" [{UNIT_SIGNS.get(unit, unit)}]" if unit else "")


def _map(figure: Figure, axes: Axes, found: Sweep, name: str) -> None:
    """The share out of limits over both fields; Ppk where none is out, the mean where there are no limits."""
    numbers, mean, _, _, out = _numbers(found, name)
    built = [own.measures[name] for own in found.variants if name in own.measures]
    values, words = mean, f"mean of {_label(found, name)}"
    if any((own.lower_limit, own.upper_limit) != (None, None) for own in built):
        values, words = out / 1e4, f"{name}: out of limits [%]"
        if not np.nanmax(out, initial=0.0) > 0.0:
            values, words = np.array([own.ppk for own in built], dtype=np.float64), f"{name}: Ppk"
    across, up = (np.unique([own.numbers[k] for own in found.variants]) for k in range(2))
    if len(across) * len(up) == len(found.variants) and len(across) > 1 and len(up) > 1:
        grid = np.full((len(up), len(across)), np.nan)
        grid[np.searchsorted(up, numbers[:, 1]), np.searchsorted(across, numbers[:, 0])] = values
        image: ScalarMappable = axes.pcolormesh(_edges(across), _edges(up), grid, cmap=COLOURS)
        _write(axes, across, up, grid)
    else:
        image = axes.scatter(numbers[:, 0], numbers[:, 1], c=values, cmap=COLOURS, s=40)
    bar = figure.colorbar(image, ax=axes)
    bar.ax.tick_params(labelsize=8)
    axes.set_title(words, fontsize=9, color=BLACK, loc="left")
    axes.set_xlabel(_field_label(found, 0), fontsize=9)
    axes.set_ylabel(_field_label(found, 1), fontsize=9)


def _write(axes: Axes, across: Array, up: Array, grid: Array) -> None:
    """Values in the cells of a small map."""
    if grid.size > 64:
        return
    middle = (np.nanmin(grid) + np.nanmax(grid)) / 2
    for (row, column), value in np.ndenumerate(grid):
        text = "–" if np.isnan(value) else f"{value:.3g}"
        colour = BLACK if np.isnan(value) or value > middle else "white"
        axes.text(float(across[column]), float(up[row]), text, ha="center", va="center", fontsize=7.5, color=colour)


def _edges(values: Array) -> Array:
    middles = (values[1:] + values[:-1]) / 2
    return np.concatenate([[1.5 * values[0] - 0.5 * values[1]], middles, [1.5 * values[-1] - 0.5 * values[-2]]])
