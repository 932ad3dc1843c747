"""Runs beside each other as tables: mean, sigma and range of each run and method, and how far the methods differ."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Annotated

import numpy as np

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.report.bars import Bars
from tol3d.report.column import is_bounded, seated_text
from tol3d.report.declared import declared_table
from tol3d.report.joint import joint_comparison
from tol3d.report.number import NOTHING, UNIT_SIGNS, difference_text, share_text
from tol3d.report.page import BLANK, Page, PageItem, Row, Shown, Table, line, note, page, title
from tol3d.report.verdict import verdict_lines
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import Method
from tol3d.study.system.outcome import METHODS, outcome_of, status_column, value_column

BARS = 40
MOST_NAMED = 3  # contributors of a sentence
POINTS_SHOWN = 4000  # dots in a picture; more hide each other
TURN = 360.0  # deg
SMALLEST_SPAN = 1e-6  # um or arc minutes; for methods that agree to the last bit


@dataclass(frozen=True, eq=False)
class Difference:
    """Difference of the two methods for one measure.

    Args:
        bars: histogram of the differences, in the measure's unit.
        at: (n,) abscissa of the first trials: the driver's position [deg] within a turn, or the
            analytic value if a measure has many positions; n at most POINTS_SHOWN.
        values: (n,) their differences.
        by_position: True if `at` is a position.
        largest, rms: of all trials, in the measure's unit.
    """

    bars: Bars
    at: Array
    values: Array
    by_position: bool
    largest: float
    rms: float


def difference_of(run: Run, measure: str) -> Difference | None:
    """The difference of the two methods of a scalar or curve measure; None without a 3D simulation, or without trials.

    Memory does not grow with the number of trials: one block of columns is held at a time.
    """
    summary = run.found.measures[measure]
    if not {f"analytic:{measure}", f"geometric:{measure}"} <= set(run.column_names):
        return None
    position = summary.position_column if summary.position_column in run.column_names else None
    ends = np.array([_ends(analytic, geometric) for analytic, geometric, _ in _blocks(run, measure, position)])
    low, high = float(ends.min()), float(ends.max())
    edges = np.linspace(low, max(high, low + SMALLEST_SPAN), BARS + 1)
    counts, total, squares = np.zeros(BARS), 0, 0.0
    at, values = np.empty(0), np.empty(0)
    for analytic, geometric, places in _blocks(run, measure, position):
        difference = (geometric - analytic).ravel()
        known = ~np.isnan(difference)
        counts += np.histogram(difference[known], edges)[0]
        total += int(known.sum())
        squares += float(np.sum(difference[known] ** 2))
        room = POINTS_SHOWN - len(at)
        at = np.append(at, _abscissa(summary, analytic, places)[known][:room])
        values = np.append(values, difference[known][:room])
    count = max(total, 1)
    return Difference(
        bars=Bars(edges, counts, count),
        at=at,
        values=values,
        by_position=position is not None or summary.take == "curve",
        largest=max(high, -low),
        rms=float(np.sqrt(squares / count)),
    )


def _abscissa(summary: MeasureSummary, analytic: Array, places: Array | None) -> Array:
    if summary.take == "curve":
        return np.broadcast_to(summary.position_deg or [], analytic.shape).ravel()
    return analytic if places is None else places % TURN


def _ends(analytic: Array, geometric: Array) -> tuple[float, float]:
    """Smallest and largest difference of a block, and 0."""
    difference = geometric - analytic
    known = difference[~np.isnan(difference)]
    return float(np.min(known, initial=0.0)), float(np.max(known, initial=0.0))


def _blocks(run: Run, measure: str, position: str | None) -> Iterator[tuple[Array, Array, Array | None]]:
    """Analytic and geometric values and positions, one file of trials at a time; NaN where a trial failed."""
    wanted = (*(value_column(method, measure) for method in METHODS), status_column(measure))
    asked = tuple(name for name in wanted if name in run.column_names)
    lacking = run.found.lacking
    for columns in run.pieces(*asked, *((position,) if position else ())):
        analytic, geometric = (outcome_of(columns, method, measure, lacking).values for method in METHODS)
        yield analytic, geometric, np.asarray(columns[position], dtype=np.float64) if position else None


NO_ONE_MEAN = "no row: it is 0 with the load on one side and jumps where the load changes side; the picture shows it"
SHOWN_APART = "not all of these runs read it alike, at the same positions and contacts: shown apart"
ENDS_BEFORE = "the trials end before mean ∓ 3 sigma here, so low and high lie outside them"
SHORT: Mapping[Method, str] = {"analytic": "analytic", "geometric": "3D"}


@dataclass(frozen=True)
class Compared:
    """A measure as runs may share it on one axis; the same name over other positions is another measure.

    Args:
        name, unit, over, take, identity, jumps, position_word: as in its summary.
    """

    name: str
    unit: str
    over: str
    take: str
    identity: tuple[str | None, ...]
    jumps: bool
    position_word: str

    @classmethod
    def of(cls, name: str, measure: MeasureSummary) -> "Compared":
        """From a measure's summary."""
        own = measure
        return cls(name, own.unit, own.over, own.take, own.identity, own.jumps, own.position_word)

    def found_in(self, runs: Sequence[Run]) -> list[tuple[str, Run]]:
        """The runs that have it, each with its label."""
        return [(label, run) for label, run in labelled(runs) if self in measures_of([run])]


def require_shared_measures(runs: Sequence[Run]) -> None:
    """Refuse runs of which one has no measure, by its name, that another has too.

    Raises:
        InputError: there are no runs, or one shares nothing with the others.
    """
    if not runs:
        raise InputError("nothing to compare: give the folder of at least one run")
    names = [set(run.found.measures) for run in runs]
    shared = {name for name, count in Counter(chain.from_iterable(names)).items() if count > 1}
    alone = [label for (label, _), own in zip(labelled(runs), names, strict=True) if not own & shared]
    if len(runs) > 1 and alone:
        raise InputError(
            f"{', '.join(alone)}: expected a measure that another of these runs has too, got none; show each by itself"
        )


def measures_of(runs: Sequence[Run]) -> list[Compared]:
    """The measures of all runs, each once."""
    found = (Compared.of(name, measure) for run in runs for name, measure in run.found.measures.items())
    return list(dict.fromkeys(found))


def comparison_report(runs: Sequence[Run]) -> Page:
    """Tables of every measure: mean, sigma and range of each run and method, and how far the methods differ.

    Raises:
        InputError: there are no runs, or they share no measure.
    """
    require_shared_measures(runs)
    blocks: list[PageItem] = verdict_lines([(label, run.found) for label, run in labelled(runs)])
    for measure in measures_of(runs):
        own = measure.found_in(runs)
        blocks += [title(measure.name)]
        blocks += [line(own[0][1].found.measures[measure.name].words, "dim")]
        blocks += [note(NO_ONE_MEAN)] if measure.jumps else [BLANK, _table(measure.name, measure.unit, own)]
        blocks += [note(SHOWN_APART)] if len(own) < _named_alike(measure.name, runs) else []
        bounded = any(is_bounded(run.found.measures[measure.name]) for _, run in own)
        blocks += [note(ENDS_BEFORE)] if bounded else []
    blocks += joint_comparison([(label, run.found) for label, run in labelled(runs)])
    blocks += [note(sentence) for sentence in _renamed(runs)]
    words = "low and high: mean ∓ 3 sigma; max and rms: of 3D simulation − analytic, trial by trial"
    words += (
        "; means and sigmas are of the assembled trials, the fraction out of limits is of all"
        if _any_failed(runs)
        else ""
    )
    words += "; shift: of the mean against the first run" if len(runs) > 1 else ""
    return page(*blocks, line(f"\n{words}", "dim"))


def _named_alike(name: str, runs: Sequence[Run]) -> int:
    return sum(name in run.found.measures for run in runs)


def _renamed(runs: Sequence[Run]) -> Iterator[str]:
    """Sentence on contributors that one of two runs of a seed lacks: by another name they are drawn anew."""
    if len(runs) != 2 or runs[0].found.seed != runs[1].found.seed:
        return
    names = [{share.name for measure in run.found.measures.values() for share in measure.contributors} for run in runs]
    first, second = sorted(names[0] - names[1]), sorted(names[1] - names[0])
    if first and second:
        told = [", ".join(own[:MOST_NAMED]) + (", …" if len(own) > MOST_NAMED else "") for own in (first, second)]
        yield (
            f"contributors only in the first run: {told[0]}; only in the second: {told[1]}. Draws go by the name of a "
            "contributor: what is called otherwise is drawn anew, also with the same seed"
        )


def _any_failed(runs: Sequence[Run]) -> bool:
    return any(seated_text(measure) for run in runs for measure in run.found.measures.values())


def labelled(runs: Sequence[Run]) -> list[tuple[str, Run]]:
    """Each run with as much of its folder's path, from the end, as distinguishes it from the others."""
    paths = [run.path.resolve() for run in runs]
    labels = [_end_of(path, [other for other in paths if other != path]) for path in paths]
    return list(zip(labels, runs, strict=True))


def _end_of(path: Path, others: Sequence[Path]) -> str:
    """The shortest end of a path that no other path ends with.

    >>> _end_of(Path("/runs/a/arm"), [Path("/runs/b/arm")]), _end_of(Path("/runs/a/arm"), [Path("/runs/a/leg")])
    ('a/arm', 'arm')
    """
    ends = (path.parts[-count:] for count in range(1, len(path.parts) + 1))
    shortest = next((end for end in ends if all(other.parts[-len(end) :] != end for other in others)), path.parts)
    return str(Path(*shortest))


@dataclass(frozen=True)
class _Found:
    """Result of a method in a run; for a curve the average over its positions."""

    count: int
    trials: int
    mean: float | None
    sigma: float | None
    low: float | None
    high: float | None
    out_ppm: float | None

    @property
    def trials_text(self) -> str:
        """Number of trials behind its mean and sigma, and of all trials if some failed."""
        if not self.trials:
            return ""
        return f"{self.count} of {self.trials}" if self.trials != self.count else str(self.count)


@dataclass(frozen=True)
class ComparedRow:
    """A method in one of several runs: what it found of a measure, and how far it is from the other."""

    method: Annotated[str, Shows("method", "words")]
    trials: Annotated[str, Shows("trials")]
    mean: Annotated[float | None, Shows("mean")]
    sigma: Annotated[float | None, Shows("sigma")]
    low: Annotated[float | None, Shows("low")]
    high: Annotated[float | None, Shows("high")]
    out: Annotated[str | None, Shows("out of limits", seldom=True)]
    largest: Annotated[str, Shows("max")]
    rms: Annotated[str, Shows("rms")]
    shift: Annotated[str | None, Shows("shift", seldom=True)]


def _table(name: str, unit: str, runs: Sequence[tuple[str, Run]]) -> Table:
    judged = any(_judged(run.found.measures[name]) for _, run in runs)
    rows, first = [], dict[str, float]()
    for label, run in runs:
        for index, (method, found) in enumerate(_found(run.found.measures[name])):
            largest, rms = _differences(run, name, unit) if method == "geometric" else (NOTHING, NOTHING)
            shifted = None if found.mean is None else found.mean - first.setdefault(method, found.mean)
            shift = _bare(shifted, unit) if len(runs) > 1 else None
            values = (found.mean, found.sigma, found.low, found.high)
            out = share_text(found.out_ppm) if judged else None
            row = ComparedRow(SHORT[method], found.trials_text, *values, out, largest, rms, shift)
            rows.append((Row(label if index == 0 else "", (), unit=unit), row))
    corner = "run" if unit == "arcmin" else f"run [{UNIT_SIGNS[unit]}]"
    return replace(declared_table(corner, rows, unit), repeated=1)


def _judged(measure: MeasureSummary) -> bool:
    """True if trials of a measure can be out: it has a limit, or some of them failed."""
    return measure.has_limits or bool(seated_text(measure))


def _found(measure: MeasureSummary) -> Iterator[tuple[Method, _Found]]:
    """Result of each method."""
    if measure.take != "curve":
        for method in SHORT:
            if own := measure.sample(method):
                ends = (own.low_3sigma, own.high_3sigma)
                yield method, _Found(own.count, own.trials, own.mean, own.sigma, *ends, own.out_ppm)
        return
    for method, curve in measure.curve.by_method.items() if measure.curve else ():
        counted = (measure.seated, measure.trials) if method == "geometric" else (0, 0)
        yield method, _Found(*counted, _average(curve.mean), _average(curve.sigma), None, None, curve.out_ppm)


def _average(values: Sequence[float | None]) -> float | None:
    """Mean of the values that are known."""
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


def _differences(run: Run, name: str, unit: str) -> list[Shown]:
    found: tuple[float | None, float | None] = (None, None)
    if agreement := run.found.measures[name].agreement:
        found = (agreement.max_abs_difference, agreement.rms_difference)
    elif difference := difference_of(run, name):
        found = (difference.largest, difference.rms)
    return [_bare(value, unit) for value in found]


def _bare(difference: float | None, unit: str) -> Shown:
    """A difference in a table whose corner has the unit."""
    return Shown(difference_text(difference, unit).removesuffix(f" {UNIT_SIGNS[unit]}"), difference)
