"""Columns of tables, declared at the fields that they show: tables for a terminal, pages and files follow from them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any, Generic, TypeVar, get_type_hints

T = TypeVar("T")


@dataclass(frozen=True)
class Shows:
    """The column of a field, or the row where rows are fields; of a field that is a mapping, one for each of its keys.

    Args:
        heading: its head; {unit} stands for the unit of a table of one measure, {key} for the key of a mapping.
        form: of its numbers: a name of report/declared.py or a format such as ".4f". Texts stand as they are; those of
            the form "words" stand left and wrap.
        unit: in which a number of mm or rad is shown, and a fraction in %; it stands behind the heading, in brackets.
        meaning: a sentence for tooltips and the schema; default: the description or docstring of the field.
        decides: True for the column by which a table is read; it stands bold.
        given: True for figures that somebody else gave; they stand green.
        optional: True for a column that narrow terminals leave out.
        below: True for one that they set below the table.
        plain: True for numbers without the unit of their row.
        seldom: True for a column that is left out where no row has a value.
        behind: name of the field behind which a property stands, "" for the front; default: the end, in their order.
    """

    heading: str
    form: str = "value"
    unit: str = ""
    meaning: str = ""
    decides: bool = False
    given: bool = False
    optional: bool = False
    below: bool = False
    plain: bool = False
    seldom: bool = False
    behind: str | None = None

    def __get_pydantic_json_schema__(self, schema: Any, handler: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
        """Describe the field by the meaning of its column; a description of its own goes before."""
        return handler(schema) | ({"description": self.meaning} if self.meaning else {})


class Computed(property):
    """A property that has a column: `size = Computed(Shows("size [mm]", ".4f"), lambda own: own.part.size)`."""

    def __init__(self, shows: Shows, of: Callable[[Any], Any]) -> None:
        super().__init__(of)
        self.shows = shows


@dataclass(frozen=True)
class RowOf(Generic[T]):
    """A row whose columns are of one object: a class that derives from it declares them."""

    of: T


def shown(shows: Shows) -> Callable[[Callable[[Any], Any]], Any]:
    """Decorate a property that has a column and needs more than a line."""
    return partial(Computed, shows)


@cache
def shown_by(kind: type) -> Mapping[str, Shows]:
    """Columns of a dataclass or a section by its attributes, from left to right."""
    if fields := getattr(kind, "model_fields", None):
        told = {name: (field.metadata, field.description or "") for name, field in fields.items()}
    else:
        hints = get_type_hints(kind, include_extras=True)
        told = {name: (getattr(hint, "__metadata__", ()), "") for name, hint in hints.items()}
    found = {
        name: replace(own, meaning=description or own.meaning)
        for name, (metadata, description) in told.items()
        for own in metadata
        if isinstance(own, Shows)
    }
    for name, own in ((name, own) for each in reversed(kind.__mro__) for name, own in vars(each).items()):
        if isinstance(own, Computed):
            names, behind = [*found], own.shows.behind
            place = len(names) if behind is None else names.index(behind) + 1 if behind else 0
            here = replace(own.shows, meaning=own.shows.meaning or (own.__doc__ or "").partition("\n")[0])
            found = {key: found.get(key, here) for key in (*names[:place], name, *names[place:])} | {name: here}
    return found


def columns_of(own: object) -> Mapping[str, Shows]:
    """Columns of an object, by its attributes."""
    kind: type = type(own)
    return shown_by(kind)
