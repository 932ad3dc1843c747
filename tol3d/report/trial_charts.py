"""Charts of kept trials: convergence of a measure, both methods of runs beside each other, and their differences.

Convergence of a measure's mean and sigma with the number of trials, read piece by piece.
"""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.errors import InputError, RunError
from tol3d.numerics.arrays import Array
from tol3d.report.bars import bars_of
from tol3d.report.chart import SERIES, Axis, Band, Chart, Filled, Line, Mark, Outline, Panel, Points, Role, Series
from tol3d.report.column import seated_text
from tol3d.report.compare import Compared, Difference, labelled
from tol3d.report.heading import heading
from tol3d.report.measure_charts import METHOD_WORDS, ROOM, Stepped, position_axis, spanned
from tol3d.report.number import UNIT_SIGNS, limit_text, measured_text, short_text
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.values import Method
from tol3d.study.system.outcome import GEOMETRIC, outcome_of, status_column, value_column

CONFIDENCE: Final = 1.96  # standard errors to either side, 95 %
FEWEST: Final = 10


@dataclass(frozen=True, eq=False)
class Convergence:
    """Mean and sigma of the first so many trials, with their standard errors, all in the measure's unit.

    Args:
        counts: (n,) how many trials, those that could not be assembled left out.
        mean, sigma: (n,) of them.
    """

    counts: Array
    mean: Array
    sigma: Array

    @property
    def mean_error(self) -> Array:
        """Standard errors of the means."""
        return np.asarray(self.sigma / np.sqrt(self.counts))

    @property
    def sigma_error(self) -> Array:
        """Standard errors of the sigmas, of normal values."""
        return np.asarray(self.sigma / np.sqrt(2 * (self.counts - 1)))


def convergence_of(run: Run, name: str, points: int) -> Convergence:
    """Convergence of a measure at so many numbers of trials; memory does not grow with them.

    Raises:
        InputError: a curve, which has no one mean, or too few trials seated. RunError: the run kept no trials.
    """
    measure = run.found.measures[name]
    if measure.take == "curve":
        raise InputError(f"{name}: expected a measure of one number a trial, got a curve")
    if not run.keeps_trials:
        raise RunError(f"{run.path}: this run kept its statistics only (--no-trials); run the scene again with them")
    total = measure.seated if measure.best_method == GEOMETRIC else run.trials
    if total < FEWEST:
        raise InputError(f"{name}: expected {FEWEST} assembled trials, got {total}")
    counts = np.unique(np.geomspace(FEWEST, total, points).round().astype(int))
    return running(_known(run, name), counts)


def running(pieces: Iterable[Array], counts: Array) -> Convergence:
    """Mean and sigma of the first so many values, each; of counts beyond the last value that of all of them.

    >>> found = running([np.array([1.0, 3.0]), np.array([5.0])], np.array([2, 3]))
    >>> found.mean, found.sigma
    (array([2., 3.]), array([1.41421356, 2.        ]))
    """
    there, shift, total, squares = 0, None, 0.0, 0.0
    found = list[tuple[int, float, float]]()
    for values in pieces:
        shift = float(values.mean()) if shift is None and len(values) else shift or 0.0
        off = values - shift
        sums, seconds = total + np.cumsum(off), squares + np.cumsum(off**2)
        wanted = counts[(counts > there) & (counts <= there + len(values))]
        found += [(int(n), float(sums[n - there - 1]), float(seconds[n - there - 1])) for n in wanted]
        if len(values):
            there, total, squares = there + len(values), float(sums[-1]), float(seconds[-1])
    if not found or found[-1][0] < there < counts[-1]:
        found.append((there, total, squares))
    numbers, firsts, seconds = (np.array(column, dtype=np.float64) for column in zip(*found, strict=True))
    means = firsts / numbers
    variance = np.maximum(seconds - numbers * means**2, 0.0) / (numbers - 1)
    return Convergence(numbers, means + (shift or 0.0), np.sqrt(variance))


def _known(run: Run, name: str) -> Iterator[Array]:
    """Values of the trials that have one, of the best method there is, piece by piece."""
    method, lacking = run.found.measures[name].best_method, run.found.lacking
    wanted = (value_column(method, name), status_column(name))
    for columns in run.pieces(*(own for own in wanted if own in run.column_names)):
        values = outcome_of(columns, method, name, lacking).values
        yield np.asarray(values[np.isfinite(values)])


NO_SIMULATION: Final = "no 3D simulation in these runs"
NO_TRIALS: Final = "these runs kept no trials (--no-trials)"
DIFFERENCE: Final = "difference of both methods"
DIFFERENCE_UNITS: Final = {"um": ("um", 1.0), "mm": ("um", 1000.0), "arcmin": ("″", 60.0), "pins": ("pins", 1.0)}
"""Unit of small differences, and the number of them in one of the measure's unit."""
FULL_TURN: Final = 360.0  # deg


def convergence(name: str, measure: MeasureSummary, own: Convergence, factor: float = 1.0) -> Chart:
    """Mean above sigma of the first trials over how many they are, with what 95 % of other draws would give.

    Args:
        name: of the measure.
        measure: in the unit that is shown.
        own: in the measure's unit of files.
        factor: from that to the one that is shown.
    """
    first, last = float(own.counts[0]), float(own.counts[-1])
    rows = (("mean", own.mean, own.mean_error), ("sigma", own.sigma, own.sigma_error))
    panels, table = [], []
    for word, found, errors in rows:
        values, reach, unit = factor * found, factor * CONFIDENCE * errors, measure.unit
        series: list[Series] = [
            Line(own.counts, values, measure.best_method),
            Band(own.counts, values - reach, values + reach, measure.best_method, "95 % of other draws"),
        ]
        end = float(values[-1])
        y = spanned(word, np.concatenate([values - reach, values + reach]), unit)
        panels.append(Panel(y, series, [Mark(end, "guide", upright=False)], height=0.38))
        table.append((f"{word} of all", f"{measured_text(end, unit)} ± {short_text(float(reach[-1]), unit)}"))
    across = Axis("trials", first, last if last > first else 10 * first, log=True)
    return Chart("mean and sigma over the number of trials", across, panels, name, heading(measure), table)


# runs ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Shown:
    """A run as it is shown in every row: its label, "" of a single one, and its role."""

    label: str
    run: Run
    role: Role | None

    def of(self, method: Method) -> Role:
        """Role of a method's series: the run's, or of a single run the method's."""
        return self.role or method


def shown_runs(runs: Sequence[Run]) -> list[Shown]:
    """Every run in a role of its own; a single one in those of its methods."""
    if len(runs) == 1:
        return [Shown("", runs[0], None)]
    return [Shown(label, run, SERIES[k % len(SERIES)]) for k, (label, run) in enumerate(labelled(runs))]


def compared_runs(measure: Compared, shown: Sequence[Shown]) -> Chart:
    """Both methods of each run over each other: histograms, or mean curves."""
    name, first = measure.name, shown[0].run.found.measures[measure.name]
    curve = first.take == "curve"
    series = [own for each in shown for own in (_curves if curve else _samples)(name, each)]
    words = heading(first)
    if shown[0].role:
        words += f"; {'solid' if curve else 'filled'}: 3D simulation, dashed: analytic"
    if curve:
        ends = [own.y for own in series if isinstance(own, Line)]
        panel = Panel(spanned(name, np.concatenate(ends), first.unit), series)
        return Chart(f"{name} by methods", position_axis(first, Stepped(first)), [panel], name, words)
    bars = [own for own in series if isinstance(own, Filled | Outline)]
    if not bars:
        return Chart(f"{name} by methods", Axis(name, 0.0, 1.0, first.unit), (), name, words, instead="no histogram")
    across = spanned(name, np.concatenate([bar.edges for bar in bars]), first.unit)
    top = ROOM * max(float(bar.heights.max()) for bar in bars) or 1.0
    marks = [mark for mark in _limits(name, shown) if across.low <= mark.value <= across.high]
    panel = Panel(Axis(f"% of trials per {UNIT_SIGNS[first.unit]}", 0.0, top), series, marks)
    return Chart(f"{name} by methods", across, [panel], name, words)


def _samples(name: str, shown: Shown) -> Iterator[Series]:
    """Both methods' samples of a run: the 3D simulation filled, the stack-up as outline."""
    measure = shown.run.found.measures[name]
    seated = f", {text}" if (text := seated_text(measure)) else ""
    for method, bars in sorted(bars_of(measure).items(), reverse=True):
        role, word = shown.of(method), METHOD_WORDS[method]
        if method == "geometric":
            yield Filled(bars.edges, bars.density, role, f"{shown.label or word}{seated}")
        else:
            yield Outline(
                bars.edges, bars.density, role, f"{shown.label}, {word}" if shown.label else word, bool(shown.label)
            )


def _curves(name: str, shown: Shown) -> Iterator[Series]:
    measure = shown.run.found.measures[name]
    stepped, start = Stepped(measure), f"{shown.label}, " if shown.label else ""
    if own := measure.curve_sample("geometric"):
        yield Line(stepped.x, stepped(own.mean), shown.of("geometric"), f"{start}3D simulation, mean")
    if own := measure.curve_sample("analytic"):
        yield Line(stepped.x, stepped(own.mean), shown.of("analytic"), f"{start}analytic, mean", "dashed")


def _limits(name: str, shown: Sequence[Shown]) -> Iterator[Mark]:
    """Limits; those that not all runs share in the colour of theirs."""
    measures = [each.run.found.measures[name] for each in shown]
    for word, limits in zip(("LSL", "USL"), zip(*(measure.limits for measure in measures), strict=True), strict=True):
        shared = len(set(limits)) == 1
        for each, limit in list(zip(shown, limits, strict=True))[: 1 if shared else None]:
            if limit is not None:
                text = f"{word} {limit_text(limit, measures[0].unit)}" + ("" if shared else f" of {each.label}")
                yield Mark(limit, "limit", label=text, role=None if shared else each.role)


# their difference ---------------------------------------------------------------------------------

Known = Sequence[tuple[Shown, Difference]]


def differences(name: str, unit: str, known: Known, instead: str = NO_SIMULATION) -> Chart:
    """Histograms of the 3D simulation less the analytic method, trial by trial."""
    sign, factor = DIFFERENCE_UNITS[unit]
    title, words, label = "3D simulation − analytic", f"{name}, of every trial", "difference of a trial"
    if not known:
        return Chart(DIFFERENCE, Axis(label, 0.0, 1.0, sign), (), title, words, instead=instead)
    every, table = [(each, own.bars.times(factor)) for each, own in known], []
    series: list[Series] = []
    for (each, bars), (_, own) in zip(every, known, strict=True):
        told = UNIT_SIGNS.get(sign, sign)
        text = f"max {factor * own.largest:.3f} {told}, rms {factor * own.rms:.3f} {told}"
        said = [
            f"{low:.4g} to {high:.4g} {told}: {count:.0f} trials"
            for (low, high), count in zip(itertools.pairwise(bars.edges), bars.counts, strict=True)
        ]
        legend = f"{each.label}: {text}" if each.label else text
        heights = bars.counts if len(known) == 1 else bars.density
        series.append(Filled(bars.edges, heights, each.of("geometric"), legend, words=said))
        table.append((each.label or "3D simulation − analytic", text))
    edges = np.concatenate([bars.edges for _, bars in every])
    top = ROOM * max(float(own.heights.max()) for own in series if isinstance(own, Filled)) or 1.0
    y = Axis("trials", 0.0, top) if len(known) == 1 else Axis("share of trials", 0.0, top, ticks=False)
    panel = Panel(y, series, [Mark(0.0, "guide", role="plain")], 0.62)
    return Chart(DIFFERENCE, spanned(label, edges, sign), [panel], title, words, table)


def by_position(measure: Compared, known: Known, instead: str = NO_SIMULATION) -> Chart:
    """Differences over the position of each trial, or over its analytic value."""
    sign, factor = DIFFERENCE_UNITS[measure.unit]
    turning, title = measure.position_word, "difference"
    over = all(own.by_position for _, own in known)
    words = f"by position of the {turning}" if over else "by value"
    if not known:
        return Chart(f"{DIFFERENCE} {words}", Axis("", 0.0, 1.0), (), title, words, instead=instead)
    at = np.concatenate([own.at for _, own in known])
    if over:
        turn = " within its turn" if turning == "driver" and at.max(initial=0.0) <= FULL_TURN else ""
        across = spanned(f"{turning} position{turn}", at, "deg")
    else:
        across = spanned(f"analytic: {measure.name}", at, measure.unit)
    y = spanned("difference", factor * np.concatenate([own.values for _, own in known]), sign)
    series = [Points(own.at, factor * own.values, each.of("geometric"), sign="speck") for each, own in known]
    return Chart(
        f"{DIFFERENCE} {words}",
        across,
        [Panel(y, series, [Mark(0.0, "guide", upright=False, role="plain")])],
        title,
        words,
    )
