"""Parts of consecutive trials in the world, after moves."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.datum_seats import PartFeatures
from tol3d.assembly.placing.poses import Codes, Pose
from tol3d.numerics.arrays import Array


class SolidReader(Protocol):
    """Reader of distances of solids; made where trials are computed, for it may not pickle."""

    def __hash__(self) -> int:
        """Each is one of its own."""
        ...

    def read(self, name: str, start: Array, end: Array) -> tuple[Array, Codes]:
        """Distances (n,) [mm], NaN where the code is not OK, and codes (n,).

        Args:
            name: of the measure.
            start, end: poses of its parts in the world (n, 4, 4).
        """
        ...


@dataclass(frozen=True, eq=False)
class World:
    """Poses of parts after a move.

    Args:
        assembly: the model.
        columns: the deviations, (width, n) [mm].
        own: features and datum frames of each part, by its name.
        poses: of placed parts, in the world.
        bodies: parts welded to each part, itself included.
        loads: by move, the part of its force that each contact carries (contacts, n).
        slacks: of moves with play, by their names (n,) [mm].
        tightest: of moves with play, by their names, the pair that decides it (n,).
        kept: found of these trials alike in every pose in which the assembly is read, by keys of those who keep it; or
            of fewer trials, which these repeat one after the other with other turns of joints.
    """

    assembly: Assembly
    columns: Array
    own: Mapping[str, PartFeatures]
    poses: Mapping[str, Pose]
    bodies: Mapping[str, frozenset[str]]
    loads: Mapping[str, Array] = field(default_factory=dict)
    slacks: Mapping[str, Array] = field(default_factory=dict)
    tightest: Mapping[str, NDArray[np.str_]] = field(default_factory=dict)
    kept: dict[str, Any] = field(default_factory=dict)

    @property
    def trials(self) -> int:
        """Number of trials."""
        return int(self.columns.shape[1])

    def part_of(self, feature: str) -> str:
        """The part to which a feature belongs."""
        return self.assembly.features[feature].part

    def on_part(self, feature: str) -> ActualFeature:
        """A feature in its part's frame."""
        return self.own[self.part_of(feature)].feature(feature)

    def forget(self, feature: str) -> None:
        """Free a feature that is unlikely to be needed again; it is recomputed if it is."""
        self.own[self.part_of(feature)].forget(feature)

    def on_body(self, feature: str, part: str) -> ActualFeature:
        """A feature in the frame of a part of the same body."""
        own = self.part_of(feature)
        actual = self.on_part(feature)
        return actual if own == part else actual.moved(self.poses[part].inverse @ self.poses[own])

    def placed(self, feature: str) -> ActualFeature:
        """A feature in the world."""
        return self.on_part(feature).moved(self.poses[self.part_of(feature)])

    def with_part_at(self, part: str, pose: Pose) -> "World":
        """The world in which a part has a pose; parts welded to it move along."""
        moved = {part: pose}
        for other in self.bodies[part] - {part}:
            moved[other] = pose @ (self.poses[part].inverse @ self.poses[other])
        return replace(self, poses={**self.poses, **moved})

    def with_loads(self, move: str, loads: Array) -> "World":
        """The world in which contacts of a move carry some parts of its force (contacts, n)."""
        return replace(self, loads={**self.loads, move: loads})

    def with_slack(self, move: str, slack: Array, tightest: NDArray[np.str_]) -> "World":
        """The world in which a move with play has a slack (n,), and the pairs that decide it (n,)."""
        return replace(self, slacks={**self.slacks, move: slack}, tightest={**self.tightest, move: tightest})

    def with_welded(self, parts: tuple[str, ...]) -> "World":
        """The world in which parts, and parts welded to them, are one body."""
        body = frozenset[str]().union(*(self.bodies[part] for part in parts))
        return replace(self, bodies={**self.bodies, **dict.fromkeys(body, body)})
