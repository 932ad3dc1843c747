"""A measure over the positions of a driver or an output: mean, ±3 sigma and extremes."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from tol3d.report.canvas import GREY, ORANGE, OUTSIDE, ROAD_COLOURS, label_angles, say_instead
from tol3d.report.column import best_road
from tol3d.report.distribution import NO_VALUES, values_label
from tol3d.report.heading import position_of
from tol3d.report.number import given_text, unit_suffix

Summary = Any  # typed, read by text
Array = NDArray[np.float64]

TURN: Final = 360.0  # deg; from two turns on the axis counts turns
MARKERS: Final = {"tip_error": "."}  # it jumps from one position to the next: the line between them is no value
BAND: Final = 0.28  # opacity
FEW_CHANGES: Final = 4  # of the load's side; more are not told one by one


class Stepped:
    """Curves over positions with both their values at the positions between at which they jump.

    `x` are the positions in the unit of the axis, those of jumps twice; `changes` those of the jumps [deg].
    """

    def __init__(self, measure: Summary) -> None:
        x: Array = np.asarray(measure["position_deg"], dtype=float)
        self.changes = [change for change in measure.get("load_changes_deg") or [] if x[0] < change < x[-1]]
        self._positions = x
        doubled = np.insert(x, np.repeat(np.searchsorted(x, self.changes), 2), np.repeat(self.changes, 2))
        self.x: Array = doubled / per_unit(measure)

    def __call__(self, values: Sequence[float] | Array) -> Array:
        """Values at the positions, in front of each jump the one before it and behind it the one after it."""
        known = np.asarray(values, dtype=float)
        after = np.searchsorted(self._positions, self.changes)
        both = np.stack([known[after - 1], known[after]], axis=-1).ravel()
        return np.insert(known, np.repeat(after, 2), both)


def draw_curve(axes: Axes, name: str, measure: Summary) -> None:
    """Mean and ±3 sigma of the 3D simulation as line and band, its extremes as thin lines, and the analytic mean.

    A band and lines: two bands would change places where the trials do not reach to ±3 sigma.
    """
    unit, curve = measure["unit"], measure["curve"]
    leading = best_road(measure)
    stepped = Stepped(measure)
    own = {key: stepped(values) for key, values in curve[leading].items() if key in ("mean", "sigma", "min", "max")}
    x, mean, sigma = stepped.x, own["mean"], own["sigma"]
    word = "3D simulation" if leading == "geometric" else "analytic"
    colour = ROAD_COLOURS[leading]
    marker = MARKERS.get(measure["kind"])
    axes.plot(x, mean, color=colour, linewidth=2, marker=marker, markersize=7, label=f"{word}, mean")
    band: dict[str, Any] = {"color": colour, "alpha": BAND, "linewidth": 0}
    axes.fill_between(x, mean - 3 * sigma, mean + 3 * sigma, label=f"{word}, ±3 sigma", **band)
    for values, text in ((own["min"], f"{word}, smallest and largest"), (own["max"], None)):
        axes.plot(x, values, color=colour, linewidth=1.0, linestyle=(0, (1, 1)), label=text)
    if leading != "analytic":
        analytic = stepped(curve["analytic"]["mean"])
        axes.plot(x, analytic, color=ORANGE, linewidth=1.8, linestyle="--", label="analytic, mean")
    _mark_changes(axes, measure, stepped.changes)
    for key, limit_word in (("lower_limit", "LSL"), ("upper_limit", "USL")):
        if measure.get(key) is not None:
            text = f"{limit_word} {given_text(measure[key], unit)}{unit_suffix(unit)}"
            axes.axhline(measure[key], color=OUTSIDE, linewidth=2, label=text)
    axes.set_xlim(x[0], x[-1] if x[-1] > x[0] else x[0] + 1.0)
    axes.set_xlabel(position_label(measure), fontsize=10)
    axes.set_ylabel(values_label(name, unit, 34), fontsize=10)
    label_angles(axes.yaxis, unit)
    if np.isnan(mean).all():
        say_instead(axes, NO_VALUES, OUTSIDE)
    axes.legend(fontsize=8.5, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))


def position_label(measure: Summary) -> str:
    """Label of an axis of a curve's positions."""
    return f"{position_of(measure)} position [{'deg' if per_unit(measure) == 1.0 else 'turns'}]"


def per_unit(measure: Summary) -> float:
    """Degrees in one unit of the axis."""
    return TURN if measure["position_deg"] and measure["position_deg"][-1] > 2 * TURN else 1.0


def _mark_changes(axes: Axes, measure: Summary, changes: Sequence[float]) -> None:
    told = ", ".join(f"{change:.1f}°" for change in changes)
    text = f"the load changes sides at {told}" if len(changes) <= FEW_CHANGES else "the load changes sides"
    for index, change in enumerate(changes):
        label = None if index else text
        axes.axvline(change / per_unit(measure), color=GREY, linewidth=1.2, linestyle=":", label=label)
