"""Common base of tolerances of a gear's single flanks, and the law of measured flanks."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Final, Literal

from pydantic import BeforeValidator, Field, model_validator

from tol3d.files import Files
from tol3d.gearing.draws.flank_record import FlankRecord
from tol3d.gearing.effects import Effect
from tol3d.gearing.grammar.moves import GearMeshSpec, meshes_of
from tol3d.gearing.grammar.parts import HelicalGearSpec, InternalGearSpec, SpurGearSpec, helix_of
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Unit
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.flank import LEFT, RIGHT, Flank
from tol3d.gears.iso1328 import CLASSES, FlankTolerances, flank_tolerances
from tol3d.scene.bases import MoveSpec, PartSpec, ToleranceEntry
from tol3d.scene.entry import AboutOne, Contradiction, Entry
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions.csv_table import csv_table
from tol3d.strict import Strict, refused
from tol3d.study.system.draw import Draw
from tol3d.units import MICRO_SIGNS, UNITS, Quantity, shown

OF_CLASSES: Final = Quantity(1.0, "um")
"""Unit of the limits of a class, written in numbers."""


class RecordSpec(Strict):
    """Deviations from a measuring centre, the same in every trial: a CSV file with one row per tooth and flank."""

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
        """Tooth of the gear for a tooth of the file, both counted from their first ones."""
        return tooth if self.counted == "counter_clockwise" else -tooth % teeth


SIDES: Mapping[str, Flank] = {"right": RIGHT, "left": LEFT}

Flanks = Literal["right", "left", "each", "together"]


IsoClass = Annotated[int, Field(ge=CLASSES[0], le=CLASSES[1])]
"""Flank tolerance class of ISO 1328-1:2013."""


class FlankToleranceSpec(AboutOne, ToleranceEntry):
    """A tolerance of single flanks of a spur or helical gear, or a helical ring; each tooth deviates by itself."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (SpurGearSpec, HelicalGearSpec, InternalGearSpec)

    of: Name = Field(description="the gear: a spur or helical gear, or a helical internal gear")
    flanks: Flanks = Field(
        description="right or left: that side of the teeth; each: both, drawn each for itself; together: whole teeth"
    )

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """Gears with straight teeth mesh with external gears only."""
        if helix_of(parts[self.of])[0]:
            return
        if isinstance(parts[self.of], InternalGearSpec):
            yield Contradiction(("of",), "a helical gear or an external one", f"{self.of!r}, a ring of straight teeth")
        for mesh in meshes_of(self.of, moves):
            move = moves[mesh]
            mates = move.gears if isinstance(move, GearMeshSpec) else ()
            ring = next((name for name in mates if isinstance(parts.get(name), InternalGearSpec)), None)
            if ring is not None:
                words = f"{self.of!r}, which meshes with the internal gear {ring!r} in {mesh!r}"
                yield Contradiction(("of",), "a helical gear, or a gear that meshes with external gears only", words)

    @property
    def unit(self) -> Unit:
        """Unit of its columns in results."""
        return "um"

    @property
    def sides(self) -> tuple[str, ...]:
        """Names of the flank sides that are drawn each for itself; "" where one draw is for whole teeth."""
        if self.flanks == "together":
            return ("",)
        return tuple(SIDES) if self.flanks == "each" else (self.flanks,)

    def flanks_of(self, side: str) -> tuple[Flank, ...]:
        """The flanks that one of the sides stands for."""
        return (SIDES[side],) if side else tuple(SIDES.values())

    @abstractmethod
    def draw(self, gear: CylindricalGear, files: Files) -> Draw:
        """Draw of its components; `files` holds the input of its law.

        Raises:
            GeometryError: the tolerance does not go with the gear.
        """

    @abstractmethod
    def effect(self, gear: CylindricalGear, active_roll: float) -> Effect:
        """Effect of its components on a gear whose active profile begins at a roll [rad].

        Raises:
            GeometryError: the tolerance does not go with the gear.
        """


def limits_of_class(iso_class: int, gear: CylindricalGear) -> FlankTolerances:
    """The limits that a class states for a gear.

    Raises:
        GeometryError: it states none.
    """
    return flank_tolerances(iso_class, gear.teeth, gear.module, gear.face_width, gear.helix_angle)


def no_word(example: str) -> BeforeValidator:
    """Refuse a word such as `example` in place of a law or of limits with numbers."""

    def checked(value: Any) -> Any:
        if isinstance(value, str | int | float):
            raise refused("", example, shown(value))
        return value

    return BeforeValidator(checked)


Share = Annotated[float, Field(gt=0.0, le=1.0)]
