"""Reading the products of a STEP file from its text; see structure.py for the result."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from tol3d.cad.step.feature import FACES
from tol3d.cad.step.instance import Record
from tol3d.cad.step.part21 import Part21
from tol3d.cad.step.placement import (
    SCALE_XTOL,
    Placement,
    axes,
    inverse,
    length_unit,
    located,
    placement_of,
    product,
    representation,
    rigid,
    vector_of,
)
from tol3d.cad.step.refused import StepError, shown
from tol3d.cad.step.structure import UNNAMED, Occurrence, Product, Solid, Structure
from tol3d.cad.step.units import Unit
from tol3d.cad.step.values import Missing, Reference, Typed, Value

DEFINITIONS: Final = ("PRODUCT_DEFINITION", "PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS")
USES: Final = ("NEXT_ASSEMBLY_USAGE_OCCURRENCE",)
SOLIDS: Final = ("MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "FACETED_BREP")
SAYS_NOTHING: Final = re.compile(
    r"|none|null|unidentified_product|unnamed|untitled|\(?unsaved\)?|no ?name|open cascade step translator.*",
    re.IGNORECASE,
)
"""Names that programs write where a person gave none."""
USED: Final = re.compile(
    SAYS_NOTHING.pattern + r"|next assembly (?:usage|relationship).*|nauo ?[0-9]*|=>.*|[0-9]+", re.I
)
"""Names of uses that are none of a person."""
TRANSFORMS: Final = ("CARTESIAN_TRANSFORMATION_OPERATOR_3D",)


@dataclass(frozen=True)
class StructureReader:
    """The products of a file while they are read."""

    file: Part21

    @cached_property
    def definitions(self) -> tuple[int, ...]:
        """The product definitions, without those of documents."""
        return tuple(each.id for each in self.file.of(*DEFINITIONS))

    @cached_property
    def shapes(self) -> dict[int, int]:
        """Shape of each product definition, or use of one."""
        found: dict[int, int] = {}
        for record in self.file.records("PRODUCT_DEFINITION_SHAPE"):
            found.setdefault(int(record.reference(2)), record.instance.id)
        return found

    @cached_property
    def same_frame(self) -> dict[int, tuple[int, ...]]:
        """Representations that are related to each one without a transformation."""
        found: dict[int, list[int]] = {}
        for instance in self.file.of("SHAPE_REPRESENTATION_RELATIONSHIP"):
            if instance.record("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") is None:
                record = instance.record("REPRESENTATION_RELATIONSHIP") or instance.needed(
                    "SHAPE_REPRESENTATION_RELATIONSHIP"
                )
                first, second = int(record.reference(2)), int(record.reference(3))
                found.setdefault(first, []).append(second)
                found.setdefault(second, []).append(first)
        return {each: tuple(related) for each, related in found.items()}

    @cached_property
    def represented(self) -> dict[int, tuple[int, ...]]:
        """Representations of each product definition shape, in its own frame."""
        found: dict[int, list[int]] = {}
        for record in self.file.records("SHAPE_DEFINITION_REPRESENTATION"):
            found.setdefault(int(record.reference(0)), []).append(int(record.reference(1)))
        return {shape: tuple(reached(direct, self.same_frame)) for shape, direct in found.items()}

    def read(self) -> Structure:
        """The structure.

        Raises:
            StepError: its content cannot be read, or a part stands in another file.
        """
        products = {definition: self.product(definition) for definition in self.definitions}
        occurrences = tuple(self.occurrence(record, products) for record in self.file.records(USES[0]))
        used = (*occurrences, *self.bare_maps(products))
        assemblies = {occurrence.parent for occurrence in used}
        elsewhere = {
            product.id: name
            for product in products.values()
            if not product.faces and product.id not in assemblies and (name := self.file_of(product.id))
        }
        structure = Structure(self.file.name, products, used, elsewhere)
        self.refuse_other_files(structure)
        return structure

    def product(self, definition: int) -> Product:
        """One product with its solids and faces."""
        shape = self.shapes.get(definition)
        representations = self.represented_by(definition)
        items = list(dict.fromkeys(item for each in representations for item in representation(self.file, each)[0]))
        solids = tuple(self.solid(each) for each in self.mapped(items) if self.file[each].record(*SOLIDS) is not None)
        solid_faces = {face for solid in solids for face in solid.faces}
        others = [item for item in items if self.file[item].record(*SOLIDS) is None and self.is_surface(item)]
        loose = dict.fromkeys(face for other in others for face in self.faces_under(other) if face not in solid_faces)
        return Product(definition, self.product_name(definition), shape, solids, tuple(loose))

    def mapped(self, items: Iterable[int]) -> Iterator[int]:
        """Items without those that show another representation."""
        return (item for item in items if self.file[item].record("MAPPED_ITEM") is None)

    def is_surface(self, identifier: int) -> bool:
        """True if an item of a representation is made of faces."""
        words = {record.keyword for record in self.file[identifier].records}
        return bool(
            words & {"SHELL_BASED_SURFACE_MODEL", "OPEN_SHELL", "CLOSED_SHELL", "FACE_BASED_SURFACE_MODEL", *FACES}
        )

    def solid(self, identifier: int) -> Solid:
        """One solid with its faces."""
        record = self.file[identifier].needed(*SOLIDS)
        named = self.file[identifier].record("REPRESENTATION_ITEM") or record
        return Solid(identifier, named.text(0), record.keyword, tuple(self.faces_under(identifier)))

    def faces_under(self, root: int) -> Iterator[int]:
        """The faces that an item is made of, in the order of its shells; faces are not entered."""
        seen = {root}
        stack = [root]
        while stack:
            identifier = stack.pop()
            instance = self.file[identifier]
            if any(record.keyword in FACES for record in instance.records):
                yield identifier
                continue
            named = [each for record in instance.records for each in references_in(record.arguments)]
            fresh = [each for each in dict.fromkeys(named) if each not in seen]
            seen.update(fresh)
            stack.extend(reversed(fresh))

    def product_name(self, definition: int) -> str:
        """The name of a product, else its number in the parts list; words that programs write for none are none."""
        formation = self.file[definition].inherited("PRODUCT_DEFINITION").reference(2)
        made = self.file[formation].inherited("PRODUCT_DEFINITION_FORMATION").reference(2)
        record = self.file[made].needed("PRODUCT")
        said = (record.text(own).strip() for own in (1, 0))
        return next((words for words in said if not SAYS_NOTHING.fullmatch(words)), UNNAMED)

    def occurrence(self, record: Record, products: dict[int, Product]) -> Occurrence:
        """One use of a product, with its placement."""
        parent, used = int(record.reference(3)), int(record.reference(4))
        for each in (parent, used):
            if each not in products:
                raise StepError(f"{record.instance.place}: expected a product definition, got #{each}")
        name = self.use_names.get(record.instance.id) or products[used].name
        placement = self.placement(record, parent, used)
        return Occurrence(record.instance.id, name, parent, used, placement)

    @cached_property
    def use_names(self) -> dict[int, str]:
        """Names of uses that say which part it is: one that several products share says nothing."""
        records = list(self.file.records(USES[0]))
        names = {record.instance.id: record.text(1).strip() for record in records}
        shared: dict[str, set[int]] = {}
        for record in records:
            shared.setdefault(names[record.instance.id], set()).add(int(record.reference(4)))
        return {use: name for use, name in names.items() if len(shared[name]) == 1 and not USED.fullmatch(name)}

    def placement(self, use: Record, parent: int, used: int) -> Placement:
        """`parent_from_product` of a use.

        Raises:
            StepError: the file does not say it.
        """
        shape = self.shapes.get(use.instance.id)
        if shape in self.relations:
            return self.transformation(self.relations[shape], used)
        mapped = self.maps(parent, used)
        rank = [each for each in self.uses if self.uses[each] == (parent, used)].index(use.instance.id)
        if rank < len(mapped):  # uses and mapped items of one product are written in one order
            return mapped[rank]
        raise StepError(
            f"{use.instance.place}: the file does not say where {shown(use.text(1) or use.text(0))!r} stands in its "
            "assembly (no CONTEXT_DEPENDENT_SHAPE_REPRESENTATION)"
        )

    @cached_property
    def relations(self) -> dict[int | None, int]:
        """Relation of representations that places the shape of each use."""
        found = self.file.records("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION")
        return {int(each.reference(1)): int(each.reference(0)) for each in found}

    @cached_property
    def uses(self) -> dict[int, tuple[int, int]]:
        """Assembly and product of each use."""
        found = self.file.records(USES[0])
        return {each.instance.id: (int(each.reference(3)), int(each.reference(4))) for each in found}

    def bare_maps(self, products: dict[int, Product]) -> Iterator[Occurrence]:
        """Parts that stand in an assembly by a MAPPED_ITEM alone, beyond its uses in the parts list."""
        used = list(self.uses.values())
        related = {self.uses[use] for use in self.uses if self.shapes.get(use) in self.relations}
        for parent in self.definitions:
            seen: dict[int, int] = {}
            for item, own in self.mapped_items(parent):
                if own == parent or (parent, own) in related:  # these are placed by relations, and shown by maps too
                    continue
                seen[own] = seen.get(own, 0) + 1
                if seen[own] > used.count((parent, own)):
                    name = item.text(0).strip()
                    name = products[own].name if SAYS_NOTHING.fullmatch(name) else name
                    yield Occurrence(item.instance.id, name, parent, own, self.map_placement(item, parent))

    @cached_property
    def owners(self) -> dict[int, int]:
        """Definition of each representation of a product, the first that has it."""
        found: dict[int, int] = {}
        for definition in self.definitions:
            for each in self.represented_by(definition):
                found.setdefault(each, definition)
        return found

    def mapped_items(self, parent: int) -> Iterator[tuple[Record, int]]:
        """The MAPPED_ITEMs in an assembly's representations that show a product, and which."""
        for outer in self.represented_by(parent):
            for item in representation(self.file, outer)[0]:
                record = self.file[item].record("MAPPED_ITEM")
                if record is None:
                    continue
                source = self.file[record.reference(1)].record("REPRESENTATION_MAP")
                if source is not None and int(source.reference(1)) in self.owners:
                    yield record, self.owners[int(source.reference(1))]

    def maps(self, parent: int, used: int) -> list[Placement]:
        """The placements of a product by the MAPPED_ITEMs in an assembly's representations, as in older files."""
        return [self.map_placement(item, parent) for item, own in self.mapped_items(parent) if own == used]

    def map_placement(self, item: Record, parent: int) -> Placement:
        """The placement of a MAPPED_ITEM: its target, less the origin of the shown item.

        Raises:
            StepError: the target is neither axes nor a transformation that is rigid.
        """
        source = self.file[item.reference(1)].needed("REPRESENTATION_MAP")
        outer = next(
            each for each in self.represented_by(parent) if item.instance.id in representation(self.file, each)[0]
        )
        origin = placement_of(self.file, source.reference(0), self.unit(source.reference(1)))
        target = self.file[item.reference(2)]
        if (operator := target.record(*TRANSFORMS)) is not None:
            return product(self.operated(operator, self.unit(outer)), inverse(origin))
        if target.record("AXIS2_PLACEMENT_3D") is None:
            raise StepError(
                f"{item.instance.place}: expected a MAPPED_ITEM that is placed by axes (AXIS2_PLACEMENT_3D), got "
                f"{target.records[0].keyword}; export the assembly with its parts as components"
            )
        return product(placement_of(self.file, item.reference(2), self.unit(outer)), inverse(origin))

    def represented_by(self, definition: int) -> tuple[int, ...]:
        """The representations of a product, in its own frame."""
        shape = self.shapes.get(definition)
        return self.represented.get(shape, ()) if shape is not None else ()

    def transformation(self, relation: int, used: int) -> Placement:
        """The placement by a relation of two representations, from the one of the used product."""
        instance = self.file[relation]
        related = instance.needed("REPRESENTATION_RELATIONSHIP")
        first, second = int(related.reference(2)), int(related.reference(3))
        operator = self.file[instance.needed("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION").reference(0)]
        units = self.unit(first), self.unit(second)
        own = self.represented_by(used)
        swapped = first not in own and second in own  # some exporters relate the assembly to its part
        items = operator.record("ITEM_DEFINED_TRANSFORMATION")
        if items is None:
            found = self.operated(operator.needed(*TRANSFORMS), units[1])
        else:
            from_first = placement_of(self.file, items.reference(2), units[0])
            found = product(placement_of(self.file, items.reference(3), units[1]), inverse(from_first))
        return inverse(found) if swapped else found

    def unit(self, identifier: int) -> Unit:
        """The unit of lengths of a representation."""
        return length_unit(self.file, representation(self.file, identifier)[1])

    def operated(self, record: Record, unit: Unit) -> Placement:
        """The placement of a CARTESIAN_TRANSFORMATION_OPERATOR_3D, which must not scale nor mirror."""
        arguments = record.arguments[-6:]  # axis1, axis2, origin, scale, axis3 after the names
        if len(arguments) < 5:
            raise record.wrong(0, "axes, an origin and a scale")
        first, second, origin, scale, third = arguments[-5:]
        if not isinstance(scale, Missing) and abs(record.number(-2) - 1) > SCALE_XTOL:
            raise StepError(f"{record.instance.place}: expected a transformation that does not scale")
        if not isinstance(origin, Reference):
            raise record.wrong(len(record) - 3, "a reference to a point")
        z = int(third) if isinstance(third, Reference) else None
        x = int(first) if isinstance(first, Reference) else None
        found = axes(self.file, z, x, record.instance.place)
        if isinstance(second, Reference):
            y = vector_of(self.file, second, "DIRECTION")
            if sum(a * b for a, b in zip(y, found[1], strict=True)) < 0:
                raise StepError(f"{record.instance.place}: expected a transformation that does not mirror")
        return rigid(*found, located(self.file, origin, unit))

    @cached_property
    def documents(self) -> dict[int, list[int]]:
        """Documents that each definition refers to, by its own `#id` or those of its formation and product."""
        found: dict[int, list[int]] = {}
        for record in self.file.records("APPLIED_DOCUMENT_REFERENCE"):
            for item in references_in(record.arguments[2:]):
                found.setdefault(item, []).append(int(record.reference(0)))
        return found

    @cached_property
    def file_names(self) -> dict[int, str]:
        """Name of the file that each document is; that of its identification before its own."""
        found = {record.instance.id: record.instance.inherited("DOCUMENT").text(0).strip()
                 for record in self.file.records("DOCUMENT_FILE")}  # fmt: skip
        for record in self.file.records("APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT"):
            for item in references_in(record.arguments[3:]):
                if item in found and record.text(0).strip():
                    found[item] = record.text(0).strip()
        return found

    @cached_property
    def digital(self) -> dict[int, list[int]]:
        """Files of each document: those of the definition that it is equivalent to."""
        files: dict[int, list[int]] = {}
        for record in self.file.records("PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS"):
            own = record.instance.inherited("PRODUCT_DEFINITION")
            files.setdefault(int(own.reference(2)), []).extend(references_in(record.arguments[-1:]))
        found: dict[int, list[int]] = {}
        for record in self.file.records("DOCUMENT_PRODUCT_EQUIVALENCE"):
            found.setdefault(int(record.reference(2)), []).extend(files.get(int(record.reference(3)), ()))
        return found

    def documents_of(self, definition: int) -> tuple[int, ...]:
        """Files that a definition names: its own, and those of documents that it refers to."""
        own = self.file[definition].record("PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS")
        direct = [] if own is None else list(references_in(own.arguments[-1:]))
        formation = int(self.file[definition].inherited("PRODUCT_DEFINITION").reference(2))
        for each in (definition, formation):
            for document in self.documents.get(each, ()):
                direct += [document, *self.digital.get(document, ())]
        return tuple(each for each in dict.fromkeys(direct) if each in self.file_names)

    def file_of(self, definition: int) -> str:
        """Name of the one file in which the shape of a definition stands; "" where it names none, or several."""
        if self.shapes.get(definition) is None:
            return ""
        names = {self.file_names[each] for each in self.documents_of(definition)}
        return names.pop() if len(names) == 1 else ""

    def refuse_other_files(self, structure: Structure) -> None:
        """Refuse parts whose shape stands in another file that they do not name."""
        files = [record.instance.inherited("DOCUMENT").text(0) for record in self.file.records("DOCUMENT_FILE")]
        named = [record.text(0) for record in self.file.records("APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT")]
        empty = [
            each
            for each in structure.products.values()
            if each.id not in structure.inside
            and not each.faces
            and each.shape is not None
            and each.id not in structure.elsewhere
        ]
        if empty and (files or named):
            told = ", ".join(repr(shown(each)) for each in dict.fromkeys(each for each in (*named, *files) if each))
            raise StepError(
                f"{self.file.name}: the shape of {shown(empty[0].name)!r} stands in another file ({shown(told)}): "
                "expected one file that holds everything; export the assembly into one"
            )


def reached(roots: Iterable[int], related: dict[int, tuple[int, ...]]) -> list[int]:
    """Everything that is related to the roots, these first."""
    found = dict.fromkeys(roots)
    stack = list(found)
    while stack:
        for each in related.get(stack.pop(), ()):
            if each not in found:
                found[each] = None
                stack.append(each)
    return list(found)


def references_in(arguments: tuple[Value, ...]) -> Iterator[int]:
    """All references in the arguments of a record, at any depth that the parser allows."""
    for argument in arguments:
        if isinstance(argument, Reference):
            yield int(argument)
        elif isinstance(argument, Typed):
            yield from references_in(argument.arguments)
        elif isinstance(argument, tuple):
            yield from references_in(argument)
