"""Charts of a measure's summary: its histogram, or its curve over positions."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.report.bars import Bars, bars_of
from tol3d.report.chart import (
    PUBLISHED,
    Axis,
    Band,
    Chart,
    Filled,
    Line,
    Mark,
    Names,
    Outline,
    Panel,
    Points,
    Range,
    Role,
    Series,
)
from tol3d.report.column import QUANTILES_MEAN, Column, Ends, columns_of, is_bounded, seated_text
from tol3d.report.heading import heading, position_of
from tol3d.report.number import UNIT_SIGNS, limit_text, measured_text, share_text, short_text
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.sample import LimitShares
from tol3d.study.runs.summary.values import Section

SIGMAS_SHOWN: Final = 3.6  # of the mean; a little more than the +-3 sigma that are marked
LIMIT_REACH: Final = 0.6  # of the shown span; a limit further off is named at the edge, not drawn to scale
NORMAL_POINTS: Final = 121
ROOM: Final = 1.05  # height of an axis over that of its highest bar
MOST_ROOM: Final = 1.5  # the same where a closed form is higher; one of a far smaller sigma is cut
NO_VALUES: Final = "no trial gave a value"
METHOD_WORDS: Final = {"analytic": "analytic", "geometric": "3D simulation", "closed form": "closed form"}
TURN: Final = 360.0  # deg; from two turns on the axis counts turns
FEW_JUMPS: Final = 4  # more are not named one by one
OUT_OF_LIMITS: Final = "out of limits"
SEATED: Final = "; 3D simulation "  # before the number of trials in a histogram, if some failed


def chart_of(name: str, measure: MeasureSummary, roles: Mapping[str, Role] | None = None) -> Chart:
    """Histogram of a measure of one number a trial, or its curve over positions."""
    return curve(name, measure) if measure.take == "curve" else histogram(name, measure, roles)


# distributions ------------------------------------------------------------------------------------


def histogram(name: str, measure: MeasureSummary, roles: Mapping[str, Role] | None = None) -> Chart:
    """Both methods' histograms over each other with limits, mean and ends, and a row with the range of each column.

    Args:
        name: of the measure.
        measure: of one number a trial.
        roles: of columns by their headings; default: `column_roles` of its own.
    """
    bars, leading, unit, alternative = bars_of(measure), measure.best_method, measure.unit, f"histogram of {name}"
    if not bars:
        return Chart(alternative, Axis(name, 0.0, 1.0, unit), (), name, _words(measure), instead=NO_VALUES)
    roles = roles or column_roles(columns_of(measure))
    published = {
        heading: _published_bars(own["histogram"], own.value("trials"))
        for heading, own in measure.published.items()
        if "histogram" in own
    }
    outlines = [("analytic", bars["analytic"], METHOD_WORDS["analytic"])] if leading != "analytic" else []
    series: list[Series] = [_filled(bars[leading], measure)]
    series += [Outline(own.edges, own.density, roles_of_method(role), label) for role, own, label in outlines]
    span = shown_span(measure, [*bars.values(), *published.values()])
    if (form := measure.analytic_closed_form) and form.sigma:
        x = np.linspace(*span, NORMAL_POINTS)
        normal = 100 * np.exp(-(((x - form.mean) / form.sigma) ** 2) / 2) / (form.sigma * math.sqrt(2 * math.pi))
        series.append(Line(x, normal, "closed-form", METHOD_WORDS["closed form"], "dashed"))
    series += [Outline(own.edges, own.density, roles[heading]) for heading, own in published.items()]
    peak = max(float(own.density.max()) for own in (*bars.values(), *published.values()))
    peak = max([peak, *(min(float(own.y.max()), MOST_ROOM * peak) for own in series if isinstance(own, Line))])
    ends, limits = [*_ends(measure)], [*limit_marks(measure.limits, measure.shares, measure.unit)]
    values = Panel(Axis(f"% of trials per {UNIT_SIGNS[unit]}", 0.0, ROOM * peak or 1.0), series, [*ends, *limits])
    columns = ranged(measure)
    rows = Panel(
        Names([column.heading for column in columns]),
        [_range(row, column, measure, roles[column.heading]) for row, column in enumerate(columns)],
    )
    words = _words(measure) + (QUANTILES_MEAN if is_bounded(measure) else "")
    table = [(mark.words[0], ", ".join(mark.words[1:])) for mark in (*ends, *limits)]
    return Chart(alternative, Axis(name, *span, unit), [values, rows], name, words, table)


def _words(measure: MeasureSummary) -> str:
    """Description of a measure, with the number of trials in its chart if some of them failed."""
    seated = seated_text(measure)
    if not seated or measure.take == "curve":
        return heading(measure)
    return f"{heading(measure)}{SEATED}{seated}, out in all {share_text(measure.shares.out_ppm)}"


def _filled(bars: Bars, measure: MeasureSummary) -> Filled:
    """Bars of the leading method, cut at the limits that any trial is beyond: else no part of a bar is out."""
    own, (lower, upper), unit = leading_column(measure), measure.limits, measure.unit
    least, largest = own.value("sample_min"), own.value("sample_max")
    passed = lower if least is None or lower is None or least < lower else None
    exceeded = upper if largest is None or upper is None or largest > upper else None
    pieces = bars.cut((passed, exceeded))
    edges = [short_text(float(edge), unit) for edge in bars.edges]
    cut = np.bincount(pieces.bars, minlength=len(bars.counts)) > 1
    words = [
        f"{low} to {high}: {count:.0f} trials{' on both sides of the limit' if both else ''}"
        for (low, high), count, both in zip(itertools.pairwise(edges), bars.counts, cut, strict=True)
    ]
    method = measure.best_method
    return Filled(
        pieces.edges,
        bars.density[pieces.bars],
        method,
        METHOD_WORDS[method],
        pieces.beyond,
        pieces.bars.tolist(),
        [words[bar] for bar in pieces.bars],
    )


def leading_column(measure: MeasureSummary) -> Column:
    """The column of the method by which a measure is shown."""
    return next(column for column in columns_of(measure) if column.method == measure.best_method)


def _published_bars(section: Section, trials: float | None) -> Bars:
    """A published histogram, with its number of trials if stated."""
    counts = np.asarray(section["counts"], dtype=np.float64)
    edges = section["lower_edge"] + section["bin_width"] * np.arange(len(counts) + 1, dtype=np.float64)
    return Bars(edges, counts, max(float(counts.sum()), trials or 0.0))


def shown_span(measure: MeasureSummary, bars: Sequence[Bars]) -> tuple[float, float]:
    """Range of the axis: every bar, the ends of every column, and limits that are not far off."""
    lows = [float(b.edges[0]) for b in bars]
    highs = [float(b.edges[-1]) for b in bars]
    bounded = is_bounded(measure)
    for column in columns_of(measure):
        found = Ends.of(column, bounded=bounded)
        mean, sigma = column.value("mean"), column.value("sigma")
        spread = () if mean is None or not sigma else (mean - SIGMAS_SHOWN * sigma, mean + SIGMAS_SHOWN * sigma)
        ends = [end for end in (*(() if bounded else spread), found.low, mean, found.high) if end is not None]
        lows += ends
        highs += ends
    low, high = min(lows), max(highs)
    reach = LIMIT_REACH * (high - low)
    limits = [limit for limit in measure.limits if limit is not None]
    near = [limit for limit in limits if low - reach <= limit <= high + reach]
    low, high = min([low, *near]), max([high, *near])
    margin = 0.03 * (high - low) or max(1e-3 * abs(low), 1e-3)
    return low - margin, high + margin


def _ends(measure: MeasureSummary) -> Iterator[Mark]:
    """Low end, mean and high end of the leading method, as far as they are known; more digits where texts coincide."""
    own = leading_column(measure)
    ends = Ends.of(own, bounded=is_bounded(measure))
    pairs = ((ends.words[0], ends.low), ("mean", own.value("mean")), (ends.words[1], ends.high))
    known = [(word, value) for word, value in pairs if value is not None]
    apart = len({short_text(value, measure.unit) for _, value in known}) == len(known)
    for word, value in known:
        yield Mark(value, "end", (word, (short_text if apart else measured_text)(value, measure.unit)))


def limit_marks(limits: Sequence[float | None], shares: LimitShares, unit: str) -> Iterator[Mark]:
    """Limits with the fraction of trials beyond each.

    Args:
        limits: lower and upper, in the unit; None for none.
        shares: of the trials beyond them.
        unit: of the limits.
    """
    sides = (("LSL", "below", shares.below_limit_ppm), ("USL", "above", shares.above_limit_ppm))
    for limit, (word, side, ppm) in zip(limits, sides, strict=True):
        if limit is not None:
            words = (f"{word} {limit_text(limit, unit)}", out_text(ppm, side))
            yield Mark(limit, "limit", words, upper=side == "above", label=OUT_OF_LIMITS)


def out_text(ppm: float | None, side: str) -> str:
    """Fraction of all trials on the wrong side of a limit.

    >>> out_text(0.0, "below"), out_text(27_000.0, "above")
    ('none below', '2.7 % above')
    """
    return f"{share_text(ppm) if ppm != 0 else 'none'} {side}"


def roles_of_method(method: str) -> Role:
    """Role of one of our methods."""
    return "closed-form" if method == "closed form" else "geometric" if method == "geometric" else "analytic"


def column_roles(columns: Sequence[Column]) -> dict[str, Role]:
    """A role for each column by its heading: the methods have their own, published ones get the others in turn."""
    published = dict.fromkeys(column.heading for column in columns if column.method == "published")
    roles: dict[str, Role] = {name: PUBLISHED[k % len(PUBLISHED)] for k, name in enumerate(published)}
    return roles | {
        column.heading: roles_of_method(column.method) for column in columns if column.method != "published"
    }


def ranged(measure: MeasureSummary) -> list[Column]:
    """The columns that have something to draw; others publish what a table alone can show."""
    bounded = is_bounded(measure)
    return [column for column in columns_of(measure) if _is_drawn(measure, column, Ends.of(column, bounded=bounded))]


def _is_drawn(measure: MeasureSummary, column: Column, ends: Ends) -> bool:
    known = (ends.low, ends.high, column.value("mean"))
    return known != (None, None, None) or "histogram" in measure.published.get(column.heading, {})


def _range(row: int, column: Column, measure: MeasureSummary, role: Role) -> Range:
    ends, mean = Ends.of(column, bounded=is_bounded(measure)), column.value("mean")
    known = [short_text(own, measure.unit) for own in (ends.low, mean, ends.high) if own is not None]
    return Range(row, ends.low, ends.high, mean, role, f"{column.heading}: {' … '.join(known)}")


# over positions -----------------------------------------------------------------------------------


class Stepped:
    """Curves over positions with both their values at the positions between at which they jump.

    `x` are the positions in the unit of the axis, those of jumps twice; `jumps` those of the jumps [deg].
    """

    def __init__(self, measure: MeasureSummary) -> None:
        x: Array = np.asarray(measure.position_deg, dtype=float)
        self.jumps = [jump for jump in measure.jumps_deg if x[0] < jump < x[-1]]
        self._positions = x
        doubled = np.insert(x, np.repeat(np.searchsorted(x, self.jumps), 2), np.repeat(self.jumps, 2))
        self.x: Array = doubled / _per_unit(measure)

    def __call__(self, values: Sequence[float | None] | Array) -> Array:
        """Values at the positions, at each jump the one before it and the one after it."""
        known = np.asarray(values, dtype=float)
        after = np.searchsorted(self._positions, self.jumps)
        both = np.stack([known[after - 1], known[after]], axis=-1).ravel()
        return np.insert(known, np.repeat(after, 2), both)


def _per_unit(measure: MeasureSummary) -> float:
    """Degrees in one unit of the axis."""
    return TURN if measure.position_deg and measure.position_deg[-1] > 2 * TURN else 1.0


def position_axis(measure: MeasureSummary, stepped: Stepped) -> Axis:
    """The axis of a curve's positions."""
    first, last = float(stepped.x[0]), float(stepped.x[-1])
    unit = "deg" if _per_unit(measure) == 1.0 else "turns"
    return Axis(f"{position_of(measure)} position", first, last if last > first else first + 1.0, unit)


def curve(name: str, measure: MeasureSummary) -> Chart:
    """Mean and ±3 sigma of the leading method as line and band, its extremes, the analytic mean, limits and jumps.

    A band and lines: two bands would change places where the trials do not reach to ±3 sigma.
    """
    stepped, own, method = Stepped(measure), measure.curve_sample(measure.best_method), measure.best_method
    x, across, alternative = stepped.x, position_axis(measure, stepped), f"{name} over its positions"
    if own is None or all(value is None for value in own.mean):
        return Chart(alternative, across, (), name, _words(measure), instead=NO_VALUES)
    mean, sigma, word = stepped(own.mean), stepped(own.sigma), METHOD_WORDS[method]
    lowest, highest = stepped(own.min), stepped(own.max)
    series: list[Series] = [
        Band(x, mean - 3 * sigma, mean + 3 * sigma, method, f"{word}, ±3 sigma"),
        Line(x, lowest, method, f"{word}, smallest and largest", "dotted"),
        Line(x, highest, method, f"{word}, smallest and largest", "dotted"),
        Line(x, mean, method, f"{word}, mean", dots=measure.jumps),  # no value on the line between positions
    ]
    if method != "analytic" and (analytic := measure.curve_sample("analytic")):
        series.append(Line(x, stepped(analytic.mean), "analytic", "analytic, mean", "dashed"))
    series += _published_means(measure)
    marks = [*_jumps(measure, stepped.jumps)]
    limits = [*limit_marks(measure.limits, measure.shares, measure.unit)]
    marks += [replace(limit, words=limit.words[:1], upright=False, label=limit.words[0]) for limit in limits]
    reach = [mean - 3 * sigma, mean + 3 * sigma, lowest, highest, np.array([limit.value for limit in limits])]
    table = [(f"{word}, smallest mean", short_text(float(np.nanmin(mean)), measure.unit))]
    table += [(f"{word}, largest mean", short_text(float(np.nanmax(mean)), measure.unit))]
    table += [(limit.words[0], limit.words[1]) for limit in limits]
    panel = Panel(spanned(name, np.concatenate(reach), measure.unit), series, marks)
    return Chart(alternative, across, [panel], name, _words(measure), table)


def spanned(label: str, values: Array, unit: str = "") -> Axis:
    """An axis with a margin beside values, those that are no numbers left out."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    margin = 0.04 * (high - low) or max(1e-3 * abs(low), 1e-3)
    return Axis(label, low - margin, high + margin, unit)


def _published_means(measure: MeasureSummary) -> Iterator[Points]:
    """Means that others published, as marks at their own positions."""
    found = [(name, own) for name, own in measure.published.items() if "position_deg" in own]
    known = [(name, own, own["curve"]) for name, own in found if own.get("curve") and "mean" in own["curve"]]
    for k, (name, own, means) in enumerate(known):
        x = np.asarray(own["position_deg"]) / _per_unit(measure)
        y = np.asarray(means["mean"], dtype=float)
        yield Points(x, y, PUBLISHED[k % len(PUBLISHED)], f"{name}, mean", "diamond")


def _jumps(measure: MeasureSummary, jumps: Sequence[float]) -> Iterator[Mark]:
    places = ", ".join(f"{jump:.1f}°" for jump in jumps)
    text = f"{measure.jump_words} at {places}" if len(jumps) <= FEW_JUMPS else measure.jump_words
    yield from (Mark(jump / _per_unit(measure), "guide", label=text) for jump in jumps)
