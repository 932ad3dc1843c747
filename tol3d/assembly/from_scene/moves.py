"""Moves of a scene: pairs, normals, locators."""

from collections.abc import Mapping, Sequence

import numpy as np

from tol3d.assembly.from_scene.contact_points import inward, lifted_name, outward, touched_name
from tol3d.assembly.from_scene.setting import Setting, Understood
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.moves import (
    AssemblyMoveSpec,
    BestFitSpec,
    FixSpec,
    LocatingSpec,
    MateSpec,
    RestSpec,
    TouchSpec,
    WeldSpec,
)
from tol3d.assembly.grammar.moves.mate import RelationSpec
from tol3d.assembly.model import (
    BestFit,
    Contact,
    Feature,
    Fit,
    Fix,
    Locate,
    Mate,
    Move,
    Pair,
    Relation,
    Rest,
    Touch,
    Weld,
)
from tol3d.assembly.model.moves import unfit_for_contact
from tol3d.import_path import named
from tol3d.numerics.arrays import Array

FLAT = 1e-6
"""Sine of the angle between directions that are the same."""


def moves_of(
    understood: Understood, features: Mapping[str, Feature], poses: Mapping[str, Array], pose: str
) -> tuple[Move, ...]:
    """All moves of a scene, in order.

    Args:
        understood: the scene's drawings.
        features: all, the points of planes that moves touch among them.
        poses: of parts, nominally.
        pose: of moves that have poses.

    Raises:
        SceneError: directions that do not fit their features.
    """
    found: list[Move] = []
    for name, spec in understood.scene.of(AssemblyMoveSpec).items():
        drawn = understood.effects.drawn.get(name, {})
        setting = Setting(understood, features, poses, drawn, spec.pose_like(pose))
        found.append(named(spec.stated_by)(spec, name, setting))
    return tuple(found)


def fixed(spec: FixSpec, name: str, setting: Setting) -> Fix:
    """A part that stays where it is drawn."""
    return Fix(name, spec.part)


def welded(spec: WeldSpec, name: str, setting: Setting) -> Weld:
    """Parts that become one body."""
    return Weld(name, spec.part, spec.to)


def mated(spec: MateSpec, name: str, setting: Setting) -> Mate:
    """A mate."""
    return Mate(name, spec.part, relations_of(spec.relations))


def relations_of(specs: Sequence[RelationSpec]) -> tuple[Relation, ...]:
    """Relations of a mate, or kept by another move."""
    return tuple(
        Relation(spec.kind, spec.from_, spec.to, 0.0 if spec.distance is None else spec.distance.internal)
        for spec in specs
    )


def touched(spec: TouchSpec, name: str, setting: Setting) -> Touch:
    """A touch.

    Raises:
        SceneError: surfaces that do not touch as contacts ask.
    """
    for path, pair in spec.paired():
        if words := unfit_for_contact(setting.features[pair.from_].shape, setting.features[pair.to].shape):
            raise setting.scene.refuse(("moves", name, *path), words)
    contacts = tuple(Contact(pair.from_, pair.to) for pair in spec.contacts)
    return Touch(name, spec.part, contacts, None if spec.pressed is None else unit(spec.pressed))


def fitted(spec: BestFitSpec, name: str, setting: Setting) -> BestFit:
    """A best fit.

    Raises:
        SceneError: points on a line.
    """
    _refuse_a_line(name, spec, setting)
    fits = tuple(Fit(pair.from_, pair.to, pair.weight, _directions(pair.along)) for pair in spec.pairs)
    return BestFit(name, spec.part, fits, spec.criterion)


def located(spec: LocatingSpec, name: str, setting: Setting) -> Locate:
    """Six contacts.

    Raises:
        SceneError: directions that do not fit their features.
    """
    return Locate(name, spec.part, _pairs(spec, name, setting), spec.points_on)


def rested(spec: RestSpec, name: str, setting: Setting) -> Rest:
    """A part at rest; raises as `located`."""
    at = np.array([own.internal for own in spec.force.at])
    force, relations = unit(spec.force.direction), relations_of(spec.relations)
    return Rest(name, spec.part, _pairs(spec, name, setting), force, at, spec.points_on, relations)


def _refuse_a_line(name: str, spec: BestFitSpec, setting: Setting) -> None:
    """Refuse points in space that leave a turn free; a fit with directions may leave those that it does not name."""
    if any(pair.along for pair in spec.pairs):
        return
    points = np.array([setting.origin(pair.from_) for pair in spec.pairs])
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[1] <= FLAT * max(spread[0], 1.0):
        words = f"expected points that do not all lie on one line, about which {spec.part!r} would be free to turn"
        raise setting.scene.refuse(("moves", name, "pairs"), f"{words}; add a point beside it")


def _pairs(spec: LocatingSpec, name: str, setting: Setting) -> tuple[Pair, ...]:
    return tuple(_pair(spec, name, number, setting) for number in spec.pairs_by_name)


def _pair(spec: LocatingSpec, move: str, number: str, setting: Setting) -> Pair:
    scene, effects, features = setting.scene, setting.effects, setting.features
    path, touch = spec.pairs_by_name[number][0], spec.touches[number]
    side, point = touch.side, touch.point
    touched_point = touched_name(touch, features)
    named = setting.drawing.kind(side)
    has_normal = named.kind == "plane" or (named.kind == "point" and named.normal is not None)
    if touch.along is None and not has_normal:
        words = f"expected the direction `along` in which {side!r} is touched, for it has no normal; got none"
        raise scene.refuse(("moves", move, *path), words)
    out = outward(touch, features)
    if touched_point != side and np.linalg.norm(out - features[side].frame[:3, 2]) > FLAT:
        words = f"expected none, or the normal of the plane {side!r}"
        raise scene.refuse(("moves", move, *path, "along"), words)
    locators, heights = effects.locators.get((move, number), ()), effects.heights.get((move, number), ())
    if not touch.lifted_for:
        return Pair(point, touched_point, out, locators + heights)
    lifted = lifted_name(point, move, number) if locators else point
    return Pair(touched_point, lifted, inward(touch, features, setting.poses), heights)


def _directions(along: tuple[tuple[float, float, float], ...]) -> Array:
    """Orthonormal (directions, 3); all three if none is given."""
    if not along:
        return np.eye(3)
    q, _ = np.linalg.qr(np.array([unit(own) for own in along]).T)
    return np.asarray(q.T)
