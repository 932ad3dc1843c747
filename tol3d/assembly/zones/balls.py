"""Balls: domains whose limit is one norm of the coordinates, in one, two or three dimensions."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri
from typing_extensions import override

from tol3d.assembly.zones.cross_section import SIGMAS, CrossSection
from tol3d.assembly.zones.inverse import NODES, WEIGHTS, inverse
from tol3d.assembly.zones.zone import Domain, Ratio, UnitLaw
from tol3d.numerics.arrays import Array
from tol3d.study.system.normals import Group


@dataclass(frozen=True)
class Line(Domain):
    """|x| <= 1: a point between two planes, an axis between two lines that keeps its direction."""

    coordinates = 1

    @property
    def uniform(self) -> UnitLaw:
        return UniformLine()

    @property
    def normal(self) -> UnitLaw:
        return NormalLine()

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        return np.copysign(half, gradient)

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        return np.asarray(np.abs(coordinates[:, 0]) - half)


@dataclass(frozen=True)
class UniformLine(UnitLaw):
    """Uniform within ±1."""

    uniforms = 1

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        return (2.0 * uniforms[0] - 1.0,)

    def covariance(self, ratio: float) -> Array:
        return np.array([[1.0 / 3.0]])


@dataclass(frozen=True)
class NormalLine(UnitLaw):
    """Normal of sigma 1/3, truncated at ±1."""

    uniforms = 1

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        value = ndtri(0.5 + (uniforms[0] - 0.5) * math.erf(SIGMAS * math.sqrt(0.5))) / SIGMAS
        return (np.clip(value, -1.0, 1.0),)

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: (1 - 6 phi(3) / (2 Phi(3) - 1)) / 9."""
        at_end = math.sqrt(2.0 / math.pi) * SIGMAS * math.exp(-0.5 * SIGMAS**2)
        return np.array([[(1.0 - at_end / math.erf(SIGMAS * math.sqrt(0.5))) / SIGMAS**2]])


@dataclass(frozen=True)
class Flat(Domain):
    """A cross-section of radius 1: rises alone, or a point or an axis in a disc."""

    section: CrossSection

    coordinates = 2

    @property
    def uniform(self) -> UnitLaw:
        return UniformFlat(self.section)

    @property
    def normal(self) -> UnitLaw:
        return NormalFlat(self.section)

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        return half * self.section.furthest(gradient)

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        return self.section.length(coordinates) - half


@dataclass(frozen=True)
class UniformFlat(UnitLaw):
    """Uniform in a cross-section."""

    section: CrossSection

    uniforms = 2

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return self.section.groups

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        return self.section.uniform(_ONE, *uniforms)

    def covariance(self, ratio: float) -> Array:
        return self.section.uniform_variance * np.eye(2)


@dataclass(frozen=True)
class NormalFlat(UnitLaw):
    """Normal of sigma 1/3, conditioned on a cross-section."""

    section: CrossSection

    uniforms = 2

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return self.section.groups

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        return self.section.normal(_ONE, *uniforms)

    def covariance(self, ratio: float) -> Array:
        return float(self.section.normal_variance(_ONE)) * np.eye(2)


@dataclass(frozen=True)
class RingFlat(UnitLaw):
    """At the edge of a disc, at a uniform phase."""

    uniforms = 1

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return (Group("phase", (0,)),)

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        phase = (2.0 * math.pi) * uniforms[0]
        return np.cos(phase), np.sin(phase)

    def covariance(self, ratio: float) -> Array:
        return 0.5 * np.eye(2)


@dataclass(frozen=True)
class Sphere(Domain):
    """A point in a sphere."""

    coordinates = 3

    @property
    def uniform(self) -> UnitLaw:
        return UniformSphere()

    @property
    def normal(self) -> UnitLaw:
        return NormalSphere()

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        size = math.hypot(*gradient)
        return half * (gradient / size if size > 0.0 else np.array([1.0, 0.0, 0.0]))

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        return np.asarray(np.sqrt((coordinates * coordinates).sum(axis=1)) - half)


@dataclass(frozen=True)
class UniformSphere(UnitLaw):
    """Uniform in a sphere: the cube of the radius is uniform."""

    uniforms = 3

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return (Group("space", (0, 1, 2)),)

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        return _in_space(np.cbrt(uniforms[0]), *uniforms[1:])

    def covariance(self, ratio: float) -> Array:
        return np.eye(3) / 5.0


@dataclass(frozen=True)
class NormalSphere(UnitLaw):
    """Normal of sigma 1/3, conditioned on the sphere: the radius is a truncated Maxwell, by a table."""

    uniforms = 3

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return (Group("space", (0, 1, 2)),)

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        return _in_space(inverse(maxwell, 3)(np.cbrt(uniforms[0])), *uniforms[1:])

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: a third of the radius' second moment, by Gauss-Legendre."""
        mass = WEIGHTS * maxwell(NODES)
        return float(mass @ NODES**2 / mass.sum() / 3.0) * np.eye(3)


def maxwell(radius: Array) -> Array:
    """Density of the length of three normals of sigma 1/3, up to a factor."""
    return radius * radius * np.exp(-0.5 * (SIGMAS * radius) ** 2)


def _in_space(length: Array, azimuth: Array, height: Array) -> tuple[Array, Array, Array]:
    """Vectors of given lengths in uniform directions: heights on a sphere are uniform (Archimedes)."""
    angle, z = 2.0 * math.pi * azimuth, 2.0 * height - 1.0
    across = length * np.sqrt(1.0 - z * z)
    return across * np.cos(angle), across * np.sin(angle), length * z


_ONE = np.asarray(1.0)
