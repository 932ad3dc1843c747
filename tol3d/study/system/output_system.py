"""A system whose trials differ by where one shaft stands, its output: reducers and planetary sets."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.measure import Measure
from tol3d.study.system.plain import PlainSystem
from tol3d.study.system.positions import Positions
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import Columns, StreamKey
from tol3d.study.system.taken import ROWS_AT_ONCE
from tol3d.study.system.trials import Trials

Parts = Callable[[Contributor, Array], Array]
"""Effect of a contributor off its mean (trials, components) on a measure (trials,), in mm or rad."""


@dataclass(frozen=True)
class OutputSystem(PlainSystem):
    """A system with an output that stands anywhere in its period; see System.

    Args:
        own: drive of the output: its name, and the period in turns of the output until everything meets again.
        implausible: warnings of probable slips.
    """

    own: Any
    implausible: tuple[str, ...] = field(default=(), kw_only=True)

    @property
    @override
    def warnings(self) -> tuple[str, ...]:  # type: ignore[override]
        """See System."""
        return self.implausible

    @property
    def streams(self) -> tuple[StreamKey, ...]:
        """One, of the position of the output."""
        return ((self.own.name, "position"),)

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        """Turns of the output, uniform over its period."""
        return {self.own.name: uniforms[self.streams[0]] * float(self.own.period)}

    @property
    def position_column(self) -> str:
        """Name of the column of positions."""
        return f"position:{self.own.name} [deg]"

    def columns(self, trials: Trials) -> Mapping[str, NDArray[np.generic]]:
        """Angle of the output."""
        return {self.position_column: 360.0 * trials.positions[self.own.name]}

    def turns(self, positions: Positions, trials: Trials) -> Array:
        """Turns of the output (trials, 1) or (1, positions) at which a measure is read."""
        if positions.fixed is None:
            return trials.positions[self.own.name][:, None]
        return np.array([positions.fixed]) / (2 * np.pi)

    def trials_again(self, columns: Columns) -> Trials:
        """Trials from columns of their results."""
        deviations = np.concatenate(
            [component_values(contributor, columns) for contributor in self.contributors], axis=1
        )
        turns = np.asarray(columns[self.position_column], dtype=np.float64) / 360.0
        return Trials(deviations, {self.own.name: turns})

    @cached_property
    def read(self) -> Mapping[str, Any]:
        """The system's own measures by their names."""
        return {measure.name: measure for measure in self.measures}

    def regressor_key(self, measure: Measure) -> Hashable:
        """Key of the measure's own: contributors are regressed by their effect on it."""
        return measure.name

    def regress_parts(
        self,
        measure: Measure,
        contributors: Sequence[Contributor],
        columns: Columns,
        rows: Mapping[str, Array],
        parts: Callable[[Trials], Parts],
    ) -> None:
        """Write contributors' rows (regressors, trials): first its part, in the measure's unit; see System.regress.

        Args:
            measure, contributors, columns, rows: see System.regress.
            parts: of some trials.
        """
        trials, slices = self.trials_again(columns), component_slices(self)
        at_once = max(1, ROWS_AT_ONCE // measure.positions.in_a_trial)
        for contributor in contributors:
            rows[contributor.name][...] = 0.0
        for first in range(0, len(trials), at_once):
            piece = trials.part(first, first + at_once)
            part_of = parts(piece)
            for own in contributors:
                turning = self.turns_at_random(own, measure.positions)
                off = piece.deviations[:, slices[own.name]] - np.array(own.draw.mean(turning=turning))
                rows[own.name][0, first : first + at_once] = measure.per_internal * part_of(own, off)


def component_values(contributor: Contributor, columns: Columns) -> Array:
    """Components of a contributor from columns of results (trials, components) [mm, rad, K]."""
    read = (np.asarray(columns[name], dtype=np.float64) for name in contributor.columns)
    return np.stack([own * contributor.per_unit for own in read], axis=1)
