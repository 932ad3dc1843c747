"""Datums: their letters, features and targets, and the datum systems that tolerances refer to."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from tol3d.cad.step.feature import Features, NamedFeature, is_datum
from tol3d.cad.step.instance import Record, spoken
from tol3d.cad.step.part21 import Part21
from tol3d.cad.step.placement import Placement, length_unit, placement_of, represented
from tol3d.cad.step.refused import StepError
from tol3d.cad.step.units import Measure, is_measure, measure_of
from tol3d.cad.step.values import Enumeration, Missing, Reference, Typed, Value

TARGETS: Final = ("DATUM_TARGET", "PLACED_DATUM_TARGET_FEATURE")
REFERENCES: Final = ("DATUM_REFERENCE_ELEMENT", "DATUM_REFERENCE_COMPARTMENT")


@dataclass(frozen=True)
class DatumTarget:
    """A place where a datum is taken.

    Args:
        id: its shape aspect.
        number: as the drawing has it after the letter: the 1 of A1.
        kind: area, point, line, rectangle, circle or another word of the file.
        feature: the faces that it names, if any.
        placement: in the part's frame, if the file states it.
        sizes: its lengths, named `target length`, `target width`, `target diameter`.
    """

    id: int
    number: str
    kind: str
    feature: NamedFeature
    placement: Placement | None
    sizes: tuple[Measure, ...]


@dataclass(frozen=True)
class Datum:
    """A datum.

    Args:
        id: its entity.
        letter: as tolerances refer to it.
        features: the geometry that it is taken from; several only if the file states it.
        targets: if targets are stated.
    """

    id: int
    letter: str
    features: tuple[NamedFeature, ...]
    targets: tuple[DatumTarget, ...]

    @property
    def faces(self) -> tuple[int, ...]:
        """The faces of its features, else of its targets."""
        named = self.features or tuple(target.feature for target in self.targets)
        return tuple(dict.fromkeys(face for each in named for face in each.faces))


@dataclass(frozen=True)
class DatumReference:
    """A datum in a frame, with its modifiers in words."""

    datum: int
    letter: str
    modifiers: tuple[str, ...]


@dataclass(frozen=True)
class Compartment:
    """One compartment of a datum system: a datum, or several that are one (A-B).

    Args:
        id: its entity.
        references: the datums.
        modifiers: those of the whole compartment, in words.
    """

    id: int
    references: tuple[DatumReference, ...]
    modifiers: tuple[str, ...]

    @property
    def letters(self) -> str:
        """Letters as a frame prints them without modifiers: `A`, `E-F-G`."""
        return "-".join(reference.letter for reference in self.references)


def datum_letter(file: Part21, identifier: int) -> str:
    """The letter of a datum."""
    return file[identifier].needed("DATUM", "COMMON_DATUM").text(-1).strip()


def read_datum(features: Features, identifier: int) -> Datum:
    """A datum with its features.

    Raises:
        StepError: its content cannot be read.
    """
    file = features.file
    ends = [
        (related if relating == identifier else relating)
        for relating, related, _ in features.relationships
        if identifier in (relating, related) and relating != related
    ]
    targets = [end for end in ends if file[end].record(*TARGETS) is not None]
    named = [
        features.named(end) for end in ends if end not in targets and file[end].record("DATUM", "DATUM_SYSTEM") is None
    ]
    if not any(each.groups for each in named):
        own = features.named(identifier)  # some exporters hang the faces on the datum itself
        named = [own] if own.groups else named
    return Datum(
        identifier,
        datum_letter(file, identifier),
        tuple(named),
        tuple(read_target(features, target) for target in sorted(set(targets))),
    )


def read_target(features: Features, identifier: int) -> DatumTarget:
    """One datum target with the place and the sizes that are represented for it."""
    instance = features.file[identifier]
    record = instance.needed(*TARGETS)
    aspect = instance.inherited("SHAPE_ASPECT")
    placement, sizes = None, []
    for item, context in represented(features.file, identifier):
        if features.file[item].record("AXIS2_PLACEMENT_3D") is not None:
            placement = placement_of(features.file, item, length_unit(features.file, context))
        elif is_measure(features.file[item]):
            sizes.append(measure_of(features.file, item))
    feature = features.named(identifier)
    holders = [relating for relating, related, _ in features.relationships if related == identifier != relating]
    if not feature.groups and holders and not is_datum(features.file[holders[0]]):
        feature = features.named(holders[0])  # by FEATURE_FOR_DATUM_TARGET_RELATIONSHIP
    number = record.text(-1).strip()
    return DatumTarget(identifier, number, aspect.text(1).strip(), feature, placement, tuple(sizes))


def read_systems(file: Part21, identifiers: tuple[Reference, ...]) -> tuple[Compartment, ...]:
    """The compartments of the datum systems, or of older files' datum references, that a tolerance lists.

    Raises:
        StepError: one of them is neither.
    """
    found: list[Compartment] = []
    ranked: list[tuple[float, Compartment]] = []
    for identifier in identifiers:
        instance = file[identifier]
        system = instance.record("DATUM_SYSTEM")
        if system is not None:
            found.extend(read_compartment(file, reference) for reference in system.references(-1))
            continue
        old = instance.needed("DATUM_REFERENCE", "REFERENCED_MODIFIED_DATUM")
        modifiers = tuple(modifier_words(file, old)) if old.keyword == "REFERENCED_MODIFIED_DATUM" else ()
        datum = old.reference(1)
        references = tuple(
            DatumReference(int(datum), letter.strip(), modifiers) for letter in datum_letter(file, datum).split("-")
        )
        ranked.append((old.number(0), Compartment(int(identifier), references, ())))
    return (*found, *(each for _, each in sorted(ranked, key=lambda pair: pair[0])))


def read_compartment(file: Part21, identifier: int) -> Compartment:
    """One compartment.

    Raises:
        StepError: its datums or modifiers cannot be read.
    """
    record = file[identifier].needed(*REFERENCES)
    base = record.argument(-2)
    modifiers = tuple(modifier_words(file, record))
    if isinstance(base, Reference):
        return Compartment(identifier, (DatumReference(int(base), datum_letter(file, base), modifiers),), ())
    elements = [file[reference].needed(*REFERENCES) for reference in record.references(-2)]
    if not elements:
        raise record.wrong(len(record) - 2, "at least one datum")
    references = tuple(
        DatumReference(
            int(element.reference(-2)), datum_letter(file, element.reference(-2)), tuple(modifier_words(file, element))
        )
        for element in elements
    )
    return Compartment(identifier, references, modifiers)


def modifier_words(file: Part21, record: Record) -> Iterator[str]:
    """The modifiers in the last argument of a datum reference, in words."""
    said: Value = record.argument(-1)
    if isinstance(said, Missing):
        return
    for each in said if isinstance(said, tuple) else (said,):
        if isinstance(each, Enumeration):
            yield spoken(each.word)
        elif isinstance(each, Typed) and each.arguments and isinstance(each.arguments[0], Enumeration):
            yield spoken(each.arguments[0].word)
        elif isinstance(each, Reference):
            valued = file[each].needed("DATUM_REFERENCE_MODIFIER_WITH_VALUE")
            word = valued.argument(0)
            if not isinstance(word, Enumeration):
                raise valued.wrong(0, "a word such as .SPHERICAL.")
            yield f"{spoken(word.word)} {measure_of(file, valued.reference(1))}"
        else:
            raise StepError(f"{record.instance.place}: {record.keyword}: expected modifiers such as .FREE_STATE.")
