"""A measure over its positions: mean, ±3 sigma and extremes."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes

from tol3d.numerics.arrays import Array
from tol3d.report.canvas import GREY, METHOD_COLOURS, ORANGE, OUTSIDE, PUBLISHED_COLOURS, label_angles, say_instead
from tol3d.report.distribution import NO_VALUES, values_label
from tol3d.report.heading import position_of
from tol3d.report.label import legible
from tol3d.report.number import limit_text
from tol3d.runs.summary.measure import MeasureSummary

TURN: Final = 360.0  # deg; from two turns on the axis counts turns
BAND: Final = 0.28  # opacity
FEW_JUMPS: Final = 4  # more are not named one by one


class Stepped:
    """Curves over positions with both their values at the positions between at which they jump.

    `x` are the positions in the unit of the axis, those of jumps twice; `jumps` those of the jumps [deg].
    """

    def __init__(self, measure: MeasureSummary) -> None:
        x: Array = np.asarray(measure.position_deg, dtype=float)
        self.jumps = [jump for jump in measure.jumps_deg if x[0] < jump < x[-1]]
        self._positions = x
        doubled = np.insert(x, np.repeat(np.searchsorted(x, self.jumps), 2), np.repeat(self.jumps, 2))
        self.x: Array = doubled / per_unit(measure)

    def __call__(self, values: Sequence[float | None] | Array) -> Array:
        """Values at the positions, at each jump the one before it and the one after it."""
        known = np.asarray(values, dtype=float)
        after = np.searchsorted(self._positions, self.jumps)
        both = np.stack([known[after - 1], known[after]], axis=-1).ravel()
        return np.insert(known, np.repeat(after, 2), both)


def draw_curve(axes: Axes, name: str, measure: MeasureSummary) -> None:
    """Mean and ±3 sigma of the 3D simulation as line and band, its extremes as thin lines, and the analytic mean.

    A band and lines: two bands would change places where the trials do not reach to ±3 sigma.
    """
    unit, leading, stepped = measure.unit, measure.best_method, Stepped(measure)
    own, analytic = measure.curve_sample(leading), measure.curve_sample("analytic")
    if own is None:
        return
    x, mean, sigma = stepped.x, stepped(own.mean), stepped(own.sigma)
    word = "3D simulation" if leading == "geometric" else "analytic"
    colour = METHOD_COLOURS[leading]
    marker = "." if measure.jumps else None  # from one position to the next: the line between them is no value
    axes.plot(x, mean, color=colour, linewidth=2, marker=marker, markersize=7, label=f"{word}, mean")
    low, high = mean - 3 * sigma, mean + 3 * sigma
    axes.fill_between(x, low, high, color=colour, alpha=BAND, linewidth=0, label=f"{word}, ±3 sigma")
    for values, text in ((own.min, f"{word}, smallest and largest"), (own.max, None)):
        axes.plot(x, stepped(values), color=colour, linewidth=1.0, linestyle=(0, (1, 1)), label=text)
    if leading != "analytic" and analytic:
        axes.plot(x, stepped(analytic.mean), color=ORANGE, linewidth=1.8, linestyle="--", label="analytic, mean")
    _draw_published(axes, measure)
    _mark_jumps(axes, measure, stepped.jumps)
    for limit, limit_word in zip(measure.limits, ("LSL", "USL"), strict=True):
        if limit is not None:
            text = f"{limit_word} {limit_text(limit, unit)}"
            axes.axhline(limit, color=OUTSIDE, linewidth=2, label=text)
    axes.set_xlim(x[0], x[-1] if x[-1] > x[0] else x[0] + 1.0)
    axes.set_xlabel(position_label(measure), fontsize=10)
    axes.set_ylabel(values_label(name, unit, 34), fontsize=10)
    label_angles(axes.yaxis, unit)
    if np.isnan(mean).all():
        say_instead(axes, NO_VALUES, OUTSIDE)
    axes.legend(fontsize=8.5, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))


def _draw_published(axes: Axes, measure: MeasureSummary) -> None:
    """Means that others published, as marks at their own positions."""
    drawn = 0
    for name, own in measure.published.items():
        curve = own.get("curve")
        if curve is not None and "mean" in curve and "position_deg" in own:
            x = np.asarray(own["position_deg"]) / per_unit(measure)
            colour = PUBLISHED_COLOURS[drawn % len(PUBLISHED_COLOURS)]
            axes.plot(x, curve["mean"], "D", color=colour, markersize=5, label=f"{legible(name, 30)}, mean")
            drawn += 1


def position_label(measure: MeasureSummary) -> str:
    """Label of an axis of a curve's positions."""
    return f"{position_of(measure)} position [{'deg' if per_unit(measure) == 1.0 else 'turns'}]"


def per_unit(measure: MeasureSummary) -> float:
    """Degrees in one unit of the axis."""
    return TURN if measure.position_deg and measure.position_deg[-1] > 2 * TURN else 1.0


def _mark_jumps(axes: Axes, measure: MeasureSummary, jumps: Sequence[float]) -> None:
    places = ", ".join(f"{jump:.1f}°" for jump in jumps)
    text = f"{measure.jump_words} at {places}" if len(jumps) <= FEW_JUMPS else measure.jump_words
    for index, jump in enumerate(jumps):
        label = None if index else text
        axes.axvline(jump / per_unit(measure), color=GREY, linewidth=1.2, linestyle=":", label=label)
