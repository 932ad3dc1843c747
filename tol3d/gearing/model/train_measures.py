"""Measures of trains: lost motion at a shaft, its effect on a point of an arm, the point's error over a swing."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tol3d.gearing.grammar.measures import LostMotionSpec, TipDisplacementSpec, TipErrorSpec, TipMeasureSpec
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
from tol3d.gearing.model.mesh_measures import Reader, measured, reader_of
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.networks import Network, Walk
from tol3d.gearing.model.reversals import of_reversals
from tol3d.gearing.model.slides import slides_along, with_shared_slides
from tol3d.gearing.model.trains import gravity_torque, refuse_incomparable
from tol3d.gearing.shafts import Arm, Train
from tol3d.scene import Scene
from tol3d.scene.direction import At, RandomOrFixed
from tol3d.study.system.positions import Positions


@measured.register
def _(spec: LostMotionSpec, scene: Scene, name: str, model: Model) -> Measure:
    train = model.train(spec.of)
    shaft = spec.shaft or train.output
    if model.layout.root_of.get(shaft) != train.driven:
        raise scene.refuse(("measures", name, "shaft"), f"expected a shaft that {train.driven!r} turns, got {shaft!r}")
    refuse_incomparable(scene, ("measures", name, "shaft"), model.layout, train.driven, shaft)
    if shaft == train.held:
        raise scene.refuse(("measures", name), f"expected another shaft than the one that is held, got {shaft!r}")
    kind = lost_motion(model, train, shaft, "lost_motion", reader_of(spec))
    return Measure(name, kind, one_position(spec.over), "value")


def lost_motion(
    model: Model, train: Train, shaft: str, quantity: TrainQuantity, read: Reader, tip: Tip | None = None
) -> LostMotion:
    """Lost motion of a train at one of its shafts, its meshes read by `read`."""
    path = model.layout.load_path(train.held, shaft)
    stages = tuple(_stage(model, element, (shaft, train.held), read) for element in path)
    slides = slides_along(model, path)
    stages = tuple(
        replace(stage, slides=slides[stage.link]) if isinstance(stage, Stage) and stage.link in slides else stage
        for stage in stages
    )
    return LostMotion(quantity, train.name, shaft, train.held, with_shared_slides(model, stages), tip)


def _stage(model: Model, element: Link | Parallel, ends: tuple[str, str], read: Reader) -> AnyStage:
    """A link or load paths in parallel, read at a shaft while another one is held."""
    if isinstance(element, Network):
        return network_stage(model, element, ends[0], read)
    layout = model.layout
    ratio = float(layout.freed_turn(element.driven, *ends))
    if isinstance(element, Parallel):
        within = (element.driven, element.driver)
        paths = tuple(tuple(_stage(model, inner, within, read) for inner in path) for path in element.paths)
        return ParallelStage(element.name, abs(ratio), element.driver, element.driven, paths, 1 if ratio > 0.0 else -1)
    return _single(model, element, ratio, read)


def _single(model: Model, link: Link, ratio: float, read: Reader) -> Stage:
    """A link that turns the shaft that is read by a ratio, signed, for a turn of its driven shaft."""
    mesh = model.mesh_of(link.name)
    if mesh is None:
        own = model.link(link.name)
        return Stage(link.name, abs(ratio), None, 1 if ratio > 0.0 else -1, own.has_middle, own.compares)
    _, carried = model.layout.carrying[mesh.driven]
    backlash = Backlash("angular_backlash", mesh.name, mesh.driven, of_reversals(model, mesh, read(mesh)))
    return Stage(link.name, abs(ratio), backlash, carried.sense if ratio > 0.0 else -carried.sense)


def network_stage(model: Model, element: Network, shaft: str, read: Reader) -> ParallelStage:
    """Load paths that share links, read at a shaft beyond the last of theirs."""
    turns = model.layout.ratio

    def along(walk: Walk) -> tuple[Stage, ...]:
        return tuple(
            _single(model, link, sense * float(turns(element.driven, link.driven)), read) for link, sense in walk
        )

    ratio = float(turns(shaft, element.driven))
    paths, loops = (tuple(along(walk) for walk in walks) for walks in (element.walks, element.loops))
    sense = 1 if ratio > 0.0 else -1
    return ParallelStage(element.name, abs(ratio), element.driver, element.driven, paths, sense, loops=loops)


def one_position(over: RandomOrFixed) -> Positions:
    """The position of the train's driven shaft: random or at an angle."""
    if isinstance(over, At):
        return Positions("at", 1, 1, over.at.internal)
    return Positions("random", 1, 1)


@measured.register
def _(spec: TipDisplacementSpec, scene: Scene, name: str, model: Model) -> Measure:
    arm = arm_of(scene, name, spec, model)
    tip, read = tip_of(arm, spec.point), reader_of(spec)
    kind = lost_motion(model, model.train(spec.of), arm.on, "tip_displacement", read, tip)
    return Measure(name, kind, one_position(spec.over), "value")


def arm_of(scene: Scene, name: str, spec: TipMeasureSpec, model: Model) -> Arm:
    """The arm that a measure is read on.

    Raises:
        SceneError: it does not move with the train.
    """
    arm = next(arm for arm in model.arms if arm.name == spec.arm)
    train = model.train(spec.of)
    if model.layout.root_of.get(arm.on) != train.driven or arm.on == train.held:
        raise scene.refuse(
            ("measures", name, "arm"),
            f"expected an arm on a shaft that moves where {train.held!r} is held, such as {train.output!r}, got "
            f"{spec.arm!r}, which hangs on {arm.on!r}",
        )
    refuse_incomparable(scene, ("measures", name, "arm"), model.layout, train.driven, arm.on)
    return arm


def tip_of(arm: Arm, point: str) -> Tip:
    """A point of an arm."""
    return Tip(arm.name, point, arm.lever(point))


SAME_ANGLE = 1e-9  # rad; a load change at an end of a swing is not within it


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
    """Error of a tip over angles of the output [rad], within which gravity changes sense.

    Args:
        model, train: the train and its model.
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
    """Zeros of gravity's torque, a cos(angle) + b sin(angle), within a swing [rad]."""
    a, b = (gravity_torque(train, model.layout, model.arms, angle) or 0.0 for angle in (0.0, math.pi / 2))
    if not a and not b:
        return
    first = math.atan2(-a, b)
    turns = range(math.ceil((swing[0] - first) / math.pi), math.floor((swing[1] - first) / math.pi) + 1)
    yield from (first + turn * math.pi for turn in turns)


def _turned(torques: list[float]) -> tuple[bool, ...]:
    """Flags of positions with another sense of the torque than at the start; without torque the flanks stay."""
    first = math.copysign(1.0, next((torque for torque in torques if torque), 1.0))
    turned, now = [], first
    for torque in torques:
        now = math.copysign(1.0, torque) if torque else now
        turned.append(now != first)
    return tuple(turned)
