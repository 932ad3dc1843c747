"""Tables of a report as files for other programs: numbers with all their digits, their units in the headings."""

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from tol3d.errors import InputError, unwritable
from tol3d.report.number import NOTHING
from tol3d.report.page import Heading, Shown, Table
from tol3d.report.report_sections import ReportSection, section_tables
from tol3d.report.workbook import Cell, Sheet, workbook
from tol3d.study.runs.atomic_write import write_whole
from tol3d.study.runs.csv_text import csv_text

LONGEST_FILE_NAME: Final = 60
UNIT: Final = "unit"
OWN_FILE: Final = re.compile(r"\d{2,}-[a-z0-9-]+\.csv")
"""Files of tables are called so."""
ReportFormat = Literal["html", "xlsx", "csv", "json"]


@dataclass(frozen=True)
class Grid:
    """A table as cells: texts as they are shown, numbers with all their digits, None for one not known.

    Args:
        name: of the table.
        headings: of the columns, with the unit of their numbers where it is one for all rows.
        rows: of cells, one for each heading; the first is the row's label, where that is left out the one
            above.
    """

    name: str
    headings: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    @classmethod
    def of(cls, name: str, table: Table) -> "Grid":
        """The whole table, with the rows that are left out where it is shown."""
        rows = table.rows if table.further is None else [*table.rows, *table.further.rows()]
        units = list(dict.fromkeys(row.unit for row in rows))
        common = units[0] if len(units) == 1 else ""
        column = [UNIT] if len(units) > 1 else []
        headings = [_headed(own, common, [row.cells[k] for row in rows]) for k, own in enumerate(table.headings)]
        labels = _carried([row.label.strip() for row in rows])
        cells = (
            (label, *([row.unit] if column else []), *map(_value, row.cells, table.headings))
            for label, row in zip(labels, rows, strict=True)
        )
        corner = table.corner.partition("[")[0].strip() or "row"
        return cls(name, (corner, *column, *headings), tuple(cells))

    def csv(self) -> str:
        """Comma-separated values, of which no cell is a formula."""
        return csv_text((self.headings, *self.rows))


def require_room_for_tables(folder: Path, *, force: bool) -> None:
    """Refuse a folder that holds other things than tables of a report, or those where they are not to be replaced.

    Raises:
        InputError: with what to do.
    """
    if not folder.exists():
        return
    if not folder.is_dir():
        raise InputError(f"{folder}: expected the name of a folder for the tables, this is a file")
    there = sorted(own.name for own in folder.iterdir())
    if others := [name for name in there if not OWN_FILE.fullmatch(name)]:
        raise InputError(f"{folder}: holds what is no table of a report ({others[0]}); choose another folder")
    if there and not force:
        raise InputError(
            f"{folder}: expected the name of a new folder, there is one already; --force replaces its tables"
        )


def write_tables(
    sections: Sequence[ReportSection], path: Path, format: ReportFormat, about: Mapping[str, object]
) -> Path:
    """Write every table of a report: into one file, or of "csv" each into a file of a folder.

    Args:
        sections: of the report.
        path: the file or folder.
        format: "xlsx", "csv" or "json".
        about: what a JSON file says besides.

    Raises:
        RunError: it cannot be written.
    """
    grids = [Grid.of(name, table) for name, table in section_tables(sections)]
    try:
        if format == "csv":
            _write_folder(path, csv_files(grids))
        else:
            write_whole(path, xlsx_file(grids) if format == "xlsx" else json_file(grids, about))
    except OSError as error:
        raise unwritable(path, error, "choose another place") from None
    return path


def _write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        write_whole(folder / name, content)
    for own in folder.iterdir():
        if OWN_FILE.fullmatch(own.name) and own.name not in files:
            own.unlink()


def csv_files(grids: Iterable[Grid]) -> Mapping[str, bytes]:
    """A file for each table by its name, in order; with the mark by which spreadsheets know UTF-8."""
    found = dict[str, bytes]()
    for number, own in enumerate(grids, 1):
        found[f"{number:02d}-{_file_name(own.name)}.csv"] = own.csv().encode("utf-8-sig")
    return found


def json_file(grids: Iterable[Grid], about: Mapping[str, object]) -> bytes:
    """All tables as one object.

    Args:
        grids: the tables.
        about: what stands beside them.
    """
    tables = [{"name": grid.name, "columns": grid.headings, "rows": grid.rows} for grid in grids]
    return json.dumps({**about, "tables": tables}, indent=1, ensure_ascii=False, allow_nan=False).encode() + b"\n"


def xlsx_file(grids: Sequence[Grid]) -> bytes:
    """A workbook with a sheet for each table."""
    return workbook([Sheet(grid.name, grid.headings, grid.rows) for grid in grids])


def _headed(heading: Heading, unit: str, cells: Sequence[str]) -> str:
    text = heading.text.strip() or "value"
    numbers = any(isinstance(cell, Shown) for cell in cells)
    return f"{text} [{unit}]" if unit and numbers and not heading.plain and "[" not in text else text


def _carried(labels: Iterable[str]) -> Iterator[str]:
    """Labels, where one is left out the one above."""
    last = ""
    for label in labels:
        last = label or last
        yield last


def _value(cell: str, heading: Heading) -> Cell:
    if isinstance(cell, Shown):
        return cell.value
    text = cell.strip()
    return None if text == NOTHING and not heading.words else text


def _file_name(name: str) -> str:
    r"""Letters and digits of a name, good for every file system.

    >>> _file_name("lost motion · share [%]"), _file_name("../<b>")
    ('lost-motion-share', 'b')
    """
    words = re.findall(r"[a-zA-Z0-9]+", name)
    return "-".join(words)[:LONGEST_FILE_NAME].strip("-").lower() or "table"
