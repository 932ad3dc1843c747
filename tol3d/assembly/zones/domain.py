"""Deviation domains: the sets of small displacements that tolerance zones allow, and what a law in one offers."""

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from tol3d.system.normals import Group, scalars

Array = NDArray[np.float64]
Ratio = float | Array
"""Width of the orientation zone over that of the zone, in (0, 1]: one number, or one a trial."""


class UnitLaw(ABC):
    """A law confined to a domain of half width 1; elementwise, for each trial from its own uniforms."""

    @property
    @abstractmethod
    def uniforms(self) -> int:
        """How many uniforms a trial takes."""

    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        """What the uniforms are, see Smooth: each by itself if not said otherwise."""
        return scalars(self.uniforms)

    @abstractmethod
    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """Coordinates (trials,) in half widths, of uniforms (trials,) in (0, 1)."""

    @abstractmethod
    def covariance(self, ratio: float) -> Array:
        """Covariance (coordinates, coordinates) in squared half widths; every mean is 0."""


class Domain(ABC):
    """A convex set of coordinates, symmetric about 0, of a half width and an orientation half width."""

    @property
    @abstractmethod
    def coordinates(self) -> int:
        """How many coordinates it has."""

    @property
    @abstractmethod
    def uniform(self) -> UnitLaw:
        """Uniform in the set."""

    @property
    @abstractmethod
    def normal(self) -> UnitLaw:
        """The middle of the feature first, a normal of sigma 1/3 truncated to the set as a point's would be.

        Tilts and half differences are normals of sigma ratio / 3, confined to what the middle leaves; where the zone
        holds no middle, of sigma 1/3.
        """

    @abstractmethod
    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """The point (coordinates,) [mm] of the set that lies furthest along a gradient (coordinates,)."""

    @abstractmethod
    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        """How far points (trials, coordinates) lie outside [mm], by the limit exceeded most; <= 0 inside."""
