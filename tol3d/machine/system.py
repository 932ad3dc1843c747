"""Gears in a housing as a study sees them: the gears' system and the assembly's, joined at the bores."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.clearances.prepared import reader_of
from tol3d.assembly.system import AssemblySystem, ClearanceSystem
from tol3d.assembly.zones import laws_told
from tol3d.gearing.model.measure import Measure as GearMeasure
from tol3d.gearing.system import EXACT, ROADS, GearSystem
from tol3d.machine.closed_form import closed_form
from tol3d.machine.joined import Joined
from tol3d.machine.regressors import regress_bores
from tol3d.machine.roads import MachineRoad
from tol3d.machine.statuses import STATUSES, WITH_CLEARANCES
from tol3d.system.breakdown import Breakdown
from tol3d.system.closed_form import ClosedForm
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.pooled import PooledTerms
from tol3d.system.positions import Positions
from tol3d.system.road import ANALYTIC_ROAD, Codes, Road, RoadKind
from tol3d.system.stated import component_slices
from tol3d.system.statuses import Statuses
from tol3d.system.system import Columns, KeyPath, Published, StreamKey
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MachineSystem(Joined):
    """Implements System."""

    # what it is -------------------------------------------------------------------------------------

    @property
    def _is_clearing(self) -> bool:
        """Whether clearances of whole parts are asked."""
        return isinstance(self.drawn, ClearanceSystem)

    @property
    def statuses(self) -> Statuses:
        """See System."""
        return WITH_CLEARANCES if self._is_clearing else STATUSES

    @property
    def roads(self) -> Mapping[str, RoadKind]:
        """See System: those of the gears, one process each where solids are read."""
        return {**ROADS, EXACT: replace(ROADS[EXACT], threads=False)} if self._is_clearing else ROADS

    @property
    def breakdowns(self) -> Sequence[Breakdown]:
        """See System."""
        return self.gears.breakdowns

    @property
    def warnings(self) -> tuple[str, ...]:
        """See System."""
        return (*self.off_shafts, *self.gears.warnings, *self.drawn.warnings)

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """See System."""
        yield from self.drawn.problems()
        yield from self.gears.problems()

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """See System: of gears also by which laws the bores lie in their zones."""
        found = self._owner(measure).describe(measure)
        if not isinstance(measure, GearMeasure):
            return found
        slices = component_slices(self.drawn)
        moving = (own for own in self.drawn.contributors if self.displacing[:, slices[own.name]].any())
        return {**found, **laws_told(moving)}

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

    def seen_by_gears(self, trials: Trials) -> tuple[Trials, Mapping[str, Codes]]:
        """Trials as the gears see them, on the axes that placed bores give; and what became of these (trials,)."""
        return MachineRoad(self, self.gears.road(ANALYTIC_ROAD, {}), exact=True).gear_trials(trials)

    # its roads --------------------------------------------------------------------------------------

    def is_compiled(self, road: str) -> bool:
        """See System."""
        return self.gears.is_compiled(road)

    def materials(self, road: str) -> Any:
        """See System."""
        own = self.gears.materials(road)
        return (own, self.drawn.materials(road)) if self._is_clearing and road != ANALYTIC_ROAD else own

    def road(self, name: str, materials: Any) -> Road:
        """See System: each system's own, gears by what the assembly's says of the bores."""
        exact = name != ANALYTIC_ROAD
        if not self._is_clearing or not exact:
            return MachineRoad(self, self.gears.road(name, materials), exact)
        own, solids = materials
        gears = self.gears.road(name, own)
        if name == EXACT:
            return MachineRoad(self, gears, exact, reader_of(solids))
        given, finer = solids
        chords = {name: given[name].chord_error + pair.chord_error for name, pair in finer.items()}
        return MachineRoad(self, gears, exact, reader_of(finer), chords)

    def cost(self, measures: Sequence[Measure]) -> int:
        """See System."""
        own = [measure for measure in measures if isinstance(measure, GearMeasure)]
        return (self.gears.cost(own) if own else 0) + len(measures) - len(own)

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """See System."""
        return self._owner(measure).chord_bound(measure, chord_error)

    # what acts on a measure -------------------------------------------------------------------------

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """See System: of a backlash also what moves the bores of its shafts."""
        if not isinstance(measure, GearMeasure):
            names = {own.name for own in self.assembly.acting(measure)}
        else:
            own = {each.name for each in self.gears.acting(measure)}
            rows = self.reading(measure)
            acts = np.asarray(np.concatenate([self.displacing[rows] != 0.0, self.bending[rows]]).any(axis=0))
            slices = component_slices(self.drawn)
            names = own | {each.name for each in self.drawn.contributors if np.any(acts[slices[each.name]])}
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
        slices = component_slices(self.drawn)
        squared = {own.name: self.squared[slices[own.name]] for own in others}
        regress_bores(others, columns, rows, squared, lambda: self._bore_slopes(measure, others))

    def _bore_slopes(self, measure: GearMeasure, contributors: Sequence[Contributor]) -> Mapping[str, Array]:
        """Change of a backlash by each component of contributors that move bores."""
        per_column = self.bore_slopes(measure) @ self.displacing
        slices = component_slices(self.drawn)
        return {own.name: per_column[slices[own.name]] for own in contributors}

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
        assert isinstance(road, MachineRoad)
        seen, _ = road.gear_trials(trials)
        return self.gears.display(seen, road.gears)
