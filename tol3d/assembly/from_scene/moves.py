"""Moves of a scene: pairs, normals, locators."""

from collections.abc import Sequence

import numpy as np

from tol3d.assembly.from_scene.features import TouchedPoints
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
from tol3d.assembly.grammar.moves.locating import ContactSpec
from tol3d.assembly.grammar.moves.mate import RelationSpec
from tol3d.assembly.model import BestFit, Contact, Fit, Fix, Locate, Mate, Move, Pair, Relation, Rest, Touch, Weld
from tol3d.assembly.model.moves import unfit_for_contact
from tol3d.import_path import named
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene

FLAT = 1e-6
"""Sine of the angle between directions that are the same."""


def moves_of(understood: Understood, touched: TouchedPoints, pose: str) -> tuple[Move, ...]:
    """All moves of a scene, in order; the points of planes that they touch are added to the features.

    Args:
        understood: the scene's drawings.
        touched: features, and nominal poses of parts.
        pose: of moves that have poses.

    Raises:
        SceneError: directions that do not fit their features.
    """
    found: list[Move] = []
    for name, spec in understood.scene.of(AssemblyMoveSpec).items():
        setting = Setting(understood, touched, understood.effects.drawn[name], spec.pose_like(pose))
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
        Relation(own.kind, own.from_, own.to, 0.0 if own.distance is None else own.distance.internal) for own in specs
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
    _refuse_a_line(setting.scene, name, spec, setting.touched)
    fits = tuple(Fit(own.from_, own.to, own.weight, _directions(own.along)) for own in spec.pairs)
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


def _refuse_a_line(scene: Scene, name: str, spec: BestFitSpec, touched: TouchedPoints) -> None:
    """Refuse points in space that leave a turn free; a fit with directions may leave those that it does not name."""
    if any(own.along for own in spec.pairs):
        return
    points = np.array([touched.origin(own.from_) for own in spec.pairs])
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[1] <= FLAT * max(spread[0], 1.0):
        words = f"expected points that do not all lie on one line, about which {spec.part!r} would be free to turn"
        raise scene.refuse(("moves", name, "pairs"), f"{words}; add a point beside it")


def _pairs(spec: LocatingSpec, name: str, setting: Setting) -> tuple[Pair, ...]:
    return tuple(_pair(spec, name, number, setting) for number in spec.pairs_by_name)


def _pair(spec: LocatingSpec, move: str, number: str, setting: Setting) -> Pair:
    scene, effects, touched = setting.scene, setting.effects, setting.touched
    path, own = spec.pairs_by_name[number]
    on_part = spec.points_on == "part"
    side, point = (own.to, own.from_) if on_part else (own.from_, own.to)
    touched_point = touched.on(side, point)
    named = effects.drawing.kind(side)
    has_normal = named.kind == "plane" or (named.kind == "point" and named.normal is not None)
    if own.along is None and not has_normal:
        words = f"expected the direction `along` in which {side!r} is touched, for it has no normal; got none"
        raise scene.refuse(("moves", move, *path), words)
    out = _normal(own, touched.features[side].frame[:3, 2])
    if touched_point != side and np.linalg.norm(out - touched.features[side].frame[:3, 2]) > FLAT:
        words = f"expected none, or the normal of the plane {side!r}"
        raise scene.refuse(("moves", move, *path, "along"), words)
    locators, heights = tuple(effects.locators.get((move, number), ())), tuple(effects.heights.get((move, number), ()))
    if on_part:
        return Pair(own.from_, touched_point, out, locators + heights)
    inward = touched.turned(-out, touched.features[side].part, spec.part)
    lifted = touched.lifted(own.to, f"{move} {number}", inward, spec.part, locators) if locators else own.to
    return Pair(touched_point, lifted, inward, heights)


def _normal(own: ContactSpec, feature_normal: Array) -> Array:
    """Out of the material, in the frame of the part that the plane stays with (3,)."""
    return feature_normal if own.along is None else unit(own.along)


def _directions(along: tuple[tuple[float, float, float], ...]) -> Array:
    """Orthonormal (directions, 3); all three if none is given."""
    if not along:
        return np.eye(3)
    q, _ = np.linalg.qr(np.array([unit(own) for own in along]).T)
    return np.asarray(q.T)
