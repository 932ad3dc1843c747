"""Columns of tables, declared at the fields that they show: tables for a terminal, pages and files follow from them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from tol3d.runs.summary.values import Section

Form = Literal[
    "value",
    "ppm",
    "ppm range",
    "share",
    "share range",
    "ppk",
    "index",
    "digits",
    "three",
    "short",
    "words",
    "unit sign",
    "count",
]
"""Notation of a cell; report/declared.py has the text of each."""


@dataclass(frozen=True)
class Shows:
    """The column of a field, or the row where rows are fields.

    Args:
        heading: its head; {unit} stands for the unit of a table of one measure.
        form: of its cells.
        words: True for cells of words, which stand left and wrap.
        optional: True for a column that narrow terminals leave out.
        seldom: True for a column that is left out where no row has a value.
        behind: name of the field behind which a property stands; "" for the order of the class.
    """

    heading: str
    form: Form = "value"
    words: bool = False
    optional: bool = False
    seldom: bool = False
    behind: str = ""


class ShownProperty(property):
    """A property that has a column."""

    def __init__(self, of: Callable[[Any], Any], shows: Shows) -> None:
        super().__init__(of)
        self.shows = shows


def shown(shows: Shows) -> Callable[[Callable[[Any], Any]], Any]:
    """Decorate a property of a section that has a column."""
    return lambda of: ShownProperty(of, shows)


@cache
def shown_by(section: type[Section]) -> Mapping[str, Shows]:
    """Columns of a section by their attributes, from left to right."""
    found = {
        name: own for name, field in section.model_fields.items() for own in field.metadata if isinstance(own, Shows)
    }
    for name, own in vars(section).items():
        if isinstance(own, ShownProperty):
            names = [*found]
            place = names.index(own.shows.behind) + 1 if own.shows.behind else 0
            found = {key: found.get(key, own.shows) for key in (*names[:place], name, *names[place:])}
    return found
