"""Chains of a scene: their joints where parts are placed, and on which side of its play gravity lays each."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from tol3d.assembly.from_scene.datums import frame_name
from tol3d.assembly.from_scene.features import poses_of
from tol3d.assembly.from_scene.setting import Setting
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.distributions.constant import Constant
from tol3d.machine.chain import Chain, Joint, forward
from tol3d.machine.either_side import EitherSide
from tol3d.machine.grammar.open_chain import FLANK, OpenChainSpec, flank_name, turn_name
from tol3d.scene import Scene
from tol3d.system.draw import Scalar
from tol3d.system.plain import UNITS, PlainContributor

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
    carried = tuple(part_of(own.between[0]) for own in spec.joints.values())
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
    masses = [(own.mass.internal, placed[own.of] @ [*(x.internal for x in own.at), 1.0], own.of) for own in spec.masses]
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
    """Joints with play that nothing loads in one of the poses."""
    sides = [loaded_sides(scene, spec, pose) for pose in spec.poses]
    trains = (name for name, own in spec.joints.items() if own.train is not None)
    return tuple(name for name in trains if any(own[name] == 0 for own in sides))
