"""The assembly that a scene means, its contributors and its measures.

Tolerances that act not only by their deviations: also by gauges, by inspections, by reducing another zone.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from tol3d.assembly.from_scene.boundaries import gauge_shifts, on_gauges
from tol3d.assembly.from_scene.contact_points import contact_points
from tol3d.assembly.from_scene.contributors import effects_of
from tol3d.assembly.from_scene.datums import DatumFrames, frames_of, in_order
from tol3d.assembly.from_scene.effects import Effects
from tol3d.assembly.from_scene.features import features_of, twins_of
from tol3d.assembly.from_scene.measures import measured_of, named_by, shown_measures
from tol3d.assembly.from_scene.moves import moves_of
from tol3d.assembly.from_scene.setting import Understood
from tol3d.assembly.from_scene.thermal_growth import growth
from tol3d.assembly.grammar.checks import read_at
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.grammar.tolerances.location import FormSpec, LocationSpec, OrientationSpec
from tol3d.assembly.grammar.tolerances.plus_minus import SizeSpec
from tol3d.assembly.model import Assembly, DatumFrame, Feature, Part
from tol3d.assembly.picking.kept_picks import shapes_of
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.study.system.plain import PlainContributor, PlainMeasure


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


def understood(scene: Scene) -> Understood:
    """Drawings and measures of a scene, wherever its parts lie. Each step makes new objects of those before.

    Raises:
        SceneError: tolerances, zones or directions that do not fit their features.
    """
    drawing = Drawing(scene)
    nominal = frames_of(drawing)
    toleranced = effects_of(drawing)
    warmed = toleranced.with_drawn(growth(drawing, nominal))
    gauged = warmed.with_drawn(gauge_shifts(drawing, warmed, nominal))
    effects = with_held(drawing, gauged, nominal)
    frames = on_gauges(drawing, effects, nominal)
    features = features_of(drawing, effects)
    measured = measured_of(drawing)
    return Understood(drawing, effects, frames, features, measured)


def meant(understood: Understood, poses: Mapping[str, Array], pose: str = "") -> Meant:
    """The assembly with given nominal poses of its parts in the world (4, 4).

    Args:
        understood: its drawings and measures.
        poses: by part.
        pose: of moves that have poses, with the measures read in it; all measures if no move has poses.
    """
    scene, effects, named = understood.scene, understood.effects, understood.features
    made = {**twins_of(scene, named, poses), **contact_points(scene, effects, named, poses)}
    features = {**named, **made}
    moves = moves_of(understood, features, poses, pose)
    parts = parts_of(scene, features, understood.frames.made, poses)
    measured = {name: own for name, own in understood.measured.items() if pose in read_at(scene, name)}
    assembly = Assembly(parts, moves, measured, effects.width)
    shown = tuple(
        shown_measure for shown_measure in shown_measures(scene, understood.measured) if shown_measure.name in measured
    )
    return Meant(assembly, effects.contributors, shown, named_by(scene))


def parts_of(
    scene: Scene, features: Mapping[str, Feature], frames: Mapping[str, DatumFrame], poses: Mapping[str, Array]
) -> tuple[Part, ...]:
    """Parts with their features and datum frames, each after what it is made of."""
    parents = {name: feature.parent for name, feature in features.items()}
    feature_order, frame_order, _ = in_order(parents, frames)  # rings are refused where the scene is checked
    its_features: dict[str, list[Feature]] = {name: [] for name in poses}
    its_frames: dict[str, list[DatumFrame]] = {name: [] for name in poses}
    for own in feature_order:
        its_features[features[own].part].append(features[own])
    for own in frame_order:
        its_frames[frames[own].part].append(frames[own])
    solids = shapes_of(scene)
    return tuple(
        Part(name, poses[name], tuple(its_features[name]), tuple(its_frames[name]), solids.get(name))
        for name in scene.of(SolidSpec)
    )


def with_held(drawing: Drawing, effects: Effects, frames: DatumFrames) -> Effects:
    """Effects whose contributors say what else their tolerances act on: gauges, inspections, reduced zones."""
    scene, held = drawing.scene, dict[str, str]()
    inspected = {
        feature
        for name, names in named_by(scene).items()
        if getattr(scene.measures[name], "modifier", None) is not None
        for feature in names
    }
    gauged = {
        f"{frames.made[name].part}.{feature}"
        for name, datums in frames.specs.items()
        for datum in datums
        if datum.gauge is not None
        for feature in datum.features
    }
    for own in drawing.stated:
        if isinstance(own, str):
            continue
        sized = isinstance(own.spec, SizeSpec) and own.spec.limits is None
        if own.feature in gauged and (sized or isinstance(own.spec, LocationSpec | OrientationSpec)):
            held[own.name] = "sizes a gauge of a datum"
        elif own.feature in inspected and sized:
            held[own.name] = "sizes the zone that a measure inspects"
        elif isinstance(own.spec, FormSpec | OrientationSpec) and drawing.of(own.feature, LocationSpec):
            held[own.name] = "narrows another zone"
    marked = (
        replace(contributor, held=held[contributor.name]) if contributor.name in held else contributor
        for contributor in effects.contributors
    )
    return replace(effects, contributors=tuple(marked))
