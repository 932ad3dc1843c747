"""An assembly that is read in several poses, or over paths: one system each, with the same deviations."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from tol3d.assembly.grammar.checks import paths_of, pose_names, read_at, read_in
from tol3d.assembly.grammar.measures.assembly_measure import TimedSpec
from tol3d.assembly.methods import PlacingMethod
from tol3d.assembly.model import Assembly
from tol3d.assembly.model.statuses import OK, WITH_LOOPS
from tol3d.assembly.system import AssemblySystem, assembly_system, meaning_of
from tol3d.numerics.kept import kept
from tol3d.scene import Scene
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Answers, Codes, Method, MethodKind
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.plain import PlainMeasure
from tol3d.study.system.posable import AS_SET, Coordinate
from tol3d.study.system.positions import Positions
from tol3d.study.system.system import Columns, KeyPath
from tol3d.study.system.trials import Trials

Array = NDArray[np.float64]

LOOKED_AT: Final = 9
"""Poses of a path at which its nominal values are compared: the ends, and between them."""

POSES: Final = "poses"
"""The coordinate that goes through all poses of a scene."""

CLOSED_A_MINUTE: Final = 3_000_000
"""Poses of a drive of two loops that one core closes in a minute, both methods and their statistics included."""


@dataclass(frozen=True)
class PosedSystem(AssemblySystem):
    """Implements System.

    The assembly is that of the first pose.

    Args:
        poses: by name, the assembly there with the measures that are read in it; those of paths among them.
        at: of each measure, the poses in which it is read, in order.
        scene: its scene.
    """

    poses: Mapping[str, AssemblySystem] = field(default_factory=dict)
    at: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    scene: Scene | None = None

    @property
    def pose_names(self) -> Sequence[str]:
        """All poses of the scene."""
        return pose_names(self.scene) if self.scene is not None else tuple(self.poses)

    @property
    def paths(self) -> Mapping[str, Sequence[str]]:
        """All paths of the scene: by name the poses on them."""
        return paths_of(self.scene) if self.scene is not None else {}

    def in_poses(self, poses: Sequence[str]) -> Mapping[str, AssemblySystem]:
        """The assembly in some poses, also in those in which nothing is read."""
        scene, meaning = self.scene, None
        found = {}
        for pose in poses:
            if pose not in self.poses and scene is not None:
                meaning = meaning or meaning_of(scene)
                found[pose] = assembly_system(scene, pose, meaning)
            else:
                found[pose] = self.poses[pose]
        return found

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """See Posable: steps along its paths, then through its poses where they are several."""
        paths = tuple(Coordinate(name, 0.0, len(poses) - 1.0, "") for name, poses in self.paths.items())
        steps = {name: float(step) for step, name in enumerate(self.pose_names)}
        if len(steps) < 2 or POSES in self.paths:
            return paths
        return (*paths, Coordinate(POSES, 0.0, len(steps) - 1.0, "", steps))

    def shown_in(self, pose: str) -> "PosedSystem":
        """See Posable: all of its poses are at hand."""
        return self

    def standing(self, values: Mapping[str, float], measures: Sequence[str]) -> "PosedSystem":
        """See Posable."""
        assert self.scene is not None
        name, step = next(iter(values.items()))
        pose = {POSES: self.pose_names, **self.paths}[name][round(step)]
        own = assembly_system(self.scene.model_copy(update={"measures": read_in(self.scene, pose)}), pose)
        own = replace(own, measures=tuple(measure for measure in own.measures if measure.name in measures))
        here = {measure.name: (AS_SET,) for measure in own.measures}
        of_own = {each.name: getattr(own, each.name) for each in fields(own)}
        return PosedSystem(**of_own, poses={AS_SET: own}, at=here)

    @property
    @override
    def statuses(self) -> Statuses:  # type: ignore[override]
        """See System."""
        return WITH_LOOPS if has_loops(self.assembly) else super().statuses

    @property
    def _kinds(self) -> Mapping[str, Mapping[str, MethodKind]]:
        return {pose: own.methods for pose, own in self.poses.items()}

    @property
    def methods(self) -> Mapping[str, MethodKind]:  # type: ignore[override]
        """See System: those of any pose, one process each where solids are read."""
        found: dict[str, MethodKind] = {}
        for kinds in self._kinds.values():
            for name, kind in kinds.items():
                if name not in found or not kind.threads:
                    found[name] = self._timed(kind)
        return found

    def _timed(self, kind: MethodKind) -> MethodKind:
        if not kind.threads or not has_loops(self.assembly):
            return kind
        return replace(kind, contacts_per_minute=CLOSED_A_MINUTE, block_contacts=CLOSED_A_MINUTE)

    def _alone(self, measure: Measure) -> AssemblySystem:
        """The assembly in the first pose in which a measure is read."""
        return self.poses[self.at[measure.name][0]]

    def _named(self, measure: Measure, pose: str) -> Measure:
        return next(own for own in self.poses[pose].measures if own.name == measure.name)

    # its methods --------------------------------------------------------------------------------------

    def materials(self, method: str) -> Any:
        """See System: of each pose, where there are any."""
        found = {pose: own.materials(method) for pose, own in self.poses.items() if method in own.methods}
        return found if any(own is not None for own in found.values()) else None

    @override
    def method(self, name: str, materials: Any) -> Method:
        given = materials or {}
        own = {pose: each.method(name, given.get(pose)) for pose, each in self.poses.items() if name in each.methods}
        return PosedMethod(self.at, own)

    def cost(self, measures: Sequence[Measure]) -> int:
        """See System: as a contact for each pose."""
        return sum(len(self.at[measure.name]) for measure in measures)

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """See System: of paths in some of their poses."""
        looked = {pose for names in self.at.values() for pose in _some(names)}
        seen = set()
        for pose in self.poses:
            for problem in self.poses[pose].problems() if pose in looked else ():
                if problem[0] not in seen:
                    seen.add(problem[0])
                    yield problem

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """See AssemblySystem; and where it is read."""
        poses, found = self.at[measure.name], self._alone(measure).describe(measure)
        if measure.take == "value":
            return {**found, "pose": poses[0]} if poses[0] else found
        return {**found, "path": poses[0].partition("|")[0], "take": measure.take}

    @override
    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        return max(self.poses[pose].chord_bound(measure, chord_error) for pose in self.at[measure.name])

    # what acts on a measure -------------------------------------------------------------------------

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """See System: in any of its poses."""
        if measure.take == "value":
            return self._alone(measure).acting(measure)
        return self._acting_on(measure.name)

    @kept
    def _acting_on(self, name: str) -> Sequence[Contributor]:
        names = {own.name for pose in self.at[name] for own in self.poses[pose]._acting_on(name)}
        return [contributor for contributor in self.contributors if contributor.name in names]

    @override
    def regressor_key(self, measure: Measure) -> Hashable:
        if measure.take != "value":
            return measure.name
        return self.at[measure.name][0], self._alone(measure).regressor_key(measure)

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """See System: over a path as in the first of its poses in which a contributor acts."""
        waiting = {contributor.name: contributor for contributor in contributors}
        for pose in self.at[measure.name]:
            if not waiting:
                return
            system = self.poses[pose]
            its = [waiting.pop(own.name) for own in system.acting(measure) if own.name in waiting]
            if its:
                system.regress(self._named(measure, pose), its, columns, rows)

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        """See System: none over a path."""
        return self._alone(measure).closed_form(measure) if measure.take == "value" else None

    def reference_form(self, measure: Measure) -> ClosedForm | None:
        """See System: over a path in its last pose."""
        return self.poses[self.at[measure.name][-1]].closed_form(measure)


@dataclass(frozen=True)
class PosedMethod:
    """A method of an assembly in several poses; implements WitnessMethod where those of its poses do.

    Args:
        at: of each measure, the poses in which it is read.
        methods: by pose.
    """

    at: Mapping[str, tuple[str, ...]]
    methods: Mapping[str, Method]

    @property
    def chord_error(self) -> float:
        """See Method."""
        return max(method.chord_error for method in self.methods.values())

    def reads(self, measure: Measure) -> bool:
        """See WitnessMethod."""
        own: Any = [self.methods.get(pose) for pose in self.at[measure.name]]
        return all(each is not None and each.reads(measure) for each in own)

    def bounds(self, measure: Measure) -> tuple[float, float]:
        """See WitnessMethod."""
        methods: Any = [self.methods[pose] for pose in self.at[measure.name]]
        own = [method.bounds(measure) for method in methods]
        return max(each for each, _ in own), max(each for _, each in own)

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Method: a trial without a value in one pose of a path has none."""
        values = {own.name: np.empty((len(trials), len(self.at[own.name]))) for own in measures}
        status: dict[str, Codes] = {}
        details: dict[str, NDArray[np.generic]] = {}
        wanted: dict[str, list[tuple[Measure, int]]] = {}
        for measure in measures:
            for k, pose in enumerate(self.at[measure.name]):
                wanted.setdefault(pose, []).append((measure, k))
        several = {own.name for own in measures if len(self.at[own.name]) > 1}
        kept = dict[int, dict[str, Any]]()
        for pose, its in wanted.items():
            method, there = self.methods[pose], [measure for measure, _ in its]
            if isinstance(method, PlacingMethod):
                found = method.answers_in_pose(trials, there, kept)
            else:
                found = method.answers(trials, there)
            for measure, k in its:
                values[measure.name][:, k] = found.values[measure.name][:, 0]
                if (codes := found.status.get(measure.name)) is not None:
                    before = status.get(measure.name)
                    status[measure.name] = codes if before is None else np.where(before == OK, codes, before)
            details |= {name: own for name, own in found.details.items() if not several or "|" not in pose}
        for name in several & status.keys():
            values[name][status[name] != OK] = np.nan
        return Answers(values, details=details, status=status)


def has_loops(assembly: Assembly) -> bool:
    """True if moves close loops, which then have statuses of their own."""
    return any(move.acts.closes_loops for move in assembly.moves)


def _some(poses: Sequence[str]) -> Sequence[str]:
    """Some of many poses, the ends among them."""
    if len(poses) <= LOOKED_AT:
        return poses
    return [poses[k] for k in np.linspace(0, len(poses) - 1, LOOKED_AT).round().astype(int)]


def system_of(scene: Scene) -> AssemblySystem:
    """System of a scene of an assembly, in all poses in which it is read.

    Raises:
        SceneError: see `assembly_system`.
    """
    paths, names = paths_of(scene), pose_names(scene)
    if not paths and not names:
        return assembly_system(scene)
    at = {name: read_at(scene, name) for name in scene.measures}
    poses = dict.fromkeys((*names[:1], *(pose for own in at.values() for pose in own)))
    meaning = meaning_of(scene)
    systems = {pose: assembly_system(scene, pose, meaning) for pose in poses}
    first = next(iter(systems.values()))
    known = {name: _measure(scene, name, systems[own[0]], len(own)) for name, own in at.items()}
    of_first = {each.name: getattr(first, each.name) for each in fields(first)}
    return PosedSystem(**{**of_first, "measures": tuple(known.values())}, poses=systems, at=at, scene=scene)


def _measure(scene: Scene, name: str, system: AssemblySystem, count: int) -> PlainMeasure:
    own = next(measure for measure in system.measures if measure.name == name)
    spec = scene.measures[name]
    if not isinstance(spec, TimedSpec) or spec.over is None:
        return own
    positions = Positions("swing", 1, max(count - 1, 1), angles=tuple(float(k) for k in range(count)), in_turn=True)
    return replace(
        own, positions=positions, take=spec.take, adds_up=False, worse="high" if spec.take == "max" else own.worse
    )
