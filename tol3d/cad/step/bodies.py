"""Products of a STEP file with geometry of their own, and the names and colours of their faces, by the text."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from tol3d.cad.step.part21 import Part21
from tol3d.cad.step.placement import length_unit, representation
from tol3d.cad.step.read_structure import StructureReader, references_in
from tol3d.cad.step.refused import StepError
from tol3d.cad.step.structure import Structure
from tol3d.cad.step.values import Reference

DEEPEST: Final = 64  # styles that refer to each other
STYLED: Final = ("STYLED_ITEM", "OVER_RIDING_STYLED_ITEM")
OTHER_STYLES: Final = ("CURVE_STYLE", "POINT_STYLE", "TEXT_STYLE", "FILL_AREA_STYLE_HATCHING")

NAMED_COLOURS: Final = {
    "red": "#FF0000", "green": "#00FF00", "blue": "#0000FF", "yellow": "#FFFF00", "magenta": "#FF00FF",
    "cyan": "#00FFFF", "black": "#000000", "white": "#FFFFFF",
}  # fmt: skip
"""Pre-defined colours of ISO 10303-202."""


@dataclass(frozen=True)
class Body:
    """A product with geometry of its own.

    Args:
        product: the `#id` of its definition.
        name: its name in the file.
        solids: the `#ids` of the faces of each of its solids, by that of the solid.
        loose: those of faces beside them.
        unit: one of its length in mm.
    """

    product: int
    name: str
    solids: Mapping[int, tuple[int, ...]]
    loose: frozenset[int]
    unit: float

    @cached_property
    def faces(self) -> frozenset[int]:
        """The `#ids` of the faces of its solids."""
        return frozenset(face for faces in self.solids.values() for face in faces)


def bodies_of(file: Part21, structure: Structure) -> tuple[Body, ...]:
    """The products of a file that have solids or faces, in its order.

    Raises:
        StepError: their unit cannot be read, or there is none with a solid.
    """
    reader = StructureReader(file)
    found = [
        Body(
            product.id,
            product.name,
            {solid.id: solid.faces for solid in product.solids},
            frozenset(product.loose_faces),
            _unit(file, reader.represented.get(product.shape or 0, ())),
        )
        for product in structure.products.values()
        if product.faces
    ]
    if not any(body.solids for body in found):
        words = "found loose faces only" if found else "found none"
        raise StepError(
            f"{file.name}: expected a product with a solid, {words}; export it as a boundary representation"
        )
    return tuple(found)


def _unit(file: Part21, representations: tuple[int, ...]) -> float:
    """One unit of length of a product's representation, in mm."""
    contexts = (representation(file, own)[1] for own in representations)
    return next((length_unit(file, context).factor for context in contexts), 1.0)


def names_of(file: Part21, faces: frozenset[int]) -> dict[int, str]:
    """Names of faces in the file; those without a name are left out."""
    named = {number: file[number].inherited("REPRESENTATION_ITEM").text(0) for number in sorted(faces)}
    return {number: name for number, name in named.items() if name}


def colours_of(file: Part21, body: Body) -> dict[int, str]:
    """Colours "#RRGGBB" of the faces of a product that have one: their own, or that of their solid."""
    own = body.faces | body.loose | {*body.solids}
    found: dict[int, str] = {}
    for instance in file.of(*STYLED):
        record = instance.record("STYLED_ITEM") or instance.needed(*STYLED)
        first = 1 if len(record) >= 3 else 0  # of a complex instance its name stands in another record
        item = record.argument(first + 1)
        if isinstance(item, Reference) and item in own and (colour := _colour(file, record.references(first))):
            found[int(item)] = colour
    whole = {solid: colour for solid, colour in found.items() if solid in body.solids}
    usual = next(iter(whole.values())) if len(whole) == 1 and len(body.solids) == 1 else ""
    faces = dict.fromkeys(sorted(body.faces), usual) if usual else {}
    return {**faces, **{item: colour for item, colour in found.items() if item not in whole}}


def layers_of(file: Part21) -> tuple[str, ...]:
    """Names of the layers of a file, each once."""
    return tuple(dict.fromkeys(record.text(0) for record in file.records("PRESENTATION_LAYER_ASSIGNMENT")))


def _colour(file: Part21, styles: tuple[Reference, ...]) -> str:
    """The first colour of surfaces that styles lead to; "" if they state none."""
    stack, seen = [(int(style), 0) for style in reversed(styles)], set(map(int, styles))
    while stack:
        number, depth = stack.pop()
        instance = file[number]
        if (rgb := instance.record("COLOUR_RGB")) is not None:
            red, green, blue = (round(255 * min(max(rgb.number(k), 0.0), 1.0)) for k in (-3, -2, -1))
            return f"#{red:02X}{green:02X}{blue:02X}"
        known = instance.record("DRAUGHTING_PRE_DEFINED_COLOUR", "PRE_DEFINED_COLOUR")
        if known is not None and known.text(0).lower() in NAMED_COLOURS:
            return NAMED_COLOURS[known.text(0).lower()]
        if instance.record(*OTHER_STYLES) is not None or depth > DEEPEST:
            continue
        for record in reversed(instance.records):
            for other in reversed(list(references_in(record.arguments))):
                if other not in seen:
                    seen.add(other)
                    stack.append((other, depth + 1))
    return ""
