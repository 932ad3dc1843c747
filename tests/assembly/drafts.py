"""Assemblies put together by numbers for tests: each component of each feature has a deviation of its own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.model import Assembly, Contribution, Datum, DatumFrame, Feature, Measured, Move, Part, Point, Shape
from tol3d.assembly.torsors.method import slopes

Array = NDArray[np.float64]
Vector = Sequence[float] | Array


def frame(origin: Vector = (0, 0, 0), z: Vector = (0, 0, 1), x: Vector | None = None) -> Array:
    """A 4x4 frame with this z; x as near as can be to the one stated, else to some direction."""
    normal = np.asarray(z, float) / np.linalg.norm(z)
    near = np.eye(3)[np.argmin(np.abs(normal))] if x is None else np.asarray(x, float)
    across = near - (near @ normal) * normal
    across /= np.linalg.norm(across)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = across, np.cross(normal, across), normal, origin
    return pose


def turned(turn: Vector, origin: Vector = (0, 0, 0)) -> Array:
    """A 4x4 frame from a rotation vector [rad] and an origin."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = Rotation.from_rotvec(np.asarray(turn, float)).as_matrix(), origin
    return pose


@dataclass
class Draft:
    """Parts, features and datum frames as they are added."""

    poses: dict[str, Array] = field(default_factory=dict)
    features: dict[str, Feature] = field(default_factory=dict)
    datum_frames: dict[str, DatumFrame] = field(default_factory=dict)
    columns: list[str] = field(default_factory=list)

    def part(self, name: str, pose: Array | None = None) -> str:
        self.poses[name] = np.eye(4) if pose is None else pose
        return name

    def contribution(self, name: str, components: Sequence[str]) -> Contribution:
        first = len(self.columns)
        self.columns += [f"{name} {component}".strip() for component in components]
        return Contribution(name, slice(first, len(self.columns)), np.eye(len(components)))

    def feature(
        self, name: str, where: Vector, shape: Shape | None = None, parent: str = "", *, deviates: bool = True
    ) -> str:
        """Add a feature, "part.name", at a 4x4 frame or at a point; its columns are "part.name component"."""
        shape = Point() if shape is None else shape
        at = np.asarray(where, float)
        at = frame(at) if at.shape == (3,) else at
        moved = (self.contribution(name, shape.components),) if deviates else ()
        self.features[name] = Feature(name, name.split(".")[0], shape, at, parent, moved)
        return name

    def size(self, name: str) -> None:
        """Give a feature a size that deviates, column "part.name size"."""
        self.features[name] = replace(self.features[name], size_by=(self.contribution(name, ["size"]),))

    def datum_frame(self, part: str, *datums: Datum) -> str:
        name = "|".join([part, *("-".join(each.split(".")[1] for each in datum.features) for datum in datums)])
        self.datum_frames[name] = DatumFrame(name, part, datums)
        return name

    def assembly(self, moves: Sequence[Move] = (), measures: Mapping[str, Measured] | None = None) -> Assembly:
        parts = tuple(
            Part(
                name,
                pose,
                tuple(each for each in self.features.values() if each.part == name),
                tuple(each for each in self.datum_frames.values() if each.part == name),
            )
            for name, pose in self.poses.items()
        )
        return Assembly(parts, tuple(moves), measures or {}, len(self.columns))

    def trial(self, deviations: Mapping[str, float]) -> Array:
        """One trial's deviations (1, columns), by names of columns; all others 0."""
        row = np.zeros((1, len(self.columns)))
        for name, value in deviations.items():
            row[0, self.columns.index(name)] = value
        return row


def moved_as_a_whole(assembly: Assembly, pose: Array) -> Assembly:
    """The same assembly, all nominal poses of parts seen from elsewhere."""
    return replace(assembly, parts=tuple(replace(part, pose=pose @ part.pose) for part in assembly.parts))


def displacement(name: str, along: Vector, start: str) -> Measured:
    """Displacement of a feature from another along a direction that is fixed in that one's part."""
    return Measured(GapSpec.reads, (start, name), np.asarray(along, float))


def coefficients(assembly: Assembly, name: str) -> Array:
    """Slopes of a measure by the columns of deviations."""
    return slopes(assembly, name, np.zeros(assembly.width), np.ones(assembly.width)).coefficients
