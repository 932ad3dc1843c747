"""Builds of assemblies as shown: each part's features at their places in the trial."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product
from typing import Final

import numpy as np

from tol3d.assembly.model import Assembly
from tol3d.assembly.placing import method as placing
from tol3d.assembly.posed import PosedSystem
from tol3d.assembly.presenting.measured_lines import arrow_factor, measured_lines
from tol3d.assembly.presenting.symbols import (
    joined_symbols,
    labels,
    mark_counts,
    marks_on_solid,
    reach_of,
    symbol_counts,
    unnamed,
)
from tol3d.assembly.system import AssemblySystem
from tol3d.errors import InputError, RunError
from tol3d.numerics.arrays import Array
from tol3d.report import body
from tol3d.report.body import Body, MeasuredLine, World, built_body
from tol3d.report.motion import Frame, Look, Motion, Shot, around, corner
from tol3d.report.presenter import View, Which
from tol3d.study.results.replaying import Replay, build_of, enlarged
from tol3d.study.runs.run import Run
from tol3d.study.runs.worst import worst_trial

COLOURS: Final = ("#4682B4", "#CD853F", "#6B8E23", "#B22222", "#8470FF", "#2F8F8F", "#C71585", "#708090")
THIN: Final = 1 / 120
"""Fraction of the assembly's size: thickness of symbols; a sixth of it is the radius of the rods that join those of a
part."""
DEFLECTION: Final = 0.05
"""mm; deflection of triangles from the faces of solids: the same in all trials, as meshes are built once."""
OPACITY: Final = 0.3
"""Opacity of solids, so that their features and their inside are visible."""
ALIKE: Final = 1e-6
"""mm, and in rotations; places that differ by less are one."""
FRAMES: Final = 25
"""Frames of a path by default."""
HALVINGS: Final = 10
"""Halvings of the range of magnifications: 1/1024 of it."""
RIGID: Final = "solids keep the shape that is drawn: what deviates on them is shown by the symbols of their features"


@dataclass(frozen=True, eq=False)
class Placed:
    """An assembly in a trial.

    Args:
        assembly: the assembly.
        frames: of its features in the world (4, 4).
        poses: of its parts in the world (4, 4).
    """

    assembly: Assembly
    frames: Mapping[str, Array]
    poses: Mapping[str, Array]

    def seen_from(self, into: Array) -> "Placed":
        """The same in another world, by a pose (4, 4)."""
        frames = {name: into @ frame for name, frame in self.frames.items()}
        return Placed(self.assembly, frames, {name: into @ pose for name, pose in self.poses.items()})

    def stands_as(self, other: "Placed") -> bool:
        """True if all parts stand as they do in another, to a nanometre."""
        return all(np.allclose(own, other.poses[name], rtol=0.0, atol=ALIKE) for name, own in self.poses.items())

    @property
    def size(self) -> float:
        """Diagonal of the box about its features [mm]."""
        return float(np.linalg.norm(np.ptp([frame[:3, 3] for frame in self.frames.values()], axis=0)))

    @property
    def has_solids(self) -> bool:
        """True if any part has a solid."""
        return any(part.solid is not None for part in self.assembly.parts)

    @property
    def points(self) -> Mapping[str, Array]:
        """Points of features that are named in pictures (3,) [mm], by label."""
        return {label: self.frames[name][:3, 3] for name, label in labels(self.assembly).items()}

    @property
    def features(self) -> Mapping[str, body.Placed]:
        """Named features, as a world has them."""
        named = {name: own for name, own in self.assembly.features.items() if own.is_named}
        return {name: body.Placed(own.part, self.frames[name], reach_of(own.shape)) for name, own in named.items()}

    @property
    def measured(self) -> Mapping[str, tuple[MeasuredLine, ...]]:
        """Lines of measures, as a world has them."""
        return measured_lines(self.assembly, self.frames, self.poses)


@dataclass(frozen=True)
class ShownAssembly:
    """Implements Display.

    Args:
        label: what it is.
        placed: the assembly in the trial.
        notes: notes for the user.
        seen: the build, with its deviations as they are magnified.
        magnify: factor of its deviations.
    """

    label: str
    placed: Placed
    notes: tuple[str, ...] = ()
    seen: Replay | None = None
    magnify: float = 1.0

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """One world a pose; the features that matter most are named."""
        system = self._posed
        if system is None:
            return (self._world("assembly", self.placed),)
        return tuple(self._world(pose or "assembly", own) for pose, own in self._in_poses)

    @cached_property
    def _in_poses(self) -> Sequence[tuple[str, Placed]]:
        """The build in every pose of its scene in which it is built."""
        assert self._posed is not None
        return self._in(self._posed.pose_names)

    @cached_property
    def _enlarged(self) -> float:
        placed = [own for _, own in self._in_poses] if self._posed is not None else [self.placed]
        return arrow_factor([own.measured for own in placed], self.placed.size)

    def _world(self, name: str, placed: Placed) -> World:
        return World(
            name,
            bodies(placed),
            points=placed.points,
            up=(0.0, 0.0, 1.0),
            features=placed.features,
            measured=placed.measured,
            magnify=self.magnify,
            enlarged=self._enlarged,
        )

    @property
    def _posed(self) -> PosedSystem | None:
        """The system of an assembly that is read in several poses."""
        system = self.seen.simulation.system if self.seen is not None else None
        return system if isinstance(system, PosedSystem) else None

    def _in(self, poses: Sequence[str]) -> Sequence[tuple[str, Placed]]:
        """The build in some poses, as far as it is built there."""
        system, seen = self._posed, self.seen
        assert system is not None
        assert seen is not None
        found = []
        for pose, own in system.in_poses(poses).items():
            if (placed := placed_in(own.assembly, seen.trials.deviations[:1])) is not None:
                found.append((pose, placed))
        return found

    @property
    def motions(self) -> tuple[str, ...]:
        """The paths of its moves; see `tol3d.report.motion.Movable`."""
        return tuple(self._posed.paths) if self._posed is not None else ()

    @property
    def travels(self) -> tuple[str, ...]:
        """All of them; see `tol3d.report.motion.Travelling`."""
        return self.motions

    def motion(self, name: str, frames: int | None) -> Motion:
        """Along a path, there and back; see `tol3d.report.motion.Movable`."""
        system = self._posed
        assert system is not None
        path = system.paths[name]
        count = min(frames or FRAMES, len(path))
        chosen = [path[k] for k in np.linspace(0, len(path) - 1, count).round().astype(int)]
        placed = self._in(list(dict.fromkeys(chosen)))
        if not placed:
            raise InputError(f"--motion: {self.label} cannot be assembled anywhere on {name}")
        world, shown = self.worlds[0], []
        for pose, own in placed:
            words = f"{name}: {pose.rpartition('|')[2]} of {len(path) - 1}"
            stop = next((stated for stated, there in self._in_poses if there.stands_as(own)), "")
            shown.append(Frame(words, moved_from(self._in_poses[0][1], own, world), stop=stop))
        look = seen_whole(world, [frame.poses for frame in shown])
        notes = () if len(placed) == len(set(chosen)) else ("it cannot be assembled in all poses of the path",)
        return Motion(world, tuple(shown), (Shot(name, (look,)),), back=True, notes=notes)

    def view(self, close_up: str | None) -> View:
        """The world, its parts named."""
        if close_up is not None:
            raise InputError(f"nothing of an assembly is shown close up, not {close_up}")
        return View(notes=unnamed(self.placed.assembly))


def display(run: Run, which: Which, *, magnify: float) -> ShownAssembly:
    """A build of a run; for the worst that cannot be assembled the worst of the others, as a note then says.

    Raises:
        RunError: it could not be assembled.
    """
    seen, label = build_of(run, which)
    notes: tuple[str, ...] = ()
    if which == "worst" and placed_by(seen) is None:
        other = worst_trial(run, seated_only=True)
        words = f"{label.replace('-', ' ')} is worse, and cannot be shown: {seen.status}"
        notes = (f"{words}; trial {other} is the worst of those that could be assembled",)
        seen, label = build_of(run, other)
    return shown(seen, label, magnify=magnify, notes=notes)


def shown(seen: Replay, label: str, *, magnify: float, notes: tuple[str, ...] = ()) -> ShownAssembly:
    """A build that was replayed; its deviations magnified and its parts placed by them.

    Raises:
        RunError: it could not be assembled.
    """
    used = 1.0
    if magnify != 1.0:
        seen, used = _as_large(seen, magnify)
        beyond = "" if used == magnify else f", not {magnify:g}: beyond that they cannot be assembled"
        notes += (f"deviations {used:.3g} times as large{beyond}; parts are placed by them",)
    placed = placed_by(seen)
    if placed is None:
        raise RunError(f"{label}: cannot be shown: {seen.status}; take another trial, or smaller deviations")
    return ShownAssembly(label, placed, (*notes, *([RIGID] if placed.has_solids else [])), seen, used)


def _as_large(seen: Replay, wanted: float) -> tuple[Replay, float]:
    """A build with its deviations magnified as far as it can still be assembled, up to a factor, and that factor."""
    large = enlarged(seen, wanted)
    if placed_by(large) is not None or wanted < 1.0 or placed_by(seen) is None:
        return large, wanted
    low, high = 1.0, wanted
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if placed_by(enlarged(seen, middle)) is not None else (low, middle)
    return enlarged(seen, low), low


def placed_by(seen: Replay) -> Placed | None:
    """The assembly of a trial that was replayed; None where a move fails."""
    system = seen.simulation.system
    assert isinstance(system, AssemblySystem)
    return placed_in(system.assembly, seen.trials.deviations[:1])


def placed_in(assembly: Assembly, deviations: Array) -> Placed | None:
    """An assembly in one trial (1, width); None where a move fails."""
    return placed_each(assembly, deviations)[0]


def placed_each(assembly: Assembly, deviations: Array) -> Sequence[Placed | None]:
    """An assembly in each of some trials (trials, width); None where a move fails."""
    frames = placing.features_placed(assembly, deviations)
    poses = placing.placed(assembly, deviations)
    failed = np.any([np.isnan(own).any(axis=(1, 2)) for own in (*frames.values(), *poses.values())], axis=0)
    found = list[Placed | None]()
    for k, fails in enumerate(failed):
        here, there = ({name: own[k] for name, own in every.items()} for every in (frames, poses))
        found.append(None if fails else Placed(assembly, here, there))
    return found


def moved_from(first: Placed, own: Placed, world: World) -> Mapping[str, Array]:
    """Poses of bodies (4, 4) in a world, by name, where their parts stand otherwise.

    Args:
        first: the parts as the world has them.
        own: as they stand.
        world: the world.
    """
    return {
        part.name: own.poses[part.name] @ np.linalg.inv(first.poses[part.name]) @ part.world_from_part
        for part in world.bodies
    }


def seen_whole(world: World, frames: Sequence[Mapping[str, Array]]) -> Look:
    """A look from a corner at all bodies of a world, by name, in all poses (4, 4) that they have."""
    points = []
    for part in world.bodies:
        low, high = part.mesh[0].min(axis=0), part.mesh[0].max(axis=0)
        corners = np.array([[*place, 1.0] for place in product(*zip(low, high, strict=True))])
        moved = np.array([poses[part.name] for poses in frames]) @ np.linalg.inv(part.world_from_part)
        points.append((corners @ moved.transpose(0, 2, 1))[..., :3].reshape(-1, 3))
    every = np.concatenate(points)
    return around(every, (every.min(axis=0) + every.max(axis=0)) / 2, *corner(np.array(world.up)))


def bodies(placed: Placed, colours: Sequence[str] = COLOURS, deflection: float = DEFLECTION) -> tuple[Body, ...]:
    """A body a part: its solid with its features' symbols on it, or these alone where it has none.

    Args:
        placed: the parts.
        colours: of them in order, "#RRGGBB"; begun again when there are more parts.
        deflection: of triangles from the faces of solids [mm].
    """
    assembly, frames = placed.assembly, placed.frames
    places = np.array([frame[:3, 3] for frame in frames.values()])
    extents = [float(np.ptp(feature.shape.ends, axis=0).max()) for feature in assembly.features.values()]
    thickness = THIN * max(float(np.ptp(places, axis=0).max()), *extents)
    found = []
    for k, part in enumerate(assembly.parts):
        colour = colours[k % len(colours)]
        named = [(feature, frames[feature.name]) for feature in part.features if feature.is_named]
        if part.solid is None:
            surface = partial(joined_symbols, tuple(named), thickness)
            counts = partial(symbol_counts, tuple(named), thickness)
            found.append(Body(part.name, np.eye(4), surface, None, colour, features=counts))
            continue
        pose = placed.poses[part.name]
        own_frames = [(own, np.linalg.inv(pose) @ frame) for own, frame in named]
        body = built_body(part.name, part.solid, pose, colour, deflection=deflection)
        if own_frames:
            details = partial(marks_on_solid, tuple(own_frames), thickness)
            body = replace(body, details=details, features=partial(mark_counts, tuple(own_frames), thickness))
        found.append(replace(body, opacity=OPACITY))
    return tuple(found)
