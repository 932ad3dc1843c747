"""Loops of a scene: their structure, positions in a pose, draws."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.from_scene.features import poses_of
from tol3d.assembly.from_scene.setting import Setting, Understood
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import UsesFeatures, part_of
from tol3d.assembly.grammar.features.nominal_frame import Triple, unit
from tol3d.assembly.grammar.measures.assembly_measure import BetweenSpec
from tol3d.assembly.grammar.measures.clearance import ClearanceSpec as SolidClearanceSpec
from tol3d.assembly.grammar.measures.pose_errors import DirectionErrorSpec, OrientationErrorSpec, PoseErrorSpec
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.linkage.grammar.close_loop import STEP, CloseLoopSpec
from tol3d.assembly.linkage.grammar.inputs import PathSpec, PlacePoseSpec, TiltPoseSpec
from tol3d.assembly.linkage.grammar.joints import (
    ClearanceSpec,
    PlaySpec,
    RandomFloatSpec,
    RollingSpec,
    ScrewSpec,
    TowardFloatSpec,
)
from tol3d.assembly.linkage.kinematics import Kinematics, Position, UnreachedError, rotation
from tol3d.assembly.linkage.loop import ClosedLoop, InputDeviation, LoopInput
from tol3d.assembly.linkage.play import InBall, JointPlay
from tol3d.assembly.linkage.structure import FREEDOMS, KINDS, Joint, Output, Structure, structured
from tol3d.assembly.zones.float_draw import FloatDraw
from tol3d.errors import InputError
from tol3d.numerics.values import Valued
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.study.system.draw import Ball, Scalar
from tol3d.study.system.plain import UNITS, PlainContributor
from tol3d.units import Quantity

Array = NDArray[np.float64]

LOOPS: Final = 32
"""Loops that are kept: of the scenes read last."""
POSITIONS: Final = 1024
PATHS: Final = 8
"""Positions of loops that are kept, each some kB: in poses, and of whole paths."""
FLOAT = "float"
TINY = 1e-6
"""Motion of a feature, as a share of the largest, that is none."""


def float_name(joint: str) -> str:
    """The contributor of where in its play a joint lies."""
    return f"float of {joint}"


def clearance_name(joint: str) -> str:
    """The contributor of how large its play is."""
    return f"clearance of {joint}"


def deviation_name(deviation: str, of: str) -> str:
    """The contributor of a deviation of an input."""
    return f"{deviation} of {of}"


def contributors_of(spec: CloseLoopSpec, name: str, scene: Scene) -> Sequence[PlainContributor]:
    """Contributors of a loop: clearances and positions of joints in them, then deviations of inputs."""
    return tuple(_drawn(spec, scene))


def _drawn(spec: CloseLoopSpec, scene: Scene) -> Iterator[PlainContributor]:
    for joint, own in spec.joints.items():
        room = own.room
        if room is None:
            continue
        if room.distribution is not None:
            draw = Scalar(room.distribution.resolve(scene.files))
            yield PlainContributor(
                clearance_name(joint), "clearance", draw, description=f"clearance of {joint}", nominal="clearance"
            )
        if isinstance(room.floating, RandomFloatSpec):
            words = f"where {joint} lies in its clearance"
            ends = tuple(f"{end} {axis}" for end in ("start", "end") for axis in "xy")
            place = Ball(InBall()) if isinstance(room, ClearanceSpec) else FloatDraw(("disc", "disc"), ends)
            yield PlainContributor(float_name(joint), FLOAT, place, "1", 1.0, words)
    for of, given in spec.inputs.items():
        for key, each in given.deviations.items():
            law = Scalar(each.distribution.resolve(scene.files))
            unit_of, per = UNITS["angle" if each.is_angle else "length"]
            yield PlainContributor(deviation_name(key, of), "input", law, unit_of, per, each.description, nominal="")


@dataclass(frozen=True, eq=False)
class PosedLoop(Valued):
    """A loop with the poses that its scene names.

    Args:
        kinematics: with other parts where they lie.
        poses: in words, of which it is told from others.
        inputs: by name.
        spec: its entry.
    """

    kinematics: Kinematics
    poses: str
    inputs: Mapping[str, LoopInput]
    spec: CloseLoopSpec = field(compare=False)


@dataclass(frozen=True)
class _Asked:
    """A loop of a scene, and the places of other parts: their poses (4, 4) as bytes."""

    understood: Understood
    name: str
    placed: tuple[tuple[str, bytes], ...]
    spec: CloseLoopSpec = field(compare=False)


class UnfitPoseError(Exception):
    """A pose that a loop cannot take.

    Args:
        pose: as the scene names it, a step of a path too.
        words: why.
    """

    def __init__(self, pose: str, words: str) -> None:
        super().__init__(words)
        self.pose = pose


def loop_of(spec: CloseLoopSpec, name: str, setting: Setting) -> ClosedLoop:
    """A loop in a pose.

    Raises:
        SceneError: it does not close, is held twice or not at all, or does not reach the pose.
    """
    understood, drawn, pose = setting.understood, setting.drawn, setting.pose
    others = {part_of(feature) for _, feature in spec.targets()} | {
        joint.carrier.partition(".")[0] for joint in spec.joints.values() if isinstance(joint, RollingSpec)
    }
    if spec.output is not None:
        others.add(part_of(spec.output.from_))
    placed = tuple((part, setting.poses[part].tobytes()) for part in sorted(others - set(spec.bodies)))
    loop = _posed(_Asked(understood, name, placed, spec))
    try:
        position = _position(loop, pose)
        stations = {pose_name: _position(loop, pose_name) for pose_name in spec.pose_names}
    except UnfitPoseError as error:
        raise setting.scene.refuse(("moves", name, "poses", error.pose.partition(STEP)[0]), str(error)) from None
    errors = _deviations(spec, loop.kinematics, position, drawn)
    return ClosedLoop(name, loop.kinematics, position, loop.inputs, stations, _plays(spec, drawn), errors)


@lru_cache(maxsize=LOOPS)
def _posed(asked: _Asked) -> PosedLoop:
    """A loop of a scene that is read, in all of its poses."""
    spec, understood = asked.spec, asked.understood
    placed = {part: np.frombuffer(pose).reshape(4, 4) for part, pose in asked.placed}
    plays = _plays(spec, understood.effects.drawn.get(asked.name, {}))
    kinematics = kinematics_of(spec, asked.name, understood, placed, plays)
    return PosedLoop(kinematics, spec.model_dump_json(include={"poses"}), inputs_of(spec), spec)


@lru_cache(maxsize=LOOPS)
def _kept(kinematics: Kinematics) -> Kinematics:
    """The first of equal loops, with what is known of it."""
    return kinematics


def _plays(spec: CloseLoopSpec, drawn: Mapping[str, slice]) -> Mapping[str, JointPlay]:
    found = {joint: _play(joint, own.room, drawn) for joint, own in spec.joints.items()}
    return {joint: play for joint, play in found.items() if play is not None}


def _play(joint: str, room: ClearanceSpec | PlaySpec | None, drawn: Mapping[str, slice]) -> JointPlay | None:
    if room is None:
        return None
    by = drawn.get(clearance_name(joint))
    toward = unit(room.floating.along) if isinstance(room.floating, TowardFloatSpec) else None
    length = room.length.internal if isinstance(room, PlaySpec) else 0.0
    return JointPlay(
        room.diameter.internal / 2, -1 if by is None else by.start, drawn.get(float_name(joint)), toward, length
    )


def kinematics_of(
    spec: CloseLoopSpec,
    name: str,
    understood: Understood,
    placed: Mapping[str, Array],
    plays: Mapping[str, JointPlay],
) -> Kinematics:
    """A loop whose other parts lie at some poses (4, 4), closed as it is drawn.

    Raises:
        SceneError: it does not close, or is held twice or not at all.
    """
    scene, drawing = understood.scene, understood.drawing
    try:
        structure = _structure(spec, name, scene, drawing)
        nominal = {joint: play.nominal for joint, play in plays.items() if play.toward is not None}
        found = _kept(Kinematics(structure, placed, nominal))
        _ = found.drawn
    except InputError as error:
        path, _, words = str(error).partition(": ")
        raise scene.refuse(_keys(path, name, spec), words) from None
    _refuse_read_idle(spec, name, scene, drawing, found)
    return found


def _keys(path: str, name: str, spec: CloseLoopSpec) -> KeyPath:
    """A place in the scene from words such as `moves.drive.joints.upper 1`."""
    rest = path.removeprefix(f"moves.{name}").removeprefix(".")
    if not rest:
        return ("moves", name)
    section, _, joint = rest.partition(".")
    return ("moves", name, section, joint) if joint in spec.joints else ("moves", name, section)


def _structure(spec: CloseLoopSpec, name: str, scene: Scene, drawing: Drawing) -> Structure:
    joints = []
    for joint, own in spec.joints.items():
        lead = own.lead.internal / (2 * np.pi) if isinstance(own, ScrewSpec) else 0.0
        ratio, carrier = 0.0, ""
        if isinstance(own, RollingSpec):
            first, last = (_radius(drawing, feature) for feature in own.between)
            ratio, carrier = 1.0 + first / last, own.carrier
        on, of = own.between
        joints.append(Joint(joint, KINDS[own.kind], on, of, lead, ratio, carrier))
    named = {feature for own in joints for feature in own.features}
    output = None
    if spec.output is not None:
        output = Output(spec.output.of, spec.output.from_, spec.output.place is not None)
        named |= {output.of, output.on}
    named |= {feature for _, feature in _read_features(spec, name, scene)}
    inputs = {
        key: (own.of, FREEDOMS[KINDS[spec.joints[own.of].kind]].index(spec.coordinate_of(key)))
        for key, own in spec.inputs.items()
    }
    frames = {feature: drawing.kind(feature).frame for feature in named}
    length = None if spec.scale is None else spec.scale.internal
    return structured(name, spec.bodies, joints, inputs, output, poses_of(scene), frames, length)


def _radius(drawing: Drawing, feature: str) -> float:
    size = drawing.kind(feature).shape.nominal_size
    assert size is not None, "a sphere"
    return size / 2


def _read_features(spec: CloseLoopSpec, name: str, scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Features of the bodies that later moves and measures read, with their fields."""
    later = list(scene.moves)[list(scene.moves).index(name) + 1 :]
    entries: list[tuple[str, str, object]] = [("moves", own, scene.moves[own]) for own in later]
    entries += [("measures", own, entry) for own, entry in scene.measures.items()]
    for section, own, entry in entries:
        if isinstance(entry, UsesFeatures):
            for use in entry.uses():
                if part_of(use.name) in spec.bodies:
                    yield (section, own, *use.path), use.name


def _read_turns(spec: CloseLoopSpec, name: str, scene: Scene) -> Iterator[tuple[KeyPath, str, Triple | None]]:
    """Bodies whose turn is read, with the field: of a direction in the body, or of all of it where that is None."""
    for own, entry in scene.measures.items():
        if isinstance(entry, PoseErrorSpec | DirectionErrorSpec) and entry.from_ in spec.bodies:
            yield ("measures", own, "from"), entry.from_, None
        if isinstance(entry, OrientationErrorSpec) and part_of(entry.of) in spec.bodies:
            yield ("measures", own, "of"), part_of(entry.of), None
        if isinstance(entry, SolidClearanceSpec):
            for key, part in (("from", entry.from_), ("to", entry.to)):
                if part in spec.bodies:
                    yield ("measures", own, key), part, None
        if isinstance(entry, BetweenSpec) and entry.along is not None and part_of(entry.from_) in spec.bodies:
            yield ("measures", own, "from"), part_of(entry.from_), entry.along
    moves = scene.of(AssemblyMoveSpec)
    for own, move in list(moves.items())[list(moves).index(name) + 1 :]:
        for path, part in move.joined:
            if part in spec.bodies:
                yield ("moves", own, *path), part, None


def _refuse_read_idle(spec: CloseLoopSpec, name: str, scene: Scene, drawing: Drawing, kinematics: Kinematics) -> None:
    """Refuse to read a feature moved by a freedom that moves no joint, as its place is undefined."""
    own = kinematics.structure
    for words, moved in kinematics.idle_freedoms:
        size = max(np.abs(moved[:, :3]).max() * own.length, np.abs(moved[:, 3:]).max())
        told = f"which it leaves free: {words}"
        for path, feature in _read_features(spec, name, scene):
            body = own.body_of[part_of(feature)]
            frame = kinematics.drawn.poses[body] @ own.frames[feature]
            shift = moved[body, 3:] + np.cross(moved[body, :3], frame[:3, 3])
            turn = np.cross(moved[body, :3], frame[:3, 2]) * own.length
            if drawing.kind(feature).kind in ("point", "sphere"):
                turn = np.zeros(3)
            if max(np.abs(shift).max(), np.abs(turn).max()) > TINY * size:
                raise scene.refuse(path, f"expected a feature that the loop holds, got {feature!r}, {told}")
        for path, part, along in _read_turns(spec, name, scene):
            body = own.body_of[part]
            turn = moved[body, :3] * own.length
            if along is not None:
                turn = np.cross(turn, kinematics.drawn.poses[body, :3, :3] @ unit(along))
            if np.abs(turn).max() > TINY * size:
                raise scene.refuse(path, f"expected a part whose turn the loop holds, got {part!r}, {told}")


@lru_cache(maxsize=POSITIONS)
def _position(loop: PosedLoop, pose: str) -> Position:
    """Position of a loop in a pose.

    Raises:
        UnfitPoseError: the loop does not reach it.
    """
    path, is_on_path, number = pose.partition(STEP)
    if is_on_path:
        return _along(loop, path)[int(number)]
    drawn = loop.kinematics.drawn
    return _reaching(loop, pose, lambda: _reached(loop.spec, loop.kinematics, pose, drawn)) if pose else drawn


@lru_cache(maxsize=PATHS)
def _along(loop: PosedLoop, path: str) -> tuple[Position, ...]:
    """Positions of a loop along a path, each found from the one before; raises as `_position`."""
    own, found = loop.spec.poses[path], list[Position]()
    assert isinstance(own, PathSpec)
    for k in range(own.steps + 1):
        first, last, share = _leg(own, k)
        ends = [_position(loop, each) for each in (first, last)]
        start = found[-1] if found else ends[0]
        reach = partial(_between, loop.spec, loop.kinematics, (first, last), ends, share, start)
        found.append(_reaching(loop, f"{path}{STEP}{k}", reach))
    return tuple(found)


def _reaching(loop: PosedLoop, pose: str, reach: Callable[[], Position]) -> Position:
    """A position, or the sentence that says why a loop does not reach it, or leaves the range of an input."""
    try:
        found = reach()
    except UnreachedError as error:
        words = f"expected a pose that the loop reaches, got {pose.replace(STEP, ' ')!r}; it gets as far as "
        got = ", ".join(f"{each} {told}" for each, told in _told(loop, error.position).items())
        raise UnfitPoseError(pose, f"{words}{got}, then it is singular or reaches no further") from None
    for name, own in loop.inputs.items():
        value = own.as_placed + loop.kinematics.inputs_at(found)[name]
        if own.range is not None and not own.range[0] - TINY <= value <= own.range[1] + TINY:
            low, high = (own.told(limit - own.as_placed) for limit in own.range)
            words = f"expected {name!r} from {low} to {high}, got {own.told(value - own.as_placed)}"
            at_position = f", at position {pose.partition(STEP)[2]} of the path" if STEP in pose else ""
            raise UnfitPoseError(pose, words + at_position)
    return found


def _leg(path: PathSpec, k: int) -> tuple[str, str, float]:
    """The poses between which a position of a path lies, and its fraction of the way."""
    legs = len(path.path) - 1
    counts = [len(own) for own in np.array_split(np.arange(path.steps), legs)]
    for leg, count in enumerate(counts):
        if k <= count:
            return path.path[leg], path.path[leg + 1], k / count
        k -= count
    raise IndexError(k)


def _reached(spec: CloseLoopSpec, kinematics: Kinematics, pose: str, start: Position) -> Position:
    own = spec.poses[pose]
    if isinstance(own, TiltPoseSpec):
        return kinematics.at_output(tilt_vector(own.tilt.internal, own.azimuth.internal), start)
    if isinstance(own, PlacePoseSpec):
        return kinematics.at_place(_frame(own), start)
    assert not isinstance(own, PathSpec)
    return kinematics.at_inputs(_values(spec, own), start)


def tilt_vector(tilt: float, azimuth: float) -> tuple[float, float]:
    """The rotation vector (x, y) that tilts z towards an azimuth [rad]."""
    return -tilt * float(np.sin(azimuth)), tilt * float(np.cos(azimuth))


def _frame(pose: PlacePoseSpec) -> Array:
    found = np.eye(4)
    found[:3, 3] = [own.internal for own in pose.at]
    if pose.turned is not None:
        found[:3, :3] = rotation(np.array([own.internal for own in pose.turned]))
    return found


def _values(spec: CloseLoopSpec, pose: Mapping[str, Quantity]) -> Mapping[str, float]:
    """Inputs from where parts are placed [mm or rad]."""
    return {name: value.internal - as_placed(spec, name) for name, value in pose.items()}


def as_placed(spec: CloseLoopSpec, name: str) -> float:
    """An input as parts are placed [mm or rad]."""
    own = spec.inputs[name].as_placed
    return 0.0 if own is None else own.internal


def _between(
    spec: CloseLoopSpec,
    kinematics: Kinematics,
    names: tuple[str, str],
    ends: Sequence[Position],
    share: float,
    start: Position,
) -> Position:
    """Position between two poses: by the output if both name it, else by the inputs."""
    if share in (0.0, 1.0):
        return ends[int(share)]
    first, last = (spec.poses[name] for name in names)
    if isinstance(first, TiltPoseSpec) and isinstance(last, TiltPoseSpec):
        tilts = [kinematics.tilt_at(end) for end in ends]
        return kinematics.at_output(tilts[0] + share * (tilts[1] - tilts[0]), start)
    if isinstance(first, PlacePoseSpec) and isinstance(last, PlacePoseSpec):
        frames = [_frame(own) for own in (first, last)]
        turned = np.array([[own.internal for own in (each.turned or ())] or [0.0] * 3 for each in (first, last)])
        found = np.eye(4)
        found[:3, :3] = rotation(turned[0] + share * (turned[1] - turned[0]))
        found[:3, 3] = frames[0][:3, 3] + share * (frames[1][:3, 3] - frames[0][:3, 3])
        return kinematics.at_place(found, start)
    inputs = [kinematics.inputs_at(end) for end in ends]
    between = {name: own + share * (inputs[1][name] - own) for name, own in inputs[0].items()}
    return kinematics.at_inputs(between, start)


def inputs_of(spec: CloseLoopSpec) -> Mapping[str, LoopInput]:
    """Inputs of a loop."""
    return {
        name: LoopInput(
            own.of,
            spec.coordinate_of(name),
            as_placed(spec, name),
            None if own.range is None else (own.range[0].internal, own.range[1].internal),
        )
        for name, own in spec.inputs.items()
    }


def _told(loop: PosedLoop, at: Position) -> Mapping[str, str]:
    """Inputs and the output where a loop stands, in words."""
    values, output = loop.kinematics.inputs_at(at), loop.spec.output
    found = {name: own.told(values[name]) for name, own in loop.inputs.items()}
    if output is not None and output.tilt is not None:
        x, y = loop.kinematics.tilt_at(at)
        found["tilt"] = f"{np.degrees(np.hypot(x, y)):.6g} deg"
        found["azimuth"] = f"{np.degrees(np.arctan2(-x, y)) % 360.0:.6g} deg"
    return found


def _deviations(
    spec: CloseLoopSpec, kinematics: Kinematics, position: Position, drawn: Mapping[str, slice]
) -> Mapping[str, Sequence[InputDeviation]]:
    values, found = kinematics.inputs_at(position), dict[str, list[InputDeviation]]()
    for of, own in spec.inputs.items():
        for key, each in own.deviations.items():
            share = 1.0
            if each.is_angle and spec.dimension_of(of) == "length":
                assert own.lead is not None
                share *= own.lead.internal / (2 * np.pi)
            if each.per is not None:
                share *= values[of] / each.per.internal
            found.setdefault(of, []).append(InputDeviation(drawn[deviation_name(key, of)].start, share))
    return found
