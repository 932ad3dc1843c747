"""The domains of round surfaces: |outward| + what their middle is off <= 1, for they move by their size and their axis.

Where the radius takes its share of the width, the ends of the axis lie in discs of what is left.
"""

import math
from dataclasses import dataclass

import numpy as np
from typing_extensions import override

from tol3d.assembly.zones.cross_section import SIGMAS, Disc, cut_normal, cut_rayleigh, cut_variance
from tol3d.assembly.zones.ends import Ends, UniformEnds, room
from tol3d.assembly.zones.inverse import NODES, WEIGHTS
from tol3d.assembly.zones.motions import Motions
from tol3d.assembly.zones.zone import Domain, Ratio, UnitLaw
from tol3d.numerics.arrays import Array
from tol3d.study.system.normals import Group, scalars, shifted


@dataclass(frozen=True)
class RoundSurface(Domain):
    """Coordinates: outward by the radius, then start x, start y, end x, end y."""

    coordinates = 5

    @property
    def uniform(self) -> UnitLaw:
        return UniformRoundSurface()

    @property
    def normal(self) -> UnitLaw:
        return NormalRoundSurface()

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: all radius or all axis."""
        ends = Ends().furthest(gradient[1:], half, half)
        if abs(gradient[0]) * half >= gradient[1:] @ ends:
            return np.array([math.copysign(half, gradient[0]), 0.0, 0.0, 0.0, 0.0])
        return np.concatenate([[0.0], ends])

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        start, end = (np.hypot(*coordinates[:, own].T) for own in (slice(1, 3), slice(3, 5)))
        return np.asarray(np.abs(coordinates[:, 0]) + np.maximum(start, end) - half)


@dataclass(frozen=True)
class UniformRoundSurface(UnitLaw):
    """Uniform: the radius by its marginal, proportional to (1 - |outward|)^4, then the ends in discs of the rest."""

    uniforms = 5

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return (*scalars(1), *shifted(UniformEnds().groups(1.0), 1))

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: closed, for the distribution function of what is left is a fifth power."""
        of_size, *of_ends = uniforms
        left = (2.0 * np.minimum(of_size, 1.0 - of_size)) ** 0.2
        ends = UniformEnds().coordinates(1.0, *of_ends)
        return np.copysign(1.0 - left, of_size - 0.5), *(left * end for end in ends)

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: integrals of s^2 (1 - s)^4 and (1 - s)^6, over that of (1 - s)^4."""
        return np.diag([1.0 / 21.0, *[0.25 * 5.0 / 7.0] * 4])


@dataclass(frozen=True)
class NormalRoundSurface(UnitLaw):
    """Normal, sigma 1/3 each: the middle of the axis first, the radius in what it leaves, then the half difference."""

    uniforms = 5

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return Group("plane", (0, 1)), *scalars(1, 2), Group("plane", (3, 4))

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: length and angle of the middle, outward, length of d and its angle against the middle."""
        u, v, w, p, q = uniforms
        length, angle, turn = cut_rayleigh(np.ones_like(u), u), 2.0 * math.pi * v, 2.0 * math.pi * q
        outward = cut_normal(1.0 - length, w)
        left = 1.0 - np.abs(outward)
        apart = cut_rayleigh(np.minimum(_apart(length, left, np.cos(turn), np.sin(turn)), 1.0), p)
        direction = angle + turn
        x, y = length * np.cos(angle), length * np.sin(angle)
        a, b = apart * np.cos(direction), apart * np.sin(direction)
        return outward, x - a, y - b, x + a, y + b

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: by Gauss-Legendre over the middle, the radius and the angle of the half difference."""
        length, share, turn = np.meshgrid(NODES, NODES, 0.5 * math.pi * NODES, indexing="ij")
        of_length = WEIGHTS * NODES * np.exp(-0.5 * (SIGMAS * NODES) ** 2)
        outward = float(of_length @ cut_variance(1.0 - NODES) / of_length.sum())
        size = (1.0 - length) * share
        of_size = np.exp(-0.5 * (SIGMAS * size) ** 2) * WEIGHTS[None, :, None]
        variance = Disc().normal_variance(np.minimum(_apart(length, 1.0 - size, np.cos(turn), np.sin(turn)), 1.0))
        given = ((variance * WEIGHTS).sum(axis=2) * of_size[..., 0]).sum(axis=1) / of_size[..., 0].sum(axis=1)
        apart = float(of_length @ given / of_length.sum())
        middle = float(Disc().normal_variance(np.asarray(1.0)))
        ends = np.kron(np.array([[middle + apart, middle - apart], [middle - apart, middle + apart]]), np.eye(2))
        found = np.zeros((5, 5))
        found[0, 0], found[1:, 1:] = outward, ends
        return found


def _apart(length: Array, left: Array, along: Array, across: Array) -> Array:
    """Longest half difference in a direction (along, across) about a middle of a length, in a disc of radius `left`."""
    some = np.maximum(left, np.finfo(float).tiny)
    return np.asarray(left * room(np.minimum(length / some, 1.0), along, across))


@dataclass(frozen=True)
class BallSurface(Domain):
    """Coordinates: outward by the radius, then the centre x, y, z; by the laws of three shifts and one turn."""

    coordinates = 4

    @property
    def uniform(self) -> UnitLaw:
        return OutwardFirst(Motions(3, 1).uniform)

    @property
    def normal(self) -> UnitLaw:
        return OutwardFirst(Motions(3, 1).normal)

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        return np.roll(Motions(3, 1).furthest(np.roll(gradient, -1), half, orientation_half), 1)

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        return Motions(3, 1).excess(np.roll(coordinates, -1, axis=1), half, orientation_half)


@dataclass(frozen=True)
class OutwardFirst(UnitLaw):
    """A law whose last coordinate is the first one here."""

    law: UnitLaw

    @property
    def uniforms(self) -> int:
        """As of the law."""
        return self.law.uniforms

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return self.law.groups(ratio)

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        *others, last = self.law.coordinates(ratio, *uniforms)
        return last, *others

    def covariance(self, ratio: float) -> Array:
        return np.roll(self.law.covariance(ratio), 1, axis=(0, 1))
