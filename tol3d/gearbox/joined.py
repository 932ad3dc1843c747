"""Gears and an assembly joined at the bores: whose columns are whose, and how bores follow from deviations."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.system import AssemblySystem, moments_of
from tol3d.assembly.torsors import road as torsors
from tol3d.gearbox.bores import Bores
from tol3d.gearing.model import Contributor as GearContributor
from tol3d.gearing.model.measure import Measure as GearMeasure
from tol3d.gearing.roads.analytic import analytic_values
from tol3d.gearing.system import GearSystem
from tol3d.system.contributor import Contributor
from tol3d.system.stated import component_slices, mean_deviations, stated
from tol3d.system.trials import Trials

Array = NDArray[np.float64]

NOTHING: Final = 1e-12
"""Displacement [mm] of an axis per mm, rad or K that is rounding."""

STEP: Final = 1e-4
"""mm; over which the analytic road's slopes by displacements of bores are taken, to both sides."""


@dataclass(frozen=True, eq=False)
class Joined:
    """Gears in a housing.

    Args:
        name: of the scene.
        contributors: of gears and of the assembly, in the scene's order.
        measures: likewise.
        gears: whose last contributors are the displacements of the bores: two a shaft, x and y each, that nobody draws.
        drawn: the assembly as the scene has it.
        bores: the same assembly with what reads its bores.
        worlds: by the first shaft of each train in bores, where its world lies in that of the parts (4, 4).
    """

    name: str
    contributors: tuple[Any, ...]
    measures: tuple[Any, ...]
    gears: GearSystem
    drawn: AssemblySystem
    bores: Bores
    worlds: Mapping[str, Array]

    @cached_property
    def assembly(self) -> AssemblySystem:
        """The assembly's system, with what reads the bores."""
        return replace(self.drawn, assembly=self.bores.assembly)

    @property
    def drawn_by_gears(self) -> tuple[GearContributor, ...]:
        """The contributors of the gears but the displacements of the bores."""
        return self.gears.contributors[: len(self.gears.contributors) - 2 * len(self.bores.shafts)]

    @cached_property
    def gear_places(self) -> NDArray[np.intp]:
        """Where the columns of the gears' own contributors lie among all."""
        return self._places(self.drawn_by_gears)

    @cached_property
    def assembly_places(self) -> NDArray[np.intp]:
        """Where the columns of the assembly's contributors lie among all."""
        return self._places(self.drawn.contributors)

    def _places(self, contributors: Sequence[Contributor]) -> NDArray[np.intp]:
        slices = component_slices(self)
        ranges = [np.arange(slices[own.name].start, slices[own.name].stop) for own in contributors]
        return np.concatenate([*ranges, np.zeros(0)]).astype(np.intp)

    def gear_trials(self, trials: Trials, displaced: Array) -> Trials:
        """Trials as the gears see them, the bores displaced (trials, shafts * 4) [mm]."""
        return replace(trials, deviations=np.concatenate([trials.deviations[:, self.gear_places], displaced], axis=1))

    def linear_gear_trials(self, trials: Trials) -> Trials:
        """The same, the bores displaced to first order."""
        return self.gear_trials(trials, trials.deviations[:, self.assembly_places] @ self.displacing.T)

    @cached_property
    def displacing(self) -> Array:
        """Displacements of the bores per deviation of the assembly's contributors, (shafts * 4, columns)."""
        moments = [moments_of(own) for own in self.drawn.contributors]
        means = np.concatenate([mean for mean, _ in moments] or [np.zeros(0)])
        sigmas = np.concatenate([np.sqrt(np.diagonal(covariance)) for _, covariance in moments] or [np.zeros(0)])
        assembly = self.bores.assembly
        rows = [torsors.slopes(assembly, name, means, sigmas).coefficients for name in self.bores.lateral_names]
        found = np.array(rows).reshape(len(rows), assembly.width)
        return np.where(np.abs(found) < NOTHING, 0.0, found)

    def moving_apart(self, mesh: str) -> Iterator[str]:
        """Contributors but temperatures that change the distance or the parallelism of the axes of a mesh."""
        layout, own = self.gears.model.layout, self.gears.model.mesh(mesh)
        lines = [self._line(layout.carrying[gear][0]) for gear in (own.driver, own.driven)]
        if lines[0] is None or lines[1] is None:
            return
        (place, low, tilt), (other, low_other, tilt_other) = lines
        z = self._housed[layout.carrying[own.driver][0]].frame[:3, 2]
        apart = other - place
        apart = (apart - z * (apart @ z)) / np.linalg.norm(apart - z * (apart @ z))
        # both at the height of the first point of the driver's axis
        shifted = low_other + tilt_other * ((place - other) @ z)
        changes = np.vstack([apart @ (shifted - low), tilt_other - tilt])
        slices = component_slices(self.drawn)
        for each in self.drawn.contributors:
            if each.kind != "temperature" and (np.abs(changes[:, slices[each.name]]) > NOTHING).any():
                yield each.name

    @cached_property
    def _housed(self) -> Mapping[str, Any]:
        return {own.shaft: own for own in self.bores.shafts}

    def _line(self, shaft: str) -> Any:
        """First point of a shaft's axis (3,), its displacement and that per mm of z (3, columns), in the world."""
        names = [own.shaft for own in self.bores.shafts]
        if shaft not in names:
            return None
        own, start = self._housed[shaft], 4 * names.index(shaft)
        low, high = (own.frame[:3, :2] @ self.displacing[start + 2 * k : start + 2 * k + 2] for k in range(2))
        length = own.along(own.bores[1]) - own.along(own.bores[0])
        return own.bores[0].place, low, (high - low) / length

    def bore_slopes(self, measure: GearMeasure) -> Array:
        """Change of a backlash by theory per displacement of the bores (shafts * 4,), at the means."""
        system = self.gears
        middle = mean_deviations(system, measure.positions)
        count = 4 * len(self.bores.shafts)
        steps = np.zeros((count, middle.shape[1]))
        steps[:, middle.shape[1] - count :] = STEP * np.eye(count)
        trials = stated(system, np.concatenate([middle + steps, middle - steps]))
        values = analytic_values(system.model, measure, trials)[:, 0]
        return np.asarray((values[:count] - values[count:]) / (2 * STEP))
