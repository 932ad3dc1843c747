"""Dimensions of a STEP file: sizes and locations with their limits. Source: as tolerance.py, section 5."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

from tol3d.cad.step.feature import Features, NamedFeature
from tol3d.cad.step.instance import Instance, Record
from tol3d.cad.step.part21 import Part21
from tol3d.cad.step.placement import representation
from tol3d.cad.step.units import Measure, is_measure, measure_of, plain

SIZES: Final = (
    "DIMENSIONAL_SIZE",
    "ANGULAR_SIZE",
    "DIMENSIONAL_SIZE_WITH_DATUM_FEATURE",
    "DIMENSIONAL_SIZE_WITH_PATH",
)
LOCATIONS: Final = (
    "DIMENSIONAL_LOCATION",
    "ANGULAR_LOCATION",
    "DIRECTED_DIMENSIONAL_LOCATION",
    "DIMENSIONAL_LOCATION_WITH_PATH",
    "DIMENSIONAL_LOCATION_WITH_DATUM_FEATURE",
    "DIRECTED_ANGULAR_LOCATION",
)
Role = Literal["toleranced", "basic", "reference"]
ROLES: Final[Mapping[str, Role]] = {"theoretical": "basic", "auxiliary": "reference"}
LIMIT_WORDS: Final = {"maximum": "MAX", "minimum": "MIN", "average": "AVG"}
"""Words of a drawing beside a value, by those of the file."""
KIND_SIGNS: Final = {
    "diameter": "⌀",
    "radius": "R",
    "spherical diameter": "S⌀",
    "spherical radius": "SR",
    "controlled radius": "CR",
    "square": "□",
}


@dataclass(frozen=True)
class Fit:
    """A class of limits as the file writes it, such as `G6` of a hole; its limits are not resolved."""

    code: str
    zone: str


@dataclass(frozen=True)
class Dimension:
    """A dimension as the file states it.

    Args:
        id: its instance.
        name: that of the dimensioned feature, such as `Linear Size.13`; often empty.
        kind: `diameter`, `radius`, `linear distance`, `angle` and so on, in the file's words.
        features: one of a size, two of a location, from the first to the second.
        directed: True if the file states that the second is measured from the first.
        role: toleranced, basic (theoretically exact) or reference.
        nominal: its value; None where the file states none.
        minus, plus: deviations from the nominal, lower and upper.
        least, most: limits that are stated as such.
        fit: a class of limits.
        notes: further words, such as the statement of an envelope.
    """

    id: int
    name: str
    kind: str
    features: tuple[NamedFeature, ...]
    directed: bool = False
    role: Role = "toleranced"
    nominal: Measure | None = None
    minus: Measure | None = None
    plus: Measure | None = None
    least: Measure | None = None
    most: Measure | None = None
    fit: Fit | None = None
    notes: tuple[str, ...] = ()

    @property
    def is_size(self) -> bool:
        """True if it is of one feature."""
        return len(self.features) == 1

    @property
    def limits(self) -> tuple[float, float] | None:
        """Least and largest value allowed [mm or rad]; None where the file states none."""
        if self.least is not None and self.most is not None:
            return self.least.value, self.most.value
        if self.nominal is not None and self.minus is not None and self.plus is not None:
            return self.nominal.value + self.minus.value, self.nominal.value + self.plus.value
        return None

    def __str__(self) -> str:
        sign = KIND_SIGNS.get(self.kind, "")
        if self.least is not None and self.most is not None:
            return f"{sign}{plain(self.least.written)}–{plain(self.most.written)}"
        said = sign + ("?" if self.nominal is None else plain(self.nominal.written) + degrees(self.nominal))
        if self.minus is not None and self.plus is not None:
            said += deviations(self.minus.written, self.plus.written)
        if self.fit is not None:
            said += f" {self.fit.code}"
        said += "".join(f" {LIMIT_WORDS[note]}" for note in self.notes if note in LIMIT_WORDS)
        return {"basic": f"[{said}]", "reference": f"({said})", "toleranced": said}[self.role]


def degrees(measure: Measure) -> str:
    """The sign of an angle's unit."""
    return "" if measure.unit.dimension == "length" else "°" if measure.unit.name == "deg" else f" {measure.unit.name}"


def deviations(minus: float, plus: float) -> str:
    """A pair of deviations as a drawing has it: ` ±0.02`, or ` +0.003/-0`."""
    if minus == -plus:
        return f" ±{plain(plus)}"
    return f" +{plain(plus)}/{plain(minus)}" if plus > 0 else f" {plain(plus)}/{plain(minus)}"


@dataclass(frozen=True)
class Dimensions:
    """The dimensions of a file, each read by itself, with the representations and the ranges that name them."""

    file: Part21
    features: Features

    @cached_property
    def ids(self) -> tuple[int, ...]:
        """Every entity that is a dimension, in the file's order."""
        return tuple(each.id for each in self.file.of(*SIZES, *LOCATIONS))

    @cached_property
    def represented(self) -> dict[int, tuple[int, ...]]:
        """Items that represent each dimension."""
        found: dict[int, tuple[int, ...]] = {}
        for record in self.file.records("DIMENSIONAL_CHARACTERISTIC_REPRESENTATION"):
            dimension = int(record.reference(0))
            items, _ = representation(self.file, record.reference(1))
            found[dimension] = (*found.get(dimension, ()), *items)
        return found

    @cached_property
    def ranges(self) -> dict[int, int]:
        """± values or class of limits of each dimension."""
        found = self.file.records("PLUS_MINUS_TOLERANCE")
        return {int(each.reference(1)): int(each.reference(0)) for each in found}

    def read(self, identifier: int) -> Dimension:
        """One dimension.

        Raises:
            StepError: its content cannot be read.
        """
        instance = self.file[identifier]
        named: dict[str, Measure] = {}
        notes: list[str] = []
        for item in self.represented.get(identifier, ()):
            described = self.file[item].record("DESCRIPTIVE_REPRESENTATION_ITEM")
            if is_measure(self.file[item]):
                measure = measure_of(self.file, item)
                named.setdefault(measure.name.strip().lower(), measure)
                notes.extend(self.qualifiers(self.file[item]))
            elif described is not None:
                notes.append(described.text(1).strip())
        nominal = named.get("nominal value") or named.get("")
        kind, features = self.sides(instance)
        minus, plus, fit = self.range_of(identifier)
        roles = [ROLES[note] for note in notes if note in ROLES]
        return Dimension(
            identifier,
            features[0].name,
            kind,
            features,
            directed=any(record.keyword.startswith("DIRECTED") for record in instance.records),
            role=roles[0] if roles else "toleranced",
            nominal=nominal,
            minus=minus,
            plus=plus,
            least=named.get("lower limit"),
            most=named.get("upper limit"),
            fit=fit,
            notes=tuple(note for note in notes if note not in ROLES),
        )

    def qualifiers(self, item: Instance) -> list[str]:
        """The words beside a value: `maximum` of a single limit such as R2 MAX."""
        record = item.record("QUALIFIED_REPRESENTATION_ITEM")
        listed = [self.file[reference] for reference in record.references(-1)] if record is not None else []
        words = [each.needed("TYPE_QUALIFIER").text(0).strip() for each in listed if each.record("TYPE_QUALIFIER")]
        return [word for word in words if word in LIMIT_WORDS]

    def sides(self, instance: Instance) -> tuple[str, tuple[NamedFeature, ...]]:
        """The kind of a dimension, and its features."""
        size = instance.record(*SIZES)
        if size is not None:
            record = instance.record("DIMENSIONAL_SIZE") or size
            first = 4 if record.keyword == "DIMENSIONAL_SIZE_WITH_DATUM_FEATURE" else 0  # that of its aspect come first
            usual = "angle" if size.keyword == "ANGULAR_SIZE" else "size"
            return self.kind(record, first + 1, usual), (self.features.aspect(record.reference(first)),)
        record = instance.record("SHAPE_ASPECT_RELATIONSHIP") or instance.needed(*LOCATIONS)
        ends = tuple(self.features.named(record.reference(index)) for index in (2, 3))
        angular = any("ANGULAR" in each.keyword for each in instance.records)
        return self.kind(record, 0, "angle" if angular else "linear distance"), ends

    def kind(self, record: Record, index: int, otherwise: str) -> str:
        """The kind of a dimension in the file's words, or the usual word by default."""
        return record.text(index).strip().lower() or otherwise

    def range_of(self, identifier: int) -> tuple[Measure | None, Measure | None, Fit | None]:
        """Lower and upper deviation, and the class of limits, that are stated for a dimension."""
        if identifier not in self.ranges:
            return None, None, None
        instance = self.file[self.ranges[identifier]]
        fit = instance.record("LIMITS_AND_FITS")
        if fit is not None:
            return (
                None,
                None,
                Fit(fit.text(0) + fit.text(2), fit.text(1)),
            )  # one exporter writes G6 into the first field
        values = instance.needed("TOLERANCE_VALUE")
        low, high = (measure_of(self.file, values.reference(index)) for index in (0, 1))
        return low, high, None
