"""Features of a scene's parts with what moves them."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from tol3d.assembly.from_scene.datums import frame_name
from tol3d.assembly.from_scene.effects import Effects
from tol3d.assembly.from_scene.zones import projected
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.measures.inspected import InspectedOrientationSpec, InspectedPositionSpec
from tol3d.assembly.grammar.measures.pose_errors import DirectionErrorSpec, PoseErrorSpec
from tol3d.assembly.grammar.moves.assembly_move import fixed_parts
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model import Feature, Point
from tol3d.assembly.picking.kept_picks import face_names
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene


def poses_of(scene: Scene) -> Mapping[str, Array]:
    """Nominal poses of parts as stated in the scene, in the world (4, 4)."""
    return {name: solid.placed.pose for name, solid in scene.of(SolidSpec).items()}


def features_of(drawing: Drawing, effects: Effects) -> Mapping[str, Feature]:
    """All features that a scene names, then the projected parts of axes that its measures inspect."""
    found, faces = {}, face_names(drawing.scene)
    for name, datums in drawing.parents():
        own = drawing.kind(name)
        found[name] = Feature(
            name,
            part_of(name),
            own.shape,
            own.frame,
            frame_name(part_of(name), datums),
            effects.moved_by.get(name, ()),
            effects.size_by.get(name, ()),
            effects.grown_by.get(name, ()),
            face=faces.get(name, ""),
            formed_by=effects.formed_by.get(name, ()),
        )
    return MappingProxyType({**found, **_projected_of(drawing.scene, found)})


def _projected_of(scene: Scene, features: Mapping[str, Feature]) -> dict[str, Feature]:
    """The projected parts of axes that measures inspect, by name."""
    inspected: list[InspectedPositionSpec | InspectedOrientationSpec] = [
        *scene.of(InspectedPositionSpec).values(),
        *scene.of(InspectedOrientationSpec).values(),
    ]
    found = (projected(features[own.of], own.projected.internal) for own in inspected if own.projected is not None)
    return {own.name: own for own in found}


def twins_of(scene: Scene, features: Mapping[str, Feature], poses: Mapping[str, Array]) -> dict[str, Feature]:
    """The nominal twins of features whose pose errors other parts see, for given poses of parts (4, 4), by name."""
    found = {}
    for spec in scene.measures.values():
        if isinstance(spec, PoseErrorSpec | DirectionErrorSpec) and (name := spec.twin) not in found:
            own, part = features[spec.of], spec.from_ or fixed_parts(scene.moves)[0]
            frame = np.linalg.inv(poses[part]) @ poses[own.part] @ own.frame
            found[name] = Feature(name, part, Point(), frame, is_named=False)
    return found
