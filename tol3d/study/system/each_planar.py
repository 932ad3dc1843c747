"""Draws of deviations that each of several features has of its own, with a direction each."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import Distribution
from tol3d.study.system.draw import Planar
from tol3d.study.system.normals import Group, groups_of, shifted
from tol3d.study.system.steepest import Values, along, steepest_ends


class EachOwn:
    """Draws for several features, each of its own: components of one after the other; see Draw."""

    axes: ClassVar[tuple[str, str]] = ("x", "y")
    names: tuple[str, ...]
    each: Any

    @property
    def uniforms(self) -> int:
        """Number of uniforms of one feature, times the number of features."""
        return len(self.names) * int(self.each.uniforms)

    @property
    def groups(self) -> tuple[Group, ...] | None:
        """See Smooth; None where one does not say."""
        own, count = groups_of(self.each), int(self.each.uniforms)
        if own is None:
            return None
        return tuple(group for k in range(len(self.names)) for group in shifted(own, k * count))

    @property
    def components(self) -> tuple[str, ...]:
        """Components of each feature."""
        return tuple(f"{name} {axis}" for name in self.names for axis in self.axes)

    @property
    def sigma(self) -> float:
        """Standard deviation of one component [mm]."""
        return float(self.each.sigma)

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw."""
        parts = parts_of(uniforms, self.each.uniforms)
        return tuple(deviation for part in parts for deviation in self.each.deviations(*part))

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """See Draw."""
        found: tuple[float, ...] = self.each.mean(turning=turning) * len(self.names)
        return found


def parts_of(given: Sequence[Array], count: int) -> list[Sequence[Array]]:
    """Groups of `count` at a time."""
    return [given[start : start + count] for start in range(0, len(given), count)]


@dataclass(frozen=True)
class EachPlanar(EachOwn):
    """Lengths for several features, each in a direction of its own.

    Args:
        distribution: of each length.
        names: of the features.
        direction: of all of them [rad]; None draws each one's, uniform over the circle.
    """

    distribution: Distribution
    names: tuple[str, ...]
    direction: float | None

    @property
    def each(self) -> Planar:
        """Draw of one feature."""
        return Planar(self.distribution, self.direction)

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: all lengths at their ends, along the effect of each one alone."""
        law, count = self.distribution, len(self.names)
        if self.direction is not None and not turning:
            return np.tile(self.each.ends(values, turning=False), (1, count))
        steps = np.full(2 * count, law.radius)
        return steepest_ends(values, np.zeros(2 * count), steps, partial(along, law.radius))
