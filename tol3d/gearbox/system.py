"""Gears in a housing as a study sees them: the gears' system and the assembly's, joined at the bores."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.system import AssemblySystem, moments_of
from tol3d.assembly.torsors import road as torsors
from tol3d.gearbox.bores import Bores
from tol3d.gearbox.closed_form import closed_form
from tol3d.gearbox.regressors import regress_bores
from tol3d.gearbox.roads import GearboxRoad
from tol3d.gearbox.statuses import STATUSES
from tol3d.gearing.model import Contributor as GearContributor
from tol3d.gearing.model.measure import Measure as GearMeasure
from tol3d.gearing.roads.analytic import analytic_values
from tol3d.gearing.system import ROADS, GearSystem
from tol3d.system.breakdown import Breakdown
from tol3d.system.closed_form import ClosedForm
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.pooled import PooledTerms
from tol3d.system.positions import Positions
from tol3d.system.road import ANALYTIC_ROAD, Road
from tol3d.system.stated import component_slices, mean_deviations, stated
from tol3d.system.statuses import Statuses
from tol3d.system.system import Columns, KeyPath, Published, StreamKey
from tol3d.system.trials import Trials

Array = NDArray[np.float64]

NOTHING: Final = 1e-12
"""Displacement [mm] of an axis per mm, rad or K that is rounding."""

STEP: Final = 1e-4
"""mm; over which the analytic road's slopes by displacements of bores are taken, to both sides."""


@dataclass(frozen=True, eq=False)
class GearboxSystem:
    """Implements System.

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

    roads = ROADS
    statuses: Statuses = STATUSES

    # what it is -------------------------------------------------------------------------------------

    @cached_property
    def assembly(self) -> AssemblySystem:
        """The assembly's system, with what reads the bores."""
        return replace(self.drawn, assembly=self.bores.assembly)

    @property
    def breakdowns(self) -> Sequence[Breakdown]:
        """See System."""
        return self.gears.breakdowns

    @property
    def warnings(self) -> tuple[str, ...]:
        """See System."""
        return (*self.gears.warnings, *self.drawn.warnings)

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """See System."""
        yield from self.drawn.problems()
        yield from self.gears.problems()

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """See System."""
        return self._owner(measure).describe(measure)

    def _owner(self, measure: Measure) -> GearSystem | AssemblySystem:
        return self.gears if isinstance(measure, GearMeasure) else self.assembly

    # its trials -------------------------------------------------------------------------------------

    @property
    def streams(self) -> tuple[StreamKey, ...]:
        """See System."""
        return self.gears.streams

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        """See System: those of the gears."""
        return self.gears.positions(uniforms)

    def columns(self, trials: Trials) -> Mapping[str, NDArray[np.generic]]:
        """See System."""
        return self.gears.columns(trials)

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """See System."""
        return contributor.name in self._of_gears and self.gears.turns_at_random(contributor, positions)

    @cached_property
    def _of_gears(self) -> frozenset[str]:
        """Contributors that act on gears themselves."""
        return frozenset(own.name for own in self.drawn_by_gears)

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

    # its roads --------------------------------------------------------------------------------------

    def is_compiled(self, road: str) -> bool:
        """See System."""
        return self.gears.is_compiled(road)

    def materials(self, road: str) -> Any:
        """See System."""
        return self.gears.materials(road)

    def road(self, name: str, materials: Any) -> Road:
        """See System: each system's own, gears by what the assembly's says of the bores."""
        return GearboxRoad(self, self.gears.road(name, materials), exact=name != ANALYTIC_ROAD)

    def cost(self, measures: Sequence[Measure]) -> int:
        """See System."""
        own = [measure for measure in measures if isinstance(measure, GearMeasure)]
        return (self.gears.cost(own) if own else 0) + len(measures) - len(own)

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """See System."""
        return self._owner(measure).chord_bound(measure, chord_error)

    # what acts on a measure -------------------------------------------------------------------------

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

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """See System: of a backlash also what moves the bores of its shafts."""
        if not isinstance(measure, GearMeasure):
            names = {own.name for own in self.assembly.acting(measure)}
        else:
            own = {each.name for each in self.gears.acting(measure)}
            displaced = [each.name in own for each in self.gears.contributors[len(self.drawn_by_gears) :] for _ in "xy"]
            acts = self.displacing[np.array(displaced, dtype=bool)].any(axis=0)
            slices = component_slices(self.drawn)
            names = own | {each.name for each in self.drawn.contributors if acts[slices[each.name]].any()}
        return [each for each in self.contributors if each.name in names]

    def regressor_key(self, measure: Measure) -> Hashable:
        """See System."""
        return self._owner(measure).regressor_key(measure)

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """See System."""
        if not isinstance(measure, GearMeasure):
            known = {own.name: own for own in self.drawn.contributors}
            self.assembly.regress(measure, [known[own.name] for own in contributors], columns, rows)
            return
        self.gears.regress(measure, [own for own in contributors if own.name in self._of_gears], columns, rows)
        others = [own for own in contributors if own.name not in self._of_gears]
        regress_bores(others, columns, rows, lambda: self._slopes(measure, others))

    def _slopes(self, measure: GearMeasure, contributors: Sequence[Contributor]) -> Mapping[str, Array]:
        """Change of a backlash by each component of contributors that move bores."""
        per_column = self.bore_slopes(measure) @ self.displacing
        slices = component_slices(self.drawn)
        return {own.name: per_column[slices[own.name]] for own in contributors}

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

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        """See System."""
        if not isinstance(measure, GearMeasure):
            return self.assembly.closed_form(measure)
        return self._form(measure, at_one_position=False)

    def _form(self, measure: GearMeasure, *, at_one_position: bool) -> ClosedForm | None:
        key = measure, at_one_position
        if key not in self._forms:
            self._forms[key] = closed_form(self, measure, at_one_position=at_one_position)
        return self._forms[key]

    @cached_property
    def _forms(self) -> dict[tuple[GearMeasure, bool], ClosedForm | None]:
        """Closed forms that are known: where axes lean, each takes a tenth of a second."""
        return {}

    def reference_form(self, measure: Measure) -> ClosedForm | None:
        """See System."""
        if not isinstance(measure, GearMeasure):
            return self.assembly.reference_form(measure)
        return self._form(measure, at_one_position=True)

    def neglected(self, measure: Measure, trials: Trials) -> Mapping[str, Array]:
        """See System."""
        if not isinstance(measure, GearMeasure):
            return self.assembly.neglected(measure, replace(trials, deviations=self._of_assembly(trials)))
        return self.gears.neglected(measure, self.linear_gear_trials(trials))

    def _of_assembly(self, trials: Trials) -> Array:
        return np.asarray(trials.deviations[:, self.assembly_places])

    # what it shows ----------------------------------------------------------------------------------

    def sections(self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published) -> Mapping[str, Any]:
        """See System."""
        return self.gears.sections(terms, published)

    def display(self, trials: Trials, road: Road) -> Any:
        """See System: the seated meshes of the gears."""
        assert isinstance(road, GearboxRoad)
        seen, _ = road.gear_trials(trials)
        return self.gears.display(seen, road.gears)
