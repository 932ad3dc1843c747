"""Points of planes at which moves lay parts, and points that locators shift."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tol3d.assembly.from_scene.effects import Effects
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.grammar.moves.assembly_move import PointTouch
from tol3d.assembly.model import Contribution, Feature, Point
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene


def touched_name(touch: PointTouch, features: Mapping[str, Feature]) -> str:
    """The name of what a point touches: a plane's point there, or the feature itself if it is no plane."""
    is_plane = features[touch.side].shape.surface == "plane"
    return f"{touch.side} at {touch.point}" if is_plane else touch.side


def lifted_name(point: str, move: str, pair: str) -> str:
    """The name of a point as the locators of a move's pair shift it."""
    return f"{point} in {move} {pair}"


def outward(touch: PointTouch, features: Mapping[str, Feature]) -> Array:
    """Out of the material, in the frame of the part that is touched (3,)."""
    return features[touch.side].frame[:3, 2] if touch.along is None else unit(touch.along)


def inward(touch: PointTouch, features: Mapping[str, Feature], poses: Mapping[str, Array]) -> Array:
    """The opposite direction (3,), as the part that is placed sees it where both lie nominally."""
    owner = poses[features[touch.side].part]
    return np.asarray(-outward(touch, features) @ owner[:3, :3].T @ poses[touch.lifted_for][:3, :3])


def contact_points(
    scene: Scene, effects: Effects, features: Mapping[str, Feature], poses: Mapping[str, Array]
) -> dict[str, Feature]:
    """Points by their names: of planes where points of other parts touch them, and points that locators shift.

    Args:
        scene: by its moves.
        effects: by its locators.
        features: those that the scene names.
        poses: of the parts, nominally.
    """
    found: dict[str, Feature] = {}
    for move, spec in scene.of(AssemblyMoveSpec).items():
        for number, touch in spec.touches.items():
            point, name = features[touch.point], touched_name(touch, features)
            if name != touch.side and name not in found:
                found[name] = _of_plane(name, features[touch.side], point, poses)
            locators = effects.locators.get((move, number), ())
            if touch.lifted_for and locators:
                own, along = lifted_name(touch.point, move, number), inward(touch, features, poses)
                found[own] = _lifted(own, point, along, poses[touch.lifted_for], poses, locators)
    return found


def _of_plane(name: str, plane: Feature, point: Feature, poses: Mapping[str, Array]) -> Feature:
    """The point of a plane at a point of another part: it rises with the plane as that tilts."""
    into = np.asarray(np.linalg.inv(poses[plane.part] @ plane.frame))
    at = into @ poses[point.part] @ point.frame
    x, y = float(at[0, 3]), float(at[1, 3])
    frame = plane.frame.copy()
    frame[:3, 3] += x * frame[:3, 0] + y * frame[:3, 1]
    along_x, along_y = plane.shape.reach
    rise = np.zeros((3, 3))
    rise[2] = 1.0, x / along_x, y / along_y
    moved_by = tuple(replace(own, matrix=rise @ own.matrix) for own in plane.moved_by)
    return Feature(
        name, plane.part, Point(), frame, plane.parent, moved_by, (), plane.grown_by, is_named=False, plane=plane.name
    )


def _lifted(
    name: str, point: Feature, along: Array, pose: Array, poses: Mapping[str, Array], by: Sequence[Contribution]
) -> Feature:
    """A point that locators shift along a direction.

    Args:
        name: of it.
        point: without them.
        along: (3,), in the frame of the part that is placed, of unit length; the direction does not turn with it.
        pose: of that part, nominally.
        poses: of all parts, nominally.
        by: what the locators contribute.
    """
    turned = poses[point.part][:3, :3] @ point.frame[:3, :3]
    direction = turned.T @ pose[:3, :3] @ along
    middle = point.shape.origin_by
    moved_by = tuple(replace(each, matrix=middle @ each.matrix) for each in point.moved_by)
    moved_by += tuple(replace(each, matrix=direction[:, None] @ each.matrix) for each in by)
    return Feature(
        name, point.part, Point(), point.frame, point.parent, moved_by, grown_by=point.grown_by, is_named=False
    )
