"""Tolerances of a drawing that act on nothing."""

from collections.abc import Iterator

from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.tolerances.location import (
    AxialRunOutSpec,
    CircularRunOutSpec,
    FormSpec,
    LocationSpec,
    OrientationSpec,
    ProfileSpec,
    RoundnessSpec,
    TotalRunOutSpec,
)


def idle_forms(drawing: Drawing) -> Iterator[str]:
    """A sentence for each form that neither lifts a point nor narrows a location zone."""
    for own in drawing.stated:
        if not isinstance(own, Stated) or not own.is_own or not isinstance(own.spec, FormSpec):
            continue
        located, turns = drawing.of(own.feature, LocationSpec), CircularRunOutSpec.applies_to
        alone = isinstance(own.spec, RoundnessSpec) and not any(
            isinstance(each.spec, CircularRunOutSpec | TotalRunOutSpec | ProfileSpec) for each in located
        )
        surface = "run-out or profile" if drawing.kind(own.feature).kind in turns else "profile"
        zones = surface if alone else "location zone"
        turned = any(isinstance(each.spec, AxialRunOutSpec) for each in drawing.of(own.feature, OrientationSpec))
        if own.spec.law is None and not turned and (alone or not located):
            why = f"it has no law, and {own.feature!r} has no {zones} that it could narrow"
            mend = "give a law to the form of a face that touches points, or of a pin or hole with play, or take it out"
            yield f"{own.name}: this {own.spec.kind} acts on nothing, for {why}; {mend}"
