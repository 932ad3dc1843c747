"""Tables of other tolerances' effect: a measure before, after, and the change."""

from collections.abc import Iterator
from typing import Final

from tol3d.analyses.what_if import LimitNumbers, MeasureWhatIf, WhatIf
from tol3d.report.number import UNIT_SIGNS, limit_text, ppm_text, value_cell
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, note, page, titled

HEADS: Final = (Heading("before"), Heading("after"), Heading("change"))
ROWS: Final = (
    ("sigma by rates", "sigma_by_rates"),
    ("sigma", "sigma"),
    ("mean", "mean"),
    ("low 0.135 %", "low"),
    ("high 99.865 %", "high"),
)
WORDS: Final = (
    "by rates: slopes at the mean build and the spreads of the tolerances; first order: Φ(−β), β the distance of the "
    "most likely build beyond the limit; by sampling: importance sampling about it, with its interval of 95 %; builds "
    "that cannot be assembled fail; trials are drawn from the same numbers before and after"
)


def what_if_report(name: str, found: WhatIf) -> Page:
    """Changes, then a table a measure.

    Args:
        name: of the scene.
        found: what they do.
    """
    head = Line(((name, "bold"), (" · what if", "")))
    rows = [Row(own.contributor, (own.before, own.after)) for own in found.changes]
    changes = Table("", (Heading("before", words=True), Heading("after", words=True)), rows)
    blocks: list[PageItem] = [head, BLANK, *titled("tolerances", changes)]
    for measure, own in found.measures.items():
        blocks += [BLANK, *titled(f"{measure} [{UNIT_SIGNS.get(own.unit, own.unit)}]", what_if_table(own))]
    counted = f"{found.trials} trials, {found.draws} draws a limit, {found.evaluations} builds evaluated"
    blocks += [BLANK, note(WORDS)]
    if found.rough:
        words = f"{', '.join(found.rough)}: no smooth map from normals, so limits are counted in the trials"
        blocks += [note(words)]
    return page(*blocks, note(counted))


def what_if_table(own: MeasureWhatIf) -> Table:
    """Table of one measure."""
    unit = own.unit
    pairs = ((label, own.before.value(key), own.after.value(key)) for label, key in ROWS)
    rows = [_values(*pair, unit) for pair in pairs if pair[1:] != (None, None)]
    if own.before.failed or own.after.failed:
        rows.append(Row("builds that fail", (str(own.before.failed), str(own.after.failed), "")))
    for side, limit in (("low", own.lower_limit), ("high", own.upper_limit)):
        if limit is not None:
            sign = "<" if side == "low" else ">"
            rows += _limit(f"{sign} {limit_text(limit, unit)}", own.before.limits[side], own.after.limits[side])
    return Table("", HEADS, rows)


def _values(label: str, before: float | None, after: float | None, unit: str) -> Row:
    change = None if before is None or after is None else after - before
    return Row(label, (value_cell(before, unit), value_cell(after, unit), value_cell(change, unit)))


def _limit(label: str, before: LimitNumbers, after: LimitNumbers) -> Iterator[Row]:
    first = [own.first_order for own in (before, after)]
    yield Row(f"{label}, first order [ppm]", (*map(_ppm, first), _times(*first)))
    if before.ppm is None or after.ppm is None or before.interval is None or after.interval is None:
        return
    yield Row(f"{label}, by sampling [ppm]", (_ppm(before.ppm), _ppm(after.ppm), _times(before.ppm, after.ppm)))
    spans = (f"{ppm_text(low)} … {ppm_text(high)}" for low, high in (before.interval, after.interval))
    yield Row("    95 %", (*spans, ""))


def _ppm(value: float | None) -> Shown:
    return Shown(ppm_text(value), value)


def _times(before: float | None, after: float | None) -> str:
    return f"× {after / before:.3g}" if before and after is not None else "–"
