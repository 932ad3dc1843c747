"""A tolerance zone as a drawing states it: which displacements it allows, and how far they reach."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.study.system.normals import Group, scalars

Ratio = float | Array
"""Width of the orientation zone over that of the zone, in (0, 1]: one number, or one per trial."""


class UnitLaw(ABC):
    """A law confined to a domain of half width 1; elementwise, for each trial from its own uniforms."""

    @property
    @abstractmethod
    def uniforms(self) -> int:
        """Number of uniforms per trial."""

    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        """Groups of the uniforms, see Smooth; by default each by itself."""
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
        """Number of coordinates."""

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
        """Distance of points (trials, coordinates) outside [mm], by the limit exceeded most; <= 0 inside."""


INSIDE_XTOL = 1e-12  # mm; a thousand times the rounding of a drawn point, far under any width
LEAST_RATIO = 1e-9  # an orientation zone narrower than that is none


@dataclass(frozen=True)
class Shape:
    """Coordinates of a deviation domain and their effect on the feature.

    Args:
        domain: of the coordinates.
        names: of the coordinates, which are the components that are drawn.
        embedding: components of the feature = embedding (components of the feature, coordinates) @ coordinates.
        middle: weights of the coordinates in a displacement of the feature's middle, along one direction; the first
            coordinate by default. For an orientation alone, without a middle, it is a rise or an end's offset.
    """

    domain: Domain
    names: tuple[str, ...]
    embedding: tuple[tuple[float, ...], ...]
    middle: tuple[float, ...] = ()


@dataclass(frozen=True)
class Zone:
    """A zone of a width t and, within it, the orientation refined to t_o; lengths in mm.

    Args:
        shape: what it holds.
        width: t, diameter of a round one; 0 where all of it is bonus.
        orientation: t_o, in (0, t]; None where the zone alone limits the orientation.
        outward: how much of an unequal profile lies outside the material; None for an equal one. It moves the first
            component by outward - t / 2.
        form: f, in [0, t): what the form of the surface takes of the width; t - f is left for where it lies.
    """

    shape: Shape
    width: float
    orientation: float | None = None
    outward: float | None = None
    form: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.width < math.inf:
            raise InputError(f"zone: expected a width of 0 mm or more, got {self.width:g} mm")
        if self.orientation is not None and not 0.0 < self.orientation <= self.width:
            expected = f"an orientation above 0 mm, within the width of the zone ({self.width:g} mm)"
            raise InputError(f"zone: expected {expected}, got {self.orientation:g} mm; state the wider one alone")
        if self.outward is not None and not math.isfinite(self.outward):
            raise InputError(f"zone: expected a finite length outward, got {self.outward} mm")
        if not (self.form == 0.0 or 0.0 < self.form < self.width):
            expected = f"a form of 0 mm or more, within the width of the zone ({self.width:g} mm)"
            raise InputError(f"zone: expected {expected}, got {self.form:g} mm")

    @property
    def components(self) -> tuple[str, ...]:
        """Names of what is drawn."""
        return self.shape.names

    @cached_property
    def matrix(self) -> Array:
        """Components of the feature = matrix (components of the feature, components) @ components; without unit."""
        return np.array(self.shape.embedding)

    @cached_property
    def middle(self) -> Array:
        """Displacement of the feature's middle along one direction = middle (components,) @ components; see Shape."""
        count = len(self.components)
        return np.array(self.shape.middle) if self.shape.middle else np.eye(1, count)[0]

    @cached_property
    def half(self) -> float:
        """Half of what is left of the width, (t - f) / 2 [mm]."""
        return 0.5 * (self.width - self.form)

    @cached_property
    def ratio(self) -> float:
        """t_o / (t - f), at most 1; exactly 1.0 where the orientation is not refined."""
        return 1.0 if self.orientation is None else min(max(0.5 * self.orientation / self.half, LEAST_RATIO), 1.0)

    @property
    def centre(self) -> float:
        """Middle of the zone along the first component [mm]."""
        return 0.0 if self.outward is None else self.outward - 0.5 * self.width

    def resized(self, width: float) -> "Zone":
        """The same of another width, about the same middle.

        Raises:
            InputError: no width, or one that leaves nothing beside what refines it.
        """
        outward = None if self.outward is None else self.centre + 0.5 * width
        return replace(self, width=width, outward=outward)

    def halves(self, width: Ratio | None = None, orientation: Ratio | None = None) -> tuple[Ratio, Ratio]:
        """As `half` and `ratio`, of widths that may be other ones in each trial (trials,) [mm].

        Args:
            width: t; the zone's own, if None. Where the form takes all of it, the half width is 0.
            orientation: t_o; the zone's own, if None, and none where it states none.
        """
        if width is None and orientation is None:
            return self.half, self.ratio
        half = 0.5 * np.maximum(np.asarray(self.width if width is None else width, dtype=np.float64) - self.form, 0.0)
        if orientation is None:
            if self.orientation is None:
                return half, 1.0
            orientation = self.orientation
        half, own = np.broadcast_arrays(half, 0.5 * np.asarray(orientation, dtype=np.float64))
        ratio = np.divide(own, half, out=np.ones_like(half), where=half > 0.0)
        return half, np.clip(ratio, LEAST_RATIO, 1.0)

    def furthest(self, gradient: Array, width: float | None = None, orientation: float | None = None) -> Array:
        """The point (components,) [mm] of the zone that lies furthest along a gradient (components,)."""
        half, ratio = (float(value) for value in self.halves(width, orientation))
        point = self.shape.domain.furthest(gradient, half, half * ratio) if half > 0.0 else np.zeros(len(gradient))
        point[0] += self.centre
        return point

    def support(self, gradient: Array, width: float | None = None, orientation: float | None = None) -> float:
        """The largest value of gradient · components in the zone: the worst case of a linear measure.

        Args:
            gradient: (components,), change of the measure per mm.
            width: t [mm]; the zone's own, if None.
            orientation: t_o likewise.
        """
        return float((gradient * self.furthest(gradient, width, orientation)).sum())

    def excess(self, components: Array, width: Ratio | None = None, orientation: Ratio | None = None) -> Array:
        """Distance of displacements (trials, components) outside [mm], (trials,), by the limit exceeded most.

        It is <= 0 inside.

        Args:
            components: as drawn.
            width: t, of all or of each trial (trials,) [mm]; the zone's own, if None.
            orientation: t_o likewise.
        """
        half, ratio = self.halves(width, orientation)
        coordinates = np.array(components, dtype=np.float64)
        coordinates[:, 0] -= self.centre
        return self.shape.domain.excess(coordinates, half, half * ratio)

    def inside(
        self, components: Array, width: Ratio | None = None, orientation: Ratio | None = None
    ) -> NDArray[np.bool_]:
        """Which displacements (trials, components) satisfy the drawing, (trials,); see `excess`."""
        return np.asarray(self.excess(components, width, orientation) <= INSIDE_XTOL)
