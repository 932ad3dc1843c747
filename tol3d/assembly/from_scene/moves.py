"""Moves of a scene: pairs, normals, locators."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tol3d.assembly.from_scene.contributors import Effects
from tol3d.assembly.from_scene.features import TouchedPoints
from tol3d.assembly.from_scene.play import engaged_by, touch
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.moves import (
    BestFitSpec,
    FixSpec,
    LocatingSpec,
    MateSpec,
    PlacingSpec,
    PlaySpec,
    RestSpec,
    StatedMoveSpec,
    TouchSpec,
    WeldSpec,
)
from tol3d.assembly.grammar.moves.locating import ContactSpec
from tol3d.assembly.grammar.moves.mate import RelationSpec
from tol3d.assembly.model import BestFit, Fit, Fix, Locate, Mate, Move, Pair, Relation, Rest, Weld
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene

if TYPE_CHECKING:
    from tol3d.assembly.from_scene.assembly import Understood


FLAT = 1e-6
"""Sine of the angle between directions that are the same."""


def moves_of(understood: "Understood", touched: TouchedPoints, pose: str) -> tuple[Move, ...]:
    """All moves of a scene, in order; the points of planes that they touch are added to the features.

    Args:
        understood: the scene's drawings.
        touched: features, and nominal poses of parts.
        pose: of moves that have poses.

    Raises:
        SceneError: directions that do not fit their features.
    """
    scene, effects = understood.scene, understood.effects
    found: list[Move] = []
    for name, spec in scene.moves.items():
        if isinstance(spec, StatedMoveSpec):
            found.append(spec.stated(name, understood, touched, effects.stated[name], spec.pose_like(pose)))
        elif isinstance(spec, PlacingSpec | WeldSpec):
            found.append(_move(scene, name, spec, effects, touched))
    return tuple(found)


def _move(scene: Scene, name: str, spec: PlacingSpec | WeldSpec, effects: Effects, touched: TouchedPoints) -> Move:
    match spec:
        case WeldSpec():
            return Weld(name, spec.part, spec.to)
        case RestSpec():
            pairs = tuple(_pair(scene, name, number, spec, effects, touched) for number in spec.pairs_by_name)
            at = np.array([own.internal for own in spec.force.at])
            return Rest(
                name, spec.part, pairs, unit(spec.force.direction), at, spec.points_on, _relations(spec.relations)
            )
        case LocatingSpec():
            pairs = tuple(_pair(scene, name, number, spec, effects, touched) for number in spec.pairs_by_name)
            return Locate(name, spec.part, pairs, spec.points_on)
        case BestFitSpec():
            _refuse_a_line(scene, name, spec, touched)
            fits = tuple(Fit(own.from_, own.to, own.weight, _directions(own.along)) for own in spec.pairs)
            return BestFit(name, spec.part, fits, spec.criterion)
        case MateSpec():
            return Mate(name, spec.part, _relations(spec.relations))
        case TouchSpec():
            return touch(scene, name, spec, touched.features)
        case PlaySpec():
            return engaged_by(scene, name, spec, _relations(spec.relations), effects, touched.features)
        case FixSpec():
            return Fix(name, spec.part)
    raise NotImplementedError(spec.kind)


def _relations(specs: Sequence[RelationSpec]) -> tuple[Relation, ...]:
    return tuple(
        Relation(own.kind, own.from_, own.to, 0.0 if own.distance is None else own.distance.internal) for own in specs
    )


def _refuse_a_line(scene: Scene, name: str, spec: BestFitSpec, touched: TouchedPoints) -> None:
    """Refuse points in space that leave a turn free; a fit with directions may leave those that it does not name."""
    if any(own.along for own in spec.pairs):
        return
    points = np.array([touched.origin(own.from_) for own in spec.pairs])
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[1] <= FLAT * max(spread[0], 1.0):
        words = f"expected points that do not all lie on one line, about which {spec.part!r} would be free to turn"
        raise scene.refuse(("moves", name, "pairs"), f"{words}; add a point beside it")


def _pair(scene: Scene, move: str, number: str, spec: LocatingSpec, effects: Effects, touched: TouchedPoints) -> Pair:
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
