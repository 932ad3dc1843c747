"""Closed loops among the parts of an assembly, on both methods; see Move."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from tol3d.assembly.linkage.closing import loops_closed
from tol3d.assembly.linkage.first_order import Displaced
from tol3d.assembly.linkage.frames import joint_frames, stacked
from tol3d.assembly.linkage.grammar.close_loop import CloseLoopSpec
from tol3d.assembly.linkage.kinematics import Kinematics, Position
from tol3d.assembly.linkage.play import JointPlay
from tol3d.assembly.linkage.structure import ROOT, Structure
from tol3d.assembly.model import Acts, Move
from tol3d.assembly.model.statuses import NO_BUILD, OK
from tol3d.assembly.placing.placer import Placer
from tol3d.assembly.placing.poses import Codes, Pose
from tol3d.assembly.placing.world import World as PlacedWorld
from tol3d.assembly.torsors.world import World as TorsorWorld

Array = NDArray[np.float64]


@dataclass(frozen=True)
class InputDeviation:
    """One deviation of an input.

    Args:
        column: of the deviations.
        share: fraction of it that the input is off, in the pose in which the loop is read.
    """

    column: int
    share: float


@dataclass(frozen=True)
class LoopInput:
    """A freedom that is given.

    Args:
        joint: whose.
        coordinate: which of its freedoms: "slide", else an angle.
        as_placed: its value as parts are placed [mm or rad].
        range: ends of its travel [mm or rad]; None if not stated.
    """

    joint: str
    coordinate: str
    as_placed: float
    range: tuple[float, float] | None

    @property
    def is_slide(self) -> bool:
        """True if it is a length."""
        return self.coordinate == "slide"

    def told(self, value: float) -> str:
        """Input in words, from its displacement off the placed parts [mm or rad]."""
        whole = self.as_placed + value
        return f"{whole:.6g} mm" if self.is_slide else f"{np.degrees(whole):.6g} deg"


@dataclass(frozen=True, eq=False)
class ClosedLoop(Move):
    """A loop in one of its poses.

    Args:
        kinematics: of the loop.
        position: without deviations.
        inputs: by name.
        stations: its positions in the poses that the scene names.
        plays: of joints, by their names.
        errors: of inputs, by their names.
    """

    acts: ClassVar[Acts] = CloseLoopSpec.acts

    kinematics: Kinematics
    position: Position
    inputs: Mapping[str, LoopInput]
    stations: Mapping[str, Position]
    plays: Mapping[str, JointPlay] = field(default_factory=dict)
    errors: Mapping[str, Sequence[InputDeviation]] = field(default_factory=dict)

    @property
    def structure(self) -> Structure:
        """The loop."""
        return self.kinematics.structure

    @property
    @override
    def parts(self) -> tuple[str, ...]:
        return self.structure.bodies

    @property
    @override
    def carriers(self) -> tuple[str, ...]:
        before = ((own.joint.of if own.reverse else own.joint.on) for own in self.structure.tree)
        return tuple(feature.partition(".")[0] for feature in before)

    @cached_property
    def _pairs(self) -> tuple[tuple[str, str], ...]:
        found = []
        for step in self.structure.steps:
            joint = step.joint
            found.append((joint.on, joint.of) if step.reverse or step.body == ROOT else (joint.of, joint.on))
            if "." in joint.carrier:
                found.append((joint.of, joint.carrier))
        return tuple(found)

    @property
    @override
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        return self._pairs

    @property
    @override
    def words(self) -> str:
        return ", ".join(step.joint.name for step in self.structure.steps)

    @cached_property
    def plays_told(self) -> tuple[object, ...]:
        """Plays by what they make of frames, to be compared."""
        return tuple((name, *play.told) for name, play in self.plays.items())


def displaced(move: ClosedLoop, world: TorsorWorld) -> TorsorWorld:
    """The world after a loop is closed, to first order."""
    plays = {name: play.torsor(world.columns) for name, play in move.plays.items()}
    inputs = {}
    for name in move.structure.inputs:
        row = world.columns.zeros(1)
        for own in move.errors.get(name, ()):
            row[0, own.column] += own.share
        inputs[name] = row
    found = Displaced(move.structure, plays, inputs).torsors(world)
    for part, torsor in zip(move.structure.bodies, found, strict=True):
        world = world.with_part_at(part, torsor)
    return world


@dataclass(frozen=True, eq=False)
class Closing(Placer):
    """A loop as it is closed in trials; see Placer."""

    move: ClosedLoop

    def placed(self, world: PlacedWorld) -> tuple[PlacedWorld, Codes]:
        """See Placer; if it is not closed, its bodies lie as without deviations."""
        own, at = self.move.structure, self.move.position
        plays, fits = dict[str, Pose](), np.ones(1, dtype=bool)
        for name, play in self.move.plays.items():
            plays[name], fit = play.offset(world.columns)
            fits = fits & fit

        base, child = self._frames(world, plays)
        given = self._given(world.columns)
        trials = max(len(base), len(child), len(given))
        free = own.free(inputs=False)
        scale = own.scale(free)
        poses, coordinates = np.empty((trials, len(own.bodies), 3, 4)), np.empty((trials, own.width))
        turned, codes = np.empty((trials, own.slots, 3, 3)), np.empty(trials, dtype=np.int8)
        found, matrix = np.empty((trials, 3)), np.empty((len(scale), len(scale)))
        loops_closed(
            own.tree_array,
            own.shut_array(output=False),
            own.numbers,
            free,
            at.held,
            at.coordinates,
            at.turns,
            base,
            child,
            at.base,
            at.child,
            given,
            scale,
            np.array([own.length, at.sign]),
            poses,
            coordinates,
            turned,
            codes,
            found,
            matrix,
        )
        codes = np.where(fits, codes, np.int8(NO_BUILD)).astype(np.int8)
        for b, part in enumerate(own.bodies):
            turn = np.ascontiguousarray(np.moveaxis(poses[:, b, :, :3], 0, -1))
            world = world.with_part_at(part, Pose(turn, np.ascontiguousarray(poses[:, b, :, 3].T)))
        return world, codes if (codes != OK).any() else codes[:1]

    def _frames(self, world: PlacedWorld, plays: Mapping[str, Pose]) -> tuple[Array, Array]:
        """Frames of joints as the kernel reads them; the last pose's where bodies before the loop lie as there."""
        own = self.move.structure

        def frame(feature: str) -> Pose:
            part = feature.partition(".")[0]
            return (world.on_body(feature, part) if part in own.body_of else world.placed(feature)).pose

        parts = {part for name in own.joined for part in (name.partition(".")[0], world.part_of(name))}
        placed = [world.poses[part] for part in sorted(parts - set(own.bodies)) if part in world.poses]
        told = [own, *(world.own[part] for part in sorted(parts)), *self.move.plays_told]
        told += [own.tobytes() for pose in placed for own in (pose.turn, pose.shift)]
        key = f"frames of {own.name}"
        if key in world.kept and world.kept[key][0] == told:
            kept: tuple[Array, Array] = world.kept[key][1:]
            return kept
        base, child = (stacked(poses) for poses in joint_frames(own, frame, plays))
        if all(pose.turn.shape[-1] == 1 and pose.shift.shape[-1] == 1 for pose in placed):
            world.kept[key] = told, base, child
        return base, child

    def _given(self, columns: Array) -> Array:
        """Coordinates of inputs with their errors (n or 1, coordinates)."""
        own, nominal = self.move.structure, self.move.position.coordinates
        errors = {
            name: sum(e.share * columns[e.column] for e in each) for name, each in self.move.errors.items() if each
        }
        found = np.repeat(nominal[None], columns.shape[1] if errors else 1, axis=0)
        for name, error in errors.items():
            place, sense = own.given[name]
            found[:, place] += sense * error
        return found


def closing(move: ClosedLoop, nominal: PlacedWorld) -> Closing:
    """A loop as it is closed in trials."""
    return Closing(move)
