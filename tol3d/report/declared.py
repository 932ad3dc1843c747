"""Tables of sections by the columns that their fields declare: a new field with a column is in all of them."""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final

from tol3d.report.number import NOTHING, ppm_text, share_text, unsigned_zero, value_text
from tol3d.report.page import Heading, Row, Shown, Table
from tol3d.runs.summary.shows import Form, Shows, shown_by
from tol3d.runs.summary.values import Section


def declared_table(corner: str, rows: Iterable[tuple[str, Section]], unit: str = "") -> Table:
    """A row a section, a column a field that declares one; of no section an empty table.

    Args:
        corner: head of the labels.
        rows: sections of one kind, with their labels.
        unit: of the measure that they are of; default: each section's own.
    """
    told = list(rows)
    columns = {
        name: shows
        for name, shows in (shown_by(type(told[0][1])) if told else {}).items()
        if not shows.seldom or any(getattr(own, name) is not None for _, own in told)
    }
    cells = ([cell(own, name, shows, unit) for name, shows in columns.items()] for _, own in told)
    return Table(
        corner, headings(columns, unit), [Row(label, own) for (label, _), own in zip(told, cells, strict=True)]
    )


def headings(columns: Mapping[str, Shows], unit: str = "") -> list[Heading]:
    """Heads of columns; those of a table of one measure have its unit."""
    return [
        Heading(shows.heading.format(unit=unit_sign(unit)), words=shows.words, optional=shows.optional)
        for shows in columns.values()
    ]


def cells_of(own: Section, unit: str = "") -> list[Shown | str]:
    """All declared cells of a section."""
    return [cell(own, name, shows, unit) for name, shows in shown_by(type(own)).items()]


def cell(own: Section, name: str, shows: Shows, unit: str = "") -> Shown | str:
    """A cell of a section: the text of its value, with the number that it shows."""
    return formed(getattr(own, name), shows.form, unit or getattr(own, "unit", ""))


def formed(value: Any, form: Form, unit: str = "") -> Shown | str:
    """A value as a cell of that form; a dash for one that is not known."""
    return Shown(NOTHING, None) if value is None else FORMS[form](value, unit)


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


FORMS: Final[Mapping[Form, Callable[[Any, str], Shown | str]]] = {
    "value": lambda value, unit: Shown(value_text(value, unit), value),
    "ppm": _number(ppm_text),
    "ppm range": _range(ppm_text, " … "),
    "share": _number(share_text),
    "share range": _range(share_text, " to "),
    "ppk": _number(lambda value: unsigned_zero(f"{value:.2f}")),
    "index": _index,
    "digits": _number(_digits),
    "three": _number(lambda value: f"{value:.3f}"),
    "short": _number(lambda value: f"{value:.4g}"),
    "words": lambda value, unit: str(value),
    "unit sign": lambda value, unit: unit_sign(value),
    "count": _number(lambda value: f"{value}"),
}
