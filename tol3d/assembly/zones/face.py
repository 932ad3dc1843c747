"""The domain of a plane: height w at the centre and the rises to two edges, |w| + |rises| <= 1, |rises| <= ratio.

|rises| is the norm of the face's cross-section. The set is a prism of height 2 (1 - ratio) with a tip of height ratio
on each end: r = min(1 - |w|, ratio).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from typing_extensions import override

from tol3d.assembly.zones.balls import NormalLine
from tol3d.assembly.zones.cross_section import SIGMAS, CrossSection
from tol3d.assembly.zones.inverse import NODES, WEIGHTS
from tol3d.assembly.zones.zone import Domain, Ratio, UnitLaw
from tol3d.numerics.arrays import Array
from tol3d.study.system.normals import Group, scalars, shifted


@dataclass(frozen=True)
class Face(Domain):
    """Domain of a plane with a rectangular (Diamond) or a round face (Disc)."""

    section: CrossSection

    @property
    def coordinates(self) -> int:
        """Height and both rises."""
        return 3

    @property
    def uniform(self) -> UnitLaw:
        return UniformFace(self.section)

    @property
    def normal(self) -> UnitLaw:
        return NormalFace(self.section)

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: the middle of an end, or a corner of the prism."""
        height = math.copysign(1.0, gradient[0])
        rises = self.section.furthest(gradient[1:])
        along = float(gradient[1:] @ rises)
        rise = orientation_half if along > abs(gradient[0]) else 0.0
        return np.array([height * (half - rise), *(rise * rises)])

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        rises = self.section.length(coordinates[:, 1:])
        return np.maximum(np.abs(coordinates[:, 0]) + rises - half, rises - orientation_half)


@dataclass(frozen=True)
class UniformFace(UnitLaw):
    """Uniform: the height by its marginal, proportional to r^2, then uniform in the section."""

    section: CrossSection

    @property
    def uniforms(self) -> int:
        """Height and both rises."""
        return 3

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return (*scalars(1), *shifted(self.section.groups, 1))

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: closed, for the height's distribution function is a line and a cubic."""
        of_height, u, v = uniforms
        tail = 2.0 * np.minimum(of_height, 1.0 - of_height)
        volume = 1.0 - ratio * (2.0 / 3.0)  # of half the set, over ratio^2
        radius = np.minimum(np.cbrt((3.0 * ratio * ratio * volume) * tail), ratio)
        height = np.where(radius < ratio, 1.0 - radius, (1.0 - tail) * volume)
        return np.copysign(height, of_height - 0.5), *self.section.uniform(radius, u, v)

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: integrals of r^2, w^2 r^2 and r^4 over the heights."""
        straight = 1.0 - ratio
        volume = straight + ratio / 3.0
        height = straight**3 / 3.0 + ratio * (1.0 / 3.0 - ratio / 2.0 + ratio**2 / 5.0)
        square = ratio**2 * (straight + ratio / 5.0)
        rise = self.section.uniform_variance * square / volume
        return np.diag([height / volume, rise, rise])


@dataclass(frozen=True)
class NormalFace(UnitLaw):
    """Normal: the height as of a point, then both rises, of sigma ratio / 3, in the section that the height leaves."""

    section: CrossSection

    @property
    def uniforms(self) -> int:
        """Height and both rises."""
        return 3

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return (*scalars(1), *shifted(self.section.groups, 1))

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        of_height, u, v = uniforms
        (height,) = NormalLine().coordinates(ratio, of_height)
        radius = np.minimum((1.0 - np.abs(height)) / ratio, 1.0)
        return height, *(ratio * rise for rise in self.section.normal(radius, u, v))

    def covariance(self, ratio: float) -> Array:
        rise = ratio**2 * left_by_a_normal(self.section.normal_variance, ratio)
        return np.diag([NormalLine().covariance(ratio)[0, 0], rise, rise])


def left_by_a_normal(variance: Callable[[Array], Array], ratio: float) -> float:
    """Mean of a variance of the radius min(1 - |w|, ratio) / ratio, for a normal height w truncated at ±1.

    By Gauss-Legendre where the height limits it.
    """
    mass = WEIGHTS * ratio * np.exp(-0.5 * (SIGMAS * (1.0 - ratio * NODES)) ** 2)
    straight = math.sqrt(0.5 * math.pi) / SIGMAS * math.erf(math.sqrt(0.5) * SIGMAS * (1.0 - ratio))
    total = straight * float(variance(np.asarray(1.0))) + float((mass * variance(NODES)).sum())
    return total / (straight + float(mass.sum()))
