"""The assembly that a scene means, its contributors and its measures."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.from_scene.boundaries import shift_frames
from tol3d.assembly.from_scene.contributors import effects_of
from tol3d.assembly.from_scene.datums import DatumFrames, in_order
from tol3d.assembly.from_scene.features import TouchedPoints, features_of, poses_of
from tol3d.assembly.from_scene.measures import add_projected, measured_of, named_by, shown_measures
from tol3d.assembly.from_scene.moves import moves_of
from tol3d.assembly.from_scene.warming import warmed
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model import Assembly, Part
from tol3d.assembly.picking.shapes import shapes_of
from tol3d.scene import Scene
from tol3d.system.plain import PlainContributor, PlainMeasure

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Meant:
    """What a scene means.

    Args:
        assembly: at nominal poses as the scene says them.
        contributors: in the scene's order, a contributor of a part that is like another after the other's.
        measures: in the scene's order.
        named: what each measure names: features, or two measures.
    """

    assembly: Assembly
    contributors: tuple[PlainContributor, ...]
    measures: tuple[PlainMeasure, ...]
    named: Mapping[str, tuple[str, ...]]


def assembly_of(scene: Scene, settled: Mapping[str, Array] | None = None) -> Meant:
    """What a scene means.

    Args:
        scene: the scene.
        settled: nominal poses of its parts in the world (4, 4); as it says itself, if not given.

    Raises:
        SceneError: tolerances, zones or directions that do not fit what they are of.
    """
    drawing = Drawing(scene)
    effects = effects_of(scene, drawing)
    frames = DatumFrames(drawing.features)
    warmed(effects, scene, drawing, frames)
    features = features_of(drawing, effects, frames)
    add_projected(scene, features)
    measured = measured_of(scene, frames)
    poses = poses_of(scene) if settled is None else settled
    shift_frames(scene, drawing, effects, frames)
    moves = moves_of(scene, effects, TouchedPoints(features, poses))
    parents = {name: feature.parent for name, feature in features.items()}
    feature_order, frame_order, _ = in_order(parents, frames.made)  # rings are refused where the scene is checked
    solids = shapes_of(scene)
    parts = tuple(
        Part(
            name,
            poses[name],
            tuple(features[own] for own in feature_order if features[own].part == name),
            tuple(frames.made[own] for own in frame_order if frames.made[own].part == name),
            solids.get(name),
        )
        for name in scene.of(SolidSpec)
    )
    assembly = Assembly(parts, moves, measured, effects.width)
    return Meant(assembly, tuple(effects.contributors), shown_measures(scene, measured), named_by(scene))
