"""A run's results as tables for the terminal, from its summary alone."""

import math
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import replace
from enum import Enum
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from tol3d.gearing.presenting.stage import SUM_KEYS, Sums, sums_of
from tol3d.gearing.presenting.train_tables import train_report
from tol3d.report.agreement import agreement_lines, unexplained_lines
from tol3d.report.column import (
    Column,
    Road,
    best_road,
    columns_of,
    contributor_columns,
    ranked_contributors,
    seated_text,
)
from tol3d.report.ends import is_bounded
from tol3d.report.heading import heading, limits_text, position_of
from tol3d.report.number import (
    NOTHING,
    difference_text,
    given_text,
    percent_text,
    share_text,
    unit_suffix,
    unsigned_zero,
    value_text,
)
from tol3d.report.sheet import Heading, Row, Sheet, note
from tol3d.report.verdict import ACCEPTED_PPM, verdict_report
from tol3d.runs.worst import TRAIN_KINDS

Summary = Mapping[str, Any]

ROWS = {
    "low_3sigma": "low (−3 sigma)",
    "mean": "mean",
    "high_3sigma": "high (+3 sigma)",
    "sigma": "sigma",
    "p0.135": "0.135 % quantile",
    "p50": "50 % quantile",
    "p99.865": "99.865 % quantile",
    "sample_min": "smallest",
    "sample_max": "largest",
}
LOST_MOTION_ROWS = {"low_3sigma": "low", "mean": "mean", "high_3sigma": "high"}
UNIT_HEADINGS = {"um": "[µm]", "mm": "[mm]", "arcmin": "[′, ″ of arc]"}
INDICES = {"pp": "Pp", "ppk": "Ppk"}
BUILDS = {"mean_build": "build at all means", "nominal": "nominal build"}
UNEXPLAINED_SHOWN = 0.05  # %; less is 0.0 in print
NOT_ATTRIBUTED = "not attributed"
NOT_ATTRIBUTED_MEANS = (
    f"{NOT_ATTRIBUTED}: the share of the variance that the regression on the contributors leaves unexplained: "
    "interactions and what is not linear"
)
FAILURES_COUNT = (
    "out of limits is a share of all trials: a jammed build is below every lower limit, one that failed otherwise is "
    "out in all; Ppk of such a column is Φ⁻¹(1 − share out)/3; its other numbers are of the trials that seated"
)
LOST_MOTION_MEANS = (
    "lost motion: the turn of the driven gear that a normal backlash leaves free, j_n over the arm of its flank"
)
SHARES_MEAN = (
    "shares of the variance; high–low–mean: squares of the ranges that each contributor alone gives between its ends, "
    "the others at their means"
)
ATTRIBUTING: Set[Road] = frozenset(("analytic", "geometric"))
MOST_TABLES = 4  # measures whose tables are shown unasked; of 6 they took 288 lines
MORE_TABLES = "tables of every measure: -v"
CURVE_ROWS = 12  # positions of a curve that are printed; the picture and the columns have them all
SHARE_HEADINGS: Mapping[Road, str] = {"analytic": "analytic", "geometric": "3D simulation"}
STATUS_WORDS = {"ok": "seated", "interferes": "jammed", "no contact": "without contact"}
SAMPLER_WORDS = {"sobol": "scrambled Sobol' points", "latin_hypercube": "Latin hypercubes"}
TOO_FEW_TO_BOUND = "too few trials on one side of the limit in each replicate to bound the true share"


class Detail(Enum):
    """How much of a run is shown: one row a measure, that and its trains, or tables of every measure too."""

    VERDICT = 0
    TRAINS = 1
    MEASURES = 2

    @classmethod
    def fitting(cls, summary: Summary) -> "Detail":
        """What fits a screen or two: tables of every measure unless there are many."""
        return cls.MEASURES if len(summary["measures"]) <= MOST_TABLES else cls.TRAINS


def run_report(summary: Summary, detail: Detail = Detail.MEASURES, accepted_ppm: float = ACCEPTED_PPM) -> Group:
    """A run as tables: measures, contributors, trains, how the roads agree, what failed, the verdict, warnings."""
    warnings = [Text(f"warning: {warning}", style="yellow") for warning in summary.get("warnings", ())]
    verdict = verdict_report(summary, accepted_ppm, blame=detail is not Detail.MEASURES)
    if detail is Detail.VERDICT:
        return Group(*verdict, *warnings)
    blocks: list[RenderableType] = [_run_line(summary)]
    if detail is Detail.MEASURES:
        for name, measure in summary["measures"].items():
            blocks += _measure_blocks(name, measure, summary)
    blocks += train_report(summary)
    if detail is Detail.MEASURES and (meanings := list(_meanings(summary))):
        blocks += [Text("\nnotes", style="bold cyan"), *map(note, meanings)]
    blocks += verdict
    blocks += [] if detail is Detail.MEASURES else [note(MORE_TABLES)]
    return Group(*blocks, _status_line(summary), _time_line(summary), *warnings)


def _run_line(summary: Summary) -> Text:
    trials = f"{summary['trials']} trial{'' if summary['trials'] == 1 else 's'}"
    line = Text(str(summary["scene"]), style="bold")
    return line.append(f" · {trials} · seed {summary['seed']} · engine {summary['engine']}", "dim")


def _measure_blocks(name: str, measure: Summary, summary: Summary) -> list[RenderableType]:
    title = Text("\n").append(name, style="bold cyan")
    words = Text(f"{heading(measure)} · {limits_text(measure)}", style="dim")
    if measure["take"] == "curve":
        notes = [*_curve_notes(measure), *_witness_notes(name, measure, summary), *_published_notes(measure)]
        return [title, words, "", curve_table(measure), *map(note, notes)]
    notes = [*_notes(name, measure, summary)]
    sums = sums_of(measure, summary)
    blocks: list[RenderableType] = [title, words, "", measure_table(measure, sums), *map(note, notes)]
    blocks += [Text(f" {line}", style="bold red") for line in unexplained_lines(measure.get("agreement") or {})]
    if measure["contributors"]:
        blocks += ["", contributors_table(measure)]
    return blocks


def _meanings(summary: Summary) -> Iterator[str]:
    """What words in the tables of measures mean, each once for all of them."""
    scalars = [measure for measure in summary["measures"].values() if measure["take"] != "curve"]
    if any(measure["contributors"] for measure in scalars):
        yield SHARES_MEAN
    if any(map(_not_attributed, scalars)):
        yield NOT_ATTRIBUTED_MEANS
    limited = [measure for measure in scalars if _limit_rows(measure)]
    if any(map(seated_text, limited)):
        yield FAILURES_COUNT
    if any("analytic_closed_form" in measure for measure in limited):
        yield "out of limits by the closed form: as if the measure were normal"
    if any("lost_motion" in measure for measure in scalars):
        yield LOST_MOTION_MEANS


def _headings(columns: Sequence[Column]) -> list[Heading]:
    styles = {"geometric": "bold", "published": "green"}
    return [Heading(column.heading, styles.get(column.road, "")) for column in columns]


def measure_table(measure: Summary, sums: Sums) -> Sheet:
    """Statistics of one scalar measure, one column a road, the published ones last; below, sums of a train's stages."""
    columns, unit = columns_of(measure), measure["unit"]
    rows = [*_failure_rows(measure, columns)]
    rows += [Row(label, [_cell(column, key, unit) for column in columns]) for key, label in ROWS.items()]
    rows += [
        Row(label, [share_text(_ppm(column, key, measure)) for column in columns])
        for key, label in _limit_rows(measure).items()
    ]
    rows += [
        Row(label, [_index_text(column.value(key)) for column in columns])
        for key, label in INDICES.items()
        if any(column.value(key) is not None for column in columns)
    ]
    builds = {label: measure.get(key) or {} for key, label in BUILDS.items()}
    rows += [
        Row(label, [value_text(values.get(column.road), unit) for column in columns])
        for label, values in builds.items()
    ]
    rows += [*_lost_motion_rows(measure, columns), *_sum_rows(sums, columns, unit)]
    return Sheet(UNIT_HEADINGS[unit], _headings(columns), rows)


def _cell(column: Column, key: str, unit: str) -> str:
    text = given_text if column.road == "published" else value_text
    return text(column.value(key), unit)


def _index_text(value: float | None) -> str:
    return NOTHING if value is None else unsigned_zero(f"{value:.3f}")


def _failure_rows(measure: Summary, columns: Sequence[Column]) -> Iterator[Row]:
    """How many trials seated, and how the others failed; nothing where all of them seated."""
    if not seated_text(measure):
        return
    own = {"geometric": measure["status"], "analytic": {"ok": sum(measure["status"].values())}}
    for status, count in measure["status"].items():
        if count or status == "ok":
            cells = [str(own[c.road].get(status, 0)) if c.road in own else NOTHING for c in columns]
            yield Row(f"trials {STATUS_WORDS.get(status, status)}", cells)


def _limit_rows(measure: Summary) -> dict[str, str]:
    unit = measure["unit"]
    sides = {
        f"{side}_limit_ppm": f"{side} {given_text(measure[limit], unit)}{unit_suffix(unit)}"
        for side, limit in (("below", "lower_limit"), ("above", "upper_limit"))
        if measure.get(limit) is not None
    }
    in_all = len(sides) > 1 or (sides and seated_text(measure))
    return {**sides, "out_ppm": "out in all"} if in_all else sides


def _ppm(column: Column, key: str, measure: Summary) -> float | None:
    """Counted, or for the closed form that of a normal measure."""
    if column.road != "closed form":
        return column.value(key)
    mean, sigma, lower, upper = (*(column.values[k] for k in ("mean", "sigma")), *limits_of(measure))
    if not sigma:
        return None
    margins = {"below_limit_ppm": None if lower is None else mean - lower}
    margins["above_limit_ppm"] = None if upper is None else upper - mean
    asked = margins.values() if key == "out_ppm" else [margins[key]]
    return sum(1e6 * math.erfc(margin / sigma / math.sqrt(2)) / 2 for margin in asked if margin is not None)


def limits_of(measure: Summary) -> tuple[float | None, float | None]:
    """Lower and upper limit of a measure, None for none."""
    return measure.get("lower_limit"), measure.get("upper_limit")


def _lost_motion_rows(measure: Summary, columns: Sequence[Column]) -> Iterator[Row]:
    motion = measure.get("lost_motion")
    if motion is None:
        return
    for key, word in LOST_MOTION_ROWS.items():
        turns = [(value, motion["arcmin_per_um"]) for value in (column.value(key) for column in columns)]
        cells = [value_text(None if value is None else value * per_um, "arcmin") for value, per_um in turns]
        yield Row(f"lost motion, {word}", cells)


def _sum_rows(sums: Sums, columns: Sequence[Column], unit: str) -> Iterator[Row]:
    """Sums of the stages' ends, where a measure is the sum of a train's stages."""
    if not sums:
        return
    own = [sums.get(column.heading if column.road == "published" else column.road, {}) for column in columns]
    for key, word in SUM_KEYS.items():
        yield Row(f"sum of the stages' {word}", [value_text(values.get(key), unit) for values in own])


def _notes(name: str, measure: Summary, summary: Summary) -> Iterator[str]:
    unit, agreement = measure["unit"], measure.get("agreement")
    if agreement and agreement.get("compared"):
        of_train = measure.get("kind") in TRAIN_KINDS
        yield from agreement_lines(agreement, unit, summary.get("chord_error_um"), " in each mesh" if of_train else "")
    yield from _witness_notes(name, measure, summary)
    own = measure[best_road(measure)]
    seated = " that seated" if seated_text(measure) else ""
    if own.get("mean_se") is not None and own.get("sigma_se") is not None:
        yield (
            f"sampling error of {own['count']} trials{seated}{_by_replicates(own, summary)}: "
            f"mean ±{difference_text(own['mean_se'], unit)}, "
            f"sigma ±{difference_text(own['sigma_se'], unit)} (one standard error)"
        )
    if is_bounded(measure):
        yield "trials end before mean ∓ 3 sigma here: the quantiles tell more than low and high"
    for key, label in _limit_rows(measure).items():
        low_high = own.get(f"{key}_95")
        if low_high:
            low, high = map(share_text, low_high)
            yield f"{label}: the true share lies between {low} and {high} (95 % confidence)"
        elif own.get("error_by") == "replicates":
            yield f"{label}: {TOO_FEW_TO_BOUND}"
    yield from _published_notes(measure)


def _published_notes(measure: Summary) -> Iterator[str]:
    """What the scene says of other people's numbers."""
    for column, values in measure.get("published", {}).items():
        if values.get("description"):
            yield f"{column}: {values['description']}"


def _by_replicates(sample: Summary, summary: Summary) -> str:
    """What tells the error, where it is not the trials themselves."""
    if sample.get("error_by") != "replicates":
        return ""
    study = summary["study"]
    return f" of {SAMPLER_WORDS[study['sampler']]}, by the spread of {study['replicates']} replicates"


def _witness_notes(name: str, measure: Summary, summary: Summary) -> Iterator[str]:
    """What FCL found of the trials that it measured again."""
    witness = summary.get("witness") or {"measures": {}}
    found = witness["measures"].get(name)
    if found is None:
        return
    again = f"witness: FCL measured {witness['trials']} of these trials again"
    if not found["compared"]:
        yield f"{again}: none of them has a value on both sides"
        return
    largest = difference_text(found["max_abs_difference"], measure["unit"])
    chords = difference_text(found["expected_at_most"], measure["unit"])
    yield f"{again}: at most {largest} more or less (up to {chords} of that is the chord error of its strips)"


def contributors_table(measure: Summary) -> Sheet:
    """Shares of the variance, the largest first; those of the 3D simulation with their standard error."""
    shares = [
        replace(column, heading=SHARE_HEADINGS.get(column.road, column.heading))
        for column in contributor_columns(measure)
    ]
    errors = {c["name"]: c.get("geometric_percent_se") for c in measure["contributors"]}
    rows = [
        Row(name, [_share(column, name, errors[name]) for column in shares]) for name in ranked_contributors(measure)
    ]
    left = _not_attributed(measure)
    if left:
        rows.append(Row(NOT_ATTRIBUTED, [percent_text(rest) for rest in left], "dim"))
    return Sheet("share [%]", _headings(shares), rows)


def _share(column: Column, name: str, error: float | None) -> str:
    text = percent_text(column.percents.get(name))
    return f"{text} ±{error:.1f}" if column.road == "geometric" and error is not None else text


def _not_attributed(measure: Summary) -> list[float | None]:
    """What each road leaves to no contributor [%], None for other columns; empty where that is nothing in print."""
    left = [
        100 - sum(share or 0.0 for share in column.percents.values()) if column.road in ATTRIBUTING else None
        for column in contributor_columns(measure)
    ]
    return left if any(abs(rest or 0.0) > UNEXPLAINED_SHOWN for rest in left) else []


def curve_table(measure: Summary) -> Sheet:
    """A curve measure at some of its positions."""
    unit, curve = measure["unit"], measure["curve"]
    roads = [(road, word) for road, word in (("analytic", "analytic"), ("geometric", "3D")) if road in curve]
    columns = [(road, key, f"{word} {key}") for road, word in roads for key in ("mean", "sigma")]
    leading, word = roads[-1]
    columns += [(leading, "min", f"{word} smallest"), (leading, "max", f"{word} largest")]
    headings = [Heading(text, "bold" if road == "geometric" else "") for road, _, text in columns]
    positions = [unsigned_zero(f"{position:.1f}") for position in measure["position_deg"]]
    longest = max(map(len, positions), default=0)
    rows = [
        Row(positions[index].rjust(longest), [value_text(curve[road][key][index], unit) for road, key, _ in columns])
        for index in _shown_positions(measure)
    ]
    return Sheet(f"{position_of(measure)} at [°]", headings, rows)


def _shown_positions(measure: Summary) -> range:
    count = len(measure["position_deg"])
    return range(0, count, max(1, -(-count // CURVE_ROWS)))


def _curve_notes(measure: Summary) -> Iterator[str]:
    """How many positions are left out, and the share of the trials that is out of a limit anywhere on its curve."""
    shown, count = len(_shown_positions(measure)), len(measure["position_deg"])
    if shown < count:
        yield f"{shown} of {count} positions shown; all in summary.json"
    if seated := seated_text(measure):
        yield f"3D mean, sigma, smallest and largest are {seated} at every position"
    words = {"lower_limit": "below", "upper_limit": "above"}
    for limit, word in words.items():
        if measure.get(limit) is not None:
            given = given_text(measure[limit], measure["unit"]) + unit_suffix(measure["unit"])
            yield f"anywhere {word} {given}, of all trials: " + ", ".join(
                f"{'3D' if road == 'geometric' else road} {share_text(own[f'{word}_limit_ppm'])}"
                for road, own in measure["curve"].items()
            )


def _status_line(summary: Summary) -> Text:
    trials = summary["trials"]
    failed = {text: count for text, count in summary["status"].items() if text != "ok" and count}
    line = Text("\ntrials: ").append(f"{summary['status'].get('ok', 0)} seated")
    for status, count in failed.items():
        line.append(f", {count} {STATUS_WORDS.get(status, status)} ({share_text(1e6 * count / trials)})", "red")
    return line if failed else line.append(", none failed")


def _time_line(summary: Summary) -> Text:
    timing = summary["timing"]
    workers = f" by {timing['workers']} workers" if timing.get("workers", 1) != 1 else ""
    return Text(
        f"time: {timing['setup_s']:.1f} s to set up, {timing['simulate_s']:.1f} s for the trials{workers}, "
        f"{timing['trials_per_s']:.0f} trials/s"
    )
