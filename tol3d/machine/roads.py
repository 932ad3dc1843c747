"""Both roads of gears in a housing: the assembly is placed, then the gears mesh on the axes that its bores give."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.placing import road as placing
from tol3d.assembly.placing.world import SolidReader
from tol3d.assembly.torsors import road as torsors
from tol3d.gearing.model.measure import Measure as GearMeasure
from tol3d.machine.joined import Joined
from tol3d.machine.statuses import FROM_ASSEMBLIES
from tol3d.system.measure import Measure
from tol3d.system.outcome import reason_column
from tol3d.system.road import Answers, Codes, Road
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MachineRoad:
    """A road of the gears behind one of the assembly; implements WitnessRoad where the gears' does.

    Args:
        system: whose.
        gears: the gears' own road.
        exact: whether parts are placed by finite poses; else by torsors.
        solids: reads clearances of whole parts; None where there are none.
        chords: by clearance, what chord errors of a witness and of what it checks explain [mm]; else empty.
    """

    system: Joined
    gears: Road
    exact: bool
    solids: SolidReader | None = None
    chords: Mapping[str, float] = field(default_factory=dict)

    @property
    def chord_error(self) -> float:
        """See Road."""
        return self.gears.chord_error

    def reads(self, measure: Measure) -> bool:
        """See WitnessRoad: every one."""
        return True

    def bounds(self, measure: Measure) -> tuple[float, float]:
        """See WitnessRoad; of the assembly clearances alone are read otherwise than by the road that is witnessed."""
        if not isinstance(measure, GearMeasure):
            return self.chords.get(measure.name, 0.0) * measure.per_internal, 0.0
        witness: Any = self.gears
        found: tuple[float, float] = witness.bounds(measure)
        return found

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Road."""
        of_gears = [measure for measure in measures if isinstance(measure, GearMeasure)]
        others = [measure.name for measure in measures if not isinstance(measure, GearMeasure)]
        values, codes, details = self._read(trials, (*self.system.bores.names, *others) if of_gears else others)
        hidden = {reason_column(name) for name in self.system.bores.names}
        shown = {name: own for name, own in details.items() if name not in hidden}
        own = Answers(
            {name: values[name][:, None] for name in others}, details=shown, status=self._status(codes, others)
        )
        if not of_gears:
            return own
        seen, failed = self._seen(trials, values, codes)
        answers = self.gears.answers(seen, of_gears)
        return self._joined(answers, own, of_gears, failed)

    def gear_trials(self, trials: Trials) -> tuple[Trials, Mapping[str, Codes]]:
        """Trials as the gears see them, and by shaft what became of its bores (trials,), codes of this system."""
        values, codes, _ = self._read(trials, self.system.bores.names)
        return self._seen(trials, values, codes)

    def _read(
        self, trials: Trials, names: Sequence[str]
    ) -> tuple[Mapping[str, Array], Mapping[str, Codes], Mapping[str, NDArray[np.generic]]]:
        """Measures of the assembly, what became of them in its own codes, empty where all are built, and details."""
        assembly, deviations = self.system.bores.assembly, trials.deviations[:, self.system.assembly_places]
        if not self.exact:
            return torsors.values(assembly, deviations, names), {}, {}
        found, decided = placing.answers(assembly, deviations, names, self.solids)
        values = {name: own for name, (own, _) in found.items()}
        return values, {name: codes for name, (_, codes) in found.items()}, decided

    def _seen(
        self, trials: Trials, values: Mapping[str, Array], codes: Mapping[str, Codes]
    ) -> tuple[Trials, Mapping[str, Codes]]:
        bores = self.system.bores
        displaced = bores.exactly(values) if self.exact else bores.to_first_order(values)
        failed = {}
        for k, own in enumerate(bores.shafts):
            names = bores.names[6 * k : 6 * k + 6]
            worst = np.max([codes[name] for name in names], axis=0) if codes else np.zeros(len(trials), dtype=np.int8)
            failed[own.shaft] = FROM_ASSEMBLIES[worst]
        return self.system.gear_trials(trials, np.nan_to_num(displaced, nan=0.0)), failed

    def _status(self, codes: Mapping[str, Codes], names: Sequence[str]) -> dict[str, Codes]:
        return {name: FROM_ASSEMBLIES[codes[name]] for name in names} if codes else {}

    def _joined(
        self, answers: Answers, own: Answers, measures: Sequence[GearMeasure], failed: Mapping[str, Codes]
    ) -> Answers:
        """Answers of gears and of the assembly; a backlash whose bores are not where they should be has none."""
        values, status = {**answers.values, **own.values}, {**answers.status, **own.status}
        if any(codes.any() for codes in failed.values()):
            for measure in measures:
                before = status.get(measure.name, np.zeros(len(values[measure.name]), dtype=np.int8))
                codes = np.max([np.zeros_like(before), *(failed[shaft] for shaft in self._shafts(measure))], axis=0)
                status[measure.name] = np.where(codes != 0, codes, before).astype(np.int8)
                values[measure.name] = np.where((codes != 0)[:, None], np.nan, values[measure.name])
        return replace(answers, values=values, details={**answers.details, **own.details}, status=status)

    def _shafts(self, measure: GearMeasure) -> set[str]:
        """Shafts in bores of the meshes that a measure reads."""
        model = self.system.gears.model
        meshes = [model.mesh(backlash.mesh) for _, backlash in measure.kind.backlashes]
        shafts = {model.layout.carrying[gear][0] for mesh in meshes for gear in (mesh.driver, mesh.driven)}
        return shafts & {own.shaft for own in self.system.bores.shafts}
