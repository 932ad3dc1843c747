"""Tables of one measure: statistics of its columns, shares of its contributors, a curve at its positions."""

import math
from collections.abc import Iterator, Mapping, Sequence, Set

from tol3d.report.column import (
    NOT_ATTRIBUTED,
    SHARES_BY,
    Column,
    Method,
    columns_of,
    contributor_columns,
    heading_by,
    ranked_contributors,
    seated_text,
    unexplained_of,
)
from tol3d.report.heading import MOST_CONTRIBUTORS
from tol3d.report.number import (
    NOTHING,
    limit_text,
    percent_cell,
    share_cell,
    unsigned_zero,
    value_cell,
)
from tol3d.report.page import Row, Shown, Table
from tol3d.report.presenter import FurtherRow
from tol3d.report.published import (
    STATISTICS,
    curve_columns,
    published_cell,
    published_counts,
    published_rows,
    statistic_row,
)
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.sample import CurveMethods, Methods
from tol3d.study.system.outcome import SEATED
from tol3d.units import FACTORS, RESOLVED, UNITS

CONVERTED_ROWS = {"low_3sigma": "low", "mean": "mean", "high_3sigma": "high"}
UNIT_HEADINGS = {"um": "[µm]", "mm": "[mm]", "arcmin": "[′, ″ of arc]", "pins": "[pins]"}
SIDES = ("below", "above")
UNEXPLAINED_SHOWN = 0.05  # %; less is 0.0 in print
ATTRIBUTING: Set[Method] = frozenset(("analytic", "geometric"))
CURVE_ROWS = 12  # positions of a curve that are printed; the picture and the columns have them all
SHARE_HEADINGS: Mapping[Method, str] = {"analytic": "analytic", "geometric": "3D simulation"}


def measure_table(run: RunSummary, measure: MeasureSummary, further: Sequence[FurtherRow] = ()) -> Table:
    """Statistics of one scalar measure, one column a method, the published ones last; `further` rows below."""
    columns, unit = columns_of(measure), measure.unit
    limits = limit_rows(measure)
    own = [key for key, shows in STATISTICS.items() if not shows.given]
    indices = [key for key in own if STATISTICS[key].seldom]
    rows = [*_failure_rows(run, measure, columns)]
    rows += [statistic_row(measure, columns, key) for key in own if key not in indices]
    rows += [
        Row(label, [share_cell(_ppm(column, key, measure)) for column in columns], unit="ppm")
        for key, label in limits.items()
    ]
    rows += [
        statistic_row(measure, columns, key)
        for key in indices
        if any(column.value(key) is not None for column in columns)
    ]
    rows += [
        Row(label, [_build_cell(column, key, build, unit) for column in columns], unit=unit)
        for key, label, build in (
            ("mean_build", "build at all means", measure.mean_build),
            ("nominal", "nominal build", measure.nominal),
        )
    ]
    rows += [*_converted_rows(measure, columns), *_further_rows(further, columns, unit)]
    rows += published_rows(measure, columns, limits)
    return Table(UNIT_HEADINGS[unit], [heading_by(column.method, column.heading) for column in columns], rows)


def _build_cell(column: Column, key: str, build: Methods, unit: str) -> Shown:
    """Cell of one build: by both methods, and as published."""
    value = column.value(key) if column.method == "published" else build.value(column.method)
    return published_cell(column, value, unit)


def _failure_rows(run: RunSummary, measure: MeasureSummary, columns: Sequence[Column]) -> Iterator[Row]:
    """Numbers of assembled and of failed trials, by reason; nothing if all could be assembled."""
    others = [published_counts(column) for column in columns]
    if not seated_text(measure) and not any(others):
        return
    own = {"geometric": measure.status, "analytic": {SEATED: measure.trials}}
    counts = [its or own.get(column.method, {}) for its, column in zip(others, columns, strict=True)]
    for status in dict.fromkeys(status for each in (measure.status, *others) for status in each):
        if measure.status.get(status) or status == SEATED or any(status in other for other in others):
            cells = [str(count.get(status, 0)) if count else NOTHING for count in counts]
            yield Row(f"trials {run.state(status)}", cells)


def limit_rows(measure: MeasureSummary) -> dict[str, str]:
    """Labels of the rows of shares out of limits, by their keys."""
    unit = measure.unit
    sides = {
        f"{side}_limit_ppm": f"{side} {limit_text(limit, unit)}"
        for side, limit in zip(SIDES, measure.limits, strict=True)
        if limit is not None
    }
    in_all = len(sides) > 1 or (sides and seated_text(measure))
    return {**sides, "out_ppm": "out in all"} if in_all else sides


def _ppm(column: Column, key: str, measure: MeasureSummary) -> float | None:
    """Counted, or for the closed form that of a normal measure."""
    form = measure.analytic_closed_form
    if column.method != "closed form" or form is None:
        return column.value(key)
    mean, sigma, lower, upper = form.mean, form.sigma, *measure.limits
    if not sigma:
        return None
    margins = {"below_limit_ppm": None if lower is None else mean - lower}
    margins["above_limit_ppm"] = None if upper is None else upper - mean
    asked = margins.values() if key == "out_ppm" else [margins[key]]
    return sum(1e6 * math.erfc(margin / sigma / math.sqrt(2)) / 2 for margin in asked if margin is not None)


def _converted_rows(measure: MeasureSummary, columns: Sequence[Column]) -> Iterator[Row]:
    """Low, mean and high in the other words that a measure has for them."""
    for other in measure.conversions:
        for key, word in CONVERTED_ROWS.items():
            values = [column.value(key) for column in columns]
            cells = [value_cell(None if value is None else value * other.per_unit, other.unit) for value in values]
            yield Row(f"{other.words}, {word}", cells, unit=other.unit)


def _further_rows(further: Sequence[FurtherRow], columns: Sequence[Column], unit: str) -> Iterator[Row]:
    """Rows added by the system's presenter."""
    for own in further:
        keys = (column.heading if column.method == "published" else column.method for column in columns)
        values = [own.values.get(key) for key in keys]
        yield Row(own.label, [value_cell(value, unit) for value in values], unit=unit)


def contributors_table(measure: MeasureSummary) -> Table:
    """Shares of the variance, the largest first, of many the sum of the rest; of the 3D simulation with their error.

    What is not attributed stands last, but first where it is so much that the shares are not those of the regression.
    """
    shares = contributor_columns(measure)
    errors = {share.name: share.geometric_percent_se for share in measure.contributors}
    ranked = ranked_contributors(measure)
    shown, rest = ranked[:MOST_CONTRIBUTORS], ranked[MOST_CONTRIBUTORS:]
    rows = [Row(name, [_share(measure, column, name, errors[name]) for column in shares], unit="%") for name in shown]
    if rest:
        sums = [_sum_of(measure, column, rest) for column in shares]
        rows.append(Row(f"and {len(rest)} more", list(map(percent_cell, sums)), "dim", unit="%"))
    if left := not_attributed(measure):
        row = Row(NOT_ATTRIBUTED, [percent_cell(rest) for rest in left], "dim", unit="%")
        rows = [row, *rows] if measure.shares_by else [*rows, row]
    return Table("share [%]", [heading_by(share.method, _share_heading(measure, share)) for share in shares], rows)


def _share_heading(measure: MeasureSummary, column: Column) -> str:
    """Heading of a column of shares, which says by what they are if not by regression."""
    heading, unexplained = SHARE_HEADINGS.get(column.method, column.heading), unexplained_of(measure, column)
    return f"{heading}, {SHARES_BY[unexplained.by]}" if unexplained else heading


def _share(measure: MeasureSummary, column: Column, name: str, error: float | None) -> Shown:
    if not _varies(measure, column):
        return percent_cell(None)
    return percent_cell(column.percents.get(name), error if column.method == "geometric" else None)


def _sum_of(measure: MeasureSummary, column: Column, names: Sequence[str]) -> float | None:
    """Share of several contributors together [%]; None where none of theirs is known."""
    known = [share for name in names if (share := column.percents.get(name)) is not None]
    return min(sum(known), 100.0) if known and _varies(measure, column) else None


def _varies(measure: MeasureSummary, column: Column) -> bool:
    """True if there is a variance to attribute: a method finds none, or rounding, if all that acts is constant."""
    own = measure.sample(column.method) if column.method in ("analytic", "geometric") else None
    if own is None or own.sigma is None:
        return True
    factor = FACTORS[UNITS[measure.unit]][measure.unit] if measure.unit in UNITS else 1.0
    return own.sigma * factor > (RESOLVED if measure.unit in UNITS else 0.0)


def not_attributed(measure: MeasureSummary) -> list[float | None]:
    """Percentage that each method attributes to no contributor, None for other columns; [] if it prints as zero."""
    left = [
        _not_attributed(measure, column) if column.method in ATTRIBUTING and _varies(measure, column) else None
        for column in contributor_columns(measure)
    ]
    return left if any(abs(rest or 0.0) > UNEXPLAINED_SHOWN for rest in left) else []


def _not_attributed(measure: MeasureSummary, column: Column) -> float | None:
    if unexplained := unexplained_of(measure, column):
        return None if unexplained.explained_percent is None else 100 - unexplained.explained_percent
    return 100 - sum(share or 0.0 for share in column.percents.values())


def curve_table(measure: MeasureSummary, curve: CurveMethods) -> Table:
    """A curve measure at some of its positions."""
    words = {"analytic": "analytic", "geometric": "3D"}
    columns: list[tuple[str, str, Sequence[float | None]]] = [
        (f"{words[method]} {key}", method, getattr(own, key))
        for method, own in curve.by_method.items()
        for key in ("mean", "sigma")
    ]
    leading, own = [*curve.by_method.items()][-1]
    columns += [(f"{words[leading]} smallest", leading, own.min), (f"{words[leading]} largest", leading, own.max)]
    columns += [(text, "published", values) for text, values in curve_columns(measure)]
    positions = [unsigned_zero(f"{position:.1f}") for position in measure.position_deg or ()]
    longest = max(map(len, positions), default=0)
    rows = [
        Row(
            positions[index].rjust(longest),
            [value_cell(values[index], measure.unit) for _, _, values in columns],
            unit=measure.unit,
        )
        for index in shown_positions(measure)
    ]
    return Table(
        f"{measure.position_word} at [°]".lstrip(), [heading_by(method, text) for text, method, _ in columns], rows
    )


def shown_positions(measure: MeasureSummary) -> range:
    """Which positions of a curve are printed."""
    count = len(measure.position_deg or ())
    return range(0, count, max(1, -(-count // CURVE_ROWS)))
