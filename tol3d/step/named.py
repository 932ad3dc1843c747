"""Names on the faces of a foreign part's drawing: datums, tolerances, dimensions. Selectors may use them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from tol3d.step.datum import Compartment
from tol3d.step.feature import NamedFeature
from tol3d.step.frame import frame
from tol3d.step.outline import StepText
from tol3d.step.tolerance import Tolerance


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
    for own in text.tolerances:
        value = None if own.magnitude is None or own.magnitude.unit.dimension != "length" else own.magnitude.value
        words = frame(own)
        yield Named(own.id, "tolerance", own.name, own.kind, value, _letters(own), words, tuple(own.feature.faces))
    for each in text.dimensions:
        yield Named(each.id, "dimension", each.name, "", None, "", str(each), _faces(each.features))


def _faces(features: Sequence[NamedFeature]) -> tuple[int, ...]:
    return tuple(dict.fromkeys(face for feature in features for face in feature.faces))


def _letters(tolerance: Tolerance) -> str:
    """The letters of its datums, without their modifiers."""
    return " | ".join(_of(own) for own in tolerance.datums)


def _of(compartment: Compartment) -> str:
    return "-".join(own.letter for own in compartment.references)
