"""The law of a gear that was measured: its deviations stand in a file."""

from collections.abc import Iterator
from typing import Literal

from pydantic import Field, model_validator

from tol3d.distributions.csv_table import csv_table
from tol3d.files import Files
from tol3d.gearing.flank_record import FlankRecord
from tol3d.scene.place import KeyPath
from tol3d.strict import Strict, refused
from tol3d.units import MICRO_SIGNS, UNITS


class RecordSpec(Strict):
    """Deviations as a measuring centre wrote them, the same in every trial: a CSV file with a row a tooth and flank."""

    kind: Literal["record"]
    file: str = Field(description="CSV with columns `tooth` and `flank` (right or left), and one of the deviations")
    column: str = Field(description="header of the deviations, with or without its unit")
    unit: str | None = Field(default=None, description="of the deviations, where the header has none, such as um")
    counted: Literal["counter_clockwise", "clockwise"] = Field(
        default="counter_clockwise", description="which way the file counts teeth, seen against the gear's z"
    )

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> "RecordSpec":
        if not self.file.strip() or "\0" in self.file:
            raise refused("file", "the name of a CSV file", repr(self.file))
        if self.unit is not None and UNITS.get(self.unit.translate(MICRO_SIGNS)) != "length":
            raise refused("unit", "a unit of length such as um", repr(self.unit))
        return self

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """The CSV file."""
        yield ("law", "file"), self.file

    def record(self, teeth: int, files: Files) -> FlankRecord:
        """The file's table.

        Raises:
            SceneError: it is no CSV file.
        """
        return FlankRecord(csv_table(files[self.file]), teeth, self.column, self.unit)

    def placed(self, tooth: int, teeth: int) -> int:
        """Which tooth of the gear one of the file is, both counted from their first ones."""
        return tooth if self.counted == "counter_clockwise" else -tooth % teeth
