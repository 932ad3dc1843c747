"""Charts of a sweep: of one field curves with their bands, of two over a grid heat maps, of more a row of each."""

from typing import Final

import numpy as np

from tol3d.analyses.sweep_table import short_names
from tol3d.analyses.variant_sweep import Sweep, measures_of
from tol3d.numerics.arrays import Array
from tol3d.report.chart import Axis, Band, Chart, Charts, Field, Line, Mark, Panel, Points, Series
from tol3d.report.measure_charts import spanned
from tol3d.report.number import UNIT_SIGNS

MOST_MEASURES: Final = 4
MOST_FIELDS: Final = 6
WIDTH: Final = 4.6  # inch, of each chart


def sweep_charts(found: Sweep) -> Charts:
    """The charts of all its measures, MOST_MEASURES at most."""
    names, fields = list(measures_of(found))[:MOST_MEASURES], len(found.fields)
    words = f"{found.scene}   ·   {len(found.variants)} variants of {found.trials} trials"
    rows = [[over_field(found, name, field) for field in range(min(fields, MOST_FIELDS))] for name in names]
    if fields == 1:
        rows = [[chart for row in rows for chart in row]]
    if names and fields == 2 and all(_is_grid(found, name) for name in names):
        rows = [[over_both(found, name) for name in names]]
    if not names:
        nothing = "no variant could be built"
        rows = [[Chart(nothing, Axis("", 0.0, 1.0), (), instead=nothing)]]
    return Charts(rows, words, WIDTH * max(len(rows[0]), 1))


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
    first = next(variant.measures[name] for variant in found.variants if name in variant.measures)
    limits = [limit for limit in (first.lower_limit, first.upper_limit) if limit is not None]
    marks = [Mark(limit, "limit", upright=False) for limit in limits]
    lost = [variant.numbers[field] for variant in found.variants if name not in variant.measures]
    marks += [Mark(place, "guide", label="could not be built") for place in lost if len(found.fields) == 1]
    across = spanned(short_names(found.fields)[field], np.array([*at, *lost]), found.units[field])
    y = spanned(name, np.concatenate([mean, low, high, limits]), first.unit)
    alternative = f"{name} over {across.label}"
    return Chart(alternative, across, [Panel(y, series, marks, 0.8)])


def _numbers(found: Sweep, name: str) -> tuple[Array, Array, Array, Array, Array]:
    """Numbers of the fields (variants, fields), then mean, low, high and share out of limits of each."""
    built = [variant for variant in found.variants if name in variant.measures]
    numbers = np.array([own.numbers for own in built]).reshape(len(built), len(found.fields))
    keys = ("mean", "low", "high", "out_ppm")
    columns = [np.array([own.measures[name].value(key) for own in built], dtype=np.float64) for key in keys]
    return numbers, columns[0], columns[1], columns[2], columns[3]


def _is_grid(found: Sweep, name: str) -> bool:
    """True where two fields have each number of one with each of the other."""
    across, up = (np.unique([variant.numbers[k] for variant in found.variants]) for k in range(2))
    return len(across) * len(up) == len(found.variants) and len(across) > 1 and len(up) > 1


def over_both(found: Sweep, name: str) -> Chart:
    """A measure over the numbers of two fields: share out of limits, Ppk where none is, mean without limits."""
    numbers, mean, _, _, out = _numbers(found, name)
    built = [variant.measures[name] for variant in found.variants if name in variant.measures]
    unit = UNIT_SIGNS.get(built[0].unit, built[0].unit)
    values, words = mean, f"mean of {name} [{unit}]"
    if any((own.lower_limit, own.upper_limit) != (None, None) for own in built):
        values, words = out / 1e4, f"{name}: out of limits [%]"
        if not np.nanmax(out, initial=0.0) > 0.0:
            values, words = np.array([own.ppk for own in built], dtype=np.float64), f"{name}: Ppk"
    places = [np.unique([variant.numbers[k] for variant in found.variants]) for k in range(2)]
    grid = np.full((len(places[1]), len(places[0])), np.nan)
    grid[np.searchsorted(places[1], numbers[:, 1]), np.searchsorted(places[0], numbers[:, 0])] = values
    field = Field(places[0], places[1], grid, words)
    x, y = (
        Axis(label, float(edges[0]), float(edges[-1]), unit)
        for label, edges, unit in zip(
            short_names(found.fields),
            (field.edges(upright=False), field.edges(upright=True)),
            found.units,
            strict=True,
        )
    )
    return Chart(f"{words} over {x.label} and {y.label}", x, [Panel(y, [field], height=0.9)])
