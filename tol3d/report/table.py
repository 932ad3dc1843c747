"""A run's results as tables for the terminal, from its summary alone."""

from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from typing import NamedTuple

from tol3d.report.column import NOT_ATTRIBUTED, is_bounded, seated_text, shares_by_words
from tol3d.report.heading import MOST_CONTRIBUTORS, limits_text, shown_measures
from tol3d.report.joint import correlation_blocks
from tol3d.report.measure_table import (
    SIDES,
    contributors_table,
    curve_table,
    limit_rows,
    measure_table,
    not_attributed,
    shown_positions,
)
from tol3d.report.number import (
    COUNTED,
    NOTHING,
    counted,
    difference_text,
    limit_text,
    measured_text,
    percent_text,
    share_text,
)
from tol3d.report.page import BLANK, Line, Page, PageItem, line, note, page, some, title, warning
from tol3d.report.presenter import Presenter, ShowsNotes, presenter_of
from tol3d.report.published import published_blocks, published_notes
from tol3d.report.shown_unit import shown_run
from tol3d.report.spectrum_table import spectrum_blocks
from tol3d.report.verdict import ppk_bounds_text, short_verdict, verdict_report
from tol3d.study.runs.summary.agreement import Agreement, Explanation, LinearPart
from tol3d.study.runs.summary.judged import Accepted
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.sample import CurveMethods, Sample
from tol3d.study.system.outcome import SEATED

NAMED = 3  # contributors of one reason


def agreement_lines(agreement: Agreement, unit: str, chord_words: str = "") -> Iterator[str]:
    """The differences trial by trial, what the tessellation may explain of them, and what else does.

    Args:
        agreement: of a measure.
        unit: its unit.
        chord_words: what chord errors may explain; nothing where there are none.
    """
    line = (
        f"3D simulation − analytic, trial by trial: at most {difference_text(agreement.max_abs_difference, unit)}, "
        f"rms {difference_text(agreement.rms_difference, unit)}, "
        f"mean {difference_text(agreement.mean_difference, unit)}"
    )
    line += f"; {chord_words}" if chord_words else ""
    explanation = agreement.explanation
    if explanation is None:
        yield line
    elif explanation.undecided:
        yield f"{line}; {explanation.undecided}"
    elif explanation.faults:
        yield line
    else:
        why = [_of_first_order(explanation), _of_second_order(explanation, unit), *_neglected(explanation, unit)]
        yield f"{line}; difference explained; {'; '.join(why)}"
        yield from _left_out(explanation.linear)


def unexplained_lines(agreement: Agreement | None) -> list[str]:
    """Lines on unexplained differences."""
    explanation = agreement.explanation if agreement else None
    return [f"NOT EXPLAINED: {fault}" for fault in (explanation.faults if explanation else ())]


def _of_first_order(explanation: Explanation) -> str:
    other = "other " if explanation.linear else ""
    largest = explanation.largest_percent
    if not largest:  # counts what is more than noise
        return f"no {other}contributor is significant"
    return f"no {other}contributor explains more of it than {largest:.2g} % of its own effect"


def _of_second_order(explanation: Explanation, unit: str) -> str:
    rms = explanation.second_order_rms
    if unit in COUNTED:
        return "values near a bound are counted by one method and not by the other"
    if rms is None:
        return "the order of the rest is unknown, for the nominal build could not be assembled"
    named = ", ".join(explanation.second_order_of)
    shift = difference_text(explanation.second_order_mean, unit)
    terms = f"second-order terms: rms {difference_text(rms, unit)}, mean {shift}"
    return f"{terms}, mainly from {named}" if named else terms


def _neglected(explanation: Explanation, unit: str) -> Iterator[str]:
    """Neglected terms of the stack-up that no contributor explains, if they are visible at all."""
    nothing, shown = difference_text(0.0, unit), {part.by for part in explanation.linear}
    for what, rms in explanation.neglected.items():
        if what not in shown and (text := difference_text(rms, unit)) != nothing:
            yield f"the stack-up leaves out {what}: rms {text}"


def _left_out(linear: Sequence[LinearPart]) -> Iterator[str]:
    """A line for each thing that the stack-up leaves out, with the contributors that it explains."""
    for reason in dict.fromkeys(part.by for part in linear):
        own = sorted((part for part in linear if part.by == reason), key=lambda part: -part.percent)
        named = ", ".join(f"{part.contributor} {percent_text(part.percent)} %" for part in own[:NAMED])
        more = f" and {len(own) - NAMED} more" if len(own) > NAMED else ""
        what = reason if reason.startswith("second order") else f"the stack-up leaves out: {reason}"
        yield f"{what} (of their own effects: {named}{more})"


NOT_ATTRIBUTED_MEANS = (
    f"{NOT_ATTRIBUTED}: the share of the variance that a linear regression on the contributors does not explain "
    "(interactions, nonlinear effects)"
)
SHARES_MEAN = (
    "shares of the variance; high–low–mean: squared range of each contributor alone, from one of its limits to the "
    "other, with the others at their means"
)
MORE = "more with -v: all tables, agreement of the methods, sampling errors"
MORE_CONTRIBUTORS = f"shares: the {MOST_CONTRIBUTORS} largest of each measure and the sum of the others"
SAMPLER_WORDS = {"sobol": "scrambled Sobol' points", "latin_hypercube": "Latin hypercubes"}


class Elapsed(NamedTuple):
    """Time taken by a command [s]: before its run, to load libraries and the scene, and in all until now."""

    loading: float
    whole: float


class Detail(Enum):
    """Detail shown of a run: the verdict, a first look with the largest contributors, or everything."""

    VERDICT = 0
    SHORT = 1
    MEASURES = 2


def run_report(
    run: RunSummary,
    detail: Detail = Detail.MEASURES,
    accepted: Accepted | None = None,
    presenter: str | None = None,
    elapsed: Elapsed | None = None,
) -> Page:
    """A run as tables: the verdict, measures, contributors, how the methods agree, what failed, warnings.

    Args:
        run: what it found.
        detail: how much of it is shown.
        accepted: what is asked of a measure; default: what the study asks.
        presenter: import path of what shows more of the system; by default that of the run's measures.
        elapsed: what the command took besides what the run tells of itself.
    """
    shown = shown_run(run)
    warnings = [*map(warning, some(run.warnings, ", all in summary.json"))]
    if detail is Detail.VERDICT:
        return page(*verdict_report(shown, accepted, blame=True), *warnings)
    own = presenter_of(run, presenter)
    if detail is Detail.SHORT:
        head = [_run_line(run), *short_verdict(shown, accepted), *_unexplained(shown)]
        told = own.first_notes(run) if isinstance(own, ShowsNotes) else ()
        return page(*head, status_line(run), _time_line(run, elapsed, brief=True), *told, note(MORE), *warnings)
    blocks: list[PageItem] = [_run_line(run), *verdict_report(shown, accepted)]
    for name in shown_measures(shown.measures):
        blocks += measure_blocks(name, shown.measures[name], shown, own)
    blocks += [*own.sections(run), *published_blocks(run), *correlation_blocks(run)]
    if words := list(meanings(shown)):
        blocks += [title("notes"), *map(note, words)]
    return page(*blocks, status_line(run), _time_line(run, elapsed), *warnings)


def _unexplained(run: RunSummary) -> list[PageItem]:
    """Differences of the methods that are not explained, of the measures that are shown."""
    names = shown_measures(run.measures)
    told = [(name, text) for name in names for text in unexplained_lines(run.measures[name].agreement)]
    return [line(f"{name}: {text}", "bold red") for name, text in told]


def _run_line(run: RunSummary) -> Line:
    trials = counted(run.trials, "trial")
    return Line(((run.scene, "bold"), (f" · {trials} · seed {run.seed} · engine {run.engine}", "bold dim")))


def measure_blocks(name: str, measure: MeasureSummary, run: RunSummary, presenter: Presenter) -> list[PageItem]:
    """A measure: its title, what it is, its table and notes, then its contributors."""
    head = [title(name), line(f"{measure.words} · {limits_text(measure)}", "dim"), BLANK]
    if measure.curve is not None and measure.take == "curve":
        notes = [*_curve_notes(measure, measure.curve), *_witness_notes(name, measure, run), *published_notes(measure)]
        spectrum = spectrum_blocks(measure, measure.curve)
        return [*head, curve_table(measure, measure.curve), *map(note, notes), *spectrum]
    notes = [*_notes(name, measure, run)]
    further = presenter.measure_rows(measure, run)
    blocks: list[PageItem] = [*head, measure_table(run, measure, further), *map(note, notes)]
    blocks += [line(f" {text}", "bold red") for text in unexplained_lines(measure.agreement)]
    if measure.contributors:
        blocks += [BLANK, contributors_table(measure)]
    return blocks


def meanings(run: RunSummary) -> Iterator[str]:
    """Meanings of the words in tables of measures, each once for all of them."""
    scalars = [measure for measure in run.measures.values() if measure.take != "curve"]
    if any(measure.contributors for measure in scalars):
        yield SHARES_MEAN
    if any(len(measure.contributors) > MOST_CONTRIBUTORS for measure in scalars):
        yield f"{MORE_CONTRIBUTORS}; all in summary.json"
    if any(map(not_attributed, scalars)):
        yield NOT_ATTRIBUTED_MEANS
    yield from shares_by_words(scalars)
    limited = [measure for measure in scalars if limit_rows(measure)]
    if any(map(seated_text, limited)):
        yield _failures_count(run)
    if any(measure.analytic_closed_form for measure in limited):
        yield "out of limits in the closed form: for a normal distribution"
    yield from dict.fromkeys(other.meaning for measure in scalars for other in measure.conversions)


def _failures_count(run: RunSummary) -> str:
    """Words on failed builds among those out of limits."""
    lacking = " or ".join(run.state(status) for status in run.statuses if status in run.lacking)
    other = "a build that could not be assembled"
    below = f"a build that is {lacking} is below every lower limit, and any other that could not be assembled"
    return (
        f"the fraction out of limits is of all trials: {below if lacking else other} counts as out; Ppk of such a "
        "column is Φ⁻¹(1 − fraction out)/3; its other numbers are of the assembled trials"
    )


def _notes(name: str, measure: MeasureSummary, run: RunSummary) -> Iterator[str]:
    unit, agreement, chords = measure.unit, measure.agreement, run.chord_error_um
    if agreement and agreement.compared:
        yield from agreement_lines(agreement, unit, measure.chord_words(chords) if chords else "")
    yield from _witness_notes(name, measure, run)
    if own := measure.sample(measure.best_method):
        yield from _sampling_notes(measure, own, run)
    yield from published_notes(measure)


def _sampling_notes(measure: MeasureSummary, sample: Sample, run: RunSummary) -> Iterator[str]:
    """Notes on the sampling errors of mean, sigma, ends and shares."""
    unit = measure.unit
    assembled = "assembled " if seated_text(measure) else ""
    if sample.mean_se is not None and sample.sigma_se is not None:
        mean, sigma, words = sample.mean_se, sample.sigma_se, "one standard error"
        if sample.error_by == "replicates" and sample.mean_95 and sample.sigma_95:  # not in runs made before
            mean, sigma = (((high or 0.0) - (low or 0.0)) / 2 for low, high in (sample.mean_95, sample.sigma_95))
            words = "95 % confidence, Student's t"
        yield (
            f"sampling error of {sample.count} {assembled}trials{_by_replicates(sample, run)}: "
            f"mean ±{difference_text(mean, unit)}, sigma ±{difference_text(sigma, unit)} ({words})"
        )
    if is_bounded(measure):
        yield "the distribution ends before mean ∓ 3 sigma: use the quantiles instead of low and high"
    for words, quantile in (("0.135 % quantile", sample.p0_135_95), ("99.865 % quantile", sample.p99_865_95)):
        if quantile:
            low, high = (measured_text(end, unit) for end in quantile)
            yield f"{words}: 95 % confidence interval {low} to {high}"
    if (bounds := ppk_bounds_text(measure)) != NOTHING:
        yield f"Ppk: 95 % confidence interval {bounds}"
    for key, label in limit_rows(measure).items():
        low_high = getattr(sample, f"{key}_95")
        if low_high:
            low, high = map(share_text, low_high)
            yield f"{label}: 95 % confidence interval of the fraction {low} to {high}"


def _by_replicates(sample: Sample, run: RunSummary) -> str:
    """Words on replicates as the basis of the error; "" if the trials themselves are."""
    if sample.error_by != "replicates":
        return ""
    return f" of {SAMPLER_WORDS[run.study.sampler]}, by the spread of {run.study.replicates} replicates"


def _witness_notes(name: str, measure: MeasureSummary, run: RunSummary) -> Iterator[str]:
    """Notes on the witness' results for the trials that it measured again."""
    found = run.witness.measures.get(name) if run.witness else None
    if run.witness is None or found is None:
        return
    again = f"witness: {run.witness.engine.upper()} measured {run.witness.trials} of these trials again"
    if not found.compared:
        yield f"{again}: none of them has a value by both engines"
        return
    largest = difference_text(found.max_abs_difference, measure.unit)
    chords = difference_text(found.expected_at_most, measure.unit)
    yield f"{again}: within ±{largest} (chord error of its triangles: up to {chords})"


def _curve_notes(measure: MeasureSummary, curve: CurveMethods) -> Iterator[str]:
    """Notes on positions left out, and on the fraction of trials out of a limit anywhere on its curve."""
    shown, count = len(shown_positions(measure)), len(measure.position_deg or ())
    if shown < count:
        yield f"{shown} of {count} positions shown; all in summary.json"
    if seated := seated_text(measure):
        yield f"3D mean, sigma, smallest and largest are {seated} at every position"
    for limit, word in zip(measure.limits, SIDES, strict=True):
        if limit is not None:
            given = limit_text(limit, measure.unit)
            yield f"anywhere {word} {given}, of all trials: " + ", ".join(
                f"{'3D' if method == 'geometric' else method} {share_text(own.value(f'{word}_limit_ppm'))}"
                for method, own in curve.by_method.items()
            )


def status_line(run: RunSummary) -> Line:
    """Counts of the trials that were assembled, and of those that could not be, with the reasons."""
    failed = {text: count for text, count in run.status.items() if text != SEATED and count}
    good, lost = run.status.get(SEATED, 0), sum(failed.values())
    if not lost:
        return line(f"\ntrials: all {good} assembled")
    ended = ", ".join(f"{count} {run.state(status)}" for status, count in failed.items())
    by = ", ".join(f"{reason} {count}" for reason, count in [*reasons_of(run).items()][:NAMED])
    why = f"{ended}; mostly by {by}" if by else ended
    words = f", {lost} could not be assembled ({share_text(1e6 * lost / run.trials)}): {why}"
    return Line(((f"\ntrials: {good} assembled", ""), (words, "red")))


def reasons_of(run: RunSummary) -> Mapping[str, int]:
    """Reasons of the failures of the measure that failed most often, the most frequent first."""
    worst = max(run.measures.values(), key=lambda own: own.trials - own.seated)
    return worst.reasons or {}


def _time_line(run: RunSummary, elapsed: Elapsed | None, *, brief: bool = False) -> Line:
    """Time by stage, complete if the command's own time is known."""
    timing = run.timing
    if brief and elapsed is not None:
        return line(f"time: {elapsed.whole:.1f} s")
    workers = f" by {timing.workers} workers" if timing.workers != 1 else ""
    trials = f"for the trials{workers} ({timing.trials_per_s:.0f} trials/s)"
    spent = {"to set up": timing.setup_s, trials: timing.simulate_s}
    known = {"for their statistics": timing.findings_s, "for pictures": timing.pictures_s}  # not in runs made before
    spent |= {word: seconds for word, seconds in known.items() if seconds is not None}
    whole = ""
    if elapsed is not None:
        spent = {"to load": elapsed.loading, **spent}
        spent["for files"] = max(elapsed.whole - sum(spent.values()), 0.0)
        whole = f"{elapsed.whole:.1f} s in all: "
    return line(f"time: {whole}{', '.join(f'{seconds:.1f} s {word}' for word, seconds in spent.items())}")
