"""A sweep as tables: a row a variant, for each measure, and all of it in one for files."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.analyses.variant_sweep import Sweep, Variant, VariantMeasure, measures_of
from tol3d.report.declared import cells_of, declared_table, headings
from tol3d.report.number import NOTHING
from tol3d.report.page import BLANK, Heading, Line, Page, PageItem, Row, Shown, Table, line, note, page, title
from tol3d.study.runs.summary.shows import Shows, shown_by

MOST_ROWS: Final = 60
MOST_MEASURES: Final = 6
COLUMNS: Final = (*shown_by(VariantMeasure).values(),)
NUMBERS: Final = headings(VariantMeasure)
SPAN: Final = "low, high: mean ∓ 3 sigma, or the 0.135 % and 99.865 % quantiles of trials that end before"


def sweep_report(found: Sweep) -> Page:
    """The best and the worst variant of each measure with limits, a table for each, and what could not be built."""
    count = len(found.variants)
    words = f" · {count} variants of {found.trials} trials, seed {found.seed}, the same draws in all"
    blocks: list[PageItem] = [Line(((found.scene, "bold"), (words, "")))]
    names = measures_of(found)
    blocks += [BLANK, *answers] if (answers := [*_answers(found, names[:MOST_MEASURES])]) else []
    for name in names[:MOST_MEASURES]:
        blocks += [title(name), BLANK, _of_measure(found, name).shortened(MOST_ROWS)]
    if len(names) > MOST_MEASURES:
        blocks.append(note(f"and {len(names) - MOST_MEASURES} more measures, in the files"))
    blocks += [*_not_built(found), BLANK, note(SPAN)]
    return page(*blocks)


def _answers(found: Sweep, names: Sequence[str]) -> Iterator[PageItem]:
    """Ppk of each measure at its best and at its worst variant, the first of those that are alike."""
    for name in names:
        known = {k: own.measures[name].ppk for k, own in enumerate(found.variants) if name in own.measures}
        ppk = {k: value for k, value in known.items() if value is not None}
        if ppk:
            ends = (("best", max(ppk, key=ppk.__getitem__)), ("worst", min(ppk, key=ppk.__getitem__)))
            yield line(f" {name}: " + "; ".join(f"{word} {_variant(found, k)}, Ppk {ppk[k]:.2f}" for word, k in ends))


def _variant(found: Sweep, k: int) -> str:
    """A variant by its number and what is varied."""
    varied = zip(_named(found), found.variants[k].numbers, strict=True)
    words = (f"{field} {number:g} {unit}".rstrip() for (field, unit), number in varied)
    return f"variant {k + 1} ({', '.join(words)})"


def _headings(found: Sweep) -> list[Heading]:
    return [Heading(f"{field} [{unit}]" if unit else field) for field, unit in _named(found)]


def _named(found: Sweep) -> Iterator[tuple[str, str]]:
    """Fields without their common prefix, and their units, for tables."""
    yield from zip(short_names(found.fields), map(_sign, found.units), strict=True)


def _sign(unit: str) -> str:
    return "µm" if unit == "um" else unit


def short_names(fields: Sequence[str]) -> list[str]:
    """Fields as a table or a picture names them: without their section, and without `distribution`.

    >>> short_names(["tolerances.gap.distribution.upper"])
    ['gap upper']
    """
    return [" ".join(part for part in field.split(".")[1:] if part != "distribution") or field for field in fields]


def _of_measure(found: Sweep, name: str) -> Table:
    built = [variant for variant in found.variants if name in variant.measures]
    unit = built[0].measures[name].unit
    heads = [*_headings(found), *NUMBERS]
    rows = [Row(str(k + 1), [*_values(own), *_cells(own.measures.get(name))]) for k, own in enumerate(found.variants)]
    return Table(f"variant [{_sign(unit)}]", heads, rows, repeated=len(found.fields))


def _values(variant: Variant) -> list[Shown]:
    return [Shown(f"{number:g}", number) for number in variant.numbers]


def _cells(own: VariantMeasure | None) -> Sequence[Shown | str]:
    if own is None:
        return ["not assembled", *[NOTHING] * (len(NUMBERS) - 1)]
    return cells_of(own)


@dataclass(frozen=True)
class ReasonRow:
    """A variant that could not be assembled."""

    why: Annotated[str, Shows("why", "words")]


def _not_built(found: Sweep) -> Iterator[PageItem]:
    rows = [(str(k), ReasonRow(own.reason)) for k, own in enumerate(found.variants, 1) if own.reason is not None]
    if rows:
        yield title("could not be assembled")
        yield BLANK
        yield declared_table("variant", rows)


def whole_table(found: Sweep) -> Table:
    """A row a variant: its numbers, those of every measure, and why it could not be built."""
    names = measures_of(found)
    units = {name: own.unit for variant in found.variants for name, own in variant.measures.items()}
    heads = [f"{field} [{unit}]" if unit else field for field, unit in zip(found.fields, found.units, strict=True)]
    for name in names:
        shown = ((own.heading, {"value": units[name], "share": "ppm"}.get(own.form)) for own in COLUMNS)
        heads += [f"{name}: {head} [{unit}]" if unit else f"{name}: {head}" for head, unit in shown]
    heads.append("could not be assembled")
    rows = []
    for k, own in enumerate(found.variants):
        cells: list[str] = [*_values(own)]
        for name in names:
            known = own.measures.get(name)
            cells += _cells(known) if known is not None else [Shown("", None)] * len(NUMBERS)
        rows.append(Row(str(k + 1), [*cells, own.reason or ""]))
    return Table("variant", [Heading(head) for head in heads], rows)
