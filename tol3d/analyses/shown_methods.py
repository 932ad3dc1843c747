"""Methods side by side as tables: for each measure one row per method, and the worst builds found.

Methods side by side as charts: the intervals by method over each measure's limits.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np

from tol3d.analyses.methods_section import BuildFound, MeasureMethods, Methods
from tol3d.report.chart import Chart, Charts, Mark, Names, Panel, Range, Role
from tol3d.report.declared import declared_table
from tol3d.report.measure_charts import spanned
from tol3d.report.number import UNIT_SIGNS, limit_text, measured_text, number_text, short_text
from tol3d.report.page import BLANK, Line, Page, PageItem, Table, note, page, titled, warning
from tol3d.study.runs.summary.shows import Computed, Shows

MOST_SHOWN: Final = 12
"""Contributors of a worst build."""
NOTHING: Final = "–"
NO_SLOPE: Final = "no slope at the mean build, such as of an amount: nothing by slopes, no RSS"
WORDS: Final = (
    "worst found: the worst of a search among builds within the tolerances, from several builds and positions; worse "
    "ones may exist. By slopes: sum of all half tolerances at the mean build. RSS: root of the sum of their squares. A "
    "half tolerance is half of a contributor's effect between its limits, ±3 sigma for laws without limits. Modified "
    "RSS: RSS × C_f, C_f = 1 + 0.5 (WC − RSS)/(RSS (√n − 1)), WC by slopes, n contributors with an effect"
)


def methods_report(found: Methods) -> Page:
    """A table a measure."""
    method = "analytic" if found.method == "analytic" else "3D simulation"
    blocks: list[PageItem] = [Line(((found.scene, "bold"), (f" · methods side by side, {method}", "")))]
    for name, own in found.measures.items():
        blocks += titled(f"{name}: {_limits(own)}", intervals_table(own))
        blocks += _told(own)
        if own.worst is not None:
            blocks += _builds(own, found.contributors)
    return page(*blocks, BLANK, note(WORDS), note(f"builds that were evaluated: {found.evaluations}"))


@dataclass(frozen=True)
class IntervalRow:
    """The interval of a measure by a method, in its unit."""

    unit: str
    between_limits: float | None
    low: Annotated[float | None, Shows("low")]
    high: Annotated[float | None, Shows("high")]
    sign = Computed(Shows("unit", "words"), lambda own: "′, ″" if own.unit == "arcmin" else UNIT_SIGNS[own.unit])
    half_range = Computed(Shows("half range"), lambda own: own.half)
    share = Computed(
        Shows("of the limits", ".1f", "%", optional=True),
        lambda own: None if own.half is None or not own.between_limits else 2 * own.half / own.between_limits,
    )

    @property
    def half(self) -> float | None:
        """Half of it."""
        return None if self.low is None or self.high is None else (self.high - self.low) / 2


@dataclass(frozen=True)
class DeviationRow:
    """The deviations of a contributor in the worst builds."""

    builds: Annotated[Mapping[str, str], Shows("{key}", "words")]
    unit_sign: Annotated[str, Shows("unit", "words")]


def intervals_table(measure_methods: MeasureMethods) -> Table:
    """A row a method."""
    width = (
        None
        if measure_methods.lower_limit is None or measure_methods.upper_limit is None
        else measure_methods.upper_limit - measure_methods.lower_limit
    )
    return declared_table(
        "", [(words, IntervalRow(measure_methods.unit, width, *ends)) for words, *ends in intervals_of(measure_methods)]
    )


def intervals_of(measure_methods: MeasureMethods) -> Iterator[tuple[str, float | None, float | None]]:
    """Each method with its low and its high estimate, in the measure's unit; None for one that is not known."""
    if measure_methods.worst is not None:
        low, high = measure_methods.worst.low, measure_methods.worst.high
        yield "worst found", None if low is None else low.measured, None if high is None else high.measured
    for words, half in (
        ("worst by slopes", measure_methods.by_slopes),
        ("modified RSS", measure_methods.modified_rss),
        ("RSS", measure_methods.rss),
    ):
        known = (
            None
            if measure_methods.mean is None or half is None
            else (measure_methods.mean - half, measure_methods.mean + half)
        )
        yield words, *(known or (None, None))
    sample = measure_methods.simulation
    yield "simulation, ±3 sigma", sample.low_3sigma, sample.high_3sigma
    yield "simulation, 0.135 % and 99.865 %", sample.p0_135, sample.p99_865
    if sample.law is not None:
        yield f"fitted law, {sample.law.name}", sample.law.low, sample.law.high
    yield "least and largest trial", sample.sample_min, sample.sample_max


def _limits(measure_methods: MeasureMethods) -> str:
    given = [
        f"{sign} {limit_text(limit, measure_methods.unit)}"
        for sign, limit in (("≥", measure_methods.lower_limit), ("≤", measure_methods.upper_limit))
        if limit is not None
    ]
    return ", ".join(given) or "no limits"


def _told(measure_methods: MeasureMethods) -> Iterator[PageItem]:
    sample, law = measure_methods.simulation, measure_methods.simulation.law
    count = f"{measure_methods.contributors} contributor{'s' if measure_methods.contributors != 1 else ''} with a slope"
    factor = f"C_f {measure_methods.factor:.3f}" if measure_methods.factor is not None else "no C_f of fewer than two"
    by_slopes = measure_methods.nothing_acts or (
        f"{count}, {factor}" if measure_methods.by_slopes is not None else NO_SLOPE
    )
    yield note(f"mean build {measured_text(measure_methods.mean, measure_methods.unit)}; {by_slopes}")
    shape = [
        f"{word} {NOTHING if value is None else f'{value:.3f}'}"
        for word, value in (("skewness", sample.skewness), ("excess kurtosis", sample.kurtosis))
    ]
    failed = f", {sample.failed} failed" if sample.failed else ""
    words = f"{sample.trials} trials{failed}: mean {measured_text(sample.mean, measure_methods.unit)}, "
    words += f"sigma {measured_text(sample.sigma, measure_methods.unit)}, {', '.join(shape)}"
    yield note(words)
    if law is not None:
        parameters = ", ".join(f"{name} {number_text(float(f'{value:.5g}'))}" for name, value in law.parameters.items())
        verdict = "not rejected" if law.p_value > REJECTED else "rejected, the nearest of four"
        test = f"Anderson–Darling A² {law.statistic:.3f}, p {law.p_value:.3g} by {law.replicates} refitted samples"
        yield note(f"fitted law {law.name} ({parameters}): {test} of {law.trials} trials: {verdict}")
    if sample.beyond_worst:
        few = f"{sample.beyond_worst} of {sample.trials} trials"
        yield warning(f"{few} lie beyond the worst found: laws without limits of their own draw beyond ±3 sigma")
    if measure_methods.worst is None and not measure_methods.nothing_acts:
        yield note(
            "worst case: not looked for" + (", it would take too many builds" if measure_methods.contributors else "")
        )
    elif measure_methods.worst is not None and measure_methods.worst.unseated is not None:
        status = measure_methods.worst.unseated.status
        met = measure_methods.worst.met
        yield warning(f"builds within the tolerances cannot be assembled ({status}); {met} were met in the search")


REJECTED: Final = 0.05


def _builds(measure_methods: MeasureMethods, units: Mapping[str, str]) -> Iterator[PageItem]:
    """The deviations of the worst builds, those that differ first."""
    assert measure_methods.worst is not None
    builds = {
        word: build
        for word, build in (("lowest", measure_methods.worst.low), ("highest", measure_methods.worst.high))
        if build
    }
    if measure_methods.worst.unseated is not None and measure_methods.worst.unseated.measured is None:
        builds["cannot be assembled"] = measure_methods.worst.unseated
    if not builds:
        return
    rows = []
    for name, unit in units.items():
        if any(name in build.deviations for build in builds.values()):
            deviations = {f"{word}: {build.status}": _deviations(build, name) for word, build in builds.items()}
            rows.append((name, DeviationRow(deviations, UNIT_SIGNS[unit])))
    yield declared_table("worst found", rows).shortened(MOST_SHOWN)
    yield note(f"by {measure_methods.worst.evaluations} builds")


def _deviations(build: BuildFound, name: str) -> str:
    values = build.deviations.get(name, ())
    return ", ".join(number_text(float(f"{value:.4g}")) for value in values)


MOST: Final = 12
"""Measures in one picture."""
COLUMNS: Final = 2
WIDTH: Final = 7.2  # inch, of a chart
ROLES: Final[Mapping[str, Role]] = {
    "worst found": "plain",
    "worst by slopes": "soft",
    "modified RSS": "series-1",
    "RSS": "series-4",
    "simulation, ±3 sigma": "series-0",
    "simulation, 0.135 % and 99.865 %": "series-2",
    "least and largest trial": "soft",
}


def methods_charts(found: Methods) -> Charts:
    """The measures that use most of their limits, MOST at most."""
    most = sorted(found.measures, key=lambda name: -_used(found.measures[name]))[:MOST]
    charts = [methods_chart(name, own) for name, own in found.measures.items() if name in most]
    rows = [charts[k : k + COLUMNS] for k in range(0, len(charts), COLUMNS)]
    return Charts(rows, found.scene, WIDTH * len(rows[0]))


def methods_chart(name: str, measure_methods: MeasureMethods) -> Chart:
    """A row for each method with its interval; dotted the mean build."""
    intervals = [*intervals_of(measure_methods)]
    rows = [
        Range(row, low, high, None, ROLES.get(words, "series-3"), words)
        for row, (words, low, high) in enumerate(intervals)
    ]
    limits = [
        (word, end)
        for word, end in (("LSL", measure_methods.lower_limit), ("USL", measure_methods.upper_limit))
        if end is not None
    ]
    marks = [Mark(limit, "limit", label=f"{word} {limit_text(limit, measure_methods.unit)}") for word, limit in limits]
    marks += [Mark(measure_methods.mean, "guide", label="mean build")] if measure_methods.mean is not None else []
    ends = [end for _, low, high in intervals for end in (low, high) if end is not None]
    across = spanned(name, np.array([*ends, *(mark.value for mark in marks)]), measure_methods.unit)
    table = [
        (words, f"{short_text(low, measure_methods.unit)} to {short_text(high, measure_methods.unit)}")
        for words, low, high in intervals
        if low is not None and high is not None
    ]
    panel = Panel(Names([words for words, _, _ in intervals]), rows, marks)
    said = "" if limits else "no limits"
    return Chart(f"{name} by methods", across, [panel], name, said, table)


def _used(measure_methods: MeasureMethods) -> float:
    """3 sigma of the simulation over the distance to the nearest limit; 0 without limits."""
    low, high, mean = (
        measure_methods.simulation.low_3sigma,
        measure_methods.simulation.high_3sigma,
        measure_methods.simulation.mean,
    )
    if low is None or high is None or mean is None:
        return 0.0
    half = (high - low) / 2
    margins = [] if measure_methods.lower_limit is None else [mean - measure_methods.lower_limit]
    margins += [] if measure_methods.upper_limit is None else [measure_methods.upper_limit - mean]
    return max((half / margin if margin > 0.0 else float("inf") for margin in margins), default=0.0)
