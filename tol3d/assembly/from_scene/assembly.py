"""The assembly that a scene means, its contributors and its measures."""

from collections.abc import Mapping
from dataclasses import dataclass

from tol3d.assembly.from_scene.boundaries import shift_frames
from tol3d.assembly.from_scene.contributors import effects_of
from tol3d.assembly.from_scene.datums import DatumFrames, in_order
from tol3d.assembly.from_scene.features import TouchedPoints, features_of
from tol3d.assembly.from_scene.held import mark_held
from tol3d.assembly.from_scene.measures import add_projected, add_twins, measured_of, named_by, shown_measures
from tol3d.assembly.from_scene.moves import moves_of
from tol3d.assembly.from_scene.setting import Understood
from tol3d.assembly.from_scene.warming import warmed
from tol3d.assembly.grammar.checks import read_at
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model import Assembly, DatumFrame, Feature, Part
from tol3d.assembly.picking.kept_picks import shapes_of
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.system.plain import PlainContributor, PlainMeasure


@dataclass(frozen=True, eq=False)
class Meant:
    """Model of a scene.

    Args:
        assembly: at nominal poses as stated in the scene.
        contributors: in the scene's order, that of a part that copies another after the other's.
        measures: in the scene's order.
        named: what each measure names: features, or two measures.
        second_order: shift times turn by which pushes displace parts nominally [mm].
    """

    assembly: Assembly
    contributors: tuple[PlainContributor, ...]
    measures: tuple[PlainMeasure, ...]
    named: Mapping[str, tuple[str, ...]]
    second_order: float = 0.0


def meant(understood: Understood, poses: Mapping[str, Array], pose: str = "") -> Meant:
    """The assembly with given nominal poses of its parts in the world (4, 4).

    Args:
        understood: its drawings and measures.
        poses: by part.
        pose: of moves that have poses, with the measures read in it; all measures if no move has poses.
    """
    features, frames = dict(understood.features), understood.frames
    add_twins(understood.scene, features, poses)
    moves = moves_of(understood, TouchedPoints(features, poses), pose)
    parents = {name: feature.parent for name, feature in features.items()}
    feature_order, frame_order, _ = in_order(parents, frames.made)  # rings are refused where the scene is checked
    its_features: dict[str, list[Feature]] = {name: [] for name in poses}
    its_frames: dict[str, list[DatumFrame]] = {name: [] for name in poses}
    for own in feature_order:
        its_features[features[own].part].append(features[own])
    for own in frame_order:
        its_frames[frames.made[own].part].append(frames.made[own])
    solids = shapes_of(understood.scene)
    parts = tuple(
        Part(name, poses[name], tuple(its_features[name]), tuple(its_frames[name]), solids.get(name))
        for name in understood.scene.of(SolidSpec)
    )
    measured = {name: own for name, own in understood.measured.items() if pose in read_at(understood.scene, name)}
    assembly = Assembly(parts, moves, measured, understood.effects.width)
    shown = tuple(own for own in shown_measures(understood.scene, understood.measured) if own.name in measured)
    return Meant(assembly, tuple(understood.effects.contributors), shown, named_by(understood.scene))


def understood(scene: Scene) -> Understood:
    """Model of a scene.

    Raises:
        SceneError: tolerances, zones or directions that do not fit their features.
    """
    drawing = Drawing(scene)
    effects = effects_of(scene, drawing)
    frames = DatumFrames(drawing.features)
    warmed(effects, scene, drawing, frames)
    features = features_of(drawing, effects, frames)
    add_projected(scene, features)
    measured = measured_of(scene, drawing, frames)
    shift_frames(scene, drawing, effects, frames)
    mark_held(scene, drawing, effects, frames)
    return Understood(scene, effects, frames, features, measured)
