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
from tol3d.report.canvas import BLACK, BLUE, GREY, VERMILLION, new_figure, plain_axes, save_figure, say_instead
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
    names = list(measures_of(found))[:MOST_MEASURES]
    fields = len(found.fields)
    columns = min(fields, MOST_FIELDS) if fields > 2 else max(len(names), 1)
    rows = max(len(names), 1) if fields > 2 else 1
    figure = new_figure(WIDTH * columns, HEIGHT * rows + HEAD)
    words = f"{found.scene}   ·   {len(found.variants)} variants of {found.trials} trials"
    figure.suptitle(words, fontsize=11, color=BLACK, x=0.01, ha="left")
    axes = figure.subplots(rows, columns, squeeze=False)
    if not names:
        say_instead(plain_axes(axes[0, 0]), "no variant could be built", VERMILLION)
    for k, name in enumerate(names):
        if fields == 1:
            _curve(plain_axes(axes[0, k]), found, name)
        elif fields == 2:
            _map(figure, plain_axes(axes[0, k]), found, name)
        else:
            for field in range(columns):
                _scatter(plain_axes(axes[k, field]), found, name, field)
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


def _limits(axes: Axes, found: Sweep, name: str) -> None:
    for own in found.variants:
        if name in own.measures:
            for limit in (own.measures[name].lower_limit, own.measures[name].upper_limit):
                if limit is not None:
                    axes.axhline(limit, color=VERMILLION, linewidth=1.0, linestyle="--")
            return


def _curve(axes: Axes, found: Sweep, name: str) -> None:
    numbers, mean, low, high, _ = _numbers(found, name)
    order = np.argsort(numbers[:, 0])
    at = numbers[order, 0]
    axes.fill_between(at, low[order], high[order], color=BLUE, alpha=0.2, linewidth=0.0)
    axes.plot(at, mean[order], color=BLUE, marker="o", markersize=3.5, linewidth=1.4)
    _limits(axes, found, name)
    _marks(axes, found, name)
    axes.set_xlabel(_field_label(found, 0), fontsize=9)
    axes.set_ylabel(_label(found, name), fontsize=9)


def _marks(axes: Axes, found: Sweep, name: str) -> None:
    """Mark variants that could not be built."""
    for own in found.variants:
        if name not in own.measures:
            axes.axvline(own.numbers[0], color=GREY, linewidth=1.0, linestyle=":")


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


def _scatter(axes: Axes, found: Sweep, name: str, field: int) -> None:
    numbers, mean, low, high, _ = _numbers(found, name)
    bars: Sequence[Array] = (np.maximum(mean - low, 0.0), np.maximum(high - mean, 0.0))
    if np.isfinite(mean).all():
        axes.errorbar(
            numbers[:, field], mean, yerr=bars, fmt="o", color=BLUE, ecolor=GREY, markersize=3.5, linewidth=0.8
        )
    else:
        axes.vlines(numbers[:, field], low, high, color=BLUE, linewidth=1.0)
    _limits(axes, found, name)
    axes.set_xlabel(_field_label(found, field), fontsize=9)
    axes.set_ylabel(_label(found, name), fontsize=9)
