"""Builds of gears in a housing as they are shown: seated gears, and the features of the parts around them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Final

import numpy as np

from tol3d.assembly.presenting.measured_lines import arrow_factor
from tol3d.assembly.presenting.shown_assembly import RIGID, Placed, bodies, placed_in
from tol3d.assembly.presenting.symbols import unnamed
from tol3d.cad.solids import PosedBody
from tol3d.cad.solids.posed_gear import ArmBody
from tol3d.errors import InputError, RunError
from tol3d.gearing.machine.joined import HIDDEN
from tol3d.gearing.machine.methods import WorstMeasure
from tol3d.gearing.machine.presenting.arm_motion import POSES, Arm, arm_motion
from tol3d.gearing.machine.presenting.trains_in_joints import COARSE, TrainInJoint, trains_in_joints
from tol3d.gearing.machine.system import MachineSystem
from tol3d.gearing.presenting.gear_display import GearDisplay
from tol3d.gearing.shown.display import require_factor, seated_build
from tol3d.numerics.arrays import Array
from tol3d.report.body import Body, MeasuredLine, World
from tol3d.report.motion import Motion
from tol3d.report.presenter import View
from tol3d.study.results.replaying import Replay
from tol3d.study.system.stated import magnified
from tol3d.study.system.trials import Trials

COLOURS: Final = ("#9AA7B4", "#BFA58E", "#9DB5A6", "#B4A5BE")
"""Colours of housings and other parts: greyer than those of shafts and their gears."""
STICK: Final = 1 / 100
"""Diameter of the stick that stands for a link without a solid in a STEP file, as a fraction of the arm's size."""


@dataclass(frozen=True, eq=False)
class ShownMachine:
    """Implements Display.

    Args:
        gears: at rest on the axes that the bores of the build give.
        system: whose build it is.
        placed: the parts around them in the first pose, in their own world.
        poses: the parts in every pose, where there are some.
        magnify: factor of the deviations of the parts in them.
        trials: the build, without magnification.
        trains: that turn joints, as they are shown in poses.
    """

    gears: GearDisplay
    system: MachineSystem
    placed: Placed
    poses: Mapping[str, Placed] = field(default_factory=dict)
    magnify: float = 1.0
    trials: Trials | None = None
    trains: tuple[TrainInJoint, ...] = ()

    @property
    def label(self) -> str:
        """See Display."""
        return self.gears.label

    @property
    def notes(self) -> tuple[str, ...]:
        """See Display: beyond what teeth allow parts in poses are magnified alone."""
        rigid = [RIGID] if self.placed.has_solids else []
        if self.magnify == self.gears.build.magnify:
            return (*self.gears.notes, *rigid)
        return (
            f"deviations magnified {self.magnify:g} times",
            *(f"of the gears by themselves: {note}" for note in self.gears.notes),
            *rigid,
        )

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """The parts in every pose; then the worlds of the gears, each with the parts around them."""
        posed = (
            replace(world, within={train.name: train.placed(own) for train in self.trains})
            for world, own in zip(_posed(self.system, self.poses, self.magnify), self.poses.values(), strict=True)
        )
        return (*posed, *(self._with_parts(world) for world in self.gears.worlds))

    def _with_parts(self, world: World) -> World:
        into = self._world_from_parts(world.name)
        if into is None:
            return world
        placed = self.placed.seen_from(into)
        points = {**world.points, **placed.points}
        return replace(
            world,
            bodies=(*world.bodies, *bodies(placed, COLOURS)),
            points=points,
            one_file=True,
            features=placed.features,
            measured={**world.measured, **placed.measured},
        )

    def _world_from_parts(self, name: str) -> Array | None:
        """Pose of the world of the parts in that of a train, or of a mesh; None if the train has no bores."""
        layout = self.system.gears.model.layout
        if name in layout.root_of:
            root, own = layout.root_of[name], np.eye(4)
        else:
            mesh = self.system.gears.model.mesh(name)
            root, own = layout.root_of[layout.carrying[mesh.driver][0]], layout.world_from_mesh[name]
        there = self.system.worlds.get(root)
        return None if there is None else np.asarray(np.linalg.inv(there @ own))

    @property
    def motions(self) -> tuple[str, ...]:
        """See `tol3d.report.motion.Movable`."""
        return (*self.travels, *self.gears.motions)

    @property
    def travels(self) -> tuple[str, ...]:
        """That of an arm; see `tol3d.report.motion.Travelling`."""
        return (POSES,) if self.poses and self.system.turns else ()

    def motion(self, name: str, frames: int | None) -> Motion:
        """An arm moves, or the gears do, without the parts around them; see `tol3d.report.motion.Movable`."""
        if name == POSES:
            assert self.trials is not None
            first = next(iter(self.poses.values()))
            arm = Arm(self.system, self.trials, self.magnify, self.worlds[0], first, self.trains)
            return arm_motion(arm, frames)
        return self.gears.motion(name, frames)

    def view(self, close_up: str | None) -> View:
        """The whole gearbox; with a mesh named, that mesh close up as in any train."""
        if close_up is not None:
            return self.gears.view(close_up)
        return View(notes=unnamed(self.placed.assembly))


@dataclass(frozen=True, eq=False)
class ShownParts:
    """Implements Display: the parts of a machine in one pose, without its gears.

    Args:
        label, notes: see Display.
        world: of the parts.
    """

    label: str
    notes: tuple[str, ...]
    world: World

    @property
    def worlds(self) -> tuple[World, ...]:
        """See Display."""
        return (self.world,)

    def view(self, close_up: str | None) -> View:
        """See Display."""
        if close_up is not None:
            raise InputError(f"nothing of parts in a pose is shown close up, not {close_up}")
        return View()


def _posed(system: MachineSystem, poses: Mapping[str, Placed], magnify: float) -> tuple[World, ...]:
    """The parts in poses; a largest error is read in each as its size in that pose."""
    lines = {pose: _lines(system, pose, placed) for pose, placed in poses.items()}
    factor = arrow_factor(lines.values(), next(iter(poses.values())).size) if poses else 1.0
    return tuple(
        World(
            pose,
            tuple(_with_stick(body, placed) for body in bodies(placed, COLOURS, COARSE)),
            points=placed.points,
            up=system.up,
            features=placed.features,
            measured=lines[pose],
            magnify=magnify,
            enlarged=factor,
        )
        for pose, placed in poses.items()
    )


def _lines(system: MachineSystem, pose: str, placed: Placed) -> Mapping[str, tuple[MeasuredLine, ...]]:
    """Lines of the measures of a scene that are read in a pose; of errors on any flanks parts do not stand so."""
    found = dict(placed.measured)
    for measure in system.measures:
        own = dict(measure.sizes).get(pose) if isinstance(measure, WorstMeasure) else None
        if own in found and not measure.any_flank:
            found[measure.name] = found[own]
    return {name: own for name, own in found.items() if not name.startswith(HIDDEN)}


def _with_stick(body: Body, placed: Placed) -> Body:
    """A body that has no solid with a stick through its features for STEP files; others as they are."""
    return body if body.posed is not None else replace(body, posed=partial(_stick, body.name, placed))


def _stick(name: str, placed: Placed) -> PosedBody:
    """From the part's frame through its features, one after the other along the line that they follow most."""
    places = np.array([frame[:3, 3] for frame in placed.frames.values()])
    pose = placed.poses[name]
    own = [
        placed.frames[feature.name] for part in placed.assembly.parts if part.name == name for feature in part.features
    ]
    points = np.array([(np.linalg.inv(pose) @ frame)[:3, 3] for frame in own] or [np.zeros(3)])
    along = np.linalg.svd(points - points.mean(axis=0))[2][0]
    ordered = points[np.argsort(points @ along, kind="stable")]
    thick = STICK * float(np.linalg.norm(np.ptp(places, axis=0)))
    return PosedBody(f"{name} (stick)", ArmBody(tuple((x, y, z) for x, y, z in ordered.tolist()), thick), pose)


def shown(seen: Replay, label: str, *, magnify: float) -> ShownMachine | ShownParts:
    """A build that was replayed, its deviations magnified, in the worlds of gears as far as the teeth allow.

    Raises:
        InputError, RunError: it cannot be shown.
    """
    require_factor(magnify)
    system = seen.simulation.system
    assert isinstance(system, MachineSystem)
    if system.alone:
        parts = _in_poses(seen, label, magnify)[system.alone]
        notes = (f"deviations magnified {magnify:g} times",) if magnify != 1.0 else ()
        rigid = (RIGID,) if parts.has_solids else ()
        return ShownParts(label, (*notes, *rigid), *_posed(system, {system.alone: parts}, magnify))
    build = seated_build(seen, label, magnify=magnify)
    trials = seen.trials if build.magnify == 1.0 else magnified(system, seen.trials, build.magnify)
    if "" in system.poses:
        placed = placed_in(system.drawn.assembly, system.in_pose(trials.part(0, 1), ""))
        if placed is None:
            raise RunError(f"{label}: cannot be shown: {seen.status}")
        return ShownMachine(GearDisplay(build), system, placed)
    poses = _in_poses(seen, label, magnify)
    around = placed_in(system.drawn.assembly, system.in_pose(trials.part(0, 1), next(iter(poses))))
    return ShownMachine(
        GearDisplay(build),
        system,
        around or next(iter(poses.values())),
        poses,
        magnify,
        seen.trials.part(0, 1),
        trains_in_joints(seen.simulation),
    )


def _in_poses(seen: Replay, label: str, magnify: float) -> Mapping[str, Placed]:
    """The parts of a build in all poses, deviations and the turns of joints magnified.

    Raises:
        RunError: they cannot be placed.
    """
    system, found = seen.simulation.system, dict[str, Placed]()
    assert isinstance(system, MachineSystem)
    for pose, own in system.shown_poses.items():
        deviations = Trials(system.in_pose(seen.trials.part(0, 1), pose), {})
        placed = placed_in(own.assembly, magnified(own, deviations, magnify).deviations)
        if placed is None:
            raise RunError(f"{label}: cannot be shown: {seen.status}")
        found[pose] = placed
    return found
