"""Joints of parts as trains turn them: which lost motion decides, and which end of it a joint lies at, pose by pose."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from tol3d.assembly.grammar.checks import pose_names
from tol3d.gearing.model import Measure, Model
from tol3d.gearing.model.from_scene import jumping
from tol3d.gearing.model.mesh_measures import default_reading
from tol3d.gearing.model.train_measures import lost_motion
from tol3d.machine.grammar.open_chain import OpenChainSpec, flank_name, turn_name
from tol3d.machine.open_chains import loaded_sides
from tol3d.scene import Scene
from tol3d.system.positions import Positions

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


def reading_at(model: Model, train: str, joint: str, angle: float) -> Measure:
    """The lost motion of all teeth of a train, at its output where that stands at an angle [rad]."""
    own = model.train(train)
    kind = lost_motion(model, own, own.output, "lost_motion", default_reading)
    rate = float(model.layout.shaft_turn[own.output].rate)
    return jumping(model, Measure(f".{joint} at {angle:.12g}", kind, Positions("at", 1, 1, angle / rate), "value"))
