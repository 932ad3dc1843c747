"""Linkages as plain numbers: a scene of them as a text, and the loops that an oracle closes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from oracles.closed_loops import Loops, Pair, Poses, closed, displaced, facing, followed, pose
from scipy.spatial.transform import Rotation

from tol3d.assembly.model.statuses import OK
from tol3d.study.system.method import Answers
from tol3d.study.system.stated import component_count, component_slices, stated

Array = NDArray[np.float64]
Trial = tuple[Mapping[str, Array], Mapping[str, float]]
"""Deviations of features [mm], and of inputs [mm or rad]."""

AXES = ("x", "y", "z")
LAW = "{kind: normal, mean: 0 mm, sigma: 10 um}"
ANGLE = "{kind: normal, mean: 0 deg, sigma: 0.005 deg}"


def triple(vector: Sequence[float] | Array, unit: str = " mm") -> str:
    return "[" + ", ".join(f"{float(own)!r}{unit}" for own in vector) + "]"


@dataclass(frozen=True, eq=False)
class Feature:
    """A point, an axis or a sphere in its part (4, 4); how long or wide it is [mm]."""

    kind: str
    frame: Array
    size: float = 20.0

    @property
    def text(self) -> str:
        at, z = triple(self.frame[:3, 3]), triple(self.frame[:3, 2], "")
        match self.kind:
            case "axis":
                return f"{{kind: axis, at: {at}, axis: {z}, length: {self.size!r} mm}}"
            case "sphere":
                return f"{{kind: sphere, at: {at}, diameter: {self.size!r} mm}}"
        return f"{{kind: point, at: {at}, normal: {z}}}"

    def tolerances(self, name: str) -> Mapping[str, str]:
        """By name: an axis anywhere by both ends, else along each of the part's axes."""
        if self.kind == "axis":
            law = f"{{kind: process, distribution: {LAW}}}"
            return {name.replace(".", " "): f"{{kind: position, of: {name}, zone: {{diameter: 0.1 mm}}, law: {law}}}"}
        found = {}
        for k, axis in enumerate(AXES):
            along = triple(np.eye(3)[k], "")
            found[f"{name.replace('.', ' ')} {axis}"] = (
                f"{{kind: plus_minus, of: {name}, along: {along}, distribution: {LAW}}}"
            )
        return found

    def displaced(self, by: Array) -> Array:
        """Its place with its deviations (4 of an axis, else 3) [mm] (4, 4)."""
        found = self.frame.copy()
        if self.kind != "axis":
            found[:3, 3] += by
            return found
        lean = np.array([by[2] - by[0], by[3] - by[1], self.size])
        lean /= np.linalg.norm(lean)
        across = np.array([-lean[1], lean[0], 0.0])
        sine = np.linalg.norm(across)
        own = np.eye(4)
        if sine > 0.0:
            own = pose(across / sine * np.arctan2(sine, lean[2]), np.zeros(3))
        own[:3, 3] = (by[0] + by[2]) / 2, (by[1] + by[3]) / 2, 0.0
        return np.asarray(found @ own)


def point(at: Sequence[float] | Array, z: Sequence[float] | Array = (0.0, 0.0, 1.0)) -> Feature:
    return Feature("point", facing(z, at))


def axis(at: Sequence[float] | Array, z: Sequence[float] | Array, length: float = 20.0) -> Feature:
    return Feature("axis", facing(z, at), length)


def sphere(at: Sequence[float] | Array, diameter: float) -> Feature:
    return Feature("sphere", facing((0.0, 0.0, 1.0), at), diameter)


@dataclass(frozen=True, eq=False)
class Part:
    """Its place (4, 4) and its features."""

    placed: Array
    features: Mapping[str, Feature]


@dataclass(frozen=True, eq=False)
class Joint:
    """Between two features `part.name`; further fields as the scene has them."""

    kind: str
    on: str
    of: str
    lead: float = 0.0
    carrier: str = ""
    more: str = ""

    def text(self) -> str:
        lead = f", lead: {self.lead!r} mm" if self.lead else ""
        carrier = f", carrier: {self.carrier}" if self.carrier else ""
        return f"{{kind: {self.kind}, between: [{self.on}, {self.of}]{lead}{carrier}{self.more}}}"


@dataclass(frozen=True, eq=False)
class Linkage:
    """A loop between fixed parts; the first of those reads all.

    Args:
        parts: all, by name.
        fixed: those that stay.
        joints: by name.
        inputs: by name: the joint and which of its motions.
        probes: points of bodies that are read.
        poses: by name, the inputs [mm or rad].
        bodies: in the move's order; in that of the parts if not given.
        steps: in which the oracle goes to a pose.
    """

    parts: Mapping[str, Part]
    fixed: Sequence[str]
    joints: Mapping[str, Joint]
    inputs: Mapping[str, tuple[str, str]]
    probes: Sequence[str]
    poses: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    bodies: Sequence[str] = ()
    steps: int = 4

    @property
    def placed_bodies(self) -> Sequence[str]:
        return self.bodies or [name for name in self.parts if name not in self.fixed]

    def feature(self, name: str) -> Feature:
        part, _, own = name.partition(".")
        return self.parts[part].features[own]

    @property
    def held(self) -> Sequence[str]:
        """Features of joints, each once."""
        return list(dict.fromkeys(name for own in self.joints.values() for name in (own.on, own.of)))

    def is_slide(self, name: str) -> bool:
        return self.inputs[name][1] == "slide"

    # as a scene -------------------------------------------------------------------------------------

    def text(self, deviating: Sequence[str] | None = None, more: str = "") -> str:
        """The scene.

        Args:
            deviating: features with tolerances; all of the joints if not given.
            more: further moves.
        """
        lines = ["scene: linkage", "parts:"]
        for name, part in self.parts.items():
            at, z, x = (part.placed[:3, k] for k in (3, 2, 0))
            lines += [f"  {name}:", "    kind: solid"]
            lines += [f"    placed: {{at: {triple(at)}, z: {triple(z, '')}, x: {triple(x, '')}}}", "    features:"]
            lines += [f"      {key}: {own.text}" for key, own in part.features.items()]
        named = self.held if deviating is None else deviating
        lines += ["tolerances:"] if named else []
        for name in named:
            lines += [f"  {key}: {own}" for key, own in self.feature(name).tolerances(name).items()]
        lines += ["moves:"] + [f"  fix {name}: {{kind: fix, part: {name}}}" for name in self.fixed]
        lines += self.loop_lines("drive", self.placed_bodies, self.joints, self.inputs, self.poses)
        lines += [more] if more else []
        lines += ["measures:"]
        for where in self.poses or ("",):
            for probe in self.probes:
                when = f", at: {where}" if where else ""
                lines += [
                    f"  {self.measure(probe, k, where)}: {{kind: gap, from: {self.fixed[0]}.zero, to: {probe}, "
                    f"along: {triple(np.eye(3)[k], '')}{when}}}"
                    for k in range(3)
                ]
        return "\n".join([*lines, "study: {trials: 100}", ""])

    def loop_lines(
        self,
        name: str,
        bodies: Sequence[str],
        joints: Mapping[str, Joint],
        inputs: Mapping[str, tuple[str, str]],
        poses: Mapping[str, Mapping[str, float]],
    ) -> list[str]:
        lines = [f"  {name}:", "    kind: close_loop", f"    bodies: [{', '.join(bodies)}]", "    joints:"]
        lines += [f"      {key}: {own.text()}" for key, own in joints.items()]
        if inputs:
            lines += ["    inputs:"]
        for key, (joint, motion) in inputs.items():
            law = LAW if self.is_slide(key) else ANGLE
            lines += [
                f"      {key}: {{of: {joint}, coordinate: {motion}, deviations: {{zero: {{distribution: {law}}}}}}}"
            ]
        if poses:
            lines += ["    poses:"]
        for key, values in poses.items():
            said = (f"{name}: {value!r} {'mm' if self.is_slide(name) else 'rad'}" for name, value in values.items())
            lines += [f"      {key}: {{{', '.join(said)}}}"]
        return lines

    @staticmethod
    def measure(probe: str, k: int, where: str) -> str:
        return f"{probe.replace('.', ' ')} {AXES[k]}{f' at {where}' if where else ''}"

    # as loops of the oracle -------------------------------------------------------------------------

    @property
    def loops(self) -> Loops:
        bodies = {name: self.parts[name].placed for name in self.placed_bodies}
        pairs = {}
        for name, own in self.joints.items():
            (base, on), (frame, of) = self._end(own.on), self._end(own.of)
            ratio = 1.0 + self.feature(own.on).size / self.feature(own.of).size if own.kind == "rolling" else 0.0
            pairs[name] = Pair(own.kind, on, of, base, frame, own.lead, ratio, own.carrier or None)
        return Loops(bodies, pairs, self.inputs)

    def _end(self, name: str, frame: Array | None = None) -> tuple[Array, str | None]:
        part = name.partition(".")[0]
        own = self.feature(name).frame if frame is None else frame
        return (self.parts[part].placed @ own, None) if part in self.fixed else (own, part)

    def deviated(self, deviations: Mapping[str, Array]) -> Loops:
        """With features displaced in their parts, see Feature.displaced."""
        frames: dict[str, tuple[Array | None, Array | None]] = {}
        for name, own in self.joints.items():
            first, last = (
                self._end(end, self.feature(end).displaced(deviations[end]))[0] if end in deviations else None
                for end in (own.on, own.of)
            )
            frames[name] = first, last
        return displaced(self.loops, frames)

    def seen(self, poses: Poses) -> Array:
        """All probes in the frame of the first part, from its zero (probes, 3) [mm]."""
        first = self.parts[self.fixed[0]]
        into = np.linalg.inv(first.placed)
        found = []
        for probe in self.probes:
            part = probe.partition(".")[0]
            own = poses[part] if part in poses else self.parts[part].placed
            found.append((into @ own @ self.feature(probe).frame)[:3, 3] - first.features["zero"].frame[:3, 3])
        return np.array(found)

    def expected(self, where: str, trials: Sequence[Trial]) -> Array:
        """The oracle's places of the probes (trials, probes, 3) [mm]: the nominal pose, then the deviations."""
        wanted = self.poses.get(where, dict.fromkeys(self.inputs, 0.0))
        start = followed(self.loops, self.loops, wanted, self.steps)
        assert start is not None, "a pose that the linkage reaches"
        found = []
        for deviations, zeros in trials:
            off = {name: own + zeros.get(name, 0.0) for name, own in wanted.items()}
            poses = closed(self.loops, self.deviated(deviations), start, off)
            assert poses is not None, "deviations with which it closes"
            found.append(self.seen(poses))
        return np.stack(found)


@dataclass(frozen=True)
class Study:
    """A linkage as tol3d has it."""

    linkage: Linkage
    made: Assembled

    @property
    def system(self) -> Any:
        return self.made.system

    def columns(self, deviations: Mapping[str, Array], zeros: Mapping[str, float]) -> Array:
        """A trial's deviations (components,)."""
        slices = component_slices(self.system)
        row = np.zeros(component_count(self.system))
        for name, own in deviations.items():
            key = name.replace(".", " ")
            if self.linkage.feature(name).kind == "axis":
                row[slices[key]] = own
            else:
                for k, axis_name in enumerate(AXES):
                    row[slices[f"{key} {axis_name}"]] = own[k]
        for name, value in zeros.items():
            row[slices[f"zero of {name}"]] = value
        return row

    def answers(self, rows: Array, method: str = "exact") -> Answers:
        made = self.system.method(method, self.system.materials(method))
        found: Answers = made.answers(stated(self.system, rows), self.system.measures)
        return found

    def seen(self, rows: Array, where: str = "", method: str = "exact") -> Array:
        """All probes in trials (trials, probes, 3) [mm]; every one is built."""
        answers = self.answers(rows, method)
        assert all((codes == OK).all() for codes in answers.status.values())
        own = self.linkage
        return np.stack(
            [
                np.stack([answers.values[own.measure(probe, k, where)][:, 0] for k in range(3)], axis=-1)
                for probe in own.probes
            ],
            axis=1,
        )


def study_of(linkage: Linkage, folder: Path, deviating: Sequence[str] | None = None) -> Study:
    return Study(linkage, assembled(linkage.text(deviating), folder))


def random_deviations(linkage: Linkage, rng: np.random.Generator, size: float, angle: float) -> Trial:
    """Deviations of all features of joints [mm] and of all inputs [mm or rad]."""
    deviations = {
        name: size * rng.normal(size=4 if linkage.feature(name).kind == "axis" else 3) for name in linkage.held
    }
    zeros = {name: rng.normal() * (size if linkage.is_slide(name) else angle) for name in linkage.inputs}
    return deviations, zeros


def moved_rigidly(linkage: Linkage, by: Array) -> Linkage:
    """All parts placed elsewhere together."""
    return replace(linkage, parts={name: replace(own, placed=by @ own.placed) for name, own in linkage.parts.items()})


def drawn_elsewhere(linkage: Linkage, name: str, by: Array) -> Linkage:
    """A part whose coordinates are others; it lies where it was. Its features' x are others, too."""
    own = linkage.parts[name]
    frames = {key: by @ each.frame for key, each in own.features.items()}
    features = {
        key: replace(each, frame=facing(frames[key][:3, 2], frames[key][:3, 3])) for key, each in own.features.items()
    }
    return replace(linkage, parts={**linkage.parts, name: Part(own.placed @ np.linalg.inv(by), features)})


def random_pose(rng: np.random.Generator, reach: float) -> Array:
    return pose(Rotation.random(random_state=rng).as_rotvec(), reach * rng.normal(size=3))
