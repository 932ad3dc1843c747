"""A run's results as tables for the terminal, from its summary alone."""

from collections.abc import Iterator, Sequence
from enum import Enum
from typing import NamedTuple

from tol3d.report.column import seated_text
from tol3d.report.ends import is_bounded
from tol3d.report.heading import MOST_CONTRIBUTORS, MOST_MEASURES, limits_text, shown_measures
from tol3d.report.joint import correlation_blocks
from tol3d.report.measure_table import (
    NOT_ATTRIBUTED,
    SIDES,
    contributors_table,
    curve_table,
    limit_rows,
    measure_table,
    not_attributed,
    shown_positions,
)
from tol3d.report.number import COUNTED, difference_text, limit_text, percent_text, share_text
from tol3d.report.page import BLANK, Line, Page, PageItem, line, note, page, some, title, warning
from tol3d.report.presenter import Presenter, presenter_of
from tol3d.report.published import published_blocks, published_notes
from tol3d.report.shown_unit import shown_run
from tol3d.report.spectrum_table import spectrum_blocks
from tol3d.report.verdict import ACCEPTED_PPM, verdict_report
from tol3d.runs.summary.agreement import Agreement, Explanation, LinearPart
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.run import RunSummary
from tol3d.runs.summary.sample import CurveMethods, Sample
from tol3d.system.outcome import SEATED

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
        yield f"{line}; explained: {'; '.join(why)}"
        yield from _left_out(explanation.linear)


def unexplained_lines(agreement: Agreement | None) -> list[str]:
    """Lines on unexplained differences."""
    explanation = agreement.explanation if agreement else None
    return [f"NOT EXPLAINED: {fault}" for fault in (explanation.faults if explanation else ())]


def _of_first_order(explanation: Explanation) -> str:
    other = "other " if explanation.linear else ""
    largest = explanation.largest_percent
    if not largest:  # counts contributors beyond chance
        return f"no {other}contributor has a part in it beyond chance"
    return f"no {other}contributor's part in it is above {largest:.2g} % of its own effect"


def _of_second_order(explanation: Explanation, unit: str) -> str:
    rms = explanation.second_order_rms
    if unit in COUNTED:
        return "what is near a bound one method counts and the other does not"
    if rms is None:
        return "of what order the rest is cannot be told, for nominal builds do not seat"
    named = ", ".join(explanation.second_order_of)
    shift = difference_text(explanation.second_order_mean, unit)
    terms = f"terms of second order have rms {difference_text(rms, unit)}, mean {shift}"
    return f"{terms}, the most by {named}" if named else terms


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
    f"{NOT_ATTRIBUTED}: the share of the variance that the regression on the contributors leaves unexplained: "
    "interactions and what is not linear"
)
SHARES_MEAN = (
    "shares of the variance; high–low–mean: squares of the ranges that each contributor alone gives between its ends, "
    "the others at their means"
)
MOST_TABLES = 4  # measures whose tables are shown unasked; of 6 they took 288 lines
MORE_TABLES = "tables of every measure: -v, and how they are correlated"
MORE_CONTRIBUTORS = f"shares: the {MOST_CONTRIBUTORS} largest of each measure and the sum of the others"
SAMPLER_WORDS = {"sobol": "scrambled Sobol' points", "latin_hypercube": "Latin hypercubes"}


class Elapsed(NamedTuple):
    """Time taken by a command [s]: before its run, to load libraries and the scene, and in all until now."""

    loading: float
    whole: float


class Detail(Enum):
    """Detail shown of a run: one row per measure, that with its system's sections, or full tables of every measure."""

    VERDICT = 0
    SECTIONS = 1
    MEASURES = 2

    @classmethod
    def fitting(cls, run: RunSummary) -> "Detail":
        """Detail that fits a screen or two: tables of every measure unless there are many."""
        return cls.MEASURES if len(run.measures) <= MOST_TABLES else cls.SECTIONS


def run_report(
    run: RunSummary,
    detail: Detail = Detail.MEASURES,
    accepted_ppm: float = ACCEPTED_PPM,
    presenter: str | None = None,
    elapsed: Elapsed | None = None,
) -> Page:
    """A run as tables: measures, contributors, how the methods agree, what failed, the verdict, warnings.

    Args:
        run: what it found.
        detail: how much of it is shown.
        accepted_ppm: share of trials that may be out of a measure's limits.
        presenter: import path of what shows more of the system; by default that of the run's measures.
        elapsed: what the command took besides what the run tells of itself.
    """
    own, shown = presenter_of(run, presenter), shown_run(run)
    warnings = [*map(warning, some(run.warnings, ", all in summary.json"))]
    verdict = verdict_report(shown, accepted_ppm, blame=detail is not Detail.MEASURES)
    if detail is Detail.VERDICT:
        return page(*verdict, *warnings)
    blocks: list[PageItem] = [_run_line(run)]
    if detail is Detail.MEASURES:
        for name in shown_measures(shown.measures):
            blocks += measure_blocks(name, shown.measures[name], shown, own)
    blocks += own.sections(run)
    blocks += published_blocks(run)
    blocks += correlation_blocks(run) if detail is Detail.MEASURES else []
    if detail is Detail.MEASURES and (words := list(meanings(shown))):
        blocks += [title("notes"), *map(note, words)]
    blocks += verdict
    blocks += [] if detail is Detail.MEASURES else [note(_more_tables(run))]
    return page(*blocks, status_line(run), _time_line(run, elapsed), *warnings)


def _more_tables(run: RunSummary) -> str:
    return MORE_TABLES if len(run.measures) <= MOST_MEASURES else MORE_TABLES.replace("every measure", "these measures")


def _run_line(run: RunSummary) -> Line:
    trials = f"{run.trials} trial{'' if run.trials == 1 else 's'}"
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
    limited = [measure for measure in scalars if limit_rows(measure)]
    if any(map(seated_text, limited)):
        yield _failures_count(run)
    if any(measure.analytic_closed_form for measure in limited):
        yield "out of limits by the closed form: as if the measure were normal"
    yield from dict.fromkeys(other.meaning for measure in scalars for other in measure.conversions)


def _failures_count(run: RunSummary) -> str:
    """Words on failed builds among those out of limits."""
    lacking = " or ".join(run.state(status) for status in run.statuses if status in run.lacking)
    below = f"a build that is {lacking} is below every lower limit, one that failed otherwise" if lacking else ""
    return (
        f"out of limits is a share of all trials: {below or 'a build that failed'} is out in all; Ppk of such a column "
        "is Φ⁻¹(1 − share out)/3; its other numbers are of the trials that seated"
    )


def _notes(name: str, measure: MeasureSummary, run: RunSummary) -> Iterator[str]:
    unit, agreement, chords = measure.unit, measure.agreement, run.chord_error_um
    if agreement and agreement.compared:
        yield from agreement_lines(agreement, unit, measure.chord_words(chords) if chords else "")
    yield from _witness_notes(name, measure, run)
    if own := measure.sample(measure.best_method):
        yield from _sampling_notes(measure, own, run)
    yield from published_notes(measure)


def _sampling_notes(measure: MeasureSummary, own: Sample, run: RunSummary) -> Iterator[str]:
    """Notes on the sampling errors of mean, sigma, ends and shares."""
    unit = measure.unit
    seated = " that seated" if seated_text(measure) else ""
    if own.mean_se is not None and own.sigma_se is not None:
        mean, sigma, words = own.mean_se, own.sigma_se, "one standard error"
        if own.error_by == "replicates" and own.mean_95 and own.sigma_95:  # not in runs made before
            mean, sigma = (((high or 0.0) - (low or 0.0)) / 2 for low, high in (own.mean_95, own.sigma_95))
            words = "95 % confidence, Student's t"
        yield (
            f"sampling error of {own.count} trials{seated}{_by_replicates(own, run)}: "
            f"mean ±{difference_text(mean, unit)}, sigma ±{difference_text(sigma, unit)} ({words})"
        )
    if is_bounded(measure):
        yield "trials end before mean ∓ 3 sigma here: the quantiles say more than low and high"
    for key, label in limit_rows(measure).items():
        low_high = getattr(own, f"{key}_95")
        if low_high:
            low, high = map(share_text, low_high)
            yield f"{label}: the true share lies between {low} and {high} (95 % confidence)"


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
        yield f"{again}: none of them has a value on both sides"
        return
    largest = difference_text(found.max_abs_difference, measure.unit)
    chords = difference_text(found.expected_at_most, measure.unit)
    yield f"{again}: at most {largest} more or less (up to {chords} of that is the chord error of its triangles)"


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
    """Counts of the trials that seated, and of those that failed, by their statuses."""
    failed = {text: count for text, count in run.status.items() if text != SEATED and count}
    pieces = [(f"\ntrials: {run.status.get(SEATED, 0)} seated", "")]
    for status, count in failed.items():
        share = share_text(1e6 * count / run.trials)
        pieces.append((f", {count} {run.state(status)} ({share})", "red"))
    return Line((*pieces, *(() if failed else ((", none failed", ""),))))


def _time_line(run: RunSummary, elapsed: Elapsed | None) -> Line:
    """Time by stage, complete if the command's own time is known."""
    timing = run.timing
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
