"""Zones that a bonus widens: draws from the widened zone, and processes that it judges.

Both are what a drawing may mean: by the first a maker uses the room that a size leaves, by the second his process does
not know of it and only the inspection does.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.zones.bonus import Bonus
from tol3d.assembly.zones.domain import Array, Ratio
from tol3d.assembly.zones.zone_draw import ComponentLaw, Confined, Process, ZoneDraw
from tol3d.distributions import Distribution
from tol3d.system.dependent import Given
from tol3d.system.normals import Group


@dataclass(frozen=True)
class SizedBy:
    """The size that widens a zone.

    Args:
        name: of its contributor.
        law: of its deviation from nominal [mm].
        bonus: what it adds.
    """

    name: str
    law: Distribution
    bonus: Bonus

    def of(self, given: Given) -> Array:
        """Deviations of size (trials,) [mm]."""
        return np.asarray(given[self.name][0])


@dataclass(frozen=True)
class Widened(ZoneDraw):
    """Of a law within a zone that each trial's size widens; implements Dependent.

    Args:
        zone: without bonus.
        confined: the draw from it.
        size: by which it is widened.
    """

    confined: Confined
    size: SizedBy

    @property
    def words(self) -> str:
        """See ZoneDraw."""
        return f"{self.confined.words}, widened by the bonus of {self.size.name}"

    @property
    def reads(self) -> tuple[str, ...]:
        """See Dependent: the size."""
        return (self.size.name,)

    @property
    def uniforms(self) -> int:
        """See ZoneDraw."""
        return self.confined.uniforms

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth: as where the zone is as wide as in no other trial, if its orientation is limited by itself."""
        _, ratio = self.zone.halves(np.array([self.zone.width]), None)
        return self.confined.law.groups(ratio)

    @property
    def mean_vector(self) -> Array:
        """See ZoneDraw; a bonus widens to all sides alike."""
        return self.confined.mean_vector

    @cached_property
    def covariance(self) -> Array:
        """See ZoneDraw; over all sizes."""
        return self.size.bonus.covariance(self.confined, self.size.law)

    @cached_property
    def distribution(self) -> ComponentLaw:
        """See ZoneDraw; over all sizes."""
        return replace(self._widest.distribution, variance=float(self.covariance[0, 0]))

    @cached_property
    def _widest(self) -> Confined:
        ends = np.array([self.size.law.low, self.size.law.high])
        return self._at(float(ends[np.argmax(self.size.bonus.of(ends))]))

    def _at(self, size: float) -> Confined:
        return replace(self.confined, zone=self.size.bonus.zone_at(self.zone, size))

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Dependent: not asked, for the size is missing."""
        raise TypeError(f"{self.words}: expected the sizes of the trials")

    def deviations_in(self, width: Ratio, orientation: Ratio | None, *uniforms: Array) -> tuple[Array, ...]:
        """See ZoneDraw."""
        return self.confined.deviations_in(width, orientation, *uniforms)

    def deviations_given(self, given: Given, *uniforms: Array) -> tuple[Array, ...]:
        """See Dependent."""
        return self.deviations_in(*self.size.bonus.widths(self.zone, self.size.of(given)), *uniforms)

    def furthest(self, gradient: Array) -> Array:
        """See ZoneDraw: in the widest zone that a size leaves."""
        return self._widest.furthest(gradient)

    def furthest_given(self, given: Given, slopes: Array) -> Array:
        """See Dependent."""
        return self._at(float(self.size.of(given)[0])).furthest(slopes)

    def support(self, gradient: Array) -> float:
        """See ZoneDraw: in the widest zone that a size leaves."""
        return self._widest.support(gradient)


@dataclass(frozen=True)
class JudgedProcess(Process):
    """A process that its zone judges with the bonus of each trial's size; implements DependentlyJudged.

    Args:
        size: by which the zone is widened.
    """

    size: SizedBy

    @property
    def words(self) -> str:
        """See ZoneDraw."""
        return f"its own process, judged with the bonus of {self.size.name}"

    @property
    def reads(self) -> tuple[str, ...]:
        """See DependentlyJudged: the size."""
        return (self.size.name,)

    def beyond_given(self, given: Given, *components: Array) -> NDArray[np.bool_]:
        """See DependentlyJudged: outside the zone of the trial's width."""
        widths = self.size.bonus.widths(self.zone, self.size.of(given))
        return ~self.zone.inside(np.stack(components, axis=-1), *widths)
