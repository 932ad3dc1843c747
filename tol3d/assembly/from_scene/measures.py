"""Measures of a scene: what each reads, and how it is shown."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.from_scene.bonus import sized_by
from tol3d.assembly.from_scene.boundaries import room_of
from tol3d.assembly.from_scene.datums import DatumFrames
from tol3d.assembly.from_scene.projected import projected, projected_name
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features.nominal_frame import unit as unit_vector
from tol3d.assembly.grammar.measure_checks import dimension_of
from tol3d.assembly.grammar.measures import (
    AssemblyMeasureSpec,
    ClearanceSpec,
    DifferenceSpec,
    InspectedPatternSpec,
    InspectedPositionSpec,
    OrientationErrorSpec,
    PoseErrorSpec,
    SlackSpec,
)
from tol3d.assembly.grammar.measures.assembly_measure import FeatureMeasureSpec, OverPlaySpec, TimedSpec
from tol3d.assembly.model import Feature, Measured, Point
from tol3d.assembly.model.bonus import MaterialBonus
from tol3d.assembly.model.measures import MeasureKind
from tol3d.scene import Scene
from tol3d.system.measure import Worse
from tol3d.system.plain import UNITS, PlainMeasure, measures_of

Array = NDArray[np.float64]

WORSE_HIGH: frozenset[MeasureKind] = frozenset(("position", "orientation", "flatness", "pattern", "turn"))


def measured_of(scene: Scene, drawing: Drawing, frames: DatumFrames) -> dict[str, Measured]:
    """What each measure of a scene reads."""
    return {name: _measured(scene, _named(scene, name), drawing, frames) for name in scene.measures}


def _measured(scene: Scene, spec: AssemblyMeasureSpec, drawing: Drawing, frames: DatumFrames) -> Measured:
    if isinstance(spec, DifferenceSpec):
        own, less = (_measured(scene, _named(scene, name), drawing, frames) for name in (spec.of, spec.minus))
        return replace(own, minus=less, rocking=spec.rocking)
    if isinstance(spec, SlackSpec):
        return Measured("slack", (), of_move=list(scene.moves).index(spec.of))
    after = _after(scene, spec)
    if isinstance(spec, ClearanceSpec):
        parts = (spec.from_, spec.to)
        return Measured("clearance", (), after=after, rocking=spec.rocking, parts=parts, chord_error=spec.error)
    if isinstance(spec, PoseErrorSpec):
        along = {"x": 0, "y": 1, "z": 2}
        direction = np.eye(3)[along[spec.component]] if spec.component != "size" else None
        length: MeasureKind = "distance" if direction is None else "gap"
        kind: MeasureKind = "turn" if isinstance(spec, OrientationErrorSpec) else length
        return Measured(kind, (twin_name(spec), spec.of), direction, after=after, rocking=spec.rocking)
    assert isinstance(spec, FeatureMeasureSpec)
    features = tuple(name for _, name, _ in spec.named())
    bonuses = _bonuses(scene, drawing, spec, features)
    if isinstance(spec, InspectedPositionSpec) and spec.projected is not None:
        features = (projected_name(spec.of, spec.projected.internal),)
    direction = None if spec.along is None else unit_vector(spec.along)
    frame = frames.named(part_of(features[0]), spec.named_datums)
    room = room_of(scene, drawing, spec.named()[0][1], spec.named_datums)
    over_gauges = room is None and any(own.mmb is not None for own in spec.named_datums)
    gauge = spec.free if isinstance(spec, InspectedPatternSpec) else "shift"
    over = spec.over_play if isinstance(spec, OverPlaySpec) else None
    found = Measured(spec.reads, features, direction, frame, after, bonuses, gauge, room, rocking=spec.rocking)
    return replace(found, over_play=over, over_gauges=over_gauges)


def _after(scene: Scene, spec: AssemblyMeasureSpec) -> int:
    """Index of the move after which a measure is read; -1 for the end."""
    named = spec.after if isinstance(spec, TimedSpec) else None
    return -1 if named is None else list(scene.moves).index(named)


def twin_name(spec: PoseErrorSpec) -> str:
    """The feature that lies nominally where another one does, on the part that sees it."""
    return f"{spec.of} nominal in {spec.from_}"


def add_twins(scene: Scene, features: dict[str, Feature], poses: Mapping[str, Array]) -> None:
    """Add to parts features that lie where others do, whose errors they see, where parts lie at some poses (4, 4)."""
    for spec in scene.measures.values():
        if isinstance(spec, PoseErrorSpec) and (name := twin_name(spec)) not in features:
            own = features[spec.of]
            frame = np.linalg.inv(poses[spec.from_]) @ poses[own.part] @ own.frame
            features[name] = Feature(name, spec.from_, Point(), frame, is_named=False)


def add_projected(scene: Scene, features: dict[str, Feature]) -> None:
    """Add the projected parts of axes that measures inspect."""
    for spec in scene.of(InspectedPositionSpec).values():
        if spec.projected is not None:
            own = projected(features[spec.of], spec.projected.internal)
            features[own.name] = own


def _bonuses(
    scene: Scene, drawing: Drawing, spec: FeatureMeasureSpec, features: Sequence[str]
) -> tuple[MaterialBonus, ...]:
    """Of each feature; none where no modifier asks for them."""
    modifier = spec.modifier if isinstance(spec, InspectedPositionSpec | InspectedPatternSpec) else None
    if modifier is None:
        return ()
    found = (sized_by(scene, drawing, own, modifier).bonus for own in features)
    return tuple(MaterialBonus(own.low, own.high, own.grows) for own in found)


def _named(scene: Scene, name: str) -> AssemblyMeasureSpec:
    spec = scene.measures[name]
    assert isinstance(spec, AssemblyMeasureSpec)
    return spec


def shown_measures(scene: Scene, read: Mapping[str, Measured]) -> tuple[PlainMeasure, ...]:
    """The measures as studies see them."""
    found = []
    for own in measures_of(scene):
        unit, per_unit = UNITS[dimension_of(scene, own.name)]
        worse: Worse = "high" if read[own.name].kind in WORSE_HIGH else "low"
        found.append(replace(own, worse=worse, unit=unit, per_internal=1.0 / per_unit))
    return tuple(found)


def named_by(scene: Scene) -> dict[str, tuple[str, ...]]:
    """The features that each measure names, or the measures of a difference."""
    found: dict[str, tuple[str, ...]] = {}
    for name in scene.measures:
        spec = _named(scene, name)
        if isinstance(spec, DifferenceSpec):
            found[name] = (spec.of, spec.minus)
        elif isinstance(spec, SlackSpec):
            found[name] = (spec.of,)
        elif isinstance(spec, PoseErrorSpec):
            found[name] = (spec.of, spec.from_)
        elif isinstance(spec, ClearanceSpec):
            found[name] = (spec.from_, spec.to)
        elif isinstance(spec, FeatureMeasureSpec):
            found[name] = tuple(feature for _, feature, _ in spec.named())
    return found
