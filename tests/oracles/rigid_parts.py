"""Poses of rigid parts by Newton on what their contacts ask, with finite rotations; features as their components move.

Knows parts, features without datum frames, and moves that hold all six freedoms.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tol3d.assembly.model import Assembly, Axis, Fix, Locate, Mate, Plane, Point, RoundPlane

Array = NDArray[np.float64]
Poses = Mapping[str, Array]
Equations = Callable[[Poses], Sequence[float]]

RADIUS = 100.0  # mm: turns are unknown as lengths there


@dataclass
class RigidParts:
    """An assembly in one trial.

    Args:
        assembly: the model.
        deviations: (columns,) [mm].
        asked: by the names of mates, what each asks: as many equations as unknowns, 0 where they are met.
    """

    assembly: Assembly
    deviations: Array
    asked: Mapping[str, Callable[["RigidParts", Poses], Sequence[float]]]

    def on_part(self, name: str) -> tuple[Array, Array]:
        """Origin and z of a feature in the frame of its part."""
        feature = self.assembly.features[name]
        moved = np.zeros(len(feature.shape.components))
        for each in feature.moved_by:
            moved += each.matrix @ self.deviations[each.columns]
        match feature.shape:
            case Point():
                origin, z = moved, np.array([0.0, 0.0, 1.0])
            case Plane() | RoundPlane():
                a, b = feature.shape.reach
                origin, z = np.array([0.0, 0.0, moved[0]]), np.array([-moved[1] / a, -moved[2] / b, 1.0])
            case Axis():
                origin = np.array([moved[0] + moved[2], moved[1] + moved[3], 0.0]) / 2.0
                z = np.array([moved[2] - moved[0], moved[3] - moved[1], feature.shape.length])
            case _:
                raise NotImplementedError
        rotation = feature.frame[:3, :3]
        return rotation @ origin + feature.frame[:3, 3], rotation @ z / np.linalg.norm(z)

    def size(self, name: str) -> float:
        """Diameter of a cylinder."""
        feature = self.assembly.features[name]
        assert isinstance(feature.shape, Axis)
        assert feature.shape.diameter is not None
        return feature.shape.diameter + sum(float(self.deviations[each.columns].sum()) for each in feature.size_by)

    def origin(self, name: str, poses: Poses) -> Array:
        """Origin of a feature in the world."""
        pose = poses[self.assembly.features[name].part]
        return np.asarray(pose[:3, :3] @ self.on_part(name)[0] + pose[:3, 3])

    def z(self, name: str, poses: Poses) -> Array:
        """A feature's z in the world."""
        return np.asarray(poses[self.assembly.features[name].part][:3, :3] @ self.on_part(name)[1])

    def poses(self) -> dict[str, Array]:
        """World poses (4, 4) of all parts, after all moves."""
        found: dict[str, Array] = {}
        for move in self.assembly.moves:
            match move:
                case Fix():
                    found[move.part] = self.assembly.part[move.part].pose
                case Locate():
                    found[move.part] = self._solved(move.part, found, self._contacts(move))
                case Mate():
                    asked = self.asked[move.name]
                    found[move.part] = self._solved(move.part, found, partial(asked, self))
                case _:
                    raise NotImplementedError
        return found

    def _contacts(self, move: Locate) -> Equations:
        def missing(poses: Poses) -> list[float]:
            found = []
            for pair in move.pairs:
                side = self.assembly.features[pair.target].part if move.points_on == "part" else move.part
                normal = poses[side][:3, :3] @ pair.normal
                locator = sum(float(self.deviations[each.columns].sum()) for each in pair.locator)
                apart = self.origin(pair.moving, poses) - self.origin(pair.target, poses)
                found.append(float(normal @ apart) - locator)
            return found

        return missing

    def _solved(self, part: str, poses: Poses, asked: Equations) -> Array:
        start = self.assembly.part[part].pose

        def pose(unknowns: Array) -> Array:
            own = np.eye(4)
            own[:3, :3] = Rotation.from_rotvec(unknowns[3:] / RADIUS).as_matrix() @ start[:3, :3]
            own[:3, 3] = start[:3, 3] + unknowns[:3]
            return own

        def missing(unknowns: Array) -> Array:
            return np.asarray(asked({**poses, part: pose(unknowns)}))

        unknowns = np.zeros(6)
        rates = np.array([missing(unknowns + h) - missing(unknowns - h) for h in 0.01 * np.eye(6)]).T / 0.02
        for _ in range(5):  # each leaves some 1e-4 of the error before it: slopes change so over 0.01 mm
            unknowns = unknowns - np.linalg.solve(rates, missing(unknowns))
        assert np.abs(missing(unknowns)).max() < 1e-12
        return pose(unknowns)


def directional(read: Callable[[Array], float | Array], direction: Array, step: float = 1e-3) -> Array:
    """Central difference of a reading along a direction of the deviations."""
    return np.asarray((np.asarray(read(step * direction)) - np.asarray(read(-step * direction))) / (2.0 * step))
