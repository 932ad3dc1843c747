"""Builds of assemblies as they are shown: each part's features where they lie in the trial."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Feature
from tol3d.assembly.placing import road as placing
from tol3d.assembly.presenting.symbols import Surface, rod, symbol
from tol3d.assembly.system import AssemblySystem
from tol3d.errors import GeometryError, InputError, RunError
from tol3d.report.body import Body, World
from tol3d.report.presenter import View, Which
from tol3d.runs.run import Run
from tol3d.runs.worst import worst_trial
from tol3d.simulate import Replay, replay, replayed, simulation_again
from tol3d.solids import PosedPart
from tol3d.system.stated import mean_build, nominal_build

Array = NDArray[np.float64]

COLOURS: Final = ("#4682B4", "#CD853F", "#6B8E23", "#B22222", "#8470FF", "#2F8F8F", "#C71585", "#708090")
THIN: Final = 1 / 120
"""Of the assembly's size: thickness of symbols; a sixth of it is the radius of the rods that join those of a part."""
MOST_NAMED: Final = 16
"""Features that a picture names."""


@dataclass(frozen=True)
class ShownAssembly:
    """Implements Display.

    Args:
        label: what it is.
        bodies: a body a part.
        places: of the features that a drawing names (3,) [mm].
        notes: what the user should know.
    """

    label: str
    bodies: tuple[Body, ...]
    places: Mapping[str, Array]
    notes: tuple[str, ...] = ()

    @property
    def worlds(self) -> tuple[World, ...]:
        """One world; the features are named where they are few."""
        points = self.places if len(self.places) <= MOST_NAMED else {}
        return (World("assembly", self.bodies, points=points, up=(0.0, 0.0, 1.0)),)

    def view(self, close_up: str | None) -> View:
        """The world, its parts named."""
        if close_up is not None:
            raise InputError(f"nothing of an assembly is shown close up, not {close_up}")
        return View()


def display(run: Run, which: Which, *, magnify: float) -> ShownAssembly:
    """A build of a run; its deviations magnified and its parts placed by them.

    Raises:
        RunError: it is not built.
    """
    trial = worst_trial(run) if which == "worst" else which
    if isinstance(trial, int):
        seen = replay(run, trial)
    else:
        simulation = simulation_again(run)
        system = simulation.system
        seen = replayed(
            simulation, nominal_build(system) if trial == "nominal" else mean_build(system, system.measures[0])
        )
    label = f"trial-{trial}" if isinstance(trial, int) else str(trial)
    if magnify == 1.0:
        return replayed_display(seen, label)
    seen = replayed(seen.simulation, seen.trials.scaled(magnify))
    return replayed_display(seen, label, (f"deviations {magnify:g} times as large; parts are placed by them",))


def replayed_display(seen: Replay, label: str, notes: tuple[str, ...] = ()) -> ShownAssembly:
    """A trial that was replayed.

    Raises:
        RunError: it is not built.
    """
    system = seen.simulation.system
    assert isinstance(system, AssemblySystem)
    frames = placing.features_placed(system.assembly, seen.trials.deviations[:1])
    if any(np.isnan(frame).any() for frame in frames.values()):
        raise RunError(f"{label}: cannot be shown: {seen.status}")
    here = {name: own[0] for name, own in frames.items()}
    named = [own.name for own in system.assembly.features.values() if own.is_named]
    return ShownAssembly(label, bodies(system.assembly, here), {name: here[name][:3, 3] for name in named}, notes)


def bodies(assembly: Assembly, frames: dict[str, Array]) -> tuple[Body, ...]:
    """A body a part, of its features' symbols.

    Args:
        assembly: whose.
        frames: of the features in the world (4, 4).
    """
    places = np.array([frame[:3, 3] for frame in frames.values()])
    thickness = THIN * max(float(np.ptp(places, axis=0).max()), *(_extent(own) for own in assembly.features.values()))
    found = []
    for k, part in enumerate(assembly.parts):
        named = [(own, frames[own.name]) for own in part.features if own.is_named]
        surface = partial(_joined, tuple(named), thickness)
        found.append(Body(part.name, np.eye(4), surface, partial(_no_solid, part.name), COLOURS[k % len(COLOURS)]))
    return tuple(found)


def _extent(feature: Feature) -> float:
    ends = getattr(feature.shape, "ends", None)
    radius = getattr(feature.shape, "radius", 0.0)
    return 2 * float(radius) if ends is None else float(np.ptp(ends, axis=0).max())


def _joined(features: tuple[tuple[Feature, Array], ...], thickness: float) -> Surface:
    """The symbols of several features, and rods from their middle to each, in the world."""
    places = np.array([frame[:3, 3] for _, frame in features])
    middle = places.mean(axis=0)
    surfaces = [rod(middle, place, thickness / 6) for place in places if np.linalg.norm(place - middle) > thickness]
    for feature, frame in features:
        vertices, triangles = symbol(feature.shape, thickness)
        surfaces.append((vertices @ frame[:3, :3].T + frame[:3, 3], triangles))
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in surfaces)])
    return (
        np.concatenate([vertices for vertices, _ in surfaces]),
        np.concatenate([triangles + start for (_, triangles), start in zip(surfaces, starts, strict=False)]),
    )


def _no_solid(part: str) -> PosedPart:
    raise GeometryError(
        f"{part}: its features are stated by numbers, so that it has no solid; take a format of triangles"
    )
