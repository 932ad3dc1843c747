"""Features of a scene's parts with what moves them, and the points at which planes are touched."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from tol3d.assembly.from_scene.contributors import Effects
from tol3d.assembly.from_scene.datums import DatumFrames
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model import Axis, Cone, Contribution, Feature, Plane, Point, RoundPlane
from tol3d.assembly.picking.kept_picks import face_names
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene


def poses_of(scene: Scene) -> Mapping[str, Array]:
    """Nominal poses of parts as stated in the scene, in the world (4, 4)."""
    return {name: solid.placed.pose for name, solid in scene.of(SolidSpec).items()}


def features_of(drawing: Drawing, effects: Effects, frames: DatumFrames) -> dict[str, Feature]:
    """All features that a scene names."""
    found, faces = {}, face_names(drawing.scene)
    for name, datums in drawing.parents():
        own = drawing.kind(name)
        found[name] = Feature(
            name,
            part_of(name),
            own.shape,
            own.frame,
            frames.named(part_of(name), datums),
            tuple(effects.moved_by.get(name, ())),
            tuple(effects.size_by.get(name, ())),
            tuple(effects.grown_by.get(name, ())),
            face=faces.get(name, ""),
            formed_by=tuple(effects.formed_by.get(name, ())),
        )
    return found


@dataclass
class TouchedPoints:
    """Points of planes touched by points of other parts: they rise with the plane as it tilts.

    Args:
        features: all, by their names; the points are added.
        poses: of the parts, nominally.
    """

    features: dict[str, Feature]
    poses: Mapping[str, Array]
    made: set[str] = field(default_factory=set)
    _into: dict[str, Array] = field(default_factory=dict)
    """World to the frame of each plane (4, 4)."""

    def on(self, side: str, point: str) -> str:
        """The name of the touched feature: the plane's point there, or the feature itself if it is no plane."""
        plane = self.features[side]
        if not isinstance(plane.shape, Plane | RoundPlane):
            return side
        name = f"{side} at {point}"
        if name not in self.made:
            self.made.add(name)
            x, y = self._seen_from(plane, self.features[point])
            frame = plane.frame.copy()
            frame[:3, 3] += x * frame[:3, 0] + y * frame[:3, 1]
            along_x, along_y = plane.shape.reach
            rise = np.zeros((3, 3))
            rise[2] = 1.0, x / along_x, y / along_y
            moved_by = tuple(replace(own, matrix=rise @ own.matrix) for own in plane.moved_by)
            self.features[name] = Feature(
                name, plane.part, Point(), frame, plane.parent, moved_by, (), plane.grown_by, is_named=False, plane=side
            )
        return name

    def turned(self, direction: Array, owner: str, part: str) -> Array:
        """A direction (3,) of one part as another one sees it, where both lie nominally."""
        return np.asarray(direction @ self.poses[owner][:3, :3].T @ self.poses[part][:3, :3])

    def lifted(self, point: str, pair: str, along: Array, part: str, by: Sequence[Contribution]) -> str:
        """The name of a point that locators shift along a direction.

        Args:
            point: without them.
            pair: of which move, to be named by.
            along: (3,), in the frame of `part` as it lies nominally, of unit length.
            part: the one that is placed; the direction does not turn with it.
            by: what the locators contribute.
        """
        own = self.features[point]
        turned = self.poses[own.part][:3, :3] @ own.frame[:3, :3]
        direction = turned.T @ self.poses[part][:3, :3] @ along
        middle = _middle(own)
        moved_by = tuple(replace(each, matrix=middle @ each.matrix) for each in own.moved_by)
        moved_by += tuple(replace(each, matrix=direction[:, None] @ each.matrix) for each in by)
        name = f"{point} in {pair}"
        self.features[name] = Feature(
            name, own.part, Point(), own.frame, own.parent, moved_by, grown_by=own.grown_by, is_named=False
        )
        return name

    def origin(self, name: str) -> Array:
        """Nominal origin of a feature in the world (3,) [mm]."""
        own = self.features[name]
        return np.asarray((self.poses[own.part] @ own.frame)[:3, 3])

    def _seen_from(self, plane: Feature, point: Feature) -> Sequence[float]:
        """Coordinates of a point in the plane, x and y [mm]."""
        if plane.name not in self._into:
            self._into[plane.name] = np.asarray(np.linalg.inv(self.poses[plane.part] @ plane.frame))
        found = self._into[plane.name] @ self.poses[point.part] @ point.frame
        return float(found[0, 3]), float(found[1, 3])


def _middle(feature: Feature) -> Array:
    """Displacement of a feature's origin per component (3, components)."""
    match feature.shape:
        case Point():
            return np.eye(3)
        case Cone():
            return np.array([[0.5, 0.0, 0.5, 0.0, 0.0], [0.0, 0.5, 0.0, 0.5, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0]])
        case Axis():
            return 0.5 * np.array([[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0]])
        case Plane() | RoundPlane():
            return np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
