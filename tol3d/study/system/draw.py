"""Draws: how the components of a deviation come from uniforms, and where their ends lie."""

import math
from dataclasses import dataclass
from functools import partial
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import DeviationLaw, Distribution
from tol3d.study.system.normals import Group, scalars
from tol3d.study.system.remembered import Remembered
from tol3d.study.system.steepest import TIE, along, steepest_ends
from tol3d.study.system.steepest import Values as Values  # also of mechanisms from outside


class Draw(Protocol):
    """k uniforms to m components."""

    @property
    def distribution(self) -> DeviationLaw:
        """The law of the deviation, or of its length if it has a direction; of several, that of the first."""
        ...

    @property
    def uniforms(self) -> int:
        """Number of uniforms per trial."""
        ...

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components; "" for an only one."""
        ...

    @property
    def sigma(self) -> float:
        """Standard deviation of one component [mm, rad or K]."""
        ...

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """Components (trials,) [mm, rad or K] of arrays of uniforms (trials,) in (0, 1)."""
        ...

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """Mean of each component; `turning` where the direction turns through all angles from trial to trial."""
        ...

    def ends(self, values: Values, *, turning: bool) -> Array:
        """Both ends of the deviation (2, components), in the direction in which a measure changes most.

        Of a measure that changes alike to both sides, pairs of ends in other directions follow (2 pairs, components).
        """
        ...


@runtime_checkable
class JointDraw(Protocol, metaclass=Remembered):
    """A Draw whose components spread differently or together."""

    @property
    def covariance(self) -> Array:
        """Covariance of the components (components, components) [mm^2, rad^2 or K^2]."""
        ...

    @property
    def words(self) -> str:
        """Its law in words, such as "uniform in its zone"."""
        ...


@runtime_checkable
class MiddleDraw(Protocol, metaclass=Remembered):
    """A Draw of the displacement of a feature, of whose components a stack sees the middle."""

    @property
    def middle_sigma(self) -> float:
        """Standard deviation [mm] of the feature's middle along one direction; see `zones.zone.Shape` for others."""
        ...


def told_sigma(draw: Draw) -> float:
    """Standard deviation that tables show [mm, rad or K]: of a feature's middle, else of one component."""
    return draw.middle_sigma if isinstance(draw, MiddleDraw) else draw.sigma


def drawn_each(draw: Draw) -> bool:
    """True if its components are several independent deviations, such as one per feature, not directions."""
    count, first = len(draw.components), draw.components[0] if draw.components else ""
    directed = first.rpartition(" ")[2] == "x" or isinstance(draw, JointDraw)
    return count > 1 and draw.uniforms == count and not directed


def component_sigmas(draw: Draw) -> tuple[float, ...]:
    """Standard deviation of each component of a draw [mm, rad or K]."""
    if isinstance(draw, JointDraw):
        return tuple(np.sqrt(np.diagonal(draw.covariance)).tolist())
    return (draw.sigma,) * len(draw.components)


@runtime_checkable
class JudgedDraw(Protocol, metaclass=Remembered):
    """A Draw that a drawing judges and does not confine."""

    def beyond(self, *components: Array) -> NDArray[np.bool_]:
        """True for draws (trials,) that the drawing does not allow, from components (trials,); they stay in trials."""
        ...


@dataclass(frozen=True)
class Scalar:
    """One component, drawn straight from the distribution."""

    distribution: Distribution

    uniforms = 1
    components = ("",)
    groups = scalars(1)

    @property
    def sigma(self) -> float:
        """Standard deviation of the component [mm, rad or K]."""
        return self.distribution.sigma

    def deviations(self, *uniforms: Array) -> tuple[Array]:
        """See Draw."""
        (u,) = uniforms
        return (self.distribution.ppf(u),)

    def mean(self, *, turning: bool) -> tuple[float]:
        """See Draw."""
        return (self.distribution.mean,)

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw."""
        return np.array([[self.distribution.low], [self.distribution.high]])


@dataclass(frozen=True)
class Planar:
    """A length in a direction of a plane: components x, y.

    `direction` None draws it uniform over the circle (a Rayleigh length then makes x and y two
    independent normals); an angle [rad] fixes it.
    """

    distribution: Distribution
    direction: float | None

    components = ("x", "y")

    @property
    def uniforms(self) -> int:
        """Number of uniforms per trial: the length, and the direction unless it is fixed."""
        return 1 if self.direction is not None else 2

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth."""
        return scalars(1) if self.direction is not None else (Group("plane", (0, 1)),)

    @property
    def sigma(self) -> float:
        """Standard deviation along any one axis [mm] for a random direction; else that of the length."""
        if self.direction is not None:
            return self.distribution.sigma
        return math.sqrt((self.distribution.variance + self.distribution.mean**2) / 2)

    def deviations(self, *uniforms: Array) -> tuple[Array, Array]:
        """See Draw: x and y (trials,) [mm]."""
        length = self.distribution.ppf(uniforms[0])
        if self.direction is not None:
            return length * math.cos(self.direction), length * math.sin(self.direction)
        angle = 2 * math.pi * uniforms[1]
        return length * np.cos(angle), length * np.sin(angle)

    def mean(self, *, turning: bool) -> tuple[float, float]:
        """See Draw; a random direction averages to zero."""
        if self.direction is None or turning:
            return 0.0, 0.0
        return self.distribution.mean * math.cos(self.direction), self.distribution.mean * math.sin(self.direction)

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw; of a random direction both ends of the radius along the steepest one."""
        law = self.distribution
        if self.direction is not None and not turning:
            return np.outer([law.low, law.high], [math.cos(self.direction), math.sin(self.direction)])
        return steepest_ends(values, np.zeros(2), np.full(2, law.radius), partial(along, law.radius))


@dataclass(frozen=True)
class Ball:
    """A length in a random direction of space, such as of a point's position: components x, y, z."""

    distribution: Distribution

    uniforms = 3
    components = ("x", "y", "z")
    groups = (Group("space", (0, 1, 2)),)

    @property
    def sigma(self) -> float:
        """Standard deviation along any one axis [mm]."""
        return math.sqrt((self.distribution.variance + self.distribution.mean**2) / 3)

    def deviations(self, *uniforms: Array) -> tuple[Array, Array, Array]:
        """See Draw: of length, azimuth and height, for heights on a ball are uniform (Archimedes)."""
        length, azimuth, height = self.distribution.ppf(uniforms[0]), 2 * math.pi * uniforms[1], 2 * uniforms[2] - 1
        across = length * np.sqrt(1 - height * height)
        return across * np.cos(azimuth), across * np.sin(azimuth), length * height

    def mean(self, *, turning: bool) -> tuple[float, float, float]:
        """See Draw; a random direction averages to zero."""
        return 0.0, 0.0, 0.0

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: both ends of the radius along the steepest direction."""
        radius = self.distribution.radius
        return steepest_ends(values, np.zeros(3), np.full(3, radius), partial(along, radius))


@dataclass(frozen=True)
class Each:
    """Independent draws of one distribution for each of several features: pins, lobes, planets.

    Args:
        distribution: of each of them.
        names: of the features.
    """

    distribution: Distribution
    names: tuple[str, ...]

    @property
    def uniforms(self) -> int:
        """One a feature."""
        return len(self.names)

    @property
    def components(self) -> tuple[str, ...]:
        """The features."""
        return self.names

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth."""
        return scalars(len(self.names))

    @property
    def sigma(self) -> float:
        """Standard deviation of each component."""
        return self.distribution.sigma

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw."""
        return tuple(self.distribution.ppf(u) for u in uniforms)

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """See Draw."""
        return (self.distribution.mean,) * len(self.names)

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: as far along the steepest direction as the law reaches, by all features together.

        All of them at their worst ends at once would be far rarer than the end of one deviation: sqrt(features) times
        as many sigma of their joint effect. Of a measure that changes alike to both sides each one's pair of ends
        follows: its slopes are rounding.
        """
        law, count = self.distribution, len(self.names)
        alone = np.full((2 * count + 1, count), law.mean)
        alone[np.arange(count), np.arange(count)] = law.high
        alone[count + np.arange(count), np.arange(count)] = law.low
        *found, middle = values(alone)
        above, below = np.array(found).reshape(2, count)
        slope = above - below
        if np.abs((above + below) / 2.0 - middle).sum() > (1.0 + TIE) * np.abs(slope).sum() / 2.0:
            return alone[:-1].reshape(2, count, count).transpose(1, 0, 2).reshape(2 * count, count)
        size = float(np.sqrt((slope * slope).sum()))
        along = slope / size if size > 0.0 else np.zeros(count)
        reach = np.stack([np.where(along > 0.0, law.high, law.low), np.where(along > 0.0, law.low, law.high)])
        return np.asarray(law.mean + np.abs(along) * (reach - law.mean))
