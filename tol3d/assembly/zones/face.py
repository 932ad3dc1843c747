"""The domain of a plane: height w at the centre and the rises to two edges, |w| + |rises| <= 1, |rises| <= ratio.

|rises| is the norm of the face's cross-section. The set is a prism of height 2 (1 - ratio) with a tip of height ratio
on each end: r = min(1 - |w|, ratio).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.special import ndtr, ndtri

from tol3d.assembly.zones.cross_section import SIGMAS, CrossSection, Diamond, Disc
from tol3d.assembly.zones.domain import Array, Domain, Ratio, UnitLaw
from tol3d.assembly.zones.inverse import NODES, WEIGHTS, Density, InverseTable, integral, inverse, inverse_family, table


@dataclass(frozen=True)
class Face(Domain):
    """Of a plane with a rectangular (Diamond) or a round face (Disc)."""

    section: CrossSection

    @property
    def coordinates(self) -> int:
        """Height and both rises."""
        return 3

    @property
    def uniform(self) -> UnitLaw:
        """See Domain."""
        return UniformFace(self.section)

    @property
    def normal(self) -> UnitLaw:
        """See Domain."""
        return NormalFace(self.section)

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: the middle of an end, or a corner of the prism."""
        height = math.copysign(1.0, gradient[0])
        rises = self.section.furthest(gradient[1:])
        along = float(gradient[1:] @ rises)
        rise = orientation_half if along > abs(gradient[0]) else 0.0
        return np.array([height * (half - rise), *(rise * rises)])

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        """See Domain."""
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

    def density(self, ratio: float, first: Array) -> Array:
        """See UnitLaw."""
        return np.minimum(1.0 - np.abs(first), ratio) ** 2


@dataclass(frozen=True)
class NormalFace(UnitLaw):
    """Normal: the height by its marginal, phi(3 w) times the share of both rises within r; then the section."""

    section: CrossSection

    @property
    def uniforms(self) -> int:
        """Height and both rises."""
        return 3

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: the tips by a table, for their distribution function has no closed form."""
        of_height, u, v = uniforms
        straight, tip = self._masses(ratio)
        tail = np.minimum(of_height, 1.0 - of_height) * (2.0 * (straight + tip) / tip)
        w = np.cbrt(np.minimum(tail, 1.0))
        if isinstance(ratio, float):
            radius = inverse(_TIPS[type(self.section)], 3, ratio)(w)
        else:
            radius = inverse_family(_TIPS[type(self.section)], 3)(w, ratio)
        height = 1.0 - ratio * radius
        if not isinstance(ratio, float) or ratio < 1.0:
            kept = float(self.section.kept(np.asarray(1.0)))
            inner = 0.5 + (straight + tip - tip * np.maximum(tail, 1.0)) / (kept * math.sqrt(2 * math.pi) / SIGMAS)
            height = np.where(tail < 1.0, height, np.minimum(ndtri(inner) / SIGMAS, 1.0 - ratio))
        rises = self.section.normal(radius, u, v)
        return np.copysign(height, of_height - 0.5), *(ratio * rise for rise in rises)

    def _masses(self, ratio: Ratio) -> tuple[Ratio, Ratio]:
        """Of half the prism and of a tip, of the density exp(-(3 w)^2 / 2) times the section's share."""
        kept = float(self.section.kept(np.asarray(1.0)))
        share = ndtr(SIGMAS * (1.0 - ratio)) - 0.5
        straight = kept * math.sqrt(2 * math.pi) / SIGMAS * share
        tip = ratio * _tip_mass(_TIPS[type(self.section)], ratio)
        return straight, tip

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: by Gauss-Legendre over prism and tip."""
        heights = np.concatenate([NODES * (1.0 - ratio), 1.0 - ratio * NODES])
        radii = np.concatenate([np.ones_like(NODES), NODES])
        mass = np.concatenate([WEIGHTS * (1.0 - ratio), WEIGHTS * ratio])
        mass = mass * np.exp(-0.5 * (SIGMAS * heights) ** 2) * self.section.kept(radii)
        mass = mass / mass.sum()
        rise = ratio**2 * float(mass @ self.section.normal_variance(radii))
        return np.diag([float(mass @ heights**2), rise, rise])

    def density(self, ratio: float, first: Array) -> Array:
        """See UnitLaw."""
        radius = np.minimum(1.0 - np.abs(first), ratio) / ratio
        return np.exp(-0.5 * (SIGMAS * first) ** 2) * self.section.kept(radius)


def _tip(kept: Callable[[Array], Array], z: Array, ratio: Array) -> Array:
    """Density of z = r / ratio in a tip."""
    return np.exp(-0.5 * (SIGMAS * (1.0 - ratio * z)) ** 2) * kept(z)


def diamond_tip(z: Array, ratio: Array) -> Array:
    """Density of z = r / ratio in a tip of a rectangular face's domain."""
    return _tip(Diamond.kept, z, ratio)


def disc_tip(z: Array, ratio: Array) -> Array:
    """Density of z = r / ratio in a tip of a round face's domain."""
    return _tip(Disc.kept, z, ratio)


_TIPS: dict[type[CrossSection], Density] = {Diamond: diamond_tip, Disc: disc_tip}


def _tip_mass(density: Density, ratio: Ratio) -> Ratio:
    if isinstance(ratio, float):
        return float(integral(density, np.asarray(1.0), np.asarray(ratio)))
    return _tip_masses(density)(ratio)


@cache
def _tip_masses(density: Density) -> InverseTable:
    return table(lambda ratio: integral(density, np.ones_like(ratio), ratio))
