"""Builds of gears in a housing as they are shown: seated gears, and the features of the parts around them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.assembly.presenting.shown_assembly import RIGID, Placed, bodies, placed_in
from tol3d.assembly.presenting.symbols import unnamed
from tol3d.errors import RunError
from tol3d.gearing.machine.system import MachineSystem
from tol3d.gearing.presenting.gear_display import GearDisplay
from tol3d.gearing.shown.display import seated_build
from tol3d.numerics.arrays import Array
from tol3d.report.body import World
from tol3d.report.motion import Motion
from tol3d.report.presenter import View
from tol3d.study.results.replaying import Replay
from tol3d.study.system.stated import magnified

COLOURS: Final = ("#9AA7B4", "#BFA58E", "#9DB5A6", "#B4A5BE")
"""Colours of housings and other parts: greyer than those of shafts and their gears."""


@dataclass(frozen=True, eq=False)
class ShownMachine:
    """Implements Display.

    Args:
        gears: at rest on the axes that the bores of the build give.
        system: whose build it is.
        placed: the parts around them in the first pose, in their own world.
        poses: the parts in every pose, where there are some.
    """

    gears: GearDisplay
    system: MachineSystem
    placed: Placed
    poses: Mapping[str, Placed] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """See Display."""
        return self.gears.label

    @property
    def notes(self) -> tuple[str, ...]:
        """See Display."""
        return (*self.gears.notes, *([RIGID] if self.placed.has_solids else []))

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """The parts in every pose; then the worlds of the gears, each with the parts around them."""
        up = self.system.up
        posed = (
            World(
                pose,
                bodies(own, COLOURS),
                points=own.points,
                up=up,
                features=own.features,
                measured=own.measured,
            )
            for pose, own in self.poses.items()
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
        return self.gears.motions

    def motion(self, name: str, frames: int | None) -> Motion:
        """The gears move, the parts around them are left out; see `tol3d.report.motion.Movable`."""
        return self.gears.motion(name, frames)

    def view(self, close_up: str | None) -> View:
        """The whole gearbox; with a mesh named, that mesh close up as in any train."""
        if close_up is not None:
            return self.gears.view(close_up)
        return View(notes=unnamed(self.placed.assembly))


def shown(seen: Replay, label: str, *, magnify: float) -> ShownMachine:
    """A build that was replayed, its deviations magnified as far as the teeth allow.

    Raises:
        InputError, RunError: it cannot be shown.
    """
    build = seated_build(seen, label, magnify=magnify)
    system = seen.simulation.system
    assert isinstance(system, MachineSystem)
    trials = seen.trials if build.magnify == 1.0 else magnified(system, seen.trials, build.magnify)
    poses = {}
    for pose, own in system.poses.items():
        placed = placed_in(own.assembly, system.in_pose(trials.part(0, 1), pose))
        if placed is None:
            raise RunError(f"{label}: cannot be shown: {seen.status}")
        poses[pose] = placed
    return ShownMachine(GearDisplay(build), system, next(iter(poses.values())), poses if "" not in poses else {})
