"""The content of a STEP file's text on parts, datums, tolerances and dimensions: `read_step_text`."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TypeVar

from tol3d.step.datum import Datum, read_datum
from tol3d.step.dimension import Dimension, Dimensions
from tol3d.step.feature import FACES, Features, NamedFeature
from tol3d.step.frame import SYMBOLS
from tol3d.step.part21 import Header, Part21, read_part21
from tol3d.step.read_structure import StructureReader
from tol3d.step.refused import StepError
from tol3d.step.structure import Structure
from tol3d.step.tolerance import Tolerance, Tolerances
from tol3d.step.values import Reference, Value

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
            yield from (each.feature for each in datum.targets)

    @cached_property
    def faces_of(self) -> dict[int, set[int]]:
        """Faces of every tolerance, dimension, datum and datum feature."""
        found: dict[int, set[int]] = {each.id: set(each.feature.faces) for each in self.tolerances}
        for dimension in self.dimensions:
            found[dimension.id] = {face for each in dimension.features for face in each.faces}
        for datum in self.datums:
            found[datum.id] = set(datum.faces)
            found |= {each.id: set(datum.faces) for each in datum.features}
            found |= {each.id: set(each.feature.faces) for each in datum.targets}
        return found

    def datum(self, letter: str) -> Datum | None:
        """The datum of a letter."""
        return next((each for each in self.datums if each.letter == letter), None)

    def product(self, feature: NamedFeature) -> int | None:
        """The product that a feature is of: by its faces, else by its shape."""
        by_face = next((self.structure.product_of_face.get(each) for each in feature.faces), None)
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
    for each in text.tolerances:
        what = f"tolerance {each.name}".strip()
        if each.magnitude is None:
            yield Remark(each.id, what, "states no value")
        if each.kind not in SYMBOLS:
            yield Remark(each.id, what, "states no kind of tolerance")
        yield from incomplete_feature(each.id, what, each.feature)
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
    seen = {aspect: None for each in text.features for aspect in each.aspects}
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
        if aspect not in seen and any(features.keywords(each) & FACES for each in items):
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
