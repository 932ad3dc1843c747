"""Tables by the columns that fields of objects declare: a new field with a column is in all of them."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final

from tol3d.report.number import (
    NOTHING,
    degrees_text,
    number_text,
    ppm_text,
    share_text,
    short_text,
    unsigned_zero,
    value_text,
)
from tol3d.report.page import Heading, Row, Shown, Table
from tol3d.study.runs.summary.shows import Shows, columns_of, shown_by

LEFT: Final = frozenset(("words", "unit sign"))
"""Forms of cells that are aligned left and wrapped."""
PER: Final = {"": 1.0, "mm": 1.0, "µm": 1e3, "°": 180 / math.pi, "deg": 180 / math.pi, "%": 100.0, "10⁻⁶/K": 1e6}
"""Shown number per internal one [mm, rad, 1, 1/K], by the unit shown."""


def declared_table(corner: str, rows: Iterable[tuple[str | Row, Any]], unit: str = "") -> Table:
    """Table with a row per object and a column per field that declares one; empty without objects.

    Args:
        corner: head of the labels.
        rows: objects with their labels, or with rows that have no cells yet. Objects of several kinds have a dash in
            columns of fields that they lack.
        unit: of the measure whose numbers they are; default: each object's own.
    """
    labelled = [(label if isinstance(label, Row) else Row(label, ()), item) for label, item in rows]
    columns = [*_columns([item for _, item in labelled])]
    filled = [replace(row, cells=tuple(column.cell(item, unit) for column in columns)) for row, item in labelled]
    return Table(corner, [column.heading(unit) for column in columns], filled)


def side_by_side(corner: str, columns: Iterable[tuple[str | Heading, Any]], unit: str = "") -> Table:
    """Table with a column per object and a row per field that declares one; see `declared_table`."""
    headed = [(head if isinstance(head, Heading) else Heading(head), item) for head, item in columns]
    rows = []
    for column in _columns([item for _, item in headed]):
        heading = column.heading(unit)
        rows.append(Row(heading.text, tuple(column.cell(item, unit) for _, item in headed), heading.style))
    return Table(corner, [heading for heading, _ in headed], rows)


@dataclass(frozen=True)
class _Column:
    """A declared column of some objects: of a field, or of a key of a field that is a mapping."""

    name: str
    shows: Shows
    key: str | Heading | None = None

    def heading(self, unit: str) -> Heading:
        if isinstance(self.key, Heading):
            return self.key
        shows = self.shows
        text = shows.heading.format(unit=unit_sign(unit), key=self.key) + (f" [{shows.unit}]" if shows.unit else "")
        style = "bold" if shows.decides else "green" if shows.given else ""
        return Heading(text, style, shows.form in LEFT, shows.optional, shows.plain, shows.below, shows.meaning)

    def value(self, item: Any) -> Any:
        value = getattr(item, self.name) if self.name in columns_of(item) else None
        return value if self.key is None or value is None else value.get(self.key)

    def cell(self, item: Any, unit: str) -> Shown | str:
        value, shows = self.value(item), self.shows
        number = value * PER[shows.unit] if _is_number(value) else value
        return formed(number, shows.form, unit or getattr(item, "unit", ""))


def _columns(objects: list[Any]) -> Iterator[_Column]:
    for name, shows in {name: shows for item in objects for name, shows in columns_of(item).items()}.items():
        values = [getattr(item, name) for item in objects if name in columns_of(item)]
        mappings = [value for value in values if isinstance(value, Mapping)]
        if mappings:
            yield from (
                _Column(name, shows, key) for key in dict.fromkeys(key for mapping in mappings for key in mapping)
            )
        elif not shows.seldom or any(value is not None for value in values):
            yield _Column(name, shows)


def headings(kind: type, unit: str = "") -> list[Heading]:
    """Heads of the columns that a class declares, with the unit of the measure if they are of one."""
    return [_Column(name, shows).heading(unit) for name, shows in shown_by(kind).items()]


def cells_of(item: Any, unit: str = "") -> list[Shown | str]:
    """All declared cells of an object."""
    return [_Column(name, shows).cell(item, unit) for name, shows in columns_of(item).items()]


def formed(value: Any, form: str, unit: str = "") -> Shown | str:
    """A value as a cell of that form; a dash for None and NaN, a text as it is."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return NOTHING if form in LEFT else Shown(NOTHING, None)
    if isinstance(value, str):
        return unit_sign(value) if form == "unit sign" else value
    return FORMS[form](value, unit) if form in FORMS else Shown(unsigned_zero(f"{value:{form}}"), value)


def _is_number(value: Any) -> bool:
    return isinstance(value, float) and math.isfinite(value)


def unit_sign(unit: str) -> str:
    """Sign of a unit in tables: `µm`, `′`, none for a plain number."""
    return {"um": "µm", "arcmin": "′", "1": ""}.get(unit, unit)


def _number(text: Callable[[float], str]) -> Callable[[Any, str], Shown]:
    return lambda value, unit: Shown(text(value), value)


def _range(text: Callable[[float], str], between: str) -> Callable[[Any, str], str]:
    return lambda value, unit: between.join(map(text, value))


def _index(value: Any, unit: str) -> Shown:
    """A share of a variance [%] with the half width of its 95 % interval."""
    half_width = (value.high - value.low) / 2
    text = f"{100 * value.share:.1f}".replace("-0.0", "0.0")
    return Shown(f"{text} ±{100 * half_width:.1f}" if half_width > 0.0 else text, 100 * value.share)


def _digits(value: float) -> str:
    """Number with four significant digits, or more before the point; 0 below 1e-6.

    >>> _digits(0.0), _digits(12.3456), _digits(-0.00123456)
    ('0', '12.35', '-0.001235')
    """
    digits = 0 if value == 0.0 else max(0, 3 - math.floor(math.log10(abs(value))))
    return "0" if digits > 9 else f"{value:.{digits}f}"


FORMS: Final[Mapping[str, Callable[[Any, str], Shown | str]]] = {
    "value": lambda value, unit: Shown(value_text(value, unit), value),
    "short": lambda value, unit: Shown(short_text(value, unit), value),
    **{unit: _number(partial(value_text, unit=unit)) for unit in ("um", "mm", "arcmin")},
    "ppm": _number(ppm_text),
    "ppm range": _range(ppm_text, " … "),
    "share": _number(share_text),
    "number": _number(number_text),
    "degrees": lambda value, unit: Shown(degrees_text(value), math.degrees(value)),
    "share range": _range(share_text, " to "),
    "index": _index,
    "digits": _number(_digits),
}
