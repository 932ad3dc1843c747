"""Published figures for a measure in addition to its usual rows: further rows, notes, columns of curves."""

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from typing import Any, Final

from tol3d.report.column import Column, heading_by
from tol3d.report.declared import formed
from tol3d.report.number import (
    NOTHING,
    UNIT_SIGNS,
    difference_text,
    given_text,
    number_cell,
    number_text,
    share_text,
    value_text,
)
from tol3d.report.page import PageItem, Row, Shown, Table, note, title
from tol3d.report.shown_unit import Spread
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import Joint, RunSummary
from tol3d.study.runs.summary.sample import Sample
from tol3d.study.runs.summary.shows import shown_by
from tol3d.study.runs.summary.values import Method, Section, key_of

POOLED: Final[Mapping[str, str]] = {"half_span": "99.73 % half-range"}
AGREEMENT: Final[Mapping[str, str]] = {
    "max_abs_difference": "at most",
    "rms_difference": "rms",
    "mean_difference": "mean",
}
STATISTICS: Final = {key_of(Sample, name): shows for name, shows in shown_by(Sample).items()}
"""Rows of a measure's table by the keys of summary.json."""


def statistic_row(measure: MeasureSummary, columns: Sequence[Column], key: str) -> Row:
    """The row of a statistic: a value a column, of bounds both."""
    shows = STATISTICS[key]
    form, is_range = shows.form.removesuffix(" range"), shows.form.endswith(" range")
    spread = Spread.of(measure) if form == "spread" else Spread(measure.unit)
    if is_range:
        texts = {"share": share_text, "number": number_text}
        text = texts.get(form, lambda value: value_text(spread.times(value), spread.unit))
        cells: list[Shown | str] = [" to ".join(map(text, _pair(column.values, key))) or NOTHING for column in columns]
    elif form in ("value", "spread"):
        cells = [published_cell(column, spread.times(column.value(key)), spread.unit) for column in columns]
    else:
        cells = [formed(column.value(key), form) for column in columns]
    unit = spread.unit if form in ("value", "spread") else "ppm" if shows.form == "share" else ""
    return Row(f"{shows.heading}{spread.words}", cells, unit=unit)


def published_rows(measure: MeasureSummary, columns: Sequence[Column], shown: Container[str]) -> Iterator[Row]:
    """Rows of the numbers that somebody published and that have no row else, and of statistics that a measure names.

    Args:
        measure: whose table it is.
        columns: of the table.
        shown: keys that have a row.
    """
    others = [column.values for column in columns if column.method == "published" and column.values is not None]
    for key, shows in STATISTICS.items():
        if shows.given and key not in shown and any(other.get(key) is not None for other in others):
            yield statistic_row(measure, columns, key)
    for name in dict.fromkeys(name for column in columns for name in _pooled(column)):
        cells = [published_cell(column, _pooled(column).get(name), measure.unit) for column in columns]
        yield Row(POOLED.get(name, name), cells, unit=measure.unit)


def published_counts(column: Column) -> Mapping[str, int]:
    """Published numbers of trials by status; empty if there are none."""
    if column.method != "published" or column.values is None:
        return {}
    found: Mapping[str, int] = column.values.get("status") or {}
    return found


def _pooled(column: Column) -> Mapping[str, float | None]:
    return (column.values.get("pooled") if column.values else None) or {}


def _pair(values: Section | None, key: str) -> Sequence[Any]:
    return (values.get(key) if values else None) or ()


def published_cell(column: Column, value: float | None, unit: str) -> Shown:
    """A value, with no more digits than it came with where somebody else gave it."""
    return Shown((given_text if column.method == "published" else value_text)(value, unit), value)


def published_notes(measure: MeasureSummary) -> Iterator[str]:
    """Published remarks on figures, on their two methods, and on whole curves."""
    for name, values in measure.published.items():
        if agreement := values.get("agreement"):
            known = {word: agreement.value(key) for key, word in AGREEMENT.items() if agreement.value(key) is not None}
            parts = [f"{word} {difference_text(value, measure.unit)}" for word, value in known.items()]
            parts += [f"of {agreement.compared} trials"] if "compared" in agreement else []
            yield f"{name}: simulation − analytic {', '.join(parts)}"
        if (curve := values.get("curve")) and (text := _curve_text(curve)):
            yield f"{name}: {text}"
        if values.description:
            yield f"{name}: {values.description}"


def _curve_text(curve: Section) -> str:
    """Shares of trials by their whole curves."""
    parts = [
        f"{shows.heading} {share_text(own)}"
        for key, shows in STATISTICS.items()
        if shows.form == "share" and (own := curve.value(key)) is not None
    ]
    parts += [
        f"out in all between {' and '.join(map(share_text, own))} (95 %)" for own in [_pair(curve, "out_ppm_95")] if own
    ]
    parts += [f"Ppk {number_text(curve.value('ppk'))}"] if "ppk" in curve else []
    parts += [f"of {curve['trials']} trials"] if "trials" in curve else []
    return f"anywhere on the curve: {', '.join(parts)}" if parts else ""


def at_places(places: Sequence[float], theirs: Sequence[float], values: Sequence[float]) -> list[float | None]:
    """Somebody's values at our positions or orders; None where he has none."""
    known = {round(place, 6): value for place, value in zip(theirs, values, strict=True)}
    return [known.get(round(place, 6)) for place in places]


def curve_columns(measure: MeasureSummary) -> Iterator[tuple[str, list[float | None]]]:
    """Published values of a curve at its positions: headings and values."""
    for name, own in measure.published.items():
        curve, places = own.get("curve"), own.get("position_deg")
        for key, word in (("mean", "mean"), ("sigma", "sigma"), ("min", "smallest"), ("max", "largest")):
            if curve is not None and places and key in curve:
                yield f"{name}: {word}", at_places(measure.position_deg or (), places, curve[key])


def spectrum_columns(measure: MeasureSummary, orders: Sequence[float]) -> list[tuple[str, list[float | None]]]:
    """Published values of a spectrum at some orders: headings and values."""
    spectra = {name: own["curve"].get("spectrum") for name, own in measure.published.items() if "curve" in own}
    return [
        (f"{name}: {key}", at_places(orders, own["order"], own[key]))
        for name, own in spectra.items()
        if own is not None
        for key in ("mean", "sigma", "p0.135", "p50", "p99.865", "max")
        if key in own
    ]


HEADINGS: Final[Mapping[Method, str]] = {"analytic": "analytic", "geometric": "3D simulation"}
MEANING: Final = "by the keys of summary.json; ours beside it, where there is one"

Place = tuple[str, ...]


def published_blocks(run: RunSummary) -> list[PageItem]:
    """The table and what is said of its columns; nothing where nothing was published."""
    columns = run.published or {}
    given = {name: dict(_numbers(own, ())) for name, own in columns.items()}
    places = list(dict.fromkeys(place for own in given.values() for place in own))
    if not places:
        return []
    units = {place: unit for column in columns.values() for place, unit in _units(column, ())}
    methods: list[Method] = [*dict.fromkeys(("analytic", run.best_method))]
    headings = [heading_by(method, HEADINGS[method]) for method in methods] + [
        heading_by("published", own) for own in given
    ]
    rows = []
    for place in places:
        unit = units.get(place, "")
        cells = [_cell(found_at(run, place, method), unit, value_text) for method in methods]
        cells += [_cell(own.get(place), unit, given_text) for own in given.values()]
        rows.append(Row(" · ".join(place) + _unit_words(unit), cells, unit=unit))
    notes = [note(f"{name}: {words}") for name, own in columns.items() for words in _descriptions(own)]
    return [title("published beside measures"), Table("", headings, rows), note(MEANING), *notes]


def found_at(own: Any, place: Sequence[str], method: Method) -> Any:
    """Our number at a published place; None where there is none.

    Published keys are the summary's, methods left out; an entry of a list is found by its first key, which names it.

    Args:
        own: a summary, or what is in it.
        place: keys below that.
        method: which one is entered where there are both.
    """
    if isinstance(own, Joint) and place[0] == "correlations":
        return _correlation(own, place[1:], method)
    if isinstance(own, list) and place:
        named = (each for each in own if isinstance(each, Section) and each.items()[0][1] == place[0])
        return found_at(next(named, None), place[1:], method)
    if isinstance(own, Section | Mapping):
        steps = [(place[0], place[1:])] if place else []
        steps += [(method, place), ("methods", place)]
        found = (found_at(own[key], rest, method) for key, rest in steps if key in own.keys())  # noqa: SIM118
        return next((value for value in found if value is not None), None)
    return own if not place and (_is_number(own) or _is_range(own)) else None


def _correlation(joint: Joint, place: Sequence[str], method: Method) -> float | None:
    """Correlation of two measures by name: r, or the value of a key behind them."""
    first, second, key = (*place, "r")[:3]
    names, own = joint.correlated, (joint.correlations or {}).get(method)
    matrix = own.get(key) if own else None
    if matrix is None or first not in names or second not in names:
        return None
    found: float | None = matrix[names.index(first)][names.index(second)]
    return found


def _numbers(own: Any, place: Place) -> Iterator[tuple[Place, Any]]:
    """Every number, and every range of two, with its place."""
    if _is_number(own) or _is_range(own):
        yield place, own
        return
    entries = own.items() if isinstance(own, Section | Mapping) else enumerate(own) if isinstance(own, list) else ()
    for key, value in entries:
        yield from _numbers(value, (*place, str(key)))


def _units(own: Any, place: Place) -> Iterator[tuple[Place, str]]:
    """The units of the numbers that were quantities of one dimension, with their places."""
    fields = type(own).model_fields.items() if isinstance(own, Section) else ()
    for name, field in fields:
        extra = field.json_schema_extra
        if isinstance(extra, Mapping) and "unit" in extra:
            here = (*place, key_of(type(own), name))
            yield from ((inner, str(extra["unit"])) for inner, _ in _numbers(getattr(own, name), here))
    for key, value in own.items() if isinstance(own, Section | Mapping) else ():
        yield from _units(value, (*place, key))


def _descriptions(own: Any) -> Iterator[str]:
    """Whatever words there are."""
    if isinstance(own, str):
        yield own
    for _, value in own.items() if isinstance(own, Section | Mapping) else ():
        yield from _descriptions(value)


def _is_number(own: Any) -> bool:
    return isinstance(own, int | float) and not isinstance(own, bool)


def _is_range(own: Any) -> bool:
    return isinstance(own, list) and len(own) == 2 and all(isinstance(end, float) for end in own)


def _unit_words(unit: str) -> str:
    """The unit behind a label, but for an angle, whose text has its signs."""
    return f" [{UNIT_SIGNS.get(unit, unit)}]" if unit and unit != "arcmin" else ""


def _cell(value: Any, unit: str, text: Callable[[float | None, str], str]) -> str:
    if isinstance(value, list):
        return " to ".join(map(number_text, value))
    return Shown(text(value, unit), value) if unit in UNIT_SIGNS else number_cell(value)
