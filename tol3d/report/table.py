"""A run's results as tables for the terminal, from its summary alone."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from rich import box
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from tol3d.report.column import Column, Road, best_road, columns_of, ranked_contributors, shares_of
from tol3d.report.heading import heading, limits_text
from tol3d.report.number import (
    NOTHING,
    UNIT_SIGNS,
    difference_text,
    given_text,
    percent_text,
    ppm_text,
    value_text,
)

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
UNIT_HEADINGS = {"um": "[µm]", "arcmin": "[′, ″ of arc]"}
INDICES = {"pp": "Pp", "ppk": "Ppk"}
BUILDS = {"mean_build": "build at all means", "nominal": "nominal build"}
UNEXPLAINED_SHOWN = 0.05  # %; less is 0.0 in print
CURVE_ROWS = 12  # positions of a curve that are printed; the picture and the columns have them all
SHARE_HEADINGS: Mapping[Road, str] = {"analytic": "analytic", "geometric": "3D simulation"}
STATUS_WORDS = {"ok": "seated", "interferes": "interfering", "no contact": "without contact"}
FLANKS_OF_A_BACKLASH = 4  # two at the contact, two at the gap; each may miss the true flank by the chord error


def run_report(summary: Summary) -> Group:
    """All tables of a run: each measure, its contributors, how the roads agree, what failed, how long it took."""
    blocks: list[RenderableType] = [_run_line(summary)]
    for name, measure in summary["measures"].items():
        blocks += _measure_blocks(name, measure, summary)
    blocks += [_status_line(summary), _time_line(summary)]
    blocks += [Text(f"warning: {warning}", style="yellow") for warning in summary.get("warnings", ())]
    return Group(*blocks)


def _run_line(summary: Summary) -> Text:
    trials = f"{summary['trials']} trial{'' if summary['trials'] == 1 else 's'}"
    line = Text(str(summary["scene"]), style="bold")
    return line.append(f" · {trials} · seed {summary['seed']} · engine {summary['engine']}", "dim")


def _measure_blocks(name: str, measure: Summary, summary: Summary) -> list[RenderableType]:
    title = Text("\n").append(name, style="bold cyan")
    words = Text(f"{heading(measure)} · {limits_text(measure)}", style="dim")
    if measure["take"] == "curve":
        return [title, words, "", curve_table(measure), *_curve_limits(measure)]
    blocks: list[RenderableType] = [title, words, "", measure_table(measure)]
    blocks += [Padding(Text(line, style="dim"), (0, 0, 0, 1)) for line in _notes(measure, summary)]
    if measure["contributors"]:
        blocks += ["", contributors_table(measure)]
    return blocks


def _table(columns: Sequence[Column], corner: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1), header_style="bold")
    table.add_column(Text(corner))
    for column in columns:
        style = {"geometric": "bold", "published": "green"}.get(column.road, "")
        table.add_column(Text(column.heading), justify="right", style=style)
    return table


def measure_table(measure: Summary) -> Table:
    """Statistics of one scalar measure, one column a road, the published ones last."""
    columns, unit = columns_of(measure), measure["unit"]
    table = _table(columns, UNIT_HEADINGS[unit])
    table.columns[0].no_wrap = True
    table.collapse_padding = True
    for key, label in ROWS.items():
        table.add_row(Text(label), *(_cell(column, key, unit) for column in columns))
    for key, label in _limit_rows(measure).items():
        table.add_row(Text(label), *(ppm_text(_ppm(column, key, measure)) for column in columns))
    for key, label in INDICES.items():
        if any(column.value(key) is not None for column in columns):
            table.add_row(label, *(_index_text(column.value(key)) for column in columns))
    for key, label in BUILDS.items():
        values = measure.get(key) or {}
        table.add_row(label, *(value_text(values.get(column.road), unit) for column in columns))
    for label, cells in _lost_motion_rows(measure, columns):
        table.add_row(Text(label), *cells)
    return table


def _cell(column: Column, key: str, unit: str) -> str:
    text = given_text if column.road == "published" else value_text
    return text(column.value(key), unit)


def _index_text(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3f}"


def _limit_rows(measure: Summary) -> dict[str, str]:
    unit = measure["unit"]
    sign = "" if unit == "arcmin" else f" {UNIT_SIGNS[unit]}"
    return {
        f"{side}_limit_ppm": f"{side} {given_text(measure[limit], unit)}{sign} [ppm]"
        for side, limit in (("below", "lower_limit"), ("above", "upper_limit"))
        if measure.get(limit) is not None
    }


def _ppm(column: Column, key: str, measure: Summary) -> float | None:
    """Counted, or for the closed form that of a normal measure."""
    if column.road != "closed form":
        return column.value(key)
    mean, sigma = column.values["mean"], column.values["sigma"]
    if not sigma:
        return None
    margin = mean - measure["lower_limit"] if key.startswith("below") else measure["upper_limit"] - mean
    return 1e6 * math.erfc(margin / sigma / math.sqrt(2)) / 2


def _lost_motion_rows(measure: Summary, columns: Sequence[Column]) -> Iterator[tuple[str, list[str]]]:
    motion = measure.get("lost_motion")
    if motion is None:
        return
    for key, word in LOST_MOTION_ROWS.items():
        turns = [(value, motion["arcmin_per_um"]) for value in (column.value(key) for column in columns)]
        cells = [value_text(None if value is None else value * per_um, "arcmin") for value, per_um in turns]
        yield f"lost motion, {word}", cells


def _notes(measure: Summary, summary: Summary) -> Iterator[str]:
    unit, agreement = measure["unit"], measure.get("agreement")
    if agreement and agreement.get("compared"):
        yield agreement_line(agreement, unit, summary.get("chord_error_um"))
    own = measure[best_road(measure)]
    if own.get("mean_se") is not None and own.get("sigma_se") is not None:
        yield (
            f"sampling error of {own['count']} trials: mean ±{difference_text(own['mean_se'], unit)}, "
            f"sigma ±{difference_text(own['sigma_se'], unit)} (one standard error)"
        )
    limits = list(_limit_rows(measure))
    for key in limits:
        low_high = own.get(f"{key}_95")
        if low_high:
            low, high = (ppm_text(bound) for bound in low_high)
            yield f"{_limit_rows(measure)[key]}: the true share lies between {low} and {high} ppm (95 % confidence)"
    if limits and "analytic_closed_form" in measure:
        yield "ppm of the closed form: as if the measure were normal"
    if "lost_motion" in measure:
        gear = measure["lost_motion"]["of"]
        yield f"lost motion: the turn of {gear} that this normal backlash leaves free, j_n / r_b"


def agreement_line(agreement: Summary, unit: str, chord_error_um: float | None) -> str:
    """How far the two roads differ trial by trial, and what the tessellation may explain of it."""
    line = (
        f"3D simulation − analytic, trial by trial: at most {difference_text(agreement['max_abs_difference'], unit)}, "
        f"rms {difference_text(agreement['rms_difference'], unit)}, "
        f"mean {difference_text(agreement['mean_difference'], unit)}"
    )
    if chord_error_um is None:
        return line
    whole = FLANKS_OF_A_BACKLASH * chord_error_um
    return (
        f"{line}; up to {whole:.3f} µm of normal backlash may be chord error ({chord_error_um:.3f} µm on each of "
        f"{FLANKS_OF_A_BACKLASH} flanks), the rest second order of the stack-up"
    )


def contributors_table(measure: Summary) -> Table:
    """Shares of the variance, the largest first; those of the 3D simulation with their standard error."""
    shares = [replace(column, heading=SHARE_HEADINGS.get(column.road, column.heading)) for column in shares_of(measure)]
    errors = {c["name"]: c.get("geometric_percent_se") for c in measure["contributors"]}
    table = _table(shares, "share of variance [%]")
    names = ranked_contributors(measure)
    for name in names:
        cells = [percent_text(column.percents.get(name)) for column in shares]
        for index, column in enumerate(shares):
            if column.road == "geometric" and errors[name] is not None:
                cells[index] += f" ±{errors[name]:.1f}"
        table.add_row(Text(name), *cells)
    left = [100 - sum(column.percents.get(name) or 0.0 for name in names) for column in shares]
    if any(abs(rest) > UNEXPLAINED_SHOWN for rest in left):
        table.add_row("not attributed", *(percent_text(rest) for rest in left), style="dim")
    return table


def curve_table(measure: Summary) -> Table:
    """A curve measure at some of its positions."""
    unit, curve = measure["unit"], measure["curve"]
    roads = [(road, word) for road, word in (("analytic", "analytic"), ("geometric", "3D")) if road in curve]
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1), header_style="bold")
    table.add_column(Text("driver at [°]"), justify="right")
    for road, word in roads:
        for key in ("mean", "sigma"):
            table.add_column(Text(f"{word} {key}"), justify="right", style="bold" if road == "geometric" else "")
    for key in ("smallest", "largest"):
        table.add_column(Text(f"{roads[-1][1]} {key}"), justify="right")
    positions = measure["position_deg"]
    for index in range(0, len(positions), -(-len(positions) // CURVE_ROWS)):
        cells = [value_text(curve[road][key][index], unit) for road, _ in roads for key in ("mean", "sigma")]
        cells += [value_text(curve[roads[-1][0]][key][index], unit) for key in ("min", "max")]
        table.add_row(f"{positions[index]:.1f}", *cells)
    return table


def _curve_limits(measure: Summary) -> list[Text]:
    """Which share of the trials is out of a limit anywhere on its curve."""
    curve = measure["curve"]
    words = {"lower_limit": "below", "upper_limit": "above"}
    return [
        Text(
            f" anywhere {word} {given_text(measure[limit], measure['unit'])} [ppm of the trials]: "
            + ", ".join(
                f"{'3D' if road == 'geometric' else road} {ppm_text(own[f'{word}_limit_ppm'])}"
                for road, own in curve.items()
            ),
            style="dim",
        )
        for limit, word in words.items()
        if measure.get(limit) is not None
    ]


def _status_line(summary: Summary) -> Text:
    trials = summary["trials"]
    failed = {text: count for text, count in summary["status"].items() if text != "ok" and count}
    line = Text("\ntrials: ").append(f"{summary['status'].get('ok', 0)} seated")
    for status, count in failed.items():
        line.append(f", {count} {STATUS_WORDS.get(status, status)} ({ppm_text(1e6 * count / trials)} ppm)", "red")
    return line if failed else line.append(", none failed")


def _time_line(summary: Summary) -> Text:
    timing = summary["timing"]
    workers = f" by {timing['workers']} workers" if timing.get("workers", 1) != 1 else ""
    return Text(
        f"time: {timing['setup_s']:.1f} s to set up, {timing['simulate_s']:.1f} s for the trials{workers}, "
        f"{timing['trials_per_s']:.0f} trials/s"
    )
