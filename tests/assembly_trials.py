"""Scenes of assemblies as texts, and what both methods make of their trials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scene_texts import scene_of

from tol3d.assembly.model.statuses import OK
from tol3d.assembly.system import AssemblySystem
from tol3d.simulate import Overrides, simulation_of
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.stated import component_slices, nominal_build
from tol3d.study.system.trials import Trials
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

Array = NDArray[np.float64]
BLOCK = 50_000


@dataclass(frozen=True)
class Assembled:
    """A scene of an assembly, ready to be built."""

    simulation: Simulation

    @property
    def system(self) -> AssemblySystem:
        """System that is simulated."""
        system = self.simulation.system
        assert isinstance(system, AssemblySystem)
        return system

    def values(self, trials: Trials, method: str = "exact") -> Mapping[str, Array]:
        """Measures (trials,) [mm or rad]; every one is built."""
        made = self.system.method(method, self.system.materials(method))
        answers = made.answers(trials, self.system.measures)
        assert all((codes == OK).all() for codes in answers.status.values())
        return {name: own[:, 0] for name, own in answers.values.items()}

    def drawn(self, count: int, method: str = "exact") -> Mapping[str, Array]:
        """Measures of the scene's first trials (count,) [mm or rad]."""
        pieces = [
            self.values(drawn(self.simulation, first, min(BLOCK, count - first)), method)
            for first in range(0, count, BLOCK)
        ]
        return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}

    @property
    def slices(self) -> Sequence[tuple[Contributor, slice]]:
        """Contributors with their columns of the deviations."""
        return list(zip(self.system.contributors, component_slices(self.system).values(), strict=True))

    @cached_property
    def nominal(self) -> Mapping[str, float]:
        """Measures without deviations [mm or rad]."""
        return {name: float(own[0]) for name, own in self.values(nominal_build(self.system)).items()}


def assembled(text: str, folder: Path) -> Assembled:
    """A scene that is written as a text, ready to be built."""
    return Assembled(simulation_of(scene_of(text, folder), Overrides()))


def point(at: Sequence[float] | Array, normal: Sequence[float] | Array | None = None) -> str:
    """A feature that is a point [mm]."""
    x, y, z = (float(own) for own in at)
    out = "" if normal is None else f", normal: {[float(own) for own in normal]}"
    return f"{{kind: point, at: [{x} mm, {y} mm, {z} mm]{out}}}"


def constant(value: float) -> str:
    """A distribution of one value [mm]."""
    return f"{{kind: constant, value: {value!r} mm}}"


def normal(sigma: float) -> str:
    """A distribution about 0 [mm]."""
    return f"{{kind: normal, mean: 0 mm, sigma: {sigma!r} mm}}"


def uniform(half: float) -> str:
    """A distribution about 0 [mm]."""
    return f"{{kind: uniform, lower: {-half!r} mm, upper: {half!r} mm}}"
