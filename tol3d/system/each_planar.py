"""Draws of deviations that each of several features has of its own, with a direction each."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.distributions import Distribution
from tol3d.system.draw import Planar, Values

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EachPlanar:
    """As many lengths as there are features, each in a direction of its own: components x and y of one after the other.

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
        """That of one feature."""
        return Planar(self.distribution, self.direction)

    @property
    def uniforms(self) -> int:
        """One or two a feature."""
        return len(self.names) * self.each.uniforms

    @property
    def components(self) -> tuple[str, ...]:
        """x and y of each."""
        return tuple(f"{name} {axis}" for name in self.names for axis in ("x", "y"))

    @property
    def sigma(self) -> float:
        """Standard deviation of one component [mm]."""
        return self.each.sigma

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw."""
        count = self.each.uniforms
        starts = range(0, self.uniforms, count)
        return tuple(own for start in starts for own in self.each.deviations(*uniforms[start : start + count]))

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """See Draw."""
        return self.each.mean(turning=turning) * len(self.names)

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: all lengths at their ends, along what each one's does alone."""
        law, count = self.distribution, len(self.names)
        if self.direction is not None and not turning:
            return np.tile(self.each.ends(values, turning=False), (1, count))
        alone = law.radius * np.concatenate([np.eye(2 * count), -np.eye(2 * count)])
        found = values(alone)
        slopes = found[: 2 * count] - found[2 * count :]
        size = float(np.sqrt((slopes * slopes).sum()))
        along = law.radius * (slopes / size if size > 0.0 else np.eye(2 * count)[0])
        return np.stack([along, -along])
