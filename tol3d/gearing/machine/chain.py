"""Links that turn about each other, one after the other, on both methods.

A joint is the axis of a feature of the link before, as it lies in the trial. The link after stands on it by its seat, a
datum frame of its own, or by an axis, and is turned about it by the input of the pose and by what the train behind the
joint leaves free, which is a deviation like others.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tol3d.assembly.model import Acts, Move
from tol3d.assembly.placing.placer import ALL_OK, Placer
from tol3d.assembly.placing.poses import Codes, Pose
from tol3d.assembly.placing.world import World as PlacedWorld
from tol3d.assembly.torsors.torsor import cross_matrix
from tol3d.assembly.torsors.world import World as TorsorWorld
from tol3d.gearing.machine.grammar.open_chain import OpenChainSpec
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Joint:
    """A link on the one before.

    Args:
        name: the scene's.
        part: the link after.
        axis: the feature of the link before that it turns about; z is the sense of positive inputs.
        seat: the feature of the link after that lies on it.
        frame: name of a datum frame by which the link lies there instead; "" for none.
        zero: pose of the link in the frame of the axis at input 0, nominally (4, 4).
        angle: the input [rad].
        column: of the deviations: its turn beyond the input.
    """

    name: str
    part: str
    axis: str
    seat: str
    frame: str
    zero: Array
    angle: float
    column: int


@dataclass(frozen=True, eq=False)
class Chain(Move):
    """A chain of links in one of its poses."""

    acts: ClassVar[Acts] = OpenChainSpec.acts

    joints: tuple[Joint, ...]
    carried: tuple[str, ...]

    @property
    def parts(self) -> tuple[str, ...]:
        return tuple(joint.part for joint in self.joints)

    @property
    def carriers(self) -> tuple[str, ...]:
        return self.carried

    @property
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        return [(joint.seat, joint.axis) for joint in self.joints]

    @property
    def frames(self) -> Sequence[str]:
        return [joint.frame for joint in self.joints if joint.frame]


def displaced(move: Chain, world: TorsorWorld) -> TorsorWorld:
    """The world after links turn about axes where these are nominally; a motion of the seat moves the link back."""
    for joint in move.joints:
        at, z = world.origin(joint.axis), world.axis(joint.axis)
        turned = world.columns.zeros(6)
        turned[:3, joint.column], turned[3:, joint.column] = cross_matrix(at) @ z, z
        own = world.frame_on_part(joint.frame, joint.part) if joint.frame else world.on_body(joint.seat, joint.part)
        world = world.with_part_at(joint.part, world.placed(joint.axis) + turned - own)
    return world


@dataclass(frozen=True, eq=False)
class Turning(Placer):
    """A chain as it places its links; see Placer."""

    move: Chain

    def placed(self, world: PlacedWorld) -> tuple[PlacedWorld, Codes]:
        """See Placer: every trial is placed."""
        for joint in self.move.joints:
            turn = joint.angle + world.columns[joint.column]
            axis, link = self._on_parts(world, joint)
            turned = (world.poses[world.part_of(joint.axis)] @ axis).turned_about_z(np.cos(turn), np.sin(turn))
            world = world.with_part_at(joint.part, turned @ link)
        return world, ALL_OK

    def _on_parts(self, world: PlacedWorld, joint: Joint) -> tuple[Pose, Pose]:
        """The axis in the part before, and the link in the frame of the axis at input 0; kept, see World."""
        key = f"{joint.name} of {self.move.name}"
        if key in world.kept:
            axis, link = world.kept[key]
            return axis.repeated(world.trials), link.repeated(world.trials)
        if joint.frame:
            own = world.own[joint.part].displacement(joint.frame)
        else:
            seat = world.on_body(joint.seat, joint.part)
            own = seat.pose @ Pose.of(self._nominal_seat(world, joint)).inverse
        found = world.on_part(joint.axis).pose, Pose.of(joint.zero) @ own.inverse
        if joint.frame or world.part_of(joint.seat) == joint.part:  # else it follows from how two parts are welded
            world.kept[key] = found
        return found

    @staticmethod
    def _nominal_seat(world: PlacedWorld, joint: Joint) -> Array:
        """The seat's frame as the part that is placed has it nominally (4, 4)."""
        assembly = world.assembly
        seat = assembly.features[joint.seat]
        part = np.linalg.inv(assembly.part[joint.part].pose) @ assembly.part[seat.part].pose
        return np.asarray(part @ seat.frame, dtype=np.float64)


def turning(move: Chain, nominal: PlacedWorld) -> Turning:
    """A chain as it places its links."""
    return Turning(move)


def turned_about_z(angle: float) -> Array:
    """(4, 4)."""
    made = np.eye(4)
    cos, sin = math.cos(angle), math.sin(angle)
    made[:2, :2] = [[cos, -sin], [sin, cos]]
    return made


def forward(
    joints: Sequence[Joint], axes: Mapping[str, Array], placed: Mapping[str, Array], inputs: Mapping[str, float]
) -> Mapping[str, Array]:
    """Nominal poses of all parts (4, 4) where the joints have some inputs, those that no joint moves as they are.

    Args:
        joints: in order.
        axes: frames of the joints' axes by the names of these, in their parts (4, 4).
        placed: of all parts at inputs 0.
        inputs: by joint [rad].
    """
    found = dict(placed)
    for joint in joints:
        base = joint.axis.partition(".")[0]
        found[joint.part] = found[base] @ axes[joint.axis] @ turned_about_z(inputs[joint.name]) @ joint.zero
    return found
