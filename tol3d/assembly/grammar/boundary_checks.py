"""What must hold of datums at their maximum material boundary: what orients their gauge, and a size."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.measures import InspectedPositionSpec
from tol3d.assembly.grammar.measures.assembly_measure import FeatureMeasureSpec
from tol3d.assembly.grammar.tolerances import FeatureTolerance, PlusMinusSpec, SizeSpec
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]
Array = NDArray[np.float64]

SQUARE = 1e-6  # sine of the angle of the axis to the normal


def unfit_boundaries(scene: Scene) -> Iterator[Problem]:
    """Datums at their boundary that nothing orients, without a size, or where a measure is read."""
    drawing = Drawing(scene)
    for name, spec in scene.tolerances.items():
        if isinstance(spec, FeatureTolerance):
            for k, datum in enumerate(spec.named_datums):
                if datum.mmb is not None:
                    place: KeyPath = ("tolerances", name, "datums")
                    yield from _unfit(drawing, part_of(spec.of), spec.named_datums, k, place)
                    if datum.mmb == "least":
                        yield place, "expected mmb: random or mmb: centred, for least is of what is inspected"
    for name, measure in scene.measures.items():
        if isinstance(measure, FeatureMeasureSpec):
            yield from _of_measure(drawing, name, measure)


def _of_measure(drawing: Drawing, name: str, spec: FeatureMeasureSpec) -> Iterator[Problem]:
    place: KeyPath = ("measures", name, "datums")
    for k, datum in enumerate(spec.named_datums):
        if datum.mmb is None:
            continue
        if not isinstance(spec, InspectedPositionSpec) or datum.mmb != "least":
            yield place, "expected datums without mmb, or mmb: least of an inspected position"
            continue
        yield from _unfit(drawing, part_of(spec.of), spec.named_datums, k, place)
        known = f"{part_of(spec.of)}.{datum.features[0]}"
        if {known, spec.of} <= set(drawing.names):
            frames = [drawing.kind(own).frame[:3, 2] for own in (known, spec.of)]
            if drawing.kind(spec.of).kind not in ("cylinder", "axis") or not is_square(*frames):
                yield (
                    ("measures", name, "of"),
                    f"expected a hole, pin or axis along {known!r}, in which the gauge shifts",
                )


def is_square(normal: Array, axis: Array) -> bool:
    """Whether an axis stands square to a plane."""
    return float(np.linalg.norm(np.cross(normal, axis))) < SQUARE


def _unfit(drawing: Drawing, part: str, datums: tuple[DatumSpec, ...], k: int, place: KeyPath) -> Iterator[Problem]:
    own = f"{part}.{datums[k].features[0]}"
    known = drawing.features[part]
    if own not in drawing.names or drawing.kind(own).kind != "cylinder":
        return  # said already
    first = known.get(datums[0].features[0])
    axis = drawing.kind(own).frame[:3, 2]
    square = first is not None and first.kind == "plane" and is_square(first.frame[:3, 2], axis)
    if (k, len(datums)) != (1, 2) or not square:
        yield place, f"expected mmb at the second of two datums, a hole or pin square to a plane before it, got {own!r}"
    elif not drawing.of(own, SizeSpec):
        yield place, f"expected a tolerance of the size of {own!r}, which makes the gauge's room; add one of kind size"
    elif drawing.of(own, PlusMinusSpec) or drawing.datums(own)[:1] != datums[:1]:
        words = f"expected a zone of {own!r} to {datums[0].features[0]!r} first, for that orients the gauge"
        yield place, f"{words}; add a position or perpendicularity to it"
