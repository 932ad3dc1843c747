"""Error of a point of an arm over a swing, on which gravity may turn the load."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tol3d.gearing.grammar.measures import TipErrorSpec
from tol3d.gearing.model.measure import LostMotion, Measure
from tol3d.gearing.model.measures.lost_motion import lost_motion
from tol3d.gearing.model.measures.measured import measured
from tol3d.gearing.model.measures.tip_displacement import arm_of, tip_of
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.readings import reader_of
from tol3d.gearing.model.shafts import Train
from tol3d.gearing.model.trains import gravity_torque
from tol3d.scene import Scene
from tol3d.system.positions import Positions

SAME_ANGLE = 1e-9  # rad; a load that changes sides at an end of a swing does not on it


@measured.register
def _(spec: TipErrorSpec, scene: Scene, name: str, model: Model) -> Measure:
    train, arm = model.train(spec.of), arm_of(scene, name, spec, model)
    shown = tuple(np.linspace(spec.start.internal, spec.end.internal, spec.positions).tolist())
    if arm.on != train.output:
        raise scene.refuse(
            ("measures", name, "arm"), f"expected an arm on the output {train.output!r}, got one on {arm.on!r}"
        )
    torques = [gravity_torque(train, model.layout, model.arms, angle) for angle in (0.0, math.pi / 2)]
    if torques[0] is None:
        raise scene.refuse(
            ("measures", name), f"what turns the load over a swing is gravity: give {train.name!r} its direction"
        )
    if not any(torques):
        raise scene.refuse(
            ("measures", name),
            f"gravity does not turn {train.output!r} anywhere on this swing: its direction in the world, or the arm's "
            "centre of mass, lies along the axis",
        )
    plain = lost_motion(model, train, train.output, "tip_error", reader_of(spec), tip_of(arm, spec.point))
    return over_swing(model, train, plain, shown, name)


def over_swing(model: Model, train: Train, plain: LostMotion, shown: tuple[float, ...], name: str) -> Measure:
    """Error of a tip over angles of the output [rad], somewhere in which gravity turns it.

    Args:
        model, train: whose.
        plain: the lost motion at the output that moves the tip.
        shown: the angles.
        name: of the measure.
    """
    torques = [gravity_torque(train, model.layout, model.arms, angle) or 0.0 for angle in shown]
    ends = (shown[0] + SAME_ANGLE, shown[-1] - SAME_ANGLE)
    changes = tuple(load_changes(model, train, ends))
    kind = replace(plain, quantity="tip_error", turned=_turned(torques), changes=changes)
    rate = float(model.layout.shaft_turn[train.output].rate)  # the arm is put on at 0, the first shaft at 0
    positions = Positions("swing", 1, len(shown), angles=tuple(angle / rate for angle in shown), shown=shown)
    return Measure(name, kind, positions, "curve")


def load_changes(model: Model, train: Train, swing: tuple[float, float]) -> Iterator[float]:
    """Where on a swing gravity's torque, a cos(angle) + b sin(angle), goes through 0 [rad]."""
    a, b = (gravity_torque(train, model.layout, model.arms, angle) or 0.0 for angle in (0.0, math.pi / 2))
    if not a and not b:
        return
    first = math.atan2(-a, b)
    turns = range(math.ceil((swing[0] - first) / math.pi), math.floor((swing[1] - first) / math.pi) + 1)
    yield from (first + turn * math.pi for turn in turns)


def _turned(torques: list[float]) -> tuple[bool, ...]:
    """Where the torque has another sense than at the start; without torque the flanks stay where they were."""
    first = math.copysign(1.0, next((torque for torque in torques if torque), 1.0))
    turned, now = [], first
    for torque in torques:
        now = math.copysign(1.0, torque) if torque else now
        turned.append(now != first)
    return tuple(turned)
