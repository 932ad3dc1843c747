"""Chains of a scene: joints where parts are placed, and the end of its play at which each of them lies, pose by pose.

Gravity lays a joint on a side of its play, a train turns it by its lost motion; one that nothing loads lies at either
end, each as often.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from tol3d.assembly.from_scene.datums import frame_name
from tol3d.assembly.from_scene.features import poses_of
from tol3d.assembly.from_scene.setting import Setting
from tol3d.assembly.grammar.checks import pose_names, read_in
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.errors import InputError
from tol3d.gearing.machine.chain import Chain, Joint, forward
from tol3d.gearing.machine.grammar.open_chain import FLANK, OpenChainSpec, flank_name, turn_name
from tol3d.gearing.model import Measure, Model
from tol3d.gearing.model.from_scene import jumping
from tol3d.gearing.model.mesh_measures import default_reading
from tol3d.gearing.model.train_measures import lost_motion
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.statistics.distributions.base import Distribution, Place
from tol3d.statistics.distributions.constant import Constant
from tol3d.study.system.draw import Scalar
from tol3d.study.system.plain import UNITS, PlainContributor
from tol3d.study.system.posable import AS_SET
from tol3d.study.system.positions import Positions
from tol3d.units import Quantity

SAME_LINE: Final = 1e-6
"""mm, and sine of an angle; both axes of a joint are one to within this where parts are placed."""

NO_TORQUE: Final = 1e-6
"""Limit of mass times distance, summed up; less does not load a joint."""


def joints_of(
    spec: OpenChainSpec, drawing: Drawing, frames: Mapping[str, str], columns: Mapping[str, int], pose: str
) -> tuple[Joint, ...]:
    """The joints of a chain in a pose.

    Args:
        spec: the chain.
        drawing: of the scene.
        frames: by joint, the name of the datum frame of its seat; none where the axis is the seat.
        columns: by joint, the column of its turn.
        pose: one of its poses.
    """
    placed, found = poses_of(drawing.scene), []
    for name, own in spec.joints.items():
        axis, seat = own.between
        link = part_of(seat)
        there = placed[part_of(axis)] @ drawing.kind(axis).frame
        angle = spec.poses[pose][name].internal
        zero = np.linalg.inv(there) @ placed[link]
        found.append(Joint(name, link, axis, seat, frames.get(name, ""), zero, angle, columns.get(name, -1)))
    return tuple(found)


def contributors_of(spec: OpenChainSpec, name: str, scene: Scene) -> Sequence[PlainContributor]:
    """Turns of the joints, which are not drawn; then flanks of those that nothing loads in some pose."""
    hidden = Scalar(Constant(0.0))
    turns = (
        PlainContributor(turn_name(name, joint), "joint", hidden, *UNITS["angle"], nominal="") for joint in spec.joints
    )
    words = "the end of its play at which {} lies, for nothing loads it"
    free = (
        PlainContributor(flank_name(joint), FLANK, Scalar(EitherSide()), "1", 1.0, words.format(joint))
        for joint in free_joints(scene, spec)
    )
    return (*turns, *free)


def chain_of(spec: OpenChainSpec, name: str, setting: Setting) -> Chain:
    """A chain in a pose.

    Raises:
        SceneError: a joint whose two axes are not one line where its parts are placed.
    """
    scene, drawing, drawn, pose = setting.scene, setting.drawing, setting.drawn, setting.pose
    _refuse_apart(scene, name, spec, drawing)
    frames = {joint: frame_name(part_of(own.between[1]), own.seat) for joint, own in spec.joints.items() if own.seat}
    columns = {joint: own.start for joint, own in zip(spec.joints, drawn.values(), strict=False)}
    carried = tuple(part_of(joint.between[0]) for joint in spec.joints.values())
    return Chain(name, joints_of(spec, drawing, frames, columns, pose), carried)


def _refuse_apart(scene: Scene, name: str, spec: OpenChainSpec, drawing: Drawing) -> None:
    placed = poses_of(scene)
    for joint, own in spec.joints.items():
        first, last = (placed[part_of(axis)] @ drawing.kind(axis).frame for axis in own.between)
        lean = float(np.linalg.norm(np.cross(first[:3, 2], last[:3, 2])))
        off = float(np.linalg.norm(np.cross(last[:3, 3] - first[:3, 3], first[:3, 2])))
        if lean > SAME_LINE or off > SAME_LINE:
            words = (
                f"expected axes on one line where both parts are `placed`, with the input at 0, got {own.between[1]!r}"
            )
            amount = f"{off:.4g} mm beside" if off > SAME_LINE else f"at {1e3 * lean:.4g} mrad to"
            raise scene.refuse(("moves", name, "joints", joint, "between"), f"{words} {amount} {own.between[0]!r}")


def loaded_sides(scene: Scene, spec: OpenChainSpec, pose: str) -> Mapping[str, int]:
    """End of each joint's play at which gravity lays it in a pose: 1, -1, or 0 if nothing loads it.

    A link's torque about an axis is positive where it turns the link in the sense of positive inputs.
    """
    drawing = Drawing(scene)
    joints = joints_of(spec, drawing, {}, {}, pose)
    axes = {joint.axis: drawing.kind(joint.axis).frame for joint in joints}
    placed = forward(joints, axes, poses_of(scene), {joint.name: joint.angle for joint in joints})
    gravity = np.array(spec.gravity if spec.gravity is not None else (0.0, 0.0, 0.0))
    gravity = gravity / (np.linalg.norm(gravity) or 1.0)
    masses = [
        (mass.mass.internal, placed[mass.of] @ [*(x.internal for x in mass.at), 1.0], mass.of) for mass in spec.masses
    ]
    found = {}
    for joint in joints:
        axis = placed[joint.axis.partition(".")[0]] @ axes[joint.axis]
        behind = _behind(joints, joint)
        its = [(mass, at[:3] - axis[:3, 3]) for mass, at, on in masses if on in behind]
        torque = sum(mass * float(axis[:3, 2] @ np.cross(arm, gravity)) for mass, arm in its)
        size = sum(mass * float(np.linalg.norm(arm)) for mass, arm in its)
        found[joint.name] = int(np.sign(torque)) if abs(torque) > NO_TORQUE * size else 0
    return found


def _behind(joints: Sequence[Joint], joint: Joint) -> set[str]:
    """The link that a joint turns, and those that it carries."""
    found = {joint.part}
    for other in joints:  # in an order in which each lies on those before
        if other.axis.partition(".")[0] in found:
            found.add(other.part)
    return found


def free_joints(scene: Scene, spec: OpenChainSpec) -> tuple[str, ...]:
    """Joints with play that nothing loads in one of the poses that are stated."""
    sides = [loaded_sides(scene, spec, pose) for pose in spec.poses if pose != AS_SET]
    trains = (name for name, own in spec.joints.items() if own.train is not None)
    return tuple(name for name in trains if any(side[name] == 0 for side in sides))


@dataclass(frozen=True)
class EitherSide(Distribution):
    """-1 or 1."""

    def ppf(self, u: Array) -> Array:
        """-1 below one half, 1 from it on."""
        return np.where(u < 0.5, -1.0, 1.0)

    def cdf(self, x: Array) -> Array:
        """0, one half from -1 on, 1 from 1 on."""
        return np.where(x >= 1.0, 1.0, np.where(x >= -1.0, 0.5, 0.0))

    @property
    def mean(self) -> float:
        """0."""
        return 0.0

    @property
    def variance(self) -> float:
        """1."""
        return 1.0

    @property
    def limits(self) -> tuple[float, float]:
        """-1 and 1."""
        return -1.0, 1.0

    def mapped(self, place: Place, factor: float) -> Self:
        """None: which side of its play a joint lies on has no width.

        Raises:
            InputError: always.
        """
        raise InputError("expected a law that can be scaled, got a side of a joint's play, which has no width")


HALF: Final = 0.5
"""Fraction of its play by which a joint lies off the middle."""


@dataclass(frozen=True)
class JointDrive:
    """A joint and the train behind it.

    Args:
        joint: its name.
        turn: name of the assembly's contributor, not drawn, that is its turn beyond the input.
        flank: name of the contributor that decides its side where nothing loads it.
        readings: by pose, the lost motion of the train's output where its input has the joint stand.
        sides: by pose, 1 or -1 by its load, 0 where nothing loads it.
    """

    joint: str
    turn: str
    flank: str
    readings: Mapping[str, Measure]
    sides: Mapping[str, int]


def drives_of(scene: Scene, model: Model) -> Iterator[JointDrive]:
    """The joints of a scene that trains turn.

    Poses in which a joint stands alike are one reading. A chain that lacks a pose of another one stands in its first.

    Raises:
        SceneError: a train that turns two joints.
    """
    driven: dict[str, str] = {}
    for name, spec in scene.of(OpenChainSpec).items():
        stands = {pose: pose if pose in spec.poses else next(iter(spec.poses)) for pose in pose_names(scene)}
        sides = {pose: loaded_sides(scene, spec, own) for pose, own in stands.items()}
        for joint, own in spec.joints.items():
            if own.train is None:
                continue
            if before := driven.get(own.train):
                words = f"expected a train that turns one joint, got {own.train!r}, which turns {before!r} too"
                raise scene.refuse(("moves", name, "joints", joint, "train"), words)
            driven[own.train] = joint
            readings = {
                pose: reading_at(model, own.train, joint, spec.poses[at][joint].internal) for pose, at in stands.items()
            }
            its = {pose: found[joint] for pose, found in sides.items()}
            yield JointDrive(joint, turn_name(name, joint), flank_name(joint), readings, its)


def with_inputs(scene: Scene, inputs: Mapping[str, float]) -> Scene:
    """The scene with one more pose of its chains, AS_SET, in which all measures are read.

    Args:
        scene: of an assembly.
        inputs: of joints [deg]; others stand as in the first pose of their chain.
    """
    moves = dict(scene.moves)
    for name, spec in scene.of(OpenChainSpec).items():
        first = next(iter(spec.poses.values()))
        own = {joint: Quantity(inputs[joint], "deg") if joint in inputs else first[joint] for joint in spec.joints}
        moves[name] = spec.model_copy(update={"poses": {**spec.poses, AS_SET: own}})
    return scene.model_copy(update={"moves": moves, "measures": read_in(scene, AS_SET)})


def reading_at(model: Model, train: str, joint: str, angle: float) -> Measure:
    """The lost motion of all teeth of a train, at its output where that stands at an angle [rad]."""
    own = model.train(train)
    kind = lost_motion(model, own, own.output, "lost_motion", default_reading)
    rate = float(model.layout.shaft_turn[own.output].rate)
    return jumping(model, Measure(f".{joint} at {angle:.12g}", kind, Positions("at", 1, 1, angle / rate), "value"))
