"""Sizes and zones that are most likely a slip: of more than half of the feature that they are of."""

from collections.abc import Iterator
from typing import Final

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.tolerances import (
    FeatureTolerance,
    LocationSpec,
    OrientationSpec,
    PlusMinusSpec,
    SizeSpec,
)
from tol3d.assembly.grammar.tolerances.form import FormSpec
from tol3d.assembly.grammar.zone import ProcessLawSpec
from tol3d.assembly.model.shape import nominal_size
from tol3d.files import Files
from tol3d.scene import Scene
from tol3d.scene.implausible import Implausible, farthest
from tol3d.scene.place import KeyPath

HALF: Final = Implausible(0.5)
SIZE: Final = Implausible(0.5, "write how much larger than nominal the feature is, not its size, and look at the unit")


def implausible_sizes(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Deviations of sizes, zones and displacements beyond half of a diameter or width; other features have no size."""
    drawing = Drawing(scene)
    for name, spec in scene.of(FeatureTolerance).items():
        feature = drawing.kind(spec.of)
        if (nominal := nominal_size(feature.shape)) is None:
            continue
        of = f"the {'width' if feature.kind == 'slot' else 'diameter'} of {spec.of!r}"
        for field, deviation in _deviations(spec, scene.files):
            rule = SIZE if isinstance(spec, SizeSpec) else HALF
            if sentence := rule.sentence(of, nominal, deviation):
                yield ("tolerances", name, *field), sentence


def _deviations(spec: FeatureTolerance, files: Files) -> Iterator[tuple[KeyPath, float]]:
    """Each length that a tolerance states of its feature [mm], with its field."""
    if isinstance(spec, SizeSpec | PlusMinusSpec):
        yield ("distribution",), farthest(spec.distribution.resolve(files))
    if isinstance(spec, SizeSpec) and spec.limits is not None:
        yield ("limits",), max((limit.internal for limit in spec.limits), key=abs)
    if isinstance(spec, LocationSpec | OrientationSpec | FormSpec):
        yield ("zone",), spec.zone.size
        if isinstance(spec.law, ProcessLawSpec):
            yield ("law", "distribution"), farthest(spec.law.distribution.resolve(files))
