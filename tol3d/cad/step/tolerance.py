"""Geometric tolerances of a STEP file.

Source: CAx-IF recommended practices for the representation of PMI, 4.x, section 6.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

from tol3d.cad.step.datum import Compartment, read_systems
from tol3d.cad.step.feature import Features, NamedFeature
from tol3d.cad.step.instance import Instance, spoken
from tol3d.cad.step.part21 import Part21
from tol3d.cad.step.refused import StepError
from tol3d.cad.step.units import Measure, measure_of
from tol3d.cad.step.values import Enumeration, Missing, Reference

Zone = Literal["width", "diameter", "spherical diameter"]

KINDS: Final = {
    "STRAIGHTNESS_TOLERANCE": "straightness",
    "FLATNESS_TOLERANCE": "flatness",
    "ROUNDNESS_TOLERANCE": "roundness",
    "CYLINDRICITY_TOLERANCE": "cylindricity",
    "LINE_PROFILE_TOLERANCE": "line profile",
    "SURFACE_PROFILE_TOLERANCE": "surface profile",
    "ANGULARITY_TOLERANCE": "angularity",
    "PERPENDICULARITY_TOLERANCE": "perpendicularity",
    "PARALLELISM_TOLERANCE": "parallelism",
    "POSITION_TOLERANCE": "position",
    "CONCENTRICITY_TOLERANCE": "concentricity",
    "COAXIALITY_TOLERANCE": "coaxiality",
    "SYMMETRY_TOLERANCE": "symmetry",
    "CIRCULAR_RUNOUT_TOLERANCE": "circular runout",
    "TOTAL_RUNOUT_TOLERANCE": "total runout",
}
"""The entity of each kind of tolerance, and its word."""

GENERAL: Final = (
    "GEOMETRIC_TOLERANCE",
    "GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE",
    "GEOMETRIC_TOLERANCE_WITH_DEFINED_AREA_UNIT",
    "GEOMETRIC_TOLERANCE_WITH_DEFINED_UNIT",
    "GEOMETRIC_TOLERANCE_WITH_MAXIMUM_TOLERANCE",
    "GEOMETRIC_TOLERANCE_WITH_MODIFIERS",
    "MODIFIED_GEOMETRIC_TOLERANCE",
    "UNEQUALLY_DISPOSED_GEOMETRIC_TOLERANCE",
)
"""Entities that a tolerance of any kind may be besides."""

ZONE_FORMS: Final[Mapping[str, Zone]] = {
    "cylindrical or circular": "diameter",
    "within a cylinder": "diameter",
    "within a circle": "diameter",
    "spherical": "spherical diameter",
    "within a sphere": "spherical diameter",
}
"""Forms of a zone whose magnitude is a diameter; all others are widths."""


@dataclass(frozen=True)
class ProjectedZone:
    """Length of a zone beyond its feature, and the faces that it starts from."""

    length: Measure
    ends: tuple[NamedFeature, ...]


@dataclass(frozen=True)
class PerUnit:
    """The length or the area over which a magnitude holds.

    Args:
        size: a length, side or diameter.
        area: circular, rectangular, square or another word; empty for a length.
        second: the other side of a rectangle.
    """

    size: Measure
    area: str = ""
    second: Measure | None = None


@dataclass(frozen=True)
class Tolerance:
    """A geometric tolerance as the file states it.

    Args:
        id: its instance.
        name: its name in the file, such as `Position.10`.
        text: its description, such as a note under the frame.
        kind: `position`, `flatness` and so on.
        magnitude: its value with its own unit; None where the file states none.
        zone: whether the magnitude is a width or a diameter.
        form: the zone's form in the file's words, empty if it states none.
        feature: the toleranced one.
        datums: the compartments of its datum system, in order.
        datum_system: its instance; None if there is none.
        modifiers: in words, such as `maximum material requirement`.
        projected, unequal, per_unit, maximum: further fields of the frame.
        above: the tolerance whose lower segment this one is.
        relation: how the file calls that relation, such as `composite`.
    """

    id: int
    name: str
    text: str
    kind: str
    magnitude: Measure | None
    zone: Zone
    form: str
    feature: NamedFeature
    datums: tuple[Compartment, ...] = ()
    datum_system: int | None = None
    modifiers: tuple[str, ...] = ()
    projected: ProjectedZone | None = None
    unequal: Measure | None = None
    per_unit: PerUnit | None = None
    maximum: Measure | None = None
    above: int | None = None
    relation: str = ""


@dataclass(frozen=True)
class Tolerances:
    """The tolerances of a file, each read by itself, with the zones and the relations that name them."""

    file: Part21
    features: Features

    @cached_property
    def ids(self) -> tuple[int, ...]:
        """Every entity that is a geometric tolerance, in the file's order."""
        return tuple(each.id for each in self.file.of(*GENERAL, *KINDS))

    @cached_property
    def zones(self) -> dict[int, list[int]]:
        """Zones of each tolerance."""
        found: dict[int, list[int]] = {}
        for instance in self.file.of("TOLERANCE_ZONE", "TOLERANCE_ZONE_WITH_DATUM"):
            for tolerance in zone_fields(instance)[0]:
                found.setdefault(tolerance, []).append(instance.id)
        return found

    @cached_property
    def projections(self) -> dict[int, ProjectedZone]:
        """Projection of each projected zone."""
        found: dict[int, ProjectedZone] = {}
        for instance in self.file.of("PROJECTED_ZONE_DEFINITION", "PROJECTED_ZONE_DEFINITION_WITH_OFFSET"):
            record = instance.needed("PROJECTED_ZONE_DEFINITION", "PROJECTED_ZONE_DEFINITION_WITH_OFFSET")
            first = 0 if len(instance.records) > 1 else 2
            zone = int((instance.record("TOLERANCE_ZONE_DEFINITION") or record).reference(0))
            end = self.features.named(record.reference(first))
            reach = length(self.file, record.reference(first + 1))
            before = found.get(zone, ProjectedZone(reach, ()))  # one exporter says it for each hole of a pattern
            if before.length.value != reach.value:
                raise StepError(f"{instance.place}: expected one projected length, got {before.length} and {reach}")
            found[zone] = ProjectedZone(reach, (*before.ends, end))
        return found

    @cached_property
    def uneven(self) -> frozenset[int]:
        """The zones whose width is not the same everywhere."""
        found = self.file.of("NON_UNIFORM_ZONE_DEFINITION")
        return frozenset(int(each.inherited("TOLERANCE_ZONE_DEFINITION").reference(0)) for each in found)

    @cached_property
    def above(self) -> dict[int, tuple[int, str]]:
        """Tolerance above each lower segment, and the relation's name."""
        related = self.file.records("GEOMETRIC_TOLERANCE_RELATIONSHIP")
        return {int(each.reference(3)): (int(each.reference(2)), each.text(0)) for each in related}

    def read(self, identifier: int) -> Tolerance:
        """One tolerance.

        Raises:
            StepError: its content cannot be read.
        """
        instance = self.file[identifier]
        record = instance.inherited("GEOMETRIC_TOLERANCE")
        named = [KINDS[each.keyword] for each in instance.records if each.keyword in KINDS]
        magnitude = record.argument(2)
        systems = datum_systems(instance)
        zone, form, projected = self.zone_of(identifier)
        uneven = any(each in self.uneven for each in self.zones.get(identifier, ()))
        above, relation = self.above.get(identifier, (None, ""))
        return Tolerance(
            id=identifier,
            name=record.text(0),
            text=record.text(1),
            kind=named[0] if named else "geometric tolerance without a kind",
            magnitude=None if isinstance(magnitude, Missing) else length(self.file, record.reference(2)),
            zone=zone,
            form=form,
            feature=self.features.named(record.reference(3)),
            datums=read_systems(self.file, systems),
            datum_system=int(systems[0]) if systems else None,
            modifiers=(*modifiers(instance), *(("non-uniform zone",) if uneven else ())),
            projected=projected,
            unequal=own_measure(self.file, instance, "UNEQUALLY_DISPOSED_GEOMETRIC_TOLERANCE"),
            per_unit=per_unit(self.file, instance),
            maximum=own_measure(self.file, instance, "GEOMETRIC_TOLERANCE_WITH_MAXIMUM_TOLERANCE"),
            above=above,
            relation=relation,
        )

    def zone_of(self, identifier: int) -> tuple[Zone, str, ProjectedZone | None]:
        """The zone of a tolerance: its type of magnitude, its form, and its projection."""
        zone: Zone = "width"
        form, projected = "", None
        for each in self.zones.get(identifier, ()):
            form = self.file[zone_fields(self.file[each])[1]].needed("TOLERANCE_ZONE_FORM").text(0)
            zone = ZONE_FORMS.get(form.strip().lower(), "width")
            projected = self.projections.get(each, projected)
        return zone, form, projected


def zone_fields(instance: Instance) -> tuple[tuple[Reference, ...], Reference]:
    """The tolerances that a zone is of, and its form."""
    record = instance.needed("TOLERANCE_ZONE", "TOLERANCE_ZONE_WITH_DATUM")
    first = 4 if len(instance.records) == 1 else 0
    return record.references(first), record.reference(first + 1)


def datum_systems(instance: Instance) -> tuple[Reference, ...]:
    """The datum systems that a tolerance lists."""
    listed = instance.record("GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE")
    if listed is not None:
        return listed.references(4 if len(instance.records) == 1 else 0)
    record = instance.records[0]
    if len(instance.records) == 1 and record.keyword in KINDS and len(record.arguments) > 4:
        return instance.needed(record.keyword).references(4)
    return ()


def modifiers(instance: Instance) -> tuple[str, ...]:
    """The modifiers of a tolerance, in words."""
    listed = instance.record("GEOMETRIC_TOLERANCE_WITH_MODIFIERS")
    if listed is not None:
        return listed.words(-1)
    single = instance.record("MODIFIED_GEOMETRIC_TOLERANCE")
    if single is None:
        return ()
    word = single.argument(-1)
    if not isinstance(word, Enumeration):
        raise single.wrong(len(single) - 1, "a modifier such as .MAXIMUM_MATERIAL_CONDITION.")
    return (spoken(word.word),)


def own_measure(file: Part21, instance: Instance, keyword: str) -> Measure | None:
    """The length that is the last argument of one of a tolerance's entities, None if it has no such entity."""
    record = instance.record(keyword)
    return None if record is None else length(file, record.reference(-1))


def per_unit(file: Part21, instance: Instance) -> PerUnit | None:
    """The length or the area over which a tolerance holds."""
    record = instance.record("GEOMETRIC_TOLERANCE_WITH_DEFINED_UNIT")
    area = instance.record("GEOMETRIC_TOLERANCE_WITH_DEFINED_AREA_UNIT")
    if record is None:
        return None
    size = length(file, record.reference(-1))
    if area is None:
        return PerUnit(size)
    word, second = area.argument(-2), area.argument(-1)
    if not isinstance(word, Enumeration):
        raise area.wrong(len(area) - 2, "a form of area such as .CIRCULAR.")
    return PerUnit(size, spoken(word.word), None if isinstance(second, Missing) else length(file, area.reference(-1)))


def length(file: Part21, identifier: int) -> Measure:
    """A measure that must be a length.

    Raises:
        StepError: it is an angle.
    """
    found = measure_of(file, identifier)
    if found.unit.dimension != "length":
        raise StepError(f"{file.place(identifier)}: expected a length, got an angle, {found}")
    return found
