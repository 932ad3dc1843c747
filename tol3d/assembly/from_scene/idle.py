"""Tolerances of a drawing that act on nothing."""

from collections.abc import Iterator

from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.tolerances.location import FormSpec, LocationSpec


def idle_forms(drawing: Drawing) -> Iterator[str]:
    """A sentence for each form that neither lifts a point nor narrows a location zone."""
    for own in drawing.stated:
        if not isinstance(own, Stated) or not own.is_own or not isinstance(own.spec, FormSpec):
            continue
        if own.spec.law is None and not drawing.of(own.feature, LocationSpec):
            why = f"it has no law, and {own.feature!r} has no location zone that it could narrow"
            mend = "give a law to the form of a face that touches points in a move, or take it out"
            yield f"{own.name}: this {own.spec.kind} acts on nothing, for {why}; {mend}"
