"""A build of a planetary set as it is shown and exported: all gears in one world."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.gearing.display import replayed_of
from tol3d.gearing.links import LinkTrials, StatedLink
from tol3d.gearing.presenting.shown_train import ShownLink
from tol3d.gearing.presenting.whole_trains import gear_body
from tol3d.planetary.presenting.arms import arms_of
from tol3d.planetary.presenting.motions import motion, motions
from tol3d.planetary.set_link import SetLink
from tol3d.planetary.shown import ShownSet
from tol3d.report.body import Body, World
from tol3d.report.motion import Motion
from tol3d.report.presenter import View, Which
from tol3d.runs.run import Run
from tol3d.simulate import Replay, replayed
from tol3d.system.stated import magnified

CENTRALS, FORWARD, BACKWARD, PLANETS = "#E69F00", "#4682B4", "#009E73", "#4682B4"


@dataclass(frozen=True, eq=False)
class PlanetaryDisplay:
    """A build of a set; see `tol3d.report.presenter.Display`."""

    label: str
    shown: ShownSet
    notes: tuple[str, ...] = ()

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """One world with every gear, and the carrier where its pins fit in bores."""
        return (World(self.shown.own.name, (*bodies_of(self.shown), *arms_of(self.shown))),)

    @property
    def motions(self) -> tuple[str, ...]:
        """See `tol3d.report.motion.Movable`."""
        return motions(self.shown.own)

    def motion(self, name: str, frames: int | None) -> Motion:
        """See `tol3d.report.motion.Movable`."""
        return motion(self.shown, self.worlds[0], name, frames)

    def view(self, close_up: str | None) -> View:
        """All gears.

        Raises:
            InputError: a close-up was asked for.
        """
        if close_up is not None:
            raise InputError(f"--mesh: nothing of a planetary set is shown close up, not {close_up[:80]!r}")
        return View()


def bodies_of(shown: ShownSet) -> tuple[Body, ...]:
    """Every gear of a set, central gears and planets in their colours, planets by how springs push them."""
    own, colours = shown.own, [CENTRALS] * len(shown.own.meshes)
    for planet in range(own.planets):
        pushed = [spring.sense(planet) for spring in own.springs if spring.sense(planet)]
        colours += [BACKWARD if pushed and pushed[0] < 0 else FORWARD if pushed else PLANETS] * len(own.gears)
    return tuple(gear_body(gear, colour) for gear, colour in zip(shown.gears, colours, strict=True))


def shown_link(link: StatedLink, seen: LinkTrials, world_from_driver: NDArray[np.float64]) -> ShownLink:
    """A set in the world of its train; see ShowsLinks."""
    assert isinstance(link, SetLink)
    shown, above = link.shown(seen), np.eye(4)
    above[2, 3] = link.height
    into = world_from_driver @ above
    gears = tuple(replace(gear, world_from_gear=into @ gear.world_from_gear) for gear in shown.gears)
    note = f"{link.name} jams; shown where no backlash would have its gears" if shown.status else ""
    return ShownLink(bodies_of(replace(shown, gears=gears)), note)


def display(run: Run, which: Which, *, magnify: float) -> PlanetaryDisplay:
    """A build of a run.

    Raises:
        InputError: no such build, or a magnification with which it jams.
    """
    if not (math.isfinite(magnify) and magnify >= 0.0):
        raise InputError(f"magnify: expected a number of at least 0, got {magnify:g}")
    label, seen = replayed_of(run, which)
    if magnify == 1.0:
        return replayed_display(seen, label)
    again = replayed(seen.simulation, magnified(seen.simulation.system, seen.trials, magnify))
    shown: ShownSet = again.build
    if shown.status:
        raise InputError(f"magnify: {label} jams with its deviations magnified {magnify:g} times; take less")
    return PlanetaryDisplay(f"{label}-x{magnify:g}", shown, (f"deviations magnified {magnify:g} times",))


def replayed_display(seen: Replay, label: str) -> PlanetaryDisplay:
    """A build that was replayed, under a label."""
    shown: ShownSet = seen.build
    note = () if not shown.status else (f"{label} jams; shown where no backlash would have its gears",)
    return PlanetaryDisplay(label, shown, note)
