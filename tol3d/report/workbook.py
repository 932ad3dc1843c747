"""Workbooks of spreadsheets (Office Open XML, ECMA-376): tables of texts and numbers, none of which is a formula."""

import io
import math
import re
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from tol3d.report.html.blocks import Markup, escaped, tag

Cell = str | float | int | None

LONGEST_SHEET: Final = 31  # letters of a sheet's name
FORBIDDEN: Final = re.compile(r"[\[\]:*?/\\]")  # in names of sheets
LONGEST_TEXT: Final = 32_767  # letters of a cell
WIDEST: Final = 48  # letters; columns are as wide as their texts up to this
BEGAN: Final = (1980, 1, 1, 0, 0, 0)  # of every file inside: the same tables give the same bytes
TEXT, BOLD = 1, 2  # styles: text that stays text when it is edited, headings

DECLARED: Final = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
MAIN: Final = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
OFFICE: Final = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE: Final = "http://schemas.openxmlformats.org/package/2006"
OWN_TYPE: Final = "application/vnd.openxmlformats-officedocument.spreadsheetml"

STYLES: Final = (
    f'{DECLARED}<styleSheet xmlns="{MAIN}"><fonts count="2"><font><sz val="11"/><name val="Calibri"/></font>'
    '<font><b/><sz val="11"/><name val="Calibri"/></font></fonts><fills count="2"><fill><patternFill '
    'patternType="none"/></fill><fill><patternFill patternType="gray125"/></fill></fills><borders count="1"><border/>'
    '</borders><cellStyleXfs count="1"><xf/></cellStyleXfs><cellXfs count="3"><xf/><xf quotePrefix="1"/>'
    '<xf fontId="1" quotePrefix="1" applyFont="1"/></cellXfs></styleSheet>'
)


@dataclass(frozen=True)
class Sheet:
    """A table of a workbook: its name, its headings, and rows of as many cells."""

    name: str
    headings: Sequence[str]
    rows: Sequence[Sequence[Cell]]


def workbook(sheets: Sequence[Sheet]) -> bytes:
    """The bytes of an .xlsx file; the same sheets give the same ones."""
    names = sheet_names([sheet.name for sheet in sheets])
    numbers = range(1, len(sheets) + 1)
    listed = [
        tag("sheet", name_=name, sheetId=k, **{"r:id": f"rId{k}"}) for k, name in zip(numbers, names, strict=True)
    ]
    targets = [_related(f"rId{k}", f"{OFFICE}/worksheet", f"worksheets/sheet{k}.xml") for k in numbers]
    targets.append(_related("styles", f"{OFFICE}/styles", "styles.xml"))
    kinds = [_kind(f"/xl/worksheets/sheet{k}.xml", "worksheet") for k in numbers]
    kinds += [_kind("/xl/workbook.xml", "sheet.main"), _kind("/xl/styles.xml", "styles")]
    defaults = [
        tag("Default", Extension="rels", ContentType="application/vnd.openxmlformats-package.relationships+xml"),
        tag("Default", Extension="xml", ContentType="application/xml"),
    ]
    files = {
        "[Content_Types].xml": tag("Types", *defaults, *kinds, xmlns=f"{PACKAGE}/content-types"),
        "_rels/.rels": _relations([_related("rId1", f"{OFFICE}/officeDocument", "xl/workbook.xml")]),
        "xl/workbook.xml": tag("workbook", tag("sheets", *listed), xmlns=MAIN, **{"xmlns:r": OFFICE}),
        "xl/_rels/workbook.xml.rels": _relations(targets),
        **{f"xl/worksheets/sheet{k}.xml": _sheet(own) for k, own in zip(numbers, sheets, strict=True)},
    }
    texts = {name: DECLARED + text for name, text in files.items()} | {"xl/styles.xml": STYLES}
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in texts.items():
            entry = zipfile.ZipInfo(name, BEGAN)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text.encode())
    return packed.getvalue()


def sheet_names(names: Sequence[str]) -> list[str]:
    """Names as sheets may have them: short, without some signs, no two alike however they are written.

    >>> sheet_names(["a/b", "A:b", "x" * 40])
    ['a b', 'A b 2', 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx']
    """
    found = dict[str, str]()
    for name in names:
        words = " ".join(FORBIDDEN.sub(" ", str(escaped_text(name))).split()).strip("'")[:LONGEST_SHEET] or "table"
        own, number = words, 2
        while own.casefold() in found:
            behind = f" {number}"
            own, number = words[: LONGEST_SHEET - len(behind)] + behind, number + 1
        found[own.casefold()] = own
    return list(found.values())


def escaped_text(text: str) -> str:
    """A text with characters that XML does not allow replaced by their code points."""
    return "".join(sign if sign in "&<>\"'" else str(escaped(sign)) for sign in text)


def _sheet(sheet: Sheet) -> Markup:
    rows = [_row(1, sheet.headings, BOLD), *(_row(number, row, TEXT) for number, row in enumerate(sheet.rows, 2))]
    columns = [tag("col", min=k, max=k, width=width + 2.0, customWidth=1) for k, width in enumerate(_widths(sheet), 1)]
    pane = tag("pane", xSplit=1, ySplit=1, topLeftCell="B2", state="frozen", activePane="bottomRight")
    views = tag("sheetViews", tag("sheetView", pane, workbookViewId=0))
    return tag("worksheet", views, tag("cols", *columns), tag("sheetData", *rows), xmlns=MAIN)


def _row(number: int, cells: Sequence[Cell], style: int) -> Markup:
    return tag("row", *_cells(number, cells, style), r=number)


def _cells(number: int, cells: Sequence[Cell], style: int) -> Iterator[Markup]:
    for k, own in enumerate(cells):
        place = f"{_letters(k)}{number}"
        if isinstance(own, str):
            text = tag("t", own[:LONGEST_TEXT], **{"xml:space": "preserve"})
            yield tag("c", tag("is", text), r=place, t="inlineStr", s=style)
        elif own is not None and math.isfinite(own):
            yield tag("c", tag("v", Markup(repr(own))), r=place)


def _letters(column: int) -> str:
    """The letters of a column, counted from 0.

    >>> _letters(0), _letters(25), _letters(26), _letters(701), _letters(702)
    ('A', 'Z', 'AA', 'ZZ', 'AAA')
    """
    found, left = "", column + 1
    while left:
        left, digit = divmod(left - 1, 26)
        found = chr(ord("A") + digit) + found
    return found


def _widths(sheet: Sheet) -> list[int]:
    columns = zip(sheet.headings, *sheet.rows, strict=True)
    return [min(WIDEST, max(len(cell) if isinstance(cell, str) else 10 for cell in column)) for column in columns]


def _relations(entries: Sequence[Markup]) -> Markup:
    return tag("Relationships", *entries, xmlns=f"{PACKAGE}/relationships")


def _related(name: str, kind: str, target: str) -> Markup:
    return tag("Relationship", Id=name, Type=kind, Target=target)


def _kind(part: str, kind: str) -> Markup:
    return tag("Override", PartName=part, ContentType=f"{OWN_TYPE}.{kind}+xml")
