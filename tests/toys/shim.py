"""A move from outside the package, whole in one file: a part stands on a feature of another one by a shim between."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from tol3d.assembly.from_scene.setting import Setting
from tol3d.assembly.grammar.moves.assembly_move import PairSpec, PlacingSpec
from tol3d.assembly.model import Acts, PartMove
from tol3d.assembly.placing.placer import ALL_OK, Placer
from tol3d.assembly.placing.poses import Codes, Pose, column
from tol3d.assembly.placing.world import World as PlacedWorld
from tol3d.assembly.torsors.world import World as TorsorWorld
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions import StatedDistribution
from tol3d.study.system.draw import Scalar
from tol3d.study.system.mechanism import Mechanism
from tol3d.study.system.plain import PlainContributor

ACTS = Acts("shim", "shimmed on", f"{__name__}:shimming", f"{__name__}:displaced")


class ShimSpec(PlacingSpec):
    """A part lies as drawn to a feature of another one, moved off along its normal as the shim is thicker."""

    words: ClassVar[str] = "a shim"
    acts = ACTS
    stated_by = f"{__name__}:shimmed"
    drawn_by = f"{__name__}:thickness_of"

    kind: Literal["shim"]
    seat: PairSpec
    thickness: StatedDistribution

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        yield ("seat",), self.seat


def thickness_of(spec: ShimSpec, name: str, scene: Scene) -> Iterator[PlainContributor]:
    yield PlainContributor(f"thickness of {name}", "shim", Scalar(spec.thickness.resolve(scene.files)))


def shimmed(spec: ShimSpec, name: str, setting: Setting) -> "Shim":
    return Shim(name, spec.part, spec.seat.from_, spec.seat.to, setting.drawn[f"thickness of {name}"].start)


@dataclass(frozen=True)
class Shim(PartMove):
    acts: ClassVar[Acts] = ACTS

    moving: str
    target: str
    column: int

    @property
    def feature_pairs(self) -> list[tuple[str, str]]:
        return [(self.moving, self.target)]


@dataclass(frozen=True, eq=False)
class Shimming(Placer):
    move: Shim
    drawn: Pose
    """Nominal pose of the moving feature in the target's frame."""

    def placed(self, world: PlacedWorld) -> tuple[PlacedWorld, Codes]:
        own, target = world.on_body(self.move.moving, self.move.part).pose, world.placed(self.move.target).pose
        lifted = Pose(np.eye(3)[:, :, None], column(np.array([0.0, 0.0, 1.0])) * world.columns[self.move.column])
        return world.with_part_at(self.move.part, target @ lifted @ self.drawn @ own.inverse), ALL_OK


def shimming(move: Shim, nominal: PlacedWorld) -> Shimming:
    return Shimming(move, nominal.placed(move.target).pose.inverse @ nominal.placed(move.moving).pose)


def displaced(move: Shim, world: TorsorWorld) -> TorsorWorld:
    lifted = world.columns.zeros(6)
    lifted[:3, move.column] = world.axis(move.target)
    return world.with_part_at(move.part, world.placed(move.target) + lifted - world.on_body(move.moving, move.part))


SHIMS = Mechanism(name="shims", extends=("assembly",), moves=(ShimSpec,))
