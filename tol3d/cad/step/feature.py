"""Feature that a tolerance, datum or dimension names: a shape aspect with the faces of each of its members.

An aspect's own geometry is linked by GEOMETRIC_ITEM_SPECIFIC_USAGE or ITEM_IDENTIFIED_REPRESENTATION_USAGE; its
members by SHAPE_ASPECT_RELATIONSHIP, and the basis of a centre by SHAPE_ASPECT_DERIVING_RELATIONSHIP. Source:
CAx-IF recommended practices for the representation of PMI, 4.x, sections 5 and 6.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Final, Literal

from tol3d.cad.step.instance import Instance, Record
from tol3d.cad.step.part21 import Part21
from tol3d.cad.step.values import Reference, Typed

FACES: Final = frozenset(("ADVANCED_FACE", "FACE_SURFACE"))
SOLIDS: Final = frozenset(
    (
        "MANIFOLD_SOLID_BREP",
        "BREP_WITH_VOIDS",
        "FACETED_BREP",
        "SHELL_BASED_SURFACE_MODEL",
        "CLOSED_SHELL",
        "OPEN_SHELL",
    )
)
ONE_FEATURE: Final = frozenset(("unified geometric item", "single feature"))
USAGES: Final = ("GEOMETRIC_ITEM_SPECIFIC_USAGE", "ITEM_IDENTIFIED_REPRESENTATION_USAGE")
RELATIONSHIPS: Final = (
    "SHAPE_ASPECT_RELATIONSHIP", "SHAPE_ASPECT_DERIVING_RELATIONSHIP", "FEATURE_FOR_DATUM_TARGET_RELATIONSHIP",
)  # fmt: skip
DATUM_ASPECTS: Final = (
    "DATUM", "DATUM_SYSTEM", "COMMON_DATUM", "DATUM_REFERENCE_COMPARTMENT", "DATUM_TARGET",
    "PLACED_DATUM_TARGET_FEATURE",
)  # fmt: skip
WHOLE: Final = ("PRODUCT_DEFINITION_SHAPE", "PRODUCT_DEFINITION")

Around = Literal["", "all around", "all over"]


@dataclass(frozen=True)
class NamedFeature:
    """The geometry that a tolerance, datum or dimension names.

    Args:
        id: the shape aspect, or the product's shape where the whole part is meant.
        name: the aspect's name, often that of the PMI that made it.
        shape: the product definition shape that it is of.
        groups: the `#ids` of the faces, by member: two halves of a hole are one group if the file says so.
        solids: solids and shells that are named as wholes.
        curves: edges and other curves that are named.
        aspects: the shape aspects that were gone through.
        bare: those among them that name neither geometry nor members.
        whole: whether the whole part is meant.
        around: `all around` or `all over`, empty if neither is stated.
        pattern: whether the file calls it a pattern of features.
        derived: whether it is the centre (axis or middle plane) of the faces.
    """

    id: int
    name: str
    shape: int
    groups: tuple[tuple[int, ...], ...] = ()
    solids: tuple[int, ...] = ()
    curves: tuple[int, ...] = ()
    aspects: tuple[int, ...] = ()
    bare: tuple[int, ...] = ()
    whole: bool = False
    around: Around = ""
    pattern: bool = False
    derived: bool = False

    @property
    def faces(self) -> tuple[int, ...]:
        """All faces, each once, in the file's order of naming."""
        return tuple(dict.fromkeys(chain.from_iterable(self.groups)))

    @property
    def lies_on(self) -> str:
        """Geometry of the feature in words: faces, the whole part, curves, or nothing that the file names."""
        if self.groups:
            return "faces"
        if self.whole:
            return "the whole part"
        if self.solids:
            return "solids"
        return "curves" if self.curves else "nothing"


@dataclass(frozen=True)
class Features:
    """The shape aspects of a file, with the items linked to each."""

    file: Part21

    @cached_property
    def items(self) -> dict[int, tuple[int, ...]]:
        """Geometry of each shape aspect."""
        found: dict[int, list[int]] = {}
        for instance in self.file.of(*USAGES):
            record = instance.needed(*USAGES)
            found.setdefault(int(record.reference(2)), []).extend(identified(record))
        return {aspect: tuple(dict.fromkeys(ids)) for aspect, ids in found.items()}

    @cached_property
    def relationships(self) -> tuple[tuple[int, int, bool], ...]:
        """Relating aspect, related aspect, and whether the first is derived from the second."""
        found = []
        for instance in self.file.of(*RELATIONSHIPS):
            record = instance.record("SHAPE_ASPECT_RELATIONSHIP") or instance.needed(*RELATIONSHIPS)
            if len(record) < 4:
                record = instance.needed("SHAPE_ASPECT_RELATIONSHIP")
            derives = instance.record("SHAPE_ASPECT_DERIVING_RELATIONSHIP") is not None
            found.append((int(record.reference(2)), int(record.reference(3)), derives))
        return tuple(found)

    @cached_property
    def members(self) -> dict[int, tuple[tuple[int, bool], ...]]:
        """Aspects that each relating aspect relates to, without datums, and whether it is derived from them."""
        found: dict[int, list[tuple[int, bool]]] = {}
        for relating, related, derives in self.relationships:
            if not is_datum(self.file[related]):
                found.setdefault(relating, []).append((related, derives))
        return {aspect: tuple(related) for aspect, related in found.items()}

    def named(self, identifier: int) -> NamedFeature:
        """Feature that a shape aspect names, by a walk that ends where members hold each other.

        Raises:
            StepError: it is no shape aspect, nor a dimension of one, nor the whole part.
        """
        instance = self.file[identifier]
        if instance.record(*WHOLE) is not None:
            return NamedFeature(int(identifier), "", shape=int(identifier), whole=True)
        of_size = instance.record("DIMENSIONAL_SIZE", "ANGULAR_SIZE")
        if of_size is not None and instance.record("SHAPE_ASPECT") is None:
            return self.aspect(of_size.reference(0))
        return self.aspect(identifier)

    def aspect(self, identifier: int) -> NamedFeature:
        """Feature that a shape aspect itself names."""
        instance = self.file[identifier]
        aspect = instance.inherited("SHAPE_ASPECT")
        if self.file[aspect.reference(2)].record("PRODUCT_DEFINITION_SHAPE") is None:
            raise aspect.wrong(2, "the shape of a product")
        seen: dict[int, None] = {}
        groups = tuple(dict.fromkeys(group for group in self.groups(identifier, seen) if group))
        others = [(each, self.keywords(each)) for aspect_id in seen for each in self.items.get(aspect_id, ())]
        return NamedFeature(
            int(identifier),
            aspect.text(0),
            int(aspect.reference(2)),
            groups,
            solids=tuple(dict.fromkeys(each for each, words in others if words & SOLIDS)),
            curves=tuple(dict.fromkeys(each for each, words in others if not words & SOLIDS and not words & FACES)),
            aspects=tuple(seen),
            bare=tuple(each for each in seen if each not in self.items and each not in self.members),
            around=around(instance),
            pattern="pattern" in aspect.text(1).lower(),
            derived=any(derives for each in seen for _, derives in self.members.get(each, ())),
        )

    def groups(self, identifier: int, seen: dict[int, None]) -> list[tuple[int, ...]]:
        """The faces of an aspect by member; `seen` takes every aspect on the way. Depth first, with its own stack."""
        found: list[tuple[int, ...]] = []
        stack = [(identifier, -1)]
        while stack:
            each, group = stack.pop()
            if each in seen:
                continue
            seen[each] = None
            faces = tuple(item for item in self.items.get(each, ()) if self.keywords(item) & FACES)
            if group >= 0:
                found[group] = (*found[group], *faces)
            elif faces:
                found.append(faces)
            members = self.members.get(each, ())
            if group < 0 and members and self.is_one(each):
                group = len(found)
                found.append(())
            stack.extend((member, group) for member, _ in reversed(members))
        return found

    def is_one(self, identifier: int) -> bool:
        """True if an aspect's members are parts of one feature, such as the halves of a hole."""
        instance = self.file[identifier]
        if instance.record("COMPOSITE_GROUP_SHAPE_ASPECT", "ALL_AROUND_SHAPE_ASPECT") is not None:
            return False
        return instance.inherited("SHAPE_ASPECT").text(1) in ONE_FEATURE

    def keywords(self, identifier: int) -> set[str]:
        """The entities that an instance is."""
        return {record.keyword for record in self.file[identifier].records}


def identified(record: Record) -> Iterator[int]:
    """The geometry that a usage names: one item, or a set of them."""
    last = record.argument(4)
    listed = last
    if isinstance(listed, Typed) and len(listed.arguments) == 1:
        listed = listed.arguments[0]
    for each in listed if isinstance(listed, tuple) else (listed,):
        if not isinstance(each, Reference):
            raise record.wrong(4, "a reference, or a set of them")
        yield int(each)


def is_datum(instance: Instance) -> bool:
    """True if an aspect is a datum, a target or a system of them, rather than a feature of the part."""
    return instance.record(*DATUM_ASPECTS) is not None


def around(instance: Instance) -> Around:
    """Meaning of the all-around sign of an aspect."""
    if instance.record("ALL_AROUND_SHAPE_ASPECT") is not None:
        return "all around"
    if instance.record("ALL_OVER_SHAPE_ASPECT") is not None:
        return "all over"
    return ""
