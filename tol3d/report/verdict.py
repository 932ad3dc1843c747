"""One row a measure: where it lies, what is out of its limits, and whether that is within what is accepted."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Final, get_args

from tol3d.report.column import (
    Ends,
    columns_of,
    is_bounded,
    leading_shares,
    ranked_contributors,
    seated_text,
    shares_by_words,
    unexplained_words,
)
from tol3d.report.declared import declared_table
from tol3d.report.heading import MOST_MEASURES, WORST_FIRST, shown_measures
from tol3d.report.joint import yield_lines
from tol3d.report.number import NOTHING, bounded_share_text, counted, limits_text, share_text
from tol3d.report.page import BLANK, TITLE, Line, PageItem, Row, Table, line, note
from tol3d.statistics.estimates.limits import ppk_beyond
from tol3d.study.runs.summary.judged import Accepted, AcceptedPpk, JudgedMeasure, Verdict, demand_of
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.sample import PpkBy
from tol3d.study.runs.summary.shows import Computed, Shows

PPK_BY: Final[Mapping[PpkBy, str]] = {
    "quantiles": "quantiles",
    "share out of limits": "share out",
    "mean and sigma": "mean, sigma",
}
PPK_MEANS: Final[Mapping[PpkBy, str]] = {
    "quantiles": "quantiles: distance of a limit from 50 % over that of 0.135 % or 99.865 % (ISO 22514-2)",
    "share out of limits": "share out: that of a normal measure with as much out",
    "mean and sigma": "mean, sigma: distance of the nearest limit over 3 sigma",
}
PLAIN: Final[PpkBy] = "mean and sigma"
FEW_MEASURES: Final = 4  # with so many, a few contributors of each are named
FEW_NAMED: Final = 3
LEAST_NAMED: Final = 0.5  # %; a smaller share is 0 in print
STYLES: Final[Mapping[Verdict, str]] = {"NOT OK": "red", "too few trials": "yellow"}


def accepted_text(accepted: Accepted, measures: Iterable[MeasureSummary] = ()) -> str:
    """Words for a demand on measures: a share out of limits with the Ppk that it stands for, or a Ppk with its share.

    >>> accepted_text(2700.0), accepted_text(AcceptedPpk(1.33))
    ('0.27 % out of limits (Ppk 1.00 with two limits, 0.93 with one)', 'Ppk 1.33 (33 ppm beyond each limit)')

    Args:
        accepted: share or Ppk.
        measures: those with limits say whether with two or with one.
    """
    if isinstance(accepted, AcceptedPpk):
        return f"Ppk {accepted.ppk:.4g} ({share_text(accepted.beyond_one_ppm)} beyond each limit)"
    counts = {2 - measure.limits.count(None) for measure in measures if measure.has_limits} or {1, 2}
    ppks = {count: ppk_beyond(accepted * 1e-6 / count) for count in sorted(counts, reverse=True)}
    words = ", ".join(f"{ppk:.2f} with {'two limits' if count == 2 else 'one'}" for count, ppk in ppks.items())
    if len(ppks) == 1:
        words = f"{next(iter(ppks.values())):.2f}"
    return f"{share_text(accepted)} out of limits" + (f" (Ppk {words})" if accepted else "")


def verdict_report(run: RunSummary, accepted: Accepted | None = None, *, blame: bool = False) -> list[PageItem]:
    """The verdict of every measure, what it rests on, and how it is reached.

    Args:
        run: what it found.
        accepted: what is asked of a measure; default: what the study asks.
        blame: name the contributor that most of each measure's variance comes from.
    """
    table = verdict_table(run, accepted, blame=blame)
    below = [*_left_out(run, accepted), *yield_lines(run), *map(note, _notes(run))]
    return [_verdict_line(run, accepted), BLANK, table, *below]


def short_verdict(run: RunSummary, accepted: Accepted | None = None) -> list[PageItem]:
    """The verdict of every measure, and the largest contributors of each: a first look."""
    table = verdict_table(run, accepted, brief=True)
    below = [*_left_out(run, accepted), *yield_lines(run), note(_ends_note(run)), *map(note, _other_ppks(run))]
    return [_verdict_line(run, accepted), BLANK, table, *below, *_largest_contributors(run)]


def _verdict_line(run: RunSummary, accepted: Accepted | None) -> Line:
    """The worst verdict of all measures, how many of several have it, and the accepted share."""
    worst, judged, counted = _worst_verdict(run, accepted)
    words = accepted_text(demand_of(run.study.accept_ppk, accepted), run.measures.values())
    told = f"{counted} · accepted: {words}" if judged else ""
    return Line((("\n", ""), ("verdict", TITLE), (": ", "dim"), (worst, _bold(worst)), (told, "dim")))


def verdict_lines(runs: Sequence[tuple[str, RunSummary]], accepted: Accepted | None = None) -> list[PageItem]:
    """A line for each run, with its label and its verdict; nothing where no run has limits."""
    found = [(label, *_worst_verdict(run, accepted)) for label, run in runs]
    if not any(judged for _, _, judged, _ in found):
        return []
    asked = {accepted_text(demand_of(run.study.accept_ppk, accepted)) for _, run in runs}
    head = Line(
        (("verdict", TITLE), (f" · accepted: {asked.pop() if len(asked) == 1 else 'as each study asks'}", "dim"))
    )
    return [head, *(Line(((f"  {label}: ", ""), (own, _bold(own)), (counted, ""))) for label, own, _, counted in found)]


def _worst_verdict(run: RunSummary, accepted: Accepted | None) -> tuple[Verdict, int, str]:
    """The worst verdict of all measures, the number of measures with limits, and how many of several have it."""
    asked = demand_of(run.study.accept_ppk, accepted)
    found = Counter(JudgedMeasure.of(measure, asked).verdict for measure in run.measures.values())
    judged = sum(found.values()) - found["no limits"]
    worst: Verdict = next((own for own in ("NOT OK", "too few trials", "OK") if found[own]), "no limits")
    return worst, judged, f", {found[worst]} of {judged} measures" if judged > 1 else ""


def _bold(verdict: Verdict) -> str:
    return f"bold {STYLES.get(verdict, '')}".rstrip()


def _largest_contributors(run: RunSummary) -> list[PageItem]:
    """The largest shares of the variance of each measure that is shown, fewer of each where there are many."""
    names = shown_measures(run.measures)
    most = FEW_NAMED if len(names) <= FEW_MEASURES else 1
    told = {name: _largest(run.measures[name], most) for name in names}
    rows = [(name, LargestRow(text)) for name, text in told.items() if text != NOTHING]
    notes = map(note, shares_by_words(run.measures[name] for name in names))
    return [BLANK, declared_table("largest contributors", rows), *notes] if rows else []


def _left_out(run: RunSummary, accepted: Accepted | None) -> Iterator[PageItem]:
    """Number of measures without a row, and the verdict of all; nothing if each has a row."""
    left = len(run.measures) - MOST_MEASURES
    if left > 0:
        asked = demand_of(run.study.accept_ppk, accepted)
        found = Counter(JudgedMeasure.of(measure, asked).verdict for measure in run.measures.values())
        counts = ", ".join(f"{found[verdict]} {verdict}" for verdict in get_args(Verdict) if found[verdict])
        yield line(f" and {left} more, all in summary.json; the worst are shown, {WORST_FIRST}")
        yield line(f" all {len(run.measures)} measures: {counts}", "bold")


@dataclass(frozen=True)
class LargestRow:
    """The contributors that most of a measure's variance comes from."""

    shares: Annotated[str, Shows("share of the variance", "words")]


@dataclass(frozen=True)
class VerdictRow:
    """A measure and its verdict.

    Args:
        of: the measure.
        judged: its verdict.
        wide: True where limits have a column of words, because some measure has two.
        asked: those that are shown of "ppk_95", "ppk_by", "largest".
    """

    of: MeasureSummary
    judged: JudgedMeasure
    wide: bool
    asked: Collection[str]

    verdict = Computed(Shows("verdict", "words"), lambda own: own.judged.verdict if own.judges else NOTHING)
    mean = Computed(Shows("mean", "short"), lambda own: ends_of(own.of)[1])
    low = Computed(Shows("low", "short"), lambda own: ends_of(own.of)[0])
    high = Computed(Shows("high", "short"), lambda own: ends_of(own.of)[2])
    one_limit = Computed(Shows("limits", seldom=True), lambda own: None if own.wide else own.limits)
    two_limits = Computed(Shows("limits", "words", seldom=True), lambda own: own.limits if own.wide else None)
    out = Computed(
        Shows("fraction out of limits", "words", below=True),
        lambda own: bounded_share_text(own.judged.out_ppm, own.judged.interval) if own.judges else NOTHING,
    )
    ppk = Computed(Shows("Ppk", ".2f", plain=True), lambda own: own.of.shares.ppk)
    ppk_95 = Computed(
        Shows("95 % of Ppk", "words", below=True, seldom=True),
        lambda own: ppk_bounds_text(own.of) if "ppk_95" in own.asked else None,
    )
    ppk_by = Computed(
        Shows("Ppk by", "words", seldom=True), lambda own: _ppk_by(own.of) if "ppk_by" in own.asked else None
    )
    largest = Computed(
        Shows("mostly from", "words", optional=True, seldom=True),
        lambda own: _largest(own.of, 1) if "largest" in own.asked else None,
    )

    @property
    def unit(self) -> str:
        """Unit of its numbers."""
        return self.of.unit

    @property
    def judges(self) -> bool:
        """True if it has a verdict."""
        return self.judged.verdict != "no limits"

    @property
    def limits(self) -> str:
        """Its limits."""
        return limits_text(*self.of.limits, self.unit)


def verdict_table(
    run: RunSummary, accepted: Accepted | None = None, *, blame: bool = False, brief: bool = False
) -> Table:
    """A row a measure, of many the worst, by the 3D simulation where there is one.

    Args:
        run: what it found.
        accepted: what is asked of a measure; default: what the study asks.
        blame: name the contributor that most of each measure's variance comes from.
        brief: leave out what a Ppk was taken from.
    """
    shown = {name: run.measures[name] for name in shown_measures(run.measures)}
    wide = any(None not in measure.limits for measure in shown.values())
    demand = demand_of(run.study.accept_ppk, accepted)
    with_limits = any(measure.has_limits for measure in run.measures.values())
    found = {"ppk_95": isinstance(demand, AcceptedPpk), "ppk_by": with_limits and not brief, "largest": blame}
    asked = [name for name, is_asked in found.items() if is_asked]
    rows = []
    for name, measure in shown.items():
        row = VerdictRow(measure, JudgedMeasure.of(measure, demand), wide, asked)
        label = f"{name} *" if _by_quantiles(measure) else name
        rows.append((Row(label, (), STYLES.get(row.judged.verdict, ""), measure.unit), row))
    return replace(declared_table("measure", rows), repeated=1)


def ends_of(measure: MeasureSummary) -> tuple[float | None, float | None, float | None]:
    """Low, mean and high as the verdict shows them."""
    return _curve_ends(measure) if measure.take == "curve" else _ends(measure)


def _ends(measure: MeasureSummary) -> tuple[float | None, float | None, float | None]:
    own = next(column for column in columns_of(measure) if column.method == measure.best_method)
    ends = Ends.of(own, bounded=is_bounded(measure))
    return ends.low, own.value("mean"), ends.high


def _curve_ends(measure: MeasureSummary) -> tuple[float | None, float | None, float | None]:
    """The lowest of mean − 3 sigma and the highest of mean + 3 sigma over a curve's positions; it has no one mean."""
    own = measure.curve_sample(measure.best_method)
    pairs = zip(own.mean, own.sigma, strict=True) if own else ()
    known = [(m, s) for m, s in pairs if m is not None and s is not None]
    if not known:
        return None, None, None
    return min(mean - 3 * sigma for mean, sigma in known), None, max(mean + 3 * sigma for mean, sigma in known)


def _by_quantiles(measure: MeasureSummary) -> bool:
    return measure.take != "curve" and is_bounded(measure)


def ppk_bounds_text(measure: MeasureSummary) -> str:
    """Interval of a Ppk, 95 %, one-sided where the trials bound it on one side only."""
    low, high = (None if own is None else f"{own:.2f}" for own in measure.shares.ppk_95 or (None, None))
    if low is None and high is None:
        return NOTHING
    return f"below {high}" if low is None else f"above {low}" if high is None else f"{low} to {high}"


def _ppk_by(measure: MeasureSummary) -> str:
    """Basis of a Ppk, with the reason; "" for a measure without limits, or an older run."""
    own = measure.shares
    if not measure.has_limits or own.ppk_by is None:
        return NOTHING
    return f"{PPK_BY[own.ppk_by]} ({own.ppk_reason})" if own.ppk_reason else PPK_BY[own.ppk_by]


def _largest(measure: MeasureSummary, most: int) -> str:
    """The contributors with the largest shares of the variance; first what is not attributed, if it is much."""
    leading = leading_shares(measure) if measure.take != "curve" else None
    if leading is None:
        return NOTHING
    shares = {name: leading.percents.get(name) or 0.0 for name in ranked_contributors(measure)[:most]}
    named = ", ".join(f"{name} {share:.0f} %" for name, share in shares.items() if share >= LEAST_NAMED)
    words = unexplained_words(measure)
    return f"{words}: {named or NOTHING}" if words else named or NOTHING


def _notes(run: RunSummary) -> Iterator[str]:
    measures = run.measures.values()
    yield (
        "fraction out of limits: of all trials, those included that could not be assembled, with its 95 % confidence "
        "interval; OK if the whole interval is below the accepted share, or that of Ppk above an accepted Ppk, NOT OK "
        "if it is on the other side, else too few trials"
    )
    yield _ends_note(run)
    words = {
        measure.shares.ppk_by: PPK_MEANS[measure.shares.ppk_by]
        for measure in measures
        if measure.has_limits and measure.shares.ppk_by
    }
    if words:
        yield f"Ppk by {'; by '.join(words[key] for key in PPK_BY if key in words)}"


def _other_ppks(run: RunSummary) -> Iterator[str]:
    """A sentence on each Ppk that is not by mean and sigma, with its reason; of many alike their number."""
    limited = [name for name in shown_measures(run.measures) if run.measures[name].has_limits]
    others = {name: own for name in limited if (own := run.measures[name].shares).ppk_by not in (None, PLAIN)}
    named: dict[str, list[str]] = {}
    for name, shares in others.items():
        why = f" ({shares.ppk_reason})" if shares.ppk_reason and len(others) <= FEW_MEASURES else ""
        named.setdefault(f"{shares.ppk_by}{why}", []).append(name)
    for by, names in named.items():
        yield f"Ppk of {', '.join(names) if len(names) <= FEW_MEASURES else counted(len(names), 'measure')}: by {by}"


def _ends_note(run: RunSummary) -> str:
    """Note on the meaning of low and high."""
    measures = run.measures.values()
    ends = "low, high: mean ∓ 3 sigma"
    if any(map(_by_quantiles, measures)):
        ends += "; * the 0.135 % and 99.865 % quantiles, because the trials end before"
    ends += ", of a curve over its positions" if any(measure.take == "curve" for measure in measures) else ""
    return ends + ("; of the assembled trials" if any(map(seated_text, measures)) else "")
