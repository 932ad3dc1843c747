"""Deviations of a gear's single flanks as a measuring centre wrote them: a CSV file with a row a tooth and flank.

    tooth,flank,F_p [um],f_Ha [um]
    1,right,0.0,1.2
    1,left,0.4,-0.8
    2,right,-1.1,1.9

Teeth count from 0 or from 1, round the gear; the first of them is the gear's tooth 0.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from tol3d.errors import Problem, SceneError
from tol3d.statistics.distributions.csv_table import Cell, Column, CsvTable
from tol3d.units import FACTORS, MICRO_SIGNS

NAMED: Final = re.compile(r"(?P<name>[^\[\]()]+?)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?")
SIDES: Final = ("right", "left")
LARGEST: Final = 1.0  # mm; of a deviation: more is another unit, or no deviation
LISTED: Final = 6
"""Teeth that a message lists one by one."""

Measured = Mapping[str, Sequence[float | None]]
"""Deviation of each tooth [mm], by flank side, "" for whole teeth; None for teeth without one."""


@dataclass(frozen=True)
class FlankRecord:
    """A table of deviations, one per row.

    Args:
        table: with the columns `tooth` and, where it has both sides, `flank`.
        teeth: of the gear.
        column: of the deviations, its header with or without the unit.
        unit: of the deviations, where the header gives none.
    """

    table: CsvTable
    teeth: int
    column: str
    unit: str | None

    def measured(self, sides: Sequence[str], *, gaps: bool) -> Measured:
        """The deviations of some sides, teeth in the file's order from its first one on.

        Args:
            sides: "right", "left", or "" for whole teeth of a file without a column `flank`.
            gaps: True if rows of teeth that were not measured may be missing or empty.

        Raises:
            SceneError: rows lack, come twice, or hold no tooth, flank or number; the text names file and line.
        """
        column, factor = self._deviations()
        (first, teeth), flanks = self._teeth(), self._flanks(sides)
        seen: dict[tuple[str, int], int] = {}
        found: dict[str, list[float | None]] = {side: [None] * self.teeth for side in sides}
        filled = [k for k, cell in enumerate(column.cells) if cell.text or not gaps]
        numbers = Column(column.path, column.name, [column.cells[k] for k in filled], column.commas, column.sure)
        for k, number in zip(filled, numbers.numbers(), strict=True):
            line, side, tooth = column.cells[k].line, flanks[k], teeth[k]
            if before := seen.get((side, tooth)):
                words = f"the {side} flank of tooth" if side else "tooth"
                twice = f"{words} {first + tooth} again, as in line {before}"
                raise SceneError(Problem.at(column.path, twice, line=line))
            seen[side, tooth] = line
            if abs(number * factor) > LARGEST:
                raise column.refused(column.cells[k], "a deviation of at most 1 mm", "; is its unit another one?")
            if side in found:
                found[side][tooth] = number * factor
        self._refuse_lacking(found, first, gaps)
        return found

    def grain(self) -> float:
        """One of the last decimal place of the deviations [mm]."""
        column, factor = self._deviations()
        places = [len(cell.text.replace(",", ".").partition(".")[2]) for cell in column.cells]
        return float(factor * 10.0 ** -max(places, default=0))

    def _deviations(self) -> tuple[Column, float]:
        """Their column, and its unit [mm]."""
        names = [name for name in self.table.names if self.column in (name, _bare(name))]
        if len(names) != 1:
            raise self.table.refused_header(f"one column named {self.column!r}")
        match = NAMED.fullmatch(names[0])
        stated = match["unit"] if match else None
        unit = (stated or self.unit or "").translate(MICRO_SIGNS)
        at = partial(Problem.at, self.table.path, line=self.table.header_line, path=f"column {names[0]!r}")
        if stated and self.unit and unit != self.unit.translate(MICRO_SIGNS):
            raise SceneError(at(f"expected the unit {self.unit!r} that the scene gives, got {stated!r}"))
        if unit not in FACTORS["length"]:
            words = ", ".join(FACTORS["length"])
            example, got = f"{_bare(names[0])} [um]", repr(stated) if stated else "none"
            raise SceneError(at(f"expected its unit, as in {example!r}, one of {words}; got {got}"))
        return self.table.column(names[0]), FACTORS["length"][unit]

    def _named(self, name: str) -> Column | None:
        names = [own for own in self.table.names if own.lower() == name]
        if len(names) > 1:
            raise self.table.refused_header(f"one column named {name!r}")
        return self.table.column(names[0]) if names else None

    def _teeth(self) -> tuple[int, list[int]]:
        """The number of the first tooth, and of each row how many teeth after it its own comes."""
        column = self._named("tooth")
        if column is None:
            raise self.table.refused_header("a column named 'tooth'")
        numbers = [_whole(column, cell) for cell in column.cells]
        first = 0 if 0 in numbers else 1
        for cell, number in zip(column.cells, numbers, strict=True):
            if not first <= number < first + self.teeth:
                words = f"a tooth from {first} to {first + self.teeth - 1} of a gear with {self.teeth} teeth"
                raise column.refused(cell, words)
        return first, [number - first for number in numbers]

    def _flanks(self, sides: Sequence[str]) -> list[str]:
        """Side of each row."""
        column = self._named("flank")
        if "" in sides:
            if column is not None:
                raise self.table.refused_header("no column 'flank' beside flanks: together")
            return [""] * len(self.table.rows)
        if column is None:
            raise self.table.refused_header("a column named 'flank'")
        found = [cell.text.lower() for cell in column.cells]
        for cell, side in zip(column.cells, found, strict=True):
            if side not in SIDES:
                raise column.refused(cell, "right or left")
        return found

    def _refuse_lacking(self, found: Measured, first: int, gaps: bool) -> None:
        for side, values in found.items():
            lacking = [tooth for tooth, value in enumerate(values) if value is None]
            if not lacking or (gaps and len(lacking) < self.teeth):
                continue
            listed = ", ".join(str(first + tooth) for tooth in lacking[:LISTED])
            more = f" and {len(lacking) - LISTED} more" if len(lacking) > LISTED else ""
            words = f"the {side} flank of tooth" if side else "tooth"
            sentence = f"expected a row for each of {self.teeth} teeth, got none for {words} {listed}{more}"
            raise SceneError(Problem.at(self.table.path, sentence, path=f"column {self.column!r}"))


def _bare(name: str) -> str:
    """The name of a column without its unit."""
    match = NAMED.fullmatch(name)
    return match["name"] if match else name


def _whole(column: Column, cell: Cell) -> int:
    if not re.fullmatch(r"\d{1,9}", cell.text):
        raise column.refused(cell, "the number of a tooth, such as 7")
    return int(cell.text)
