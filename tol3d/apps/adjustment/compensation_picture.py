"""The picture of a motor's compensation: the remaining error at a random position, and the tip over the swing."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from tol3d.apps.adjustment.compensation import Compensation, Swing, Unit
from tol3d.apps.adjustment.compensation_table import COLUMN_WORDS, STATE_WORDS, TOLD_OF_TIPS, Spread
from tol3d.apps.adjustment.robots import STATES, State
from tol3d.numerics.arrays import Array
from tol3d.report import charts_figure, given_text, save_figure, short_text, tip_mm
from tol3d.report.bars import Bars
from tol3d.report.chart import Axis, Band, Chart, Filled, Line, Mark, Panel, Points, Role, Series, Sign, Stroke

SIGNS: Final[Mapping[str, Sign]] = {"mean": "diamond", "low_3sigma": "left", "high_3sigma": "right"}
ROLES: Final[Mapping[State, Role]] = {"before": "series-5", "batch": "series-0", "robot": "series-2"}
BINS: Final = 90  # over what all scenes and states span together
WIDTH: Final = 14.0  # inch
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
    rows = []
    for own in found:
        unit = own.units[0]
        remaining = remaining_chart(own, unit, _edges([each for each in found if each.units[0] == unit], unit))
        rows.append([remaining, *([swing_chart(own, _swing_span(found))] if swings else [])])
    head = "motor compensation when the load changes side"
    return charts_figure(rows, head, WIDTH, (1.15, 1.0) if swings else ())


def _edges(found: Sequence[Compensation], unit: Unit) -> Array:
    """Edges of bins that hold every value, zero and the sums of highs of the scenes."""
    values = [own.remaining[own.method].in_unit(unit)[state] for own in found for state in STATES]
    marks = [mark.value for own in found for mark in _highs(own, unit)]
    every = np.concatenate([*values, np.array([0.0, *marks])])
    low, high = float(every.min()), float(every.max())
    margin = MARGIN * (high - low) or 1e-3
    return np.linspace(low - margin, high + margin, BINS + 1)


# at a random position -----------------------------------------------------------------------------


def remaining_chart(compensation: Compensation, unit: Unit, edges: Array) -> Chart:
    """Histograms of the remaining error in each state, the sums of highs, and published errors."""
    words = (
        f"{compensation.robots - compensation.failed} robots at a random position, {COLUMN_WORDS[compensation.method]}"
    )
    across = Axis(_label(compensation, unit), float(edges[0]), float(edges[-1]), unit)
    alternative = f"remaining error of {compensation.name}"
    bars = [*_samples(compensation, unit, edges)]
    if not bars:
        return Chart(alternative, across, (), compensation.name, words, instead="no robot could be assembled")
    top = 1.05 * max(float(bar.heights.max()) for bar in bars)
    y = Axis(f"% of robots per {short_text(float(edges[1] - edges[0]), unit)}", 0.0, top)
    marks = [Mark(0.0, "guide", role="soft"), *_highs(compensation, unit)]
    table = [(label, text) for bar in bars for label, _, text in [bar.label.partition(": ")]]
    return Chart(
        alternative,
        across,
        [Panel(y, [*bars, *_published(compensation, unit)], marks)],
        compensation.name,
        words,
        table,
    )


def _samples(compensation: Compensation, unit: Unit, edges: Array) -> Iterator[Filled]:
    """Remaining error in each state; nothing if no robot could be assembled."""
    values = compensation.remaining[compensation.method].in_unit(unit)
    for state in STATES:
        if len(values[state]):
            heights = float(edges[1] - edges[0]) * Bars.of(values[state], edges).density
            label = f"{STATE_WORDS[state]}: {_ends_text(Spread(values[state]), unit)}"
            yield Filled(edges, heights, ROLES[state], label)


def _ends_text(spread: Spread, unit: Unit) -> str:
    return (
        f"{short_text(spread.moments.mean, unit)}, ±3σ {short_text(spread.low, unit)} … {short_text(spread.high, unit)}"
    )


def _highs(compensation: Compensation, unit: Unit) -> Iterator[Mark]:
    """The sums of the stages' highs by the leading method."""
    correction = compensation.corrections[compensation.method]
    cases: tuple[tuple[str, float | None, State], ...] = (
        ("sum of highs", correction.before, "before"),
        ("sum of highs, compensated", correction.left, "batch"),
    )
    for label, arcmin, state in cases:
        value = tip_mm(arcmin, compensation.lever) if unit == "mm" else arcmin
        if value is not None:
            yield Mark(value, "guide", label=f"{label}: {short_text(value, unit)}", role=ROLES[state])


def _published(compensation: Compensation, unit: Unit) -> Iterator[Points]:
    """Published displacements of the tip without compensation."""
    for column, values in compensation.play.published_tips.items():
        for key, word in TOLD_OF_TIPS.items():
            if unit == "mm" and values.get(key) is not None:
                label = f"{column}, {word}: {given_text(values[key], unit)} mm"
                yield Points(np.array([values[key]]), np.zeros(1), "published-1", label, SIGNS[key])


def _label(compensation: Compensation, unit: Unit) -> str:
    if compensation.play.tip and compensation.play.tip.tip and unit == "mm":
        return f"error of {compensation.play.tip.tip.point} of {compensation.play.tip.tip.arm}"
    return f"error of {compensation.play.shaft}"


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


def swing_chart(compensation: Compensation, span: tuple[float, float]) -> Chart:
    """Mean and ±3 sigma of the robots over the swing, in each state."""
    label = "output position"
    if compensation.swing is None:
        instead = "no tip error over a swing in which the load changes side"
        return Chart(
            f"{compensation.name} over its swing", Axis(label, 0.0, 1.0, "deg"), (), compensation.name, instead=instead
        )
    bands, lines = list[Series](), list[Series]()
    for state in STATES:
        mean, low, high = _band(compensation.swing.curves[compensation.method][state])
        for first, last in _stretches(compensation.swing):
            x = np.degrees(_reaching_the_jumps(compensation.swing, first, last))
            lower, middle, upper = (_held(compensation.swing, ends, first, last) for ends in (low, mean, high))
            bands.append(Band(x, lower, upper, ROLES[state]))
            stroke: Stroke = "dashed" if state == "robot" else "solid"  # it may lie on the batch's
            lines.append(Line(x, middle, ROLES[state], STATE_WORDS[state] if first == 0 else "", stroke))
    marks = [
        Mark(angle, "guide", label=f"the load changes side, {angle:.1f}°")
        for angle in np.degrees(compensation.swing.jumps)
    ]
    words = f"{compensation.swing.measure}: mean and ±3 sigma of the robots, {COLUMN_WORDS[compensation.method]}"
    ends = np.degrees(compensation.swing.output[[0, -1]])
    y = Axis(_label(compensation, "mm"), *span, "mm")
    across = Axis(label, float(ends[0]), float(ends[1]), "deg")
    return Chart(
        f"{compensation.name} over its swing", across, [Panel(y, [*bands, *lines], marks)], compensation.name, words
    )


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
