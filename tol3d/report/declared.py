"""Tables by the columns that fields declare: a new field with a column is in all of them."""

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
"""Forms of cells that stand left and wrap."""
PER: Final = {"": 1.0, "mm": 1.0, "µm": 1e3, "°": 180 / math.pi, "deg": 180 / math.pi, "%": 100.0, "10⁻⁶/K": 1e6}
"""Numbers of a unit that are 1 mm, 1 rad or the whole."""


def declared_table(corner: str, rows: Iterable[tuple[str | Row, Any]], unit: str = "") -> Table:
    """A row an object, a column a field that declares one; of no object an empty table.

    Args:
        corner: head of the labels.
        rows: objects with their labels, or with rows that have no cells yet. A field of objects of several kinds is
            left out of those that lack it.
        unit: of the measure that they are of; default: each object's own.
    """
    told = [(own if isinstance(own, Row) else Row(own, ()), of) for own, of in rows]
    columns = [*_columns([of for _, of in told])]
    filled = [replace(row, cells=tuple(column.cell(of, unit) for column in columns)) for row, of in told]
    return Table(corner, [column.heading(unit) for column in columns], filled)


def side_by_side(corner: str, columns: Iterable[tuple[str | Heading, Any]], unit: str = "") -> Table:
    """A column an object, a row a field that declares one; see `declared_table`."""
    told = [(own if isinstance(own, Heading) else Heading(own), of) for own, of in columns]
    rows = []
    for column in _columns([of for _, of in told]):
        heading = column.heading(unit)
        rows.append(Row(heading.text, tuple(column.cell(of, unit) for _, of in told), heading.style))
    return Table(corner, [heading for heading, _ in told], rows)


@dataclass(frozen=True)
class _Column:
    """A declared column of some objects: of a field, or of a key of a field that is a mapping."""

    name: str
    shows: Shows
    key: str | Heading | None = None

    def heading(self, unit: str) -> Heading:
        if isinstance(self.key, Heading):
            return self.key
        own = self.shows
        text = own.heading.format(unit=unit_sign(unit), key=self.key) + (f" [{own.unit}]" if own.unit else "")
        style = "bold" if own.decides else "green" if own.given else ""
        return Heading(text, style, own.form in LEFT, own.optional, own.plain, own.below, own.meaning)

    def value(self, of: Any) -> Any:
        value = getattr(of, self.name) if self.name in columns_of(of) else None
        return value if self.key is None or value is None else value.get(self.key)

    def cell(self, of: Any, unit: str) -> Shown | str:
        value, own = self.value(of), self.shows
        return formed(value * PER[own.unit] if _is_number(value) else value, own.form, unit or getattr(of, "unit", ""))


def _columns(objects: list[Any]) -> Iterator[_Column]:
    for name, shows in {name: shows for own in objects for name, shows in columns_of(own).items()}.items():
        values = [getattr(own, name) for own in objects if name in columns_of(own)]
        mappings = [value for value in values if isinstance(value, Mapping)]
        if mappings:
            yield from (
                _Column(name, shows, key) for key in dict.fromkeys(key for mapping in mappings for key in mapping)
            )
        elif not shows.seldom or any(value is not None for value in values):
            yield _Column(name, shows)


def headings(of: type, unit: str = "") -> list[Heading]:
    """Heads of the columns that a class declares; those of a table of one measure have its unit."""
    return [_Column(name, shows).heading(unit) for name, shows in shown_by(of).items()]


def cells_of(own: Any, unit: str = "") -> list[Shown | str]:
    """All declared cells of an object."""
    return [_Column(name, shows).cell(own, unit) for name, shows in columns_of(own).items()]


def formed(value: Any, form: str, unit: str = "") -> Shown | str:
    """A value as a cell of that form; a dash for one that is not known, a text as it is."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return NOTHING if form in LEFT else Shown(NOTHING, None)
    if isinstance(value, str):
        return unit_sign(value) if form == "unit sign" else value
    return FORMS[form](value, unit) if form in FORMS else Shown(unsigned_zero(f"{value:{form}}"), value)


def _is_number(value: Any) -> bool:
    return isinstance(value, float) and math.isfinite(value)


def unit_sign(unit: str) -> str:
    """A unit as tables of analyses have it: `µm`, `′`, nothing of a number without one."""
    return {"um": "µm", "arcmin": "′", "1": ""}.get(unit, unit)


def _number(text: Callable[[float], str]) -> Callable[[Any, str], Shown]:
    return lambda value, unit: Shown(text(value), value)


def _range(text: Callable[[float], str], between: str) -> Callable[[Any, str], str]:
    return lambda value, unit: between.join(map(text, value))


def _index(value: Any, unit: str) -> Shown:
    """A share of a variance [%] with the reach of its 95 %."""
    reach = (value.high - value.low) / 2
    text = f"{100 * value.share:.1f}".replace("-0.0", "0.0")
    return Shown(f"{text} ±{100 * reach:.1f}" if reach > 0.0 else text, 100 * value.share)


def _digits(value: float) -> str:
    """Four digits that count.

    >>> _digits(0.0), _digits(12.3456), _digits(-0.00123456)
    ('0', '12.35', '-0.001235')
    """
    digits = 0 if value == 0.0 else max(0, 3 - math.floor(math.log10(abs(value))))
    return "0" if digits > 9 else f"{value:.{digits}f}"


FORMS: Final[Mapping[str, Callable[[Any, str], Shown | str]]] = {
    "value": lambda value, unit: Shown(value_text(value, unit), value),
    "short": lambda value, unit: Shown(short_text(value, unit), value),
    **{own: _number(partial(value_text, unit=own)) for own in ("um", "mm", "arcmin")},
    "ppm": _number(ppm_text),
    "ppm range": _range(ppm_text, " … "),
    "share": _number(share_text),
    "number": _number(number_text),
    "degrees": lambda value, unit: Shown(degrees_text(value), math.degrees(value)),
    "share range": _range(share_text, " to "),
    "index": _index,
    "digits": _number(_digits),
}
