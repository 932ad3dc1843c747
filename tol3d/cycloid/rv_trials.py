"""Trials of an RV reducer: what they deviate by, and where its output stands."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.measure import RVMeasure
from tol3d.cycloid.rv_deviated import Acts, RVDeviated
from tol3d.cycloid.rv_set import RVSet
from tol3d.system.measure import Measure
from tol3d.system.output_system import OutputSystem
from tol3d.system.positions import Positions
from tol3d.system.stated import component_slices
from tol3d.system.system import Columns
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RVTrials(OutputSystem):
    """What a System of an RV reducer knows of trials.

    Args:
        own: the reducer.
        acts: what each contributor acts on, by its name.
        rv_measures: the measures by their names.
    """

    own: RVSet
    acts: Mapping[str, Acts]
    rv_measures: Mapping[str, RVMeasure]

    def deviated(self, trials: Trials) -> RVDeviated:
        """What trials deviate by."""
        found = RVDeviated.nothing(self.own, len(trials))
        for name, own in component_slices(self).items():
            found.add(self.acts[name], trials.deviations[:, own])
        return found

    def turns(self, positions: Positions, trials: Trials) -> Array:
        """Turns of the output (trials, 1) or (1, positions) at which a measure is read."""
        if positions.fixed is None:
            return trials.positions[self.own.name][:, None]
        return np.array([positions.fixed]) / (2 * np.pi)

    def gap_bound(self, measure: Measure, error: float) -> float:
        """What errors of all gaps [mm] may make of a measure, in its unit.

        A working pin has a lever of the window's share at least. Of a lost motion both ends may be off, of a curve the
        position and the first one.
        """
        own = self.rv_measures[measure.name]
        lever = self.own.window * self.own.profile.pitch_radius * (1 + self.own.rolling / self.own.profile.lobes)
        both = own.reading == "lost motion" or own.positions.over == "turn"
        return (2 if both else 1) * error / lever * measure.per_internal

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """See System."""
        return self.gap_bound(measure, chord_error)

    def deviated_again(self, columns: Columns) -> RVDeviated:
        """The same from columns of results."""
        read = [columns[name] * own.per_unit for own in self.contributors for name in own.columns]
        count = len(np.asarray(columns[self.position_column]))
        return self.deviated(Trials(np.array(read).reshape(-1, count).T, {}))
