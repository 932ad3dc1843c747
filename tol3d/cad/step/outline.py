"""The content of a STEP file's text on parts, datums, tolerances and dimensions: `read_step_text`.

Nominal dimensions against the surfaces that they are of: a wrong unit or a wrong face shows at once.

Names on the faces of a foreign part's drawing: datums, tolerances, dimensions. Selectors may use them.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Final, Literal, TypeVar

from tol3d.cad.step.datum import Compartment, Datum, read_datum
from tol3d.cad.step.dimension import Dimension, Dimensions
from tol3d.cad.step.feature import FACES, Features, NamedFeature
from tol3d.cad.step.frame import SYMBOLS, frame
from tol3d.cad.step.part21 import Header, Part21, read_part21
from tol3d.cad.step.read_structure import StructureReader
from tol3d.cad.step.refused import StepError
from tol3d.cad.step.structure import Structure
from tol3d.cad.step.surfaces import SAME_PLACE, Surface, aligned, dot, merged
from tol3d.cad.step.tolerance import Tolerance, Tolerances
from tol3d.cad.step.values import Reference, Value

Read = TypeVar("Read")


@dataclass(frozen=True)
class Remark:
    """Something of the file that was not read, or is incomplete, and why.

    Args:
        id: its instance.
        what: `tolerance`, `dimension`, `datum`, `feature` or `shown`, and its name.
        why: in one line.
    """

    id: int
    what: str
    why: str


@dataclass(frozen=True)
class StepText:
    """Content of the text of a STEP file.

    Args:
        file: the instances.
        structure: products, solids, faces, assemblies.
        datums: in the file's order.
        tolerances: in the file's order.
        dimensions: in the file's order.
        remarks: items not read, or incomplete; nothing is left out silently.
    """

    file: Part21 = field(repr=False)
    structure: Structure
    datums: tuple[Datum, ...]
    tolerances: tuple[Tolerance, ...]
    dimensions: tuple[Dimension, ...]
    remarks: tuple[Remark, ...]

    @property
    def name(self) -> str:
        """The file's name."""
        return self.file.name

    @property
    def header(self) -> Header:
        """Header of the file."""
        return self.file.header

    @cached_property
    def faces(self) -> dict[int, str]:
        """Every face of the file with its name, in the file's order."""
        found = {}
        for instance in self.file.of(*FACES):
            named = instance.record("REPRESENTATION_ITEM") or instance.needed(*FACES)
            found[instance.id] = named.text(0) if len(named) else ""
        return found

    @property
    def features(self) -> Iterator[NamedFeature]:
        """All that tolerances, dimensions and datums name, some of it repeatedly."""
        for tolerance in self.tolerances:
            yield tolerance.feature
            if tolerance.projected is not None:
                yield from tolerance.projected.ends
        for dimension in self.dimensions:
            yield from dimension.features
        for datum in self.datums:
            yield from datum.features
            yield from (target.feature for target in datum.targets)

    @cached_property
    def faces_of(self) -> dict[int, set[int]]:
        """Faces of every tolerance, dimension, datum and datum feature."""
        found: dict[int, set[int]] = {tolerance.id: set(tolerance.feature.faces) for tolerance in self.tolerances}
        for dimension in self.dimensions:
            found[dimension.id] = {face for feature in dimension.features for face in feature.faces}
        for datum in self.datums:
            found[datum.id] = set(datum.faces)
            found |= {feature.id: set(datum.faces) for feature in datum.features}
            found |= {target.id: set(target.feature.faces) for target in datum.targets}
        return found

    def datum(self, letter: str) -> Datum | None:
        """The datum of a letter."""
        return next((datum for datum in self.datums if datum.letter == letter), None)

    def product(self, feature: NamedFeature) -> int | None:
        """The product that a feature is of: by its faces, else by its shape."""
        by_face = next((self.structure.product_of_face.get(face) for face in feature.faces), None)
        return by_face if by_face is not None else self.structure.product_of_shape.get(feature.shape)


def read_step_text(source: Path | bytes, name: str | None = None) -> StepText:
    """Read the text of a STEP file.

    Args:
        source: its path, or its content.
        name: the name for errors; default: the file's own.

    Raises:
        StepError: it is no STEP file, is damaged or too large, or refers to other files. A tolerance, dimension or
            datum that cannot be read by itself is a remark instead.
    """
    file = read_part21(source, name)
    structure = StructureReader(file).read()
    features = Features(file)
    tolerances, dimensions = Tolerances(file, features), Dimensions(file, features)
    remarks: list[Remark] = []

    def each_of(what: str, ids: tuple[int, ...], read: Callable[[int], Read]) -> Iterator[Read]:
        for identifier in ids:
            try:
                yield read(identifier)
            except StepError as error:
                remarks.append(Remark(identifier, what, str(error)))

    datum_ids = tuple(each.id for each in file.of("DATUM"))
    text = StepText(
        file,
        structure,
        tuple(each_of("datum", datum_ids, lambda each: read_datum(features, each))),
        tuple(each_of("tolerance", tolerances.ids, tolerances.read)),
        tuple(each_of("dimension", dimensions.ids, dimensions.read)),
        (),
    )
    remarks.extend(incomplete(text))
    remarks.extend(unnamed(text, features))
    return StepText(file, structure, text.datums, text.tolerances, text.dimensions, tuple(remarks))


def incomplete(text: StepText) -> Iterator[Remark]:
    """Remarks on items that lack a value, a kind, a letter or its faces, and on products without a shape."""
    for product in text.structure.products.values():
        if not product.faces and product.id not in text.structure.inside:
            yield Remark(product.id, f"product {product.name}", "has neither solids nor faces")
    for tolerance in text.tolerances:
        what = f"tolerance {tolerance.name}".strip()
        if tolerance.magnitude is None:
            yield Remark(tolerance.id, what, "states no value")
        if tolerance.kind not in SYMBOLS:
            yield Remark(tolerance.id, what, "states no kind of tolerance")
        yield from incomplete_feature(tolerance.id, what, tolerance.feature)
    for dimension in text.dimensions:
        what = f"dimension {dimension.name}".strip()
        if dimension.nominal is None and dimension.limits is None:
            yield Remark(dimension.id, what, "states no value")
        for feature in dimension.features:
            yield from incomplete_feature(dimension.id, what, feature)
    for datum in text.datums:
        what = f"datum {datum.letter}".strip()
        if not datum.letter:
            yield Remark(datum.id, what, "has no letter")
        if not datum.features and not datum.targets:
            yield Remark(datum.id, what, "names neither geometry nor targets")
        for feature in datum.features:
            yield from incomplete_feature(datum.id, what, feature)


def incomplete_feature(identifier: int, what: str, feature: NamedFeature) -> Iterator[Remark]:
    """Remarks on items that name no faces, or members without any."""
    if feature.lies_on == "nothing":
        yield Remark(identifier, what, f"names no geometry (#{feature.id})")
    elif feature.lies_on == "curves":
        yield Remark(identifier, what, f"lies on curves, not on faces (#{feature.id})")
    elif feature.bare:
        yield Remark(
            identifier, what, f"has members without geometry ({', '.join(f'#{each}' for each in feature.bare)})"
        )


def unnamed(text: StepText, features: Features) -> Iterator[Remark]:
    """Remarks on faces that the file groups, or shows, for tolerances that do not name them: something may be lost.

    Those that only a note points at are not among them.
    """
    seen = {aspect: None for feature in text.features for aspect in feature.aspects}
    told: set[int] = set()
    for shown in shown_together(text.file).values():
        own = [each for each in shown if each in text.faces_of]
        aspects = [each for each in shown if each not in text.faces_of]
        faces = {face for each in aspects for group in features.groups(each, {}) for face in group}
        lacking = faces.difference(*(text.faces_of[each] for each in own))
        if own and lacking and own[0] not in told:
            told.add(own[0])
            named = ", ".join(f"#{each}" for each in sorted(lacking)[:5])
            yield Remark(own[0], "shown", f"is shown with faces that it does not name ({named})")
        for each in aspects:
            features.groups(each, seen)
    for aspect, items in features.items.items():
        if aspect not in seen and any(features.keywords(item) & FACES for item in items):
            yield Remark(aspect, "feature", "has faces that no tolerance, dimension, datum or note refers to")


def shown_together(file: Part21) -> dict[Value, list[int]]:
    """Tolerances, dimensions and shape aspects that each callout of the presentation shows."""
    found: dict[Value, list[int]] = {}
    links = ("DRAUGHTING_MODEL_ITEM_ASSOCIATION", "DRAUGHTING_MODEL_ITEM_ASSOCIATION_WITH_PLACEHOLDER")
    for each in file.of(*links):
        record = each.needed(*links)
        if len(record) > 4 and isinstance(record.argument(2), Reference):
            found.setdefault(record.argument(4), []).append(int(record.reference(2)))
    return found


NOMINAL_XTOL: Final = 0.01  # mm; dimensions are rounded for the drawing, such as 0.1875 in as 0.188
PER_RADIUS: Final = {"diameter": 2.0, "radius": 1.0, "spherical diameter": 2.0, "spherical radius": 1.0}


def measured(dimension: Dimension, surfaces: Mapping[int, Surface]) -> float | None:
    """The size or the distance that the surfaces have [mm]; None if they are not of one size, or not parallel."""
    sides = [merged([surfaces[face] for face in feature.faces if face in surfaces]) for feature in dimension.features]
    if dimension.kind in PER_RADIUS and sides[0]:
        radii = [each.radius for each in sides[0] if each.radius and each.kind != "cone"]
        same = bool(radii) and max(radii) - min(radii) < SAME_PLACE
        return PER_RADIUS[dimension.kind] * radii[0] if same else None
    if dimension.kind != "linear distance" or [len(side) for side in sides] != [1, 1]:
        return None
    first, second = sides[0][0], sides[1][0]
    if first.kind != "plane" or second.kind != "plane" or not aligned(first.direction, second.direction):
        return None
    return abs(dot(tuple(b - a for a, b in zip(first.at, second.at, strict=True)), first.direction))


def disagreements(text: StepText, surfaces: Mapping[int, Surface]) -> Iterator[Remark]:
    """A remark on each dimension whose nominal is not that of its faces."""
    for dimension in text.dimensions:
        found = measured(dimension, surfaces)
        if found is not None and dimension.nominal is not None and abs(found - dimension.nominal.value) > NOMINAL_XTOL:
            what = f"dimension {dimension.name}".strip()
            yield Remark(dimension.id, what, f"is {dimension} where its faces have {found:.4f} mm")


@dataclass(frozen=True)
class Named:
    """Faces that a drawing names.

    Args:
        id: its instance in the file.
        what: kind of item that names them.
        name: the letter of a datum; the name of a tolerance or dimension in the file.
        kind: of a tolerance, such as "position"; of a dimension its words; "" of a datum.
        value: of a tolerance [mm]; None if it states none.
        datums: of a tolerance, their letters: "A | B-C".
        words: as a drawing has it.
        faces: their numbers.
    """

    id: int
    what: Literal["datum", "tolerance", "dimension"]
    name: str
    kind: str
    value: float | None
    datums: str
    words: str
    faces: tuple[int, ...]


def named_in(text: StepText) -> Iterator[Named]:
    """Everything in a file that names faces, in its order."""
    for datum in text.datums:
        yield Named(datum.id, "datum", datum.letter, "", None, "", f"datum {datum.letter}", datum.faces)
    for tolerance in text.tolerances:
        value = (
            None
            if tolerance.magnitude is None or tolerance.magnitude.unit.dimension != "length"
            else tolerance.magnitude.value
        )
        words = frame(tolerance)
        yield Named(
            tolerance.id,
            "tolerance",
            tolerance.name,
            tolerance.kind,
            value,
            _letters(tolerance),
            words,
            tuple(tolerance.feature.faces),
        )
    for dimension in text.dimensions:
        yield Named(dimension.id, "dimension", dimension.name, "", None, "", str(dimension), _faces(dimension.features))


def _faces(features: Sequence[NamedFeature]) -> tuple[int, ...]:
    return tuple(dict.fromkeys(face for feature in features for face in feature.faces))


def _letters(tolerance: Tolerance) -> str:
    """The letters of its datums, without their modifiers."""
    return " | ".join(_of(datum) for datum in tolerance.datums)


def _of(compartment: Compartment) -> str:
    return "-".join(reference.letter for reference in compartment.references)
