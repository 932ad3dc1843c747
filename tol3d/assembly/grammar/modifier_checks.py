"""What must hold of material modifiers: they need a feature with a size and a tolerance of it."""

from collections.abc import Iterator

from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.measures import InspectedPatternSpec, InspectedPositionSpec
from tol3d.assembly.grammar.tolerances import LocationSpec, OrientationSpec, SizeSpec
from tol3d.assembly.grammar.tolerances.modified import Modified
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]

SIZED = ("cylinder", "slot")
"""Kinds of feature whose size widens their zones."""


def unfit_modifiers(scene: Scene) -> Iterator[Problem]:
    """Modifiers of features without a size or a tolerance of it, and two that differ on one feature."""
    drawing = Drawing(scene)
    for own in drawing.stated:
        if isinstance(own, Stated) and own.is_own and isinstance(own.spec, Modified):
            yield from _of_tolerance(drawing, own, own.spec)
    sized = {name for name in drawing.names if drawing.kind(name).kind in SIZED}  # others are said already
    for name, spec in scene.measures.items():
        if isinstance(spec, InspectedPositionSpec | InspectedPatternSpec) and spec.modifier is not None:
            for own in (feature for _, feature, _ in spec.named() if feature in sized):
                yield from _unsized(drawing, own, ("measures", name, "modifier"), spec.modifier)


def _of_tolerance(drawing: Drawing, own: Stated, spec: Modified) -> Iterator[Problem]:
    place: KeyPath = ("tolerances", own.entry, "modifier")
    if spec.modifier is None or own.feature not in drawing.names:
        return
    yield from _unsized(drawing, own.feature, place, spec.modifier)
    if isinstance(own.spec, OrientationSpec):
        for located in drawing.of(own.feature, LocationSpec):
            other = located.spec.modifier if isinstance(located.spec, Modified) else None
            if other is not None and other != spec.modifier:
                yield place, f"expected that of {located.entry!r}, {other}, or none, got {spec.modifier}"


def _unsized(drawing: Drawing, feature: str, place: KeyPath, modifier: str) -> Iterator[Problem]:
    if drawing.kind(feature).kind not in SIZED:
        words = drawing.kind(feature).words
        yield place, f"expected none, for {feature!r} is {words}, whose zone no size widens, got {modifier}"
    elif not drawing.of(feature, SizeSpec):
        words = f"expected a tolerance of the size of {feature!r}, from which the bonus counts, got none"
        yield place, f"{words}; add one of kind size"
