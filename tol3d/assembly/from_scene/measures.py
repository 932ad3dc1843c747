"""Measures of a scene: their readings, and how they are shown."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from tol3d.assembly.from_scene.boundaries import room_of
from tol3d.assembly.from_scene.datums import frame_name
from tol3d.assembly.from_scene.zones import LEAST_SINE, projected_name, sized_by
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.measure_checks import dimension_of
from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec, FeatureMeasureSpec, TimedSpec
from tol3d.assembly.grammar.measures.inspected import (
    InspectedOrientationSpec,
    InspectedPatternSpec,
    InspectedPositionSpec,
    InspectedSetSpec,
    InspectedTogetherSpec,
)
from tol3d.assembly.grammar.measures.pose_errors import DifferenceSpec
from tol3d.assembly.model import Measured
from tol3d.assembly.model.datum_frame import MaterialBonus
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.study.system.plain import UNITS, PlainMeasure, measures_of


def measured_of(drawing: Drawing) -> Mapping[str, Measured]:
    """Model of each measure of a scene."""
    measures = {name: _measured(_named(drawing.scene, name), drawing) for name in drawing.scene.measures}
    return MappingProxyType(measures)


def _measured(spec: AssemblyMeasureSpec, drawing: Drawing) -> Measured:
    scene = drawing.scene
    if isinstance(spec, DifferenceSpec):
        own, less = (_measured(_named(scene, name), drawing) for name in (spec.of, spec.minus))
        return replace(own, minus=less, rocking=spec.rocking)
    found = spec.measured(list(scene.moves))
    if isinstance(spec, TimedSpec):
        found = replace(found, after=_after(scene, spec), rocking=spec.rocking)
    return _inspected(spec, drawing, found) if isinstance(spec, FeatureMeasureSpec) else found


def _inspected(spec: FeatureMeasureSpec, drawing: Drawing, found: Measured) -> Measured:
    """A measure of features with its datum frame, its bonuses, and what gauges may do."""
    features = found.features
    bonuses = _bonuses(drawing, spec, features)
    if isinstance(spec, InspectedPositionSpec | InspectedOrientationSpec) and spec.projected is not None:
        features = (projected_name(spec.of, spec.projected.internal),)
    first = spec.named()[0][1]
    frame = frame_name(part_of(first), spec.named_datums)
    several = spec if isinstance(spec, InspectedTogetherSpec) else None
    room = None if several else room_of(drawing, first, spec.named_datums)
    over_gauges = room is None and any(named_datum.gauge is not None for named_datum in spec.named_datums)
    gauge = spec.free if isinstance(spec, InspectedPatternSpec) else found.gauge
    found = replace(found, features=features, frame=frame, bonuses=bonuses)
    if isinstance(spec, InspectedOrientationSpec) and found.direction is not None:
        found = replace(found, direction=_across(spec, drawing, found.direction))
    zones = tuple(zone.internal for zone in several.zones) if several else ()
    return replace(found, gauge=gauge, zones=zones, room=room, over_gauges=over_gauges)


def _across(spec: InspectedOrientationSpec, drawing: Drawing, along: Array) -> Array:
    """The part of a direction (3,) across an axis, of unit length."""
    z = drawing.kind(spec.of).frame[:3, 2]
    across = along - (along @ z) * z
    size = float(np.linalg.norm(across))
    if size < LEAST_SINE:
        name = next(name for name, own in drawing.scene.measures.items() if own is spec)
        raise drawing.scene.refuse(
            ("measures", name, "direction"), "expected a direction across the axis, got one along it"
        )
    return np.asarray(across / size)


def _after(scene: Scene, spec: TimedSpec) -> int:
    """Index of the move after which a measure is read; -1 for the end."""
    return -1 if spec.after is None else list(scene.moves).index(spec.after)


def _bonuses(drawing: Drawing, spec: FeatureMeasureSpec, features: Sequence[str]) -> tuple[MaterialBonus, ...]:
    """Bonus of each feature; empty without a modifier."""
    widened = InspectedPositionSpec | InspectedPatternSpec | InspectedSetSpec | InspectedTogetherSpec
    modifier = spec.modifier if isinstance(spec, widened) else None
    if modifier is None:
        return ()
    found = (sized_by(drawing, feature, modifier).bonus for feature in features)
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
        reads = read[own.name].reads
        found.append(replace(own, worse=reads.worse, unit=unit, per_internal=1.0 / per_unit, inspects=reads.of_drawing))
    return tuple(found)


def named_by(scene: Scene) -> dict[str, tuple[str, ...]]:
    """The features that each measure names, or the measures of a difference."""
    return {name: (*_named(scene, name).of_what,) for name in scene.measures}
