"""Builds of trains with planetary sets as they are shown: seated gears, shafts, and the sets between them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.display import replayed_build, replayed_of, seated_build
from tol3d.gearing.linked import link_contributors
from tol3d.gearing.links import LinkTrials
from tol3d.gearing.model import Model
from tol3d.gearing.placed import PlacedGear
from tol3d.gearing.presenting.gear_display import GearDisplay
from tol3d.gearing.presenting.moved_gears import TURN, whole_train
from tol3d.gearing.system import GearSystem, gear_model
from tol3d.planetary.presenting import shown_gears
from tol3d.planetary.shown import ShownSet
from tol3d.planetary.stage.set_link import SetLink
from tol3d.report.body import Body, World
from tol3d.report.motion import Motion
from tol3d.report.presenter import Display, View, Which
from tol3d.runs.run import Run
from tol3d.simulate import Replay, simulation_again
from tol3d.system.stated import magnified
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ShownTrain:
    """Implements Display.

    Args:
        gears: in meshes, at rest, and their shafts.
        model: whose build it is.
        trials: one, with its deviations as they are shown.
    """

    gears: GearDisplay
    model: Model
    trials: Trials

    @property
    def label(self) -> str:
        """See Display."""
        return self.gears.label

    @property
    def notes(self) -> tuple[str, ...]:
        """See Display."""
        jammed = (name for name, own in self._sets.items() if own[1])
        words = (f"{self.label}: {name} jams; shown where no backlash would have its gears" for name in jammed)
        return (*self.gears.notes, *words)

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """The worlds of the gears, each with the sets that its shafts drive."""
        return tuple(
            replace(own, bodies=(*own.bodies, *self._bodies(own.name)), one_file=True) for own in self.gears.worlds
        )

    def _bodies(self, root: str) -> Iterator[Body]:
        for name, (bodies, _) in self._sets.items():
            if self._root_of(self._links[name]) == root:
                yield from bodies

    @cached_property
    def _links(self) -> dict[str, SetLink]:
        return {link.name: link for link in self.model.links if isinstance(link, SetLink)}

    def _root_of(self, link: SetLink) -> str:
        """The first shaft of the train that drives it."""
        return self.model.layout.root_of[link.driver]

    @cached_property
    def _sets(self) -> dict[str, tuple[tuple[Body, ...], bool]]:
        """Bodies of each set in the world of its train, and whether it jams."""
        shown = {name: self._shown(link) for name, link in self._links.items()}
        return {name: (shown_gears.bodies_of(own), bool(own.status)) for name, own in shown.items()}

    def _shown(self, link: SetLink, beyond: float = 0.0) -> ShownSet:
        """A set in the world of its train, the first shaft turned by so much [rad] beyond the trial's position."""
        shown = link.shown(self._seen(link, beyond))
        into = self.model.layout.world_from_shaft[link.driver] @ _along_z(link.height)
        return replace(shown, gears=tuple(_moved(gear, into) for gear in shown.gears))

    def _seen(self, link: SetLink, beyond: float) -> LinkTrials:
        own = link_contributors(self.model, link.name)
        deviations = {each.name: self.trials.deviations[:, self.model.component_slices[each.name]] for each in own}
        further = beyond * float(self.model.layout.mesh_turn[link.name].rate)
        return LinkTrials(own, deviations, self.trials.positions[link.name][:, None] + further)

    @property
    def motions(self) -> tuple[str, ...]:
        """See `tol3d.report.motion.Movable`."""
        return self.gears.motions

    def motion(self, name: str, frames: int | None) -> Motion:
        """The first shaft turns once, sets with it; swinging they stand still. See `tol3d.report.motion.Movable`."""
        found = self.gears.motion(name, frames)
        if name != TURN:
            return replace(found, notes=(*found.notes, f"{', '.join(self._sets)}: stands still here"))
        world = next(own for own in self.worlds if own.name == found.world.name)
        driven = [link for link in self._links.values() if self._root_of(link) == world.name]
        turned = (
            replace(frame, poses={**frame.poses, **self._poses(driven, 2 * math.pi * place / len(found.frames))})
            for place, frame in enumerate(found.frames)
        )
        return replace(found, world=world, frames=tuple(turned), shots=(whole_train(world), *found.shots[1:]))

    def _poses(self, links: list[SetLink], beyond: float) -> dict[str, Array]:
        """Of the gears of sets, by their names; see _shown."""
        shown = (self._shown(link, beyond) for link in links)
        return {gear.name: gear.world_from_gear for own in shown for gear in own.gears}

    def view(self, close_up: str | None) -> View:
        """The whole train with its sets; with a mesh named, that mesh close up as in any train."""
        return View() if close_up is None else self.gears.view(close_up)


def display(run: Run, which: Which, *, magnify: float) -> Display:
    """A build of a run, of a train or of a set by itself; deviations magnified as far as the teeth of meshes allow.

    Raises:
        InputError, RunError: no such build, or one that cannot be shown.
    """
    if not isinstance(simulation_again(run).system, GearSystem):
        return shown_gears.display(run, which, magnify=magnify)
    build = seated_build(run, which, magnify=magnify)
    _, seen = replayed_of(run, which)
    return _shown(GearDisplay(build), seen, build.magnify)


def replayed(seen: Replay, label: str) -> Display:
    """A trial that was replayed.

    Raises:
        RunError: it is not built.
    """
    if not isinstance(seen.simulation.system, GearSystem):
        return shown_gears.replayed_display(seen, label)
    return _shown(GearDisplay(replayed_build(seen, label)), seen, 1.0)


def _shown(gears: GearDisplay, seen: Replay, magnify: float) -> ShownTrain:
    system = seen.simulation.system
    trials = seen.trials if magnify == 1.0 else magnified(system, seen.trials, magnify)
    return ShownTrain(gears, gear_model(system), trials)


def _moved(gear: PlacedGear, into: Array) -> PlacedGear:
    return replace(gear, world_from_gear=into @ gear.world_from_gear)


def _along_z(height: float) -> Array:
    pose = np.eye(4)
    pose[2, 3] = height
    return pose
