"""Frames of a loop's joints, nominally and in trials, as its kernel reads them."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.linkage.joint_motions import ROLLING
from tol3d.assembly.linkage.structure import ROOT, Step, Structure
from tol3d.assembly.placing.poses import IDENTITY, Pose

Array = NDArray[np.float64]


def joint_frames(
    structure: Structure, pose_of: Callable[[str], Pose], plays: Mapping[str, Pose]
) -> tuple[list[Pose], list[Pose]]:
    """Frames by their slots, on the body before and on the one after; see `loops_closed`.

    Args:
        structure: the loop.
        pose_of: of a feature its frame: in the world where its part is placed, else in its body.
        plays: by joint, how the frame before lies in its play.
    """
    base, child = [IDENTITY] * structure.slots, [IDENTITY] * structure.slots
    for k, own in enumerate(structure.steps):
        rest = Pose.of(structure.rest(own.joint))
        before = pose_of(own.joint.on)
        if own.joint.name in plays:
            before = before @ plays[own.joint.name]
        after = pose_of(own.joint.of)
        in_tree = k < len(structure.tree)
        if own.reverse:
            base[own.frame], child[own.frame] = after @ rest.inverse, before.inverse
        elif in_tree:
            base[own.frame], child[own.frame] = before, rest @ after.inverse
        else:
            base[own.frame], child[own.frame] = before, after @ rest.inverse
        if own.joint.kind == ROLLING:
            base[own.frame + 1] = _carried(structure, own, pose_of)
    return base, child


def _carried(structure: Structure, step: Step, pose_of: Callable[[str], Pose]) -> Pose:
    """The frame on a carrier of the gear that it carries."""
    carrier, there = step.joint.carrier, structure.carried(step.joint)
    if "." in carrier:
        return pose_of(carrier) @ Pose.of(np.linalg.inv(structure.world(carrier)) @ there)
    if step.carrier == ROOT:
        return Pose.of(there)
    return Pose.of(np.linalg.inv(structure.drawn[carrier]) @ there)


def stacked(poses: list[Pose]) -> Array:
    """Poses of several slots as a kernel reads them (n or 1, slots, 3, 4)."""
    trials = max(max(pose.turn.shape[-1], pose.shift.shape[-1]) for pose in poses)
    found = np.empty((trials, len(poses), 3, 4))
    for k, own in enumerate(poses):
        found[:, k, :, :3] = np.moveaxis(own.turn, -1, 0)
        found[:, k, :, 3] = own.shift.T
    return found
