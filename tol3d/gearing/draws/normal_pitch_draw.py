"""Pitch deviations of a process with a capability: single pitches are normal, and no gear lies beyond F_p."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
import scipy
from typing_extensions import override

from tol3d.gearing.draws.pitch_draw import PitchDraw, centred
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import standard_normal
from tol3d.study.system.steepest import Values

END_SIGMAS = 3.0
"""Sigmas at the ends of a normal law."""


@dataclass(frozen=True, eq=False)
class NormalPitchDraw(PitchDraw):
    """Single pitches of one side are normal with 3 cpk sigma at f_p, on condition that they sum to zero.

    No gear has index deviations of more than F_p from the largest to the smallest: patterns round the gear are as
    likely as without that limit, and their size, that of normals, is cut off at F_p. Single pitches may exceed f_p, as
    normal laws do.

    Args:
        cpk: how far the process fills f_p, as ISO 22514-2 has it.
    """

    cpk: float = 1.0

    @property
    @override
    def words(self) -> str:
        return f"normal pitches, Cpk {self.cpk:g}, within F_p, each of {self.teeth}"

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw: a direction of all pitches by normals, and their length by a chi law that ends at F_p."""
        count, found = self._side_uniforms, list[Array]()
        for side in range(len(self.sides)):
            full, *others = uniforms[side * count : (side + 1) * count]
            singles = centred([standard_normal.ppf(u) for u in others])
            length = np.sqrt(_added([single * single for single in singles]))
            index = list(accumulate(singles))
            spread = np.maximum.reduce(index) - np.minimum.reduce(index)
            scale = self._size(full, self.limits.cumulative * length / spread) / length
            found += [scale * own for own in centred(index)]
        return tuple(found)

    @property
    def _single_sigma(self) -> float:
        """Sigma of independent pitches whose deviations from their mean have f_p/(3 cpk) [mm]."""
        return self.limits.single / (3 * self.cpk) / math.sqrt(1 - 1 / self.teeth)

    def _size(self, uniform: Array, most: Array) -> Array:
        """Length of all single pitches of a side together [mm], (trials,), below the most that is allowed."""
        half = (self.teeth - 1) / 2
        allowed = scipy.special.gammainc(half, (most / self._single_sigma) ** 2 / 2)
        return np.asarray(self._single_sigma * np.sqrt(2 * scipy.special.gammaincinv(half, uniform * allowed)))

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: 3 sigma along the steepest direction, within F_p, and its opposite."""
        step, count = self.sigma, len(self.components)
        found = values(step * np.concatenate([np.eye(count), -np.eye(count)]))
        slopes = found[:count] - found[count:]
        along = self.covariance @ slopes
        size = math.sqrt(max(float(slopes @ along), 0.0))
        end = END_SIGMAS * along / size if size > 0.0 else np.zeros(count)
        sides = end.reshape(len(self.sides), self.teeth)
        spread = np.ptp(sides, axis=1, keepdims=True)
        end = (sides * np.minimum(1.0, self.limits.cumulative / np.maximum(spread, 1e-300))).ravel()
        return np.stack([end, -end])


def _added(values: Sequence[Array]) -> Array:
    """Values (trials,) added up one after the other: the same bits for any trials."""
    total = values[0]
    for value in values[1:]:
        total = total + value
    return total
