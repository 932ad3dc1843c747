"""Measures of a STEP file, each by its own unit: four of NIST's files have geometry in mm and tolerances in inches."""

import math
from dataclasses import dataclass
from typing import Final, Literal

from tol3d.cad.step.instance import Instance, Record
from tol3d.cad.step.part21 import Part21
from tol3d.cad.step.refused import StepError, shown
from tol3d.cad.step.values import Enumeration, Typed

Dimension = Literal["length", "angle"]

SI_PREFIXES: Final = {
    "EXA": 1e18, "PETA": 1e15, "TERA": 1e12, "GIGA": 1e9, "MEGA": 1e6, "KILO": 1e3, "HECTO": 1e2, "DECA": 1e1,
    "DECI": 1e-1, "CENTI": 1e-2, "MILLI": 1e-3, "MICRO": 1e-6, "NANO": 1e-9, "PICO": 1e-12, "FEMTO": 1e-15,
    "ATTO": 1e-18,
}  # fmt: skip
"""Factor of each prefix."""

SI_UNITS: Final[dict[str, tuple[Dimension, float]]] = {"METRE": ("length", 1e3), "RADIAN": ("angle", 1.0)}
"""Dimension of each unit, and one of it in mm or rad."""

DEEPEST_CONVERSION: Final = 4  # units that are said by others; files of CAD systems have one
SHORT_NAMES: Final = {
    "INCH": "in",
    "INCHES": "in",
    "IN": "in",
    "DEGREE": "deg",
    "DEGREES": "deg",
    "FOOT": "ft",
    "RADIAN": "rad",
    "MILLIMETRE": "mm",
    "CENTIMETRE": "cm",
    "METRE": "m",
}
METRE_NAMES: Final = {1.0: "mm", 1e3: "m", 10.0: "cm", 1e-3: "um", 1e-6: "nm"}


@dataclass(frozen=True)
class Unit:
    """A unit of length or angle.

    Args:
        name: as tol3d writes it if it knows it (`mm`, `in`, `deg`), else the file's own name.
        dimension: length or angle.
        factor: one of it in mm or rad.
    """

    name: str
    dimension: Dimension
    factor: float


@dataclass(frozen=True)
class Measure:
    """A length or an angle with its own unit.

    Args:
        written: the number in the file.
        unit: its unit.
        name: the name of the item that holds it, such as `nominal value`; often empty.
    """

    written: float
    unit: Unit
    name: str = ""

    @property
    def value(self) -> float:
        """Its value in mm or rad."""
        return self.written * self.unit.factor

    def __str__(self) -> str:
        return f"{plain(self.written)} {self.unit.name}"


def plain(number: float) -> str:
    """A number of the file as a person writes it, at most 9 digits: 0.2999999999 is 0.3."""
    rounded = float(f"{number:.9g}")
    text = f"{rounded:.9f}".rstrip("0").rstrip(".") if 1e-6 <= abs(rounded) < 1e9 else f"{rounded:.9g}"
    return "0" if text in ("-0", "0") else text


def unit_of(file: Part21, identifier: int, depth: int = 0) -> Unit:
    """The unit that an instance is.

    Raises:
        StepError: it is none of length or angle, or is defined by others without end.
    """
    instance = file[identifier]
    converted = instance.record("CONVERSION_BASED_UNIT", "CONVERSION_BASED_UNIT_WITH_OFFSET")
    if converted is not None:
        if depth >= DEEPEST_CONVERSION:
            raise StepError(f"{instance.place}: expected a unit defined by at most {DEEPEST_CONVERSION} others")
        name_at = 1 if len(instance.records) == 1 else 0  # a simple instance has NAMED_UNIT's dimensions first
        basis = measure_of(file, converted.reference(name_at + 1), depth + 1)
        if not basis.value > 0:
            raise StepError(f"{instance.place}: expected a conversion factor above 0, got {plain(basis.written)}")
        said = converted.text(name_at).strip().upper()
        return Unit(SHORT_NAMES.get(said, shown(said.lower() or "unit")), basis.unit.dimension, basis.value)
    return si_unit(instance)


def si_unit(instance: Instance) -> Unit:
    """The unit of an SI_UNIT, whose last two arguments are its prefix and its name."""
    record = instance.needed("SI_UNIT")
    prefix, name = record.argument(-2), record.argument(-1)
    if not isinstance(name, Enumeration) or name.word not in SI_UNITS:
        raise record.wrong(len(record) - 1, "a unit of length or angle, .METRE. or .RADIAN.")
    dimension, factor = SI_UNITS[name.word]
    if isinstance(prefix, Enumeration):
        if prefix.word not in SI_PREFIXES:
            raise record.wrong(len(record) - 2, "a prefix such as .MILLI.")
        factor = factor * SI_PREFIXES[prefix.word] if dimension == "angle" else metres(SI_PREFIXES[prefix.word])
    if dimension == "angle":
        return Unit({1.0: "rad", 1e-3: "mrad", 1e-6: "urad"}.get(factor, f"{factor:g} rad"), dimension, factor)
    return Unit(METRE_NAMES.get(factor, f"{factor:g} mm"), dimension, factor)


def metres(prefix: float) -> float:
    """A prefixed metre in mm; a power of ten exactly."""
    return float(f"1e{round(math.log10(prefix)) + 3}")


MEASURES: Final = (
    "MEASURE_WITH_UNIT", "LENGTH_MEASURE_WITH_UNIT", "PLANE_ANGLE_MEASURE_WITH_UNIT", "MEASURE_REPRESENTATION_ITEM",
)  # fmt: skip


def is_measure(instance: Instance) -> bool:
    """True if an instance is a value with a unit."""
    return instance.record(*MEASURES) is not None


def measure_of(file: Part21, identifier: int, depth: int = 0) -> Measure:
    """The measure that an instance is, simple or complex.

    Raises:
        StepError: it is none, or its unit is not that of a length or an angle.
    """
    instance = file[identifier]
    record = next((found for found in (instance.record(each) for each in MEASURES) if found and len(found)), None)
    if record is None:
        raise StepError(f"{instance.place}: expected a value with a unit, got {shown(instance.keyword)}")
    first = 1 if record.keyword == "MEASURE_REPRESENTATION_ITEM" else 0  # its name comes before
    unit = unit_of(file, record.reference(first + 1), depth)
    dimension = stated_dimension(record, first)
    if dimension is not None and dimension != unit.dimension:
        raise record.wrong(first, f"a measure of the dimension of its unit, {unit.name}")
    named = instance.record("REPRESENTATION_ITEM")
    name = named.text(0) if named else record.text(0) if first else ""
    return Measure(record.number(first), unit, name)


def stated_dimension(record: Record, index: int) -> Dimension | None:
    """The dimension by the type of a value, None if it states none."""
    value = record.argument(index)
    if isinstance(value, Typed) and value.keyword.endswith("LENGTH_MEASURE"):
        return "length"
    if isinstance(value, Typed) and value.keyword.endswith("ANGLE_MEASURE"):
        return "angle"
    return None
