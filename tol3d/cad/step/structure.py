"""The products of a STEP file, their bodies, and their poses in the assemblies.

From the text and not from XCAF, which calls a part with loose faces an assembly. Source: CAx-IF recommended practices
for assembly structure and for external references; ISO 10303-44.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

from tol3d.cad.step.placement import IDENTITY, Placement, product
from tol3d.cad.step.refused import StepError, shown

UNNAMED: Final = "part"
"""Name of a product whose file says none."""
MOST_LEAVES: Final = 10_000  # parts in all; sub-assemblies that are used often multiply


@dataclass(frozen=True)
class Solid:
    """A solid of a product.

    Args:
        id: its instance.
        name: its name in the file.
        kind: its entity, such as `MANIFOLD_SOLID_BREP`.
        faces: the `#ids` of its faces.
    """

    id: int
    name: str
    kind: str
    faces: tuple[int, ...]


@dataclass(frozen=True)
class Product:
    """A part or an assembly.

    Args:
        id: its product definition.
        name: its name, or its number in the parts list; UNNAMED if the file says neither.
        shape: its product definition shape, by which tolerances name it; None if it has none.
        solids: its own solids, without those of the products in it.
        loose_faces: faces of its own that no solid of it has (supplemental geometry).
    """

    id: int
    name: str
    shape: int | None
    solids: tuple[Solid, ...]
    loose_faces: tuple[int, ...]

    @property
    def faces(self) -> tuple[int, ...]:
        """The faces of its solids, then the loose ones."""
        return (*(face for solid in self.solids for face in solid.faces), *self.loose_faces)


@dataclass(frozen=True)
class Occurrence:
    """One use of a product in an assembly.

    Args:
        id: its instance.
        name: its name; that of the product if it has none.
        parent: the assembly.
        product: the product that is used.
        placement: `parent_from_product` [mm].
    """

    id: int
    name: str
    parent: int
    product: int
    placement: Placement


@dataclass(frozen=True)
class Leaf:
    """One part as it stands in the file.

    Args:
        path: the names of the occurrences from the top assembly down, each unique among its siblings; that of the
            product where it stands in no assembly.
        occurrences: their `#ids`.
        product: the part.
        placement: `file_from_product` [mm].
    """

    path: tuple[str, ...]
    occurrences: tuple[int, ...]
    product: int
    placement: Placement


@dataclass(frozen=True)
class Structure:
    """All products and their uses.

    Args:
        name: the file's name, for errors.
        products: by `#id`, in the file's order.
        occurrences: in the file's order.
        elsewhere: names of the files in which the shapes of products stand, as this file states them.
    """

    name: str
    products: dict[int, Product]
    occurrences: tuple[Occurrence, ...]
    elsewhere: dict[int, str] = field(default_factory=dict)

    @cached_property
    def inside(self) -> dict[int, tuple[tuple[str, Occurrence], ...]]:
        """Contents of each assembly, with names that are unique in it."""
        found: dict[int, list[Occurrence]] = {}
        for occurrence in self.occurrences:
            found.setdefault(occurrence.parent, []).append(occurrence)
        return {parent: tuple(zip(unique(used), used, strict=True)) for parent, used in found.items()}

    @cached_property
    def tops(self) -> tuple[int, ...]:
        """The products that are used in none."""
        used = {occurrence.product for occurrence in self.occurrences}
        return tuple(each for each in self.products if each not in used)

    @cached_property
    def leaves(self) -> tuple[Leaf, ...]:
        """Every part with a shape as it stands in the file: a product used four times is four of them.

        Raises:
            StepError: an assembly holds itself, or there are too many.
        """
        return tuple(leaf for leaf in self.every_leaf if leaf.product not in self.elsewhere)

    @property
    def leaves_elsewhere(self) -> tuple[Leaf, ...]:
        """Every part whose shape stands in another file; raises as `leaves`."""
        return tuple(leaf for leaf in self.every_leaf if leaf.product in self.elsewhere)

    @cached_property
    def every_leaf(self) -> tuple[Leaf, ...]:
        """The parts with a shape here or elsewhere; raises as `leaves`."""
        if self.products and not self.tops:
            raise StepError(f"{self.name}: every product is used in another: expected a top assembly")
        found: list[Leaf] = []
        for leaf in self.walked():
            found.append(leaf)
            if len(found) > MOST_LEAVES:
                raise StepError(f"{self.name}: expected at most {MOST_LEAVES} parts in the assembly")
        return tuple(found)

    def walked(self) -> Iterator[Leaf]:
        """The leaves, depth first with a stack of its own, in the file's order."""
        names = unique([self.products[top] for top in self.tops])
        stack = [
            (Leaf((), (), top, IDENTITY), frozenset((top,)), name)
            for top, name in zip(reversed(self.tops), reversed(names), strict=True)
        ]
        while stack:
            leaf, holders, name = stack.pop()
            own = self.products[leaf.product]
            used = self.inside.get(leaf.product, ())
            if own.faces or own.id in self.elsewhere:
                yield Leaf(leaf.path or (name,), leaf.occurrences, leaf.product, leaf.placement)
            for word, each in reversed(used):
                if each.product in holders:
                    held = self.products[each.product].name
                    raise StepError(f"{self.name}: #{each.id}: the assembly {shown(held)!r} holds itself")
                placed = product(leaf.placement, each.placement)
                inner = Leaf((*leaf.path, word), (*leaf.occurrences, each.id), each.product, placed)
                stack.append((inner, holders | {each.product}, word))

    @cached_property
    def product_of_shape(self) -> dict[int, int]:
        """Product of each product definition shape."""
        return {each.shape: each.id for each in self.products.values() if each.shape is not None}

    @cached_property
    def product_of_face(self) -> dict[int, int]:
        """First product that has each face."""
        found: dict[int, int] = {}
        for each in self.products.values():
            for face in each.faces:
                found.setdefault(face, each.id)
        return found


def unique(named: list[Occurrence] | list[Product]) -> list[str]:
    """Names that differ: the second `bolt` is `bolt_2`."""
    taken: set[str] = set()
    found = []
    for each in named:
        name, count = each.name, 1
        while name in taken:
            count += 1
            name = f"{each.name}_{count}"
        taken.add(name)
        found.append(name)
    return found
