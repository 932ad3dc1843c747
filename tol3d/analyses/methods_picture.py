"""Methods side by side as a picture: bars of the intervals by method over each measure's limits."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

from tol3d.analyses.methods_section import MeasureMethods, Methods
from tol3d.analyses.methods_table import intervals_of
from tol3d.report.canvas import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY
from tol3d.report.interval_bars import Interval, Intervals, draw_intervals
from tol3d.report.number import limit_text

MOST: Final = 12
"""Measures in one picture."""
COLOURS: Final[Mapping[str, str]] = {
    "worst found": BLACK,
    "worst by slopes": GREY,
    "modified RSS": ORANGE,
    "RSS": SKY,
    "simulation, ±3 sigma": BLUE,
    "simulation, 0.135 % and 99.865 %": GREEN,
    "least and largest trial": GREY,
}


def draw_methods(found: Methods, path: Path) -> None:
    """Draw the measures that use most of their limits, MOST at most.

    Raises:
        InputError: the picture cannot be written there.
    """
    most = sorted(found.measures, key=lambda name: -_used(found.measures[name]))[:MOST]
    draw_intervals([_intervals(name, own, found.scene) for name, own in found.measures.items() if name in most], path)


def _intervals(name: str, own: MeasureMethods, scene: str) -> Intervals:
    limits = [limit for limit in (own.lower_limit, own.upper_limit) if limit is not None]
    told = f"limits {' and '.join(limit_text(limit, own.unit) for limit in limits)}" if limits else "no limits"
    return Intervals(
        name=name,
        words=f"{scene}; {told}; dotted: the mean build",
        unit=own.unit,
        bars=[Interval(words, low, high, COLOURS.get(words, PURPLE)) for words, low, high in intervals_of(own)],
        limits=limits,
        middle=own.mean,
    )


def _used(own: MeasureMethods) -> float:
    """3 sigma of the simulation over the distance to the nearest limit; 0 without limits."""
    low, high, mean = own.simulation.low_3sigma, own.simulation.high_3sigma, own.simulation.mean
    if low is None or high is None or mean is None:
        return 0.0
    half = (high - low) / 2
    margins = [] if own.lower_limit is None else [mean - own.lower_limit]
    margins += [] if own.upper_limit is None else [own.upper_limit - mean]
    return max((half / margin if margin > 0.0 else float("inf") for margin in margins), default=0.0)
