"""What others published beside measures, as a table: each number by its key, ours beside it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final

from tol3d.report.number import UNIT_SIGNS, given_text, number_cell, number_text, value_text
from tol3d.report.page import Heading, PageItem, Row, Shown, Table, note, title
from tol3d.runs.summary.joint import Joint
from tol3d.runs.summary.run import RunSummary
from tol3d.runs.summary.values import Road, Section, key_of

HEADINGS: Final[Mapping[Road, str]] = {"analytic": "analytic", "geometric": "3D simulation"}
MEANING: Final = "by the keys of summary.json; ours beside it, where there is one"

Place = tuple[str, ...]


def published_blocks(run: RunSummary) -> list[PageItem]:
    """The table and what is said of its columns; nothing where nothing was published."""
    columns = run.published or {}
    given = {name: dict(_numbers(own, ())) for name, own in columns.items()}
    places = list(dict.fromkeys(place for own in given.values() for place in own))
    if not places:
        return []
    units = {place: unit for own in columns.values() for place, unit in _units(own, ())}
    roads: list[Road] = [*dict.fromkeys(("analytic", run.best_road))]
    headings = [Heading(HEADINGS[road], "bold" if road == "geometric" else "") for road in roads]
    headings += [Heading(name, "green") for name in given]
    rows = []
    for place in places:
        unit = units.get(place, "")
        cells = [_cell(found_at(run, place, road), unit, value_text) for road in roads]
        cells += [_cell(own.get(place), unit, given_text) for own in given.values()]
        rows.append(Row(" · ".join(place) + _unit_words(unit), cells, unit=unit))
    notes = [note(f"{name}: {words}") for name, own in columns.items() for words in _descriptions(own)]
    return [title("published beside measures"), Table("", headings, rows), note(MEANING), *notes]


def found_at(own: Any, place: Sequence[str], road: Road) -> Any:
    """Our number at a published place; None where there is none.

    Published keys are the summary's, roads left out; an entry of a list is found by its first key, which names it.

    Args:
        own: a summary, or what is in it.
        place: keys below that.
        road: which one is entered where there are both.
    """
    if isinstance(own, Joint) and place[0] == "correlations":
        return _correlation(own, place[1:], road)
    if isinstance(own, list) and place:
        named = (each for each in own if isinstance(each, Section) and each.items()[0][1] == place[0])
        return found_at(next(named, None), place[1:], road)
    if isinstance(own, Section | Mapping):
        steps = [(place[0], place[1:])] if place else []
        steps += [(road, place), ("roads", place)]
        found = (found_at(own[key], rest, road) for key, rest in steps if key in own.keys())  # noqa: SIM118
        return next((value for value in found if value is not None), None)
    return own if not place and (_is_number(own) or _is_range(own)) else None


def _correlation(joint: Joint, place: Sequence[str], road: Road) -> float | None:
    """Of two measures by name: r, or what a key behind them names."""
    first, second, key = (*place, "r")[:3]
    names, own = joint.correlated, (joint.correlations or {}).get(road)
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
