"""Measures of a scene: what is read, over which positions. One function a sort of measure."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import singledispatch

import numpy as np

from tol3d.gearing.grammar.measures import (
    AngularBacklashSpec,
    CircumferentialBacklashSpec,
    LostMotionSpec,
    MeasureSpec,
    NormalBacklashSpec,
    TipDisplacementSpec,
    TipErrorSpec,
)
from tol3d.gearing.model.links import Link, Parallel
from tol3d.gearing.model.measure import (
    AnyStage,
    Backlash,
    LostMotion,
    Measure,
    ParallelStage,
    Stage,
    Tip,
    TrainQuantity,
)
from tol3d.gearing.model.mesh import Mesh
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.readings import Reader, reader_of, refuse_idle_teeth
from tol3d.gearing.model.shafts import Arm, Train
from tol3d.gearing.model.trains import gravity_torque, refuse_midst
from tol3d.scene import Scene
from tol3d.scene.direction import At
from tol3d.system.positions import Positions

BacklashSpec = NormalBacklashSpec | CircumferentialBacklashSpec | AngularBacklashSpec

SAME_ANGLE = 1e-9  # rad; a load that changes sides at an end of a swing does not on it


def measure_of(scene: Scene, name: str, model: Model) -> Measure:
    """A measure of a scene on its model, which has all but its measures.

    Raises:
        SceneError: a shaft or an arm that is not on the train, a swing without a load, one tooth that is out of action.
    """
    spec = scene.measures[name]
    measure = _measure(spec, scene, name, model)
    refuse_idle_teeth(scene, ("measures", name, "tooth"), measure, model)
    return replace(
        measure,
        lower_limit=None if spec.lower_limit is None else spec.lower_limit.internal,
        upper_limit=None if spec.upper_limit is None else spec.upper_limit.internal,
    )


@singledispatch
def _measure(spec: MeasureSpec, scene: Scene, name: str, model: Model) -> Measure:
    raise TypeError(f"measures.py has no function for {type(spec).__name__}")


@_measure.register(NormalBacklashSpec)
@_measure.register(CircumferentialBacklashSpec)
@_measure.register(AngularBacklashSpec)
def _(spec: BacklashSpec, scene: Scene, name: str, model: Model) -> Measure:
    mesh = model.mesh(spec.of)
    gear = getattr(spec, "gear", None) or mesh.driven
    return Measure(
        name, Backlash(spec.kind, mesh.name, gear, reader_of(spec)(mesh)), _positions_of_mesh(spec, mesh), spec.take
    )


def _positions_of_mesh(spec: BacklashSpec, mesh: Mesh) -> Positions:
    if isinstance(spec.over, At):
        return Positions("at", 1, 1, spec.over.at.internal)
    if spec.over == "random":
        return Positions("random", mesh.pair.long_period_turns, 1)
    turns = 1 if spec.over == "turn" else mesh.pair.long_period_turns
    return Positions(spec.over, turns, turns * spec.positions)


# trains -------------------------------------------------------------------------------------------


@_measure.register
def _(spec: LostMotionSpec, scene: Scene, name: str, model: Model) -> Measure:
    train = model.train(spec.of)
    shaft = spec.shaft or train.output
    if model.layout.root_of.get(shaft) != train.driven:
        raise scene.refuse(("measures", name, "shaft"), f"expected a shaft that {train.driven!r} turns, got {shaft!r}")
    refuse_midst(scene, ("measures", name, "shaft"), model.layout, train.driven, shaft)
    if shaft == train.held:
        raise scene.refuse(("measures", name), f"expected another shaft than the one that is held, got {shaft!r}")
    kind = lost_motion(model, train, shaft, "lost_motion", reader_of(spec))
    return Measure(name, kind, _positions(spec), "value")


@_measure.register
def _(spec: TipDisplacementSpec, scene: Scene, name: str, model: Model) -> Measure:
    arm = _arm(scene, name, spec, model)
    tip, read = _tip(arm, spec.point), reader_of(spec)
    kind = lost_motion(model, model.train(spec.of), arm.on, "tip_displacement", read, tip)
    return Measure(name, kind, _positions(spec), "value")


@_measure.register
def _(spec: TipErrorSpec, scene: Scene, name: str, model: Model) -> Measure:
    train, arm = model.train(spec.of), _arm(scene, name, spec, model)
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
    plain = lost_motion(model, train, train.output, "tip_error", reader_of(spec), _tip(arm, spec.point))
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


def lost_motion(
    model: Model,
    train: Train,
    shaft: str,
    quantity: TrainQuantity,
    read: Reader,
    tip: Tip | None = None,
) -> LostMotion:
    """What a train's links leave free at one of its shafts, its meshes read as `read` says."""
    stages = tuple(_stage(model, element, shaft, read) for element in model.layout.way(train.held, shaft))
    return LostMotion(quantity, train.name, shaft, train.held, stages, tip)


def _stage(model: Model, element: Link | Parallel, shaft: str, read: Reader) -> AnyStage:
    """A link or several parallel ways, read at a shaft."""
    layout = model.layout
    if isinstance(element, Parallel):
        ratio = float(layout.ratio(shaft, element.driven))
        ways = tuple(tuple(_stage(model, inner, element.driven, read) for inner in way) for way in element.ways)
        return ParallelStage(element.name, abs(ratio), element.driver, element.driven, ways, 1 if ratio > 0.0 else -1)
    ratio = float(layout.ratio(shaft, element.driven))
    mesh = next((mesh for mesh in model.meshes if mesh.name == element.name), None)
    if mesh is None:
        return Stage(element.name, abs(ratio), None)
    _, carried = layout.carrying[mesh.driven]
    backlash = Backlash("angular_backlash", mesh.name, mesh.driven, read(mesh))
    return Stage(element.name, abs(ratio), backlash, carried.sense if ratio > 0.0 else -carried.sense)


def _arm(scene: Scene, name: str, spec: TipDisplacementSpec | TipErrorSpec, model: Model) -> Arm:
    arm = next(arm for arm in model.arms if arm.name == spec.arm)
    train = model.train(spec.of)
    if model.layout.root_of.get(arm.on) != train.driven or arm.on == train.held:
        raise scene.refuse(
            ("measures", name, "arm"),
            f"expected an arm on a shaft that moves where {train.held!r} is held, such as {train.output!r}, got "
            f"{spec.arm!r}, which hangs on {arm.on!r}",
        )
    refuse_midst(scene, ("measures", name, "arm"), model.layout, train.driven, arm.on)
    return arm


def _tip(arm: Arm, point: str) -> Tip:
    return Tip(arm.name, point, arm.lever(point))


def _positions(spec: LostMotionSpec | TipDisplacementSpec) -> Positions:
    if isinstance(spec.over, At):
        return Positions("at", 1, 1, spec.over.at.internal)
    return Positions("random", 1, 1)


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
