"""Draws of deviations that every planet has of its own, with a direction each."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.zones.zone_draw import LEAST_STEP, ZoneDraw
from tol3d.distributions import DeviationLaw
from tol3d.system.draw import Values

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EachZone:
    """As many displacements as there are planets, each in a zone of its own: outwards and across, one after the other.

    Args:
        each: that of one planet, of two components.
        names: of the planets.
    """

    each: ZoneDraw
    names: tuple[str, ...]

    @property
    def distribution(self) -> DeviationLaw:
        """Of one component."""
        return self.each.distribution

    @property
    def words(self) -> str:
        """See JointDraw."""
        return f"{self.each.words}, each of {len(self.names)}"

    @property
    def uniforms(self) -> int:
        """Those of one a planet."""
        return len(self.names) * self.each.uniforms

    @property
    def components(self) -> tuple[str, ...]:
        """Both of each."""
        return tuple(f"{name} {axis}" for name in self.names for axis in ("radial", "tangential"))

    @property
    def sigma(self) -> float:
        """Standard deviation of one component [mm]."""
        return self.each.sigma

    @property
    def covariance(self) -> Array:
        """See JointDraw: planets are independent."""
        return np.asarray(np.kron(np.eye(len(self.names)), self.each.covariance), dtype=np.float64)

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw."""
        return tuple(own for part in self._parts(uniforms, self.each.uniforms) for own in self.each.deviations(*part))

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """See Draw."""
        return self.each.mean(turning=turning) * len(self.names)

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: all of them along the steepest direction, as far as one reaches along it by itself.

        All bores at their worst ends at once would be far rarer than the end of one.
        """
        steps, mean = np.maximum(np.sqrt(np.diagonal(self.covariance)), LEAST_STEP), np.array(self.mean(turning=False))
        found = values(mean + np.concatenate([np.diag(steps), -np.diag(steps)]))
        slopes = (found[: len(steps)] - found[len(steps) :]) / (2 * steps)
        return np.stack([self._reach(slopes), self._reach(-slopes)])

    def _reach(self, slopes: Array) -> Array:
        """How far all of them go along slopes, each as large a part of its own reach as its slopes are of all."""
        middle = np.array(self.each.mean(turning=False))
        size = float(np.sqrt((slopes * slopes).sum())) or 1.0
        ends = [
            middle + float(np.sqrt((own * own).sum())) / size * (self.each.furthest(own) - middle)
            for own in slopes.reshape(len(self.names), -1)
        ]
        return np.concatenate(ends)

    def _parts(self, given: Sequence[Array], count: int) -> list[Sequence[Array]]:
        return [given[start : start + count] for start in range(0, len(given), count)]


@dataclass(frozen=True)
class EachJudgedZone(EachZone):
    """The same of a process, which the zone judges only."""

    def beyond(self, *components: Array) -> NDArray[np.bool_]:
        """See JudgedDraw: where any bore lies outside its zone."""
        outside = [~self.each.zone.inside(np.stack(own, axis=-1)) for own in self._parts(components, 2)]
        return np.asarray(np.any(outside, axis=0))
