"""A build of a planetary set as it is shown and exported: all gears in one world."""

import math
from dataclasses import dataclass
from functools import cached_property

from tol3d.errors import InputError
from tol3d.gearing.presenting.whole_trains import gear_body
from tol3d.planetary.shown import ShownSet
from tol3d.report.body import World
from tol3d.report.presenter import View, Which
from tol3d.runs.run import Run
from tol3d.runs.worst import worst_trial
from tol3d.simulate import Replay, replay, replayed, simulation_again
from tol3d.system.stated import magnified, mean_build, nominal_build

CENTRALS, FORWARD, BACKWARD, PLANETS = "#E69F00", "#4682B4", "#009E73", "#4682B4"


@dataclass(frozen=True, eq=False)
class PlanetaryDisplay:
    """A build of a set; see `tol3d.report.presenter.Display`."""

    label: str
    shown: ShownSet
    notes: tuple[str, ...] = ()

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """One world with every gear."""
        own, count = self.shown.own, len(self.shown.own.meshes)
        colours = [CENTRALS] * count
        for planet in range(own.planets):
            pushed = [spring.sense(planet) for spring in own.springs if spring.sense(planet)]
            colours += [BACKWARD if pushed and pushed[0] < 0 else FORWARD if pushed else PLANETS] * len(own.gears)
        bodies = zip(self.shown.gears, colours, strict=True)
        return (World(own.name, tuple(gear_body(gear, colour) for gear, colour in bodies)),)

    def view(self, close_up: str | None) -> View:
        """All gears.

        Raises:
            InputError: a close-up was asked for.
        """
        if close_up is not None:
            raise InputError(f"--mesh: nothing of a planetary set is shown close up, not {close_up[:80]!r}")
        return View()


def display(run: Run, which: Which, *, magnify: float) -> PlanetaryDisplay:
    """A build of a run.

    Raises:
        InputError: no such build, or a magnification with which it jams.
    """
    if not (math.isfinite(magnify) and magnify >= 0.0):
        raise InputError(f"magnify: expected a number of at least 0, got {magnify:g}")
    label, seen = _replayed(run, which)
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


def _replayed(run: Run, which: Which) -> tuple[str, Replay]:
    trial = worst_trial(run) if which == "worst" else which
    if isinstance(trial, int):
        return f"trial-{trial}", replay(run, trial)
    if trial not in ("nominal", "mean"):
        raise InputError(f"expected a trial's number, worst, nominal or mean, got {trial!r}")
    simulation = simulation_again(run)
    system = simulation.system
    build = nominal_build(system) if trial == "nominal" else mean_build(system, system.measures[0])
    return trial, replayed(simulation, build)
