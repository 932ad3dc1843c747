"""Loops of a scene: their structure, positions in a pose, draws."""

from collections.abc import Iterator, Mapping, Sequence
from weakref import WeakKeyDictionary

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
from tol3d.assembly.model.feature import nominal_size
from tol3d.assembly.zones.float_draw import FloatDraw
from tol3d.errors import InputError
from tol3d.linkage.grammar.close_loop import STEP, CloseLoopSpec
from tol3d.linkage.grammar.inputs import PathSpec, PlacePoseSpec, TiltPoseSpec
from tol3d.linkage.grammar.joints import (
    ClearanceSpec,
    PlaySpec,
    RandomFloatSpec,
    RollingSpec,
    ScrewSpec,
    TowardFloatSpec,
)
from tol3d.linkage.kinematics import Kinematics, Position, UnreachedError, rotation
from tol3d.linkage.loop import ClosedLoop, InputDeviation, LoopInput
from tol3d.linkage.play import InBall, JointPlay
from tol3d.linkage.structure import FREEDOMS, KINDS, Joint, Output, Structure, structured
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.system.draw import Ball, Scalar
from tol3d.system.plain import UNITS, PlainContributor
from tol3d.units import Quantity

Array = NDArray[np.float64]

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


class _Known:
    """Known data of the loops of a scene: kinematics by the places of other parts, positions by pose."""

    def __init__(self) -> None:
        self.kinematics: dict[tuple[str, bytes], Kinematics] = {}
        self.positions: dict[tuple[str, bytes, str], Position] = {}


_KNOWN: WeakKeyDictionary[Understood, _Known] = WeakKeyDictionary()


def loop_of(spec: CloseLoopSpec, name: str, setting: Setting) -> ClosedLoop:
    """A loop in a pose.

    Raises:
        SceneError: it does not close, is held twice or not at all, or does not reach the pose.
    """
    understood, drawn, pose = setting.understood, setting.drawn, setting.pose
    plays = {joint: play for joint, own in spec.joints.items() if (play := _play(joint, own.room, drawn)) is not None}
    others = {part_of(feature) for _, feature in spec.targets()} | {
        own.carrier.partition(".")[0] for own in spec.joints.values() if isinstance(own, RollingSpec)
    }
    if spec.output is not None:
        others.add(part_of(spec.output.from_))
    placed = {part: setting.poses[part] for part in sorted(others - set(spec.bodies))}
    known = _KNOWN.setdefault(understood, _Known())
    key = name, b"".join(own.tobytes() for own in placed.values())
    if key not in known.kinematics:
        known.kinematics[key] = kinematics_of(spec, name, understood, placed, plays)
    kinematics = known.kinematics[key]
    position = _position(spec, name, understood.scene, kinematics, pose, known.positions, key)
    stations = {
        each: _position(spec, name, understood.scene, kinematics, each, known.positions, key)
        for each in spec.pose_names
    }
    errors = _deviations(spec, kinematics, position, drawn)
    return ClosedLoop(name, kinematics, position, inputs_of(spec), stations, plays, errors)


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
        found = Kinematics(structure, placed, nominal)
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
    size = nominal_size(drawing.kind(feature).shape)
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
    for words, moved in kinematics.idle_freedoms():
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


def _position(
    spec: CloseLoopSpec,
    name: str,
    scene: Scene,
    kinematics: Kinematics,
    pose: str,
    known: dict[tuple[str, bytes, str], Position],
    key: tuple[str, bytes],
) -> Position:
    """Position of a loop in a pose, found from the pose before it on a path, or from the drawn one."""
    if not pose:
        return kinematics.drawn
    if (*key, pose) in known:
        return known[*key, pose]
    path, _, number = pose.partition(STEP)
    own = spec.poses[path]
    try:
        if isinstance(own, PathSpec):
            k = int(number)
            first, last, share = _leg(own, k)
            ends = [_position(spec, name, scene, kinematics, each, known, key) for each in (first, last)]
            if share in (0.0, 1.0):
                found = ends[int(share)]
            else:
                for before in range(k):  # one by one, for each begins at the one before
                    if (*key, f"{path}{STEP}{before}") not in known:
                        _position(spec, name, scene, kinematics, f"{path}{STEP}{before}", known, key)
                found = _between(spec, kinematics, (first, last), ends, share, known[*key, f"{path}{STEP}{k - 1}"])
        else:
            found = _reached(spec, kinematics, pose, kinematics.drawn)
    except UnreachedError as error:
        words = f"expected a pose that the loop reaches, got {pose.replace(STEP, ' ')!r}; it gets as far as "
        at = error.position
        got = ", ".join(f"{each} {told}" for each, told in _told(spec, kinematics, at).items())
        raise scene.refuse(
            ("moves", name, "poses", path), f"{words}{got}, then it is singular or reaches no further"
        ) from None
    _refuse_out_of_range(spec, name, scene, kinematics, pose, found)
    known[*key, pose] = found
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
    first, last = (spec.poses[name] for name in names)
    if isinstance(first, TiltPoseSpec) and isinstance(last, TiltPoseSpec):
        tilts = [kinematics.tilt_at(own) for own in ends]
        return kinematics.at_output(tilts[0] + share * (tilts[1] - tilts[0]), start)
    if isinstance(first, PlacePoseSpec) and isinstance(last, PlacePoseSpec):
        frames = [_frame(own) for own in (first, last)]
        turned = np.array([[own.internal for own in (each.turned or ())] or [0.0] * 3 for each in (first, last)])
        found = np.eye(4)
        found[:3, :3] = rotation(turned[0] + share * (turned[1] - turned[0]))
        found[:3, 3] = frames[0][:3, 3] + share * (frames[1][:3, 3] - frames[0][:3, 3])
        return kinematics.at_place(found, start)
    inputs = [kinematics.inputs_at(own) for own in ends]
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


def _refuse_out_of_range(
    spec: CloseLoopSpec, name: str, scene: Scene, kinematics: Kinematics, pose: str, at: Position
) -> None:
    for each, own in inputs_of(spec).items():
        value = own.as_placed + kinematics.inputs_at(at)[each]
        if own.range is not None and not own.range[0] - TINY <= value <= own.range[1] + TINY:
            low, high = (own.told(limit - own.as_placed) for limit in own.range)
            words = f"expected {each!r} from {low} to {high}, got {own.told(value - own.as_placed)}"
            at_position = f", at position {pose.partition(STEP)[2]} of the path" if STEP in pose else ""
            raise scene.refuse(("moves", name, "poses", pose.partition(STEP)[0]), words + at_position)


def _told(spec: CloseLoopSpec, kinematics: Kinematics, at: Position) -> Mapping[str, str]:
    """Inputs and the output where a loop stands, in words."""
    values = kinematics.inputs_at(at)
    found = {name: own.told(values[name]) for name, own in inputs_of(spec).items()}
    if spec.output is not None and spec.output.tilt is not None:
        x, y = kinematics.tilt_at(at)
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
